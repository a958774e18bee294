"""The nonlinear RKPM contact analysis as an explicit component with exact partials."""

import openmdao.api as om

from seal_mdao.components.optional_inputs import OPTIONAL_INPUTS, check_parameters, start_value
from seal_mdao.dsa.sensitivity import METHODS, measured, particle_gradient
from seal_mdao.errors import GeometryError, LoadPathError
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.measures.catalogue import FURTHER_MEASURES, check_measures
from seal_mdao.model import SealModel
from seal_mdao.seal import FACTOR_MEMORY, measure_points


class RkpmContactComp(om.ExplicitComponent):
    """Frictional contact of a seal with a rigid door: particles in, measures at the end of the path out.

    The load path always starts from the undeformed state. The last converged path, or as many as the
    option ``kept`` holds, are found again by the inputs' bytes; partials at any other point solve the
    path first.
    """

    def initialize(self):
        self.options.declare("model", types=SealModel, recordable=False, desc="The seal model.")
        self.options.declare(
            "sensitivity",
            default="auto",
            values=METHODS,
            desc="Method of the partials: auto takes the one with fewer right-hand sides.",
        )
        self.options.declare(
            "parameters",
            default=(),
            check_valid=check_parameters,
            desc=f"Further inputs with exact partials, out of {', '.join(OPTIONAL_INPUTS)}.",
        )
        self.options.declare(
            "measures",
            default=(),
            check_valid=check_measures,
            desc=f"Further outputs with exact partials, out of {', '.join(FURTHER_MEASURES)}.",
        )
        self.options.declare(
            "factor_memory",
            default=FACTOR_MEMORY,
            types=(int, float),
            lower=0.0,
            desc="GiB for factors of converged tangents; those beyond are made again for the partials.",
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
            check_valid=_check_callable,
            desc="Called with every converged load step.",
        )

    def setup(self):
        model = self.options["model"]
        kept = self.options["kept"]
        self._kept = KeptAnalyses(memory=0.0) if kept is None else kept
        self._points = measure_points(model) if kept is None else kept.points(model)
        self.add_input(
            "particles", val=model.drawn_particles, units="mm", desc="Undeformed particles X_I."
        )
        self.add_input(
            "door_radius",
            val=model.drawn_door_radius,
            units="mm",
            desc="Corner radius of the door.",
        )
        for name in self.options["parameters"]:
            units, text = OPTIONAL_INPUTS[name]
            self.add_input(name, val=start_value(model, name), units=units, desc=text)
        self.add_output(
            "von_mises",
            shape=self._points.stress.size,
            units="kPa",
            desc="Von Mises stress at the particles frozen for the drawn seal.",
        )
        # OpenMDAO has no outputs of size zero: a drawn seal without an open stretch has no gap
        if self._points.gap.size:
            self.add_output(
                "gap",
                shape=self._points.gap.size,
                units="mm",
                desc="Normal gaps at the contact points that stand open in the drawn seal.",
            )
        self.add_output(
            "gap_square_sum", units="mm**2", desc="Sum of the squared gaps, the cost of Eq. (71)."
        )
        self.add_output(
            "reaction",
            shape=2,
            units="N/m",
            desc="Force of the seal on the door at the end of the path: horizontal, vertical.",
        )

        for name in self.options["measures"]:
            measure, size = FURTHER_MEASURES[name], self._points.size_of(name)
            if size == 0:
                raise ValueError(
                    f"measure {name!r} has no entries for a depth of {model.depth} mm; leave it out"
                )
            self.add_output(name, shape=size, units=measure.units, desc=measure.text)

    def setup_partials(self):
        self.declare_partials("*", "*")
        # complex step cannot pass through the closest-point search and the solver
        self.set_check_partial_options(wrt="*", method="fd", form="central", step=1e-6)

    def compute(self, inputs, outputs):
        result = self._analysis(inputs)
        for name in outputs:
            if name in self.options["measures"]:
                outputs[name] = measured(result, name)
                continue
            value = getattr(result, name)
            outputs[name] = value[-1] if name == "reaction" else value

    def compute_partials(self, inputs, partials):
        result = self._analysis(inputs)
        scalars = ("door_radius", *self.options["parameters"])
        gradient = particle_gradient(
            result, scalars, self.options["sensitivity"], self.options["measures"]
        )
        for name, by_measure in gradient.items():
            for measure, rows in by_measure.items():
                if rows.size:
                    partials[measure, name] = rows.reshape(len(rows), -1)

    def _analysis(self, inputs):
        values = {name: float(inputs[name][0]) for name in self.options["parameters"]}
        try:
            result = self._kept.analyze_particles(
                self.options["model"].with_parameters(values),
                inputs["particles"],
                inputs["door_radius"],
                points=self._points,
                factor_memory=self.options["factor_memory"],
                callback=self.options["callback"],
            )
            result.require_converged()
        except (GeometryError, LoadPathError) as error:
            raise om.AnalysisError(str(error)) from error
        return result


def _check_callable(name, value):
    if value is not None and not callable(value):
        raise TypeError(f"option {name!r} must be callable or None, got {value!r}")
