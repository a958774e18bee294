"""Component for the area of the section."""

from seal_mdao.components.options import OffsetsComp


class AreaComp(OffsetsComp):
    """Exact area of a seal's section, a polynomial of degree two in the offsets, with its gradient."""

    def setup(self):
        super().setup()
        self.add_output("area", val=100.0, units="mm**2", desc="Area of the section.")

    def setup_partials(self):
        super().setup_partials()
        if self.options["seal"].n_offsets:
            self.declare_partials("area", "boundary_offsets")

    def compute(self, inputs, outputs):
        outputs["area"] = self.options["seal"].area(self.checked_offsets(inputs))[0]

    def compute_partials(self, inputs, partials):
        if self.options["seal"].n_offsets:
            gradient = self.options["seal"].area(inputs["boundary_offsets"])[1]
            partials["area", "boundary_offsets"] = gradient
