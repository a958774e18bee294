"""Area of the section."""

import numpy as np
import openmdao.api as om

from seal_mdao.design.area import section_area
from seal_mdao.model import SealModel


class AreaComp(om.ExplicitComponent):
    """Exact area between the two spline boundaries of a seal, with its exact gradient."""

    def initialize(self):
        self.options.declare("model", types=SealModel, recordable=False, desc="The seal model.")

    def setup(self):
        model = self.options["model"]
        self.add_input(
            "boundary_offsets",
            val=np.zeros(model.n_offsets),
            units="mm",
            desc="Spline control values along the rays: outer, then inner boundary.",
        )
        self.add_output("area", val=100.0, units="mm**2", desc="Area of the section.")

    def setup_partials(self):
        self.declare_partials("area", "boundary_offsets")

    def compute(self, inputs, outputs):
        model = self.options["model"]
        offsets = model.check_offsets(inputs["boundary_offsets"])
        outputs["area"] = section_area(model.splines, offsets)[0]

    def compute_partials(self, inputs, partials):
        splines = self.options["model"].splines
        partials["area", "boundary_offsets"] = section_area(splines, inputs["boundary_offsets"])[1]
