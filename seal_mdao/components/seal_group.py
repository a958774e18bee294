"""Geometry, area and contact analysis wired together."""

import openmdao.api as om

from seal_mdao.components.area_comp import AreaComp
from seal_mdao.components.optional_inputs import OPTIONAL_INPUTS, check_parameters
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp
from seal_mdao.components.spline_geometry_comp import SplineGeometryComp
from seal_mdao.dsa.sensitivity import METHODS
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.measures.catalogue import FURTHER_MEASURES, check_measures
from seal_mdao.model import SealModel, door_seal
from seal_mdao.seal import FACTOR_MEMORY
from seal_mdao.settings import SETTINGS_OPTION, settings_json


class SealGroup(om.Group):
    """A seal from its design parameters to its measures.

    Promoted inputs: ``boundary_offsets`` (mm), ``door_radius`` (mm). Promoted outputs: ``area``
    (mm**2), ``von_mises`` (kPa), ``gap`` (mm), ``gap_square_sum`` (mm**2), ``reaction`` (N/m), and
    ``particles`` (mm). Without an opened stretch in the drawn seal there is no ``gap``, and
    ``gap_square_sum`` is zero. The option ``parameters`` adds material constants, friction, depth and
    penalties to the inputs, with exact derivatives too.
    """

    def initialize(self):
        self.options.declare(
            "model", types=SealModel, recordable=False, default=door_seal(), desc="The seal model."
        )
        self.options.declare(
            "sensitivity", default="auto", values=METHODS, desc="Method of the contact partials."
        )
        self.options.declare(
            "parameters",
            default=(),
            check_valid=check_parameters,
            desc=f"Further promoted inputs, out of {', '.join(OPTIONAL_INPUTS)}.",
        )
        self.options.declare(
            "measures",
            default=(),
            check_valid=check_measures,
            desc=f"Further promoted outputs, out of {', '.join(FURTHER_MEASURES)}.",
        )
        self.options.declare(
            "factor_memory",
            default=FACTOR_MEMORY,
            types=(int, float),
            lower=0.0,
            desc="GiB for the factors that the contact partials use again.",
        )
        self.options.declare(
            "kept",
            default=None,
            allow_none=True,
            types=KeptAnalyses,
            recordable=False,
            desc="Where analyses are looked up and kept; only the last one is when left out.",
        )
        self.options.declare(
            "callback",
            default=None,
            allow_none=True,
            recordable=False,
            desc="Called with every converged load step.",
        )
        self.options.declare(
            SETTINGS_OPTION,
            default="",
            types=str,
            desc="The model's attributes as JSON, filled in by setup for recorder files.",
        )

    def setup(self):
        model = self.options["model"]
        self.options[SETTINGS_OPTION] = settings_json(model)
        self.add_subsystem("geometry", SplineGeometryComp(model=model), promotes=["*"])
        self.add_subsystem("section", AreaComp(model=model), promotes=["*"])
        contact = RkpmContactComp(
            model=model,
            sensitivity=self.options["sensitivity"],
            parameters=self.options["parameters"],
            measures=self.options["measures"],
            factor_memory=self.options["factor_memory"],
            kept=self.options["kept"],
            callback=self.options["callback"],
        )
        self.add_subsystem("contact", contact, promotes=["*"])
        self.set_input_defaults("door_radius", model.drawn_door_radius, units="mm")
