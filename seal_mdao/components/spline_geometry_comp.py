"""Component from boundary offsets to particles."""

import numpy as np
import openmdao.api as om

from seal_mdao.components.failures import admissible_design
from seal_mdao.components.options import add_boundary_offsets
from seal_mdao.seals.seal import Seal

CHECK_STEP = 1e-2
"""Step of ``check_partials``, mm. Particles are linear in the offsets: complex steps of any size are
exact, and so are central differences, which OpenMDAO uses without
``setup(force_alloc_complex=True)``."""


class SplineGeometryComp(om.ExplicitComponent):
    """Particles of a seal from the offsets of its boundaries.

    particles = nominal particles + sum_p boundary_offsets[p] V_p, linear, with the design velocity V
    of Eq. (48) as constant sparse partials. Complex step works as well. Inadmissible offsets raise
    ``AnalysisError``.
    """

    def initialize(self):
        self.options.declare("seal", types=Seal, recordable=False, desc="The seal.")

    def setup(self):
        seal = self.options["seal"]
        add_boundary_offsets(self, seal)
        self.add_output(
            "particles", val=seal.drawn_particles, units="mm", desc="Undeformed particles X_I."
        )

    def setup_partials(self):
        # J = V^T, (2 n, P); boundary parameters move few particles, so only entries that are not zero
        velocity = self.options["seal"].design_velocity
        jacobian = velocity.reshape(len(velocity), -1).T
        rows, cols = np.nonzero(jacobian)
        self.declare_partials(
            "particles", "boundary_offsets", rows=rows, cols=cols, val=jacobian[rows, cols]
        )
        self.set_check_partial_options(wrt="*", method="cs", form="central", step=CHECK_STEP)

    def compute(self, inputs, outputs):
        seal, offsets = self.options["seal"], inputs["boundary_offsets"]
        with admissible_design():
            seal.check_offsets(offsets.real)
        # X = X_0 + sum_p b_p V_p
        outputs["particles"] = seal.moved(offsets)
