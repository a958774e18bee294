"""Component for the area of the section."""

import openmdao.api as om

from seal_mdao.components.failures import admissible_design
from seal_mdao.components.options import add_boundary_offsets
from seal_mdao.seals.seal import Seal

CHECK_STEP = 1e-2
"""Step of ``check_partials``, mm. The area is a polynomial of degree two in the offsets: complex steps
of any size are exact, and so are central differences, which OpenMDAO uses without
``setup(force_alloc_complex=True)``."""


class AreaComp(om.ExplicitComponent):
    """Exact area of a seal's section, with its exact gradient; complex step works as well.

    Offsets that the seal does not admit raise ``AnalysisError``.
    """

    def initialize(self):
        self.options.declare("seal", types=Seal, recordable=False, desc="The seal.")

    def setup(self):
        seal = self.options["seal"]
        add_boundary_offsets(self, seal)
        self.add_output("area", val=100.0, units="mm**2", desc="Area of the section.")

    def setup_partials(self):
        self.declare_partials("area", "boundary_offsets")
        self.set_check_partial_options(wrt="*", method="cs", form="central", step=CHECK_STEP)

    def compute(self, inputs, outputs):
        seal, offsets = self.options["seal"], inputs["boundary_offsets"]
        with admissible_design():
            # limits apply to the real part; the imaginary part carries the complex step
            seal.check_offsets(offsets.real)
        outputs["area"] = seal.area(offsets)[0]

    def compute_partials(self, inputs, partials):
        gradient = self.options["seal"].area(inputs["boundary_offsets"])[1]
        partials["area", "boundary_offsets"] = gradient
