"""The nonlinear RKPM contact analysis as an explicit component with exact partials."""

import openmdao.api as om

from seal_mdao.components.options import check_parameters, declare_seal_options
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.errors import GeometryError, LoadPathError
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.seals.result import analyze, frozen_measures


class RkpmContactComp(om.ExplicitComponent):
    """Frictional contact of a seal: particles and scalar parameters in, measures of the path out.

    The load path always starts from the undeformed state. The last converged path is kept, or more of
    them with the option ``kept``; partials at any other point solve it again first.
    """

    def initialize(self):
        declare_seal_options(self.options)

    def setup(self):
        seal = self.options["seal"]
        check_parameters(seal, self.options["parameters"])
        kept = self.options["kept"]
        self._kept = KeptAnalyses(memory=0.0) if kept is None else kept
        analysis = analyze if kept is None else kept.analyze
        self._measures = frozen_measures(seal, self.options["measures"], analysis)
        self._parameters = tuple(dict.fromkeys((*seal.inputs, *self.options["parameters"])))
        self.add_input(
            "particles", val=seal.drawn_particles, units="mm", desc="Undeformed particles X_I."
        )
        for name in self._parameters:
            value, units, text = seal.scalars[name]
            self.add_input(name, val=value, units=units, desc=text)
        for measure in self._measures:
            # OpenMDAO has no outputs of size zero: a drawn seal without an open stretch has no gap
            if measure.size(seal):
                self.add_output(
                    measure.name, shape=measure.size(seal), units=measure.units, desc=measure.text
                )

    def setup_partials(self):
        self.declare_partials("*", "*")
        # complex step cannot pass through the closest-point search and the solver
        self.set_check_partial_options(wrt="*", method="fd", form="central", step=1e-6)

    def compute(self, inputs, outputs):
        result = self._analysis(inputs)
        for measure in self._measures:
            if measure.name in outputs:
                outputs[measure.name] = result.value(measure)

    def compute_partials(self, inputs, partials):
        gradient = particle_gradient(
            self._analysis(inputs), self._parameters, self._measures, self.options["sensitivity"]
        )
        for name, by_measure in gradient.items():
            for measure, rows in by_measure.items():
                if rows.size:
                    partials[measure, name] = rows.reshape(len(rows), -1)

    def _analysis(self, inputs):
        values = {name: float(inputs[name][0]) for name in self._parameters}
        try:
            result = self._kept.analyze_particles(
                self.options["seal"].with_parameters(values),
                inputs["particles"],
                factor_memory=self.options["factor_memory"],
                callback=self.options["callback"],
            )
            result.require_possible()
        except (GeometryError, LoadPathError) as error:
            raise om.AnalysisError(str(error)) from error
        return result
