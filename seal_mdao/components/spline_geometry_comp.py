"""Component from boundary offsets to particles."""

import numpy as np

from seal_mdao.components.options import OffsetsComp


class SplineGeometryComp(OffsetsComp):
    """Compute the particles of a seal from the offsets of its boundaries.

    particles = nominal particles + sum_p boundary_offsets[p] V_p, linear, with the design velocity V
    as constant sparse partials.
    """

    def setup(self):
        super().setup()
        self.add_output(
            "particles",
            val=self.options["seal"].nominal_particles,
            units="mm",
            desc="Undeformed particles X_I.",
        )

    def setup_partials(self):
        super().setup_partials()
        if not self.options["seal"].n_offsets:
            return
        # J = V^T, (2 n, P); boundary parameters move few particles, so only entries that are not zero
        velocity = self.options["seal"].design_velocity
        jacobian = velocity.reshape(len(velocity), -1).T
        rows, cols = np.nonzero(jacobian)
        self.declare_partials(
            "particles", "boundary_offsets", rows=rows, cols=cols, val=jacobian[rows, cols]
        )

    def compute(self, inputs, outputs):
        # X = X_0 + sum_p b_p V_p
        outputs["particles"] = self.options["seal"].moved(self.checked_offsets(inputs))
