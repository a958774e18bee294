"""The nonlinear RKPM contact analysis as an explicit component with exact partials."""

from itertools import product

import numpy as np
import openmdao.api as om

from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.components.failures import admissible_design, analysis_errors, warn_of_faults
from seal_mdao.components.options import (
    add_parameters,
    check_outputs,
    check_parameters,
    check_parameters_by_differences,
    declare_seal_options,
)
from seal_mdao.components.random_directions import RandomDirectionsComp
from seal_mdao.dsa.contact_kinks import contact_states
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.seals.result import analyze, frozen_measures

PARTICLE_STEP = 2e-6
"""Step of ``check_partials`` along a random direction of all particle coordinates, mm. Values have a
relative rounding error of some 1e-11, and directions that differ between neighbouring particles have a
large truncation error."""
PARAMETER_STEP = 2e-5
"""Relative step of ``check_partials`` in a scalar parameter (absolute where its nominal value is 0),
times a random number of 0.3 to 1."""
BESIDE = ("particles", "boundary_offsets", "area")
"""Variables of this component, and of those beside it in a ``SealGroup``."""


class RkpmContactComp(RandomDirectionsComp):
    """Frictional contact analysis of a seal: inputs are particles and scalar parameters, outputs
    are measures.

    The load path always starts from the undeformed state. The last converged path is cached, or more of
    them with the option ``cache``; partials at any other point first solve the path again.

    A design that cannot be analysed, and inadmissible values (a radius that is not positive, NaN),
    raise ``AnalysisError`` and leave NaN in all outputs, and in the partials at that point: a driver
    that continues records no values of another design. A completed analysis whose result is not
    trustworthy issues an ``UntrustworthyResultWarning``, once for every fault.
    ``check_partials`` takes central differences along random directions of the particles and of every
    parameter. Complex step is refused. Particles on the axis of a body of revolution stay there: their
    radii are zero whatever the input says, with zero partials.
    """

    def initialize(self):
        declare_seal_options(self.options)

    def setup(self):
        seal = self.options["seal"] = self.options["seal"].placed(self.options["parameters"])
        check_parameters(seal, self.options["parameters"])
        cache = self.options["cache"]
        self._failed = self._result = None
        self._reason = ""
        self._reported = set()
        self._on_axis = (seal.nominal_particles[:, 0] == 0.0) & seal.body.axisymmetric
        # a cache without memory still holds the newest analysis, with its factors
        self._cache = AnalysisCache(memory=0.0) if cache is None else cache
        analysis = analyze if cache is None else cache.analyze
        measures = frozen_measures(seal, self.options["measures"], analysis)
        # inputs that the seal always has, then those of the option, each once
        self._parameters = tuple(dict.fromkeys((*seal.inputs, *self.options["parameters"])))
        check_outputs(seal, measures, (*BESIDE, *self._parameters))
        # OpenMDAO has no outputs of size zero: a nominal seal without gap region has no gap
        self._measures = tuple(measure for measure in measures if measure.size(seal))
        self.add_input(
            "particles", val=seal.nominal_particles, units="mm", desc="Undeformed particles X_I."
        )
        add_parameters(self, seal, self._parameters)
        for measure in self._measures:
            self.add_output(
                measure.name,
                shape=measure.size(seal),
                units=seal.units.of(measure.units),
                desc=measure.text,
            )

    def setup_partials(self):
        # every measure depends on every particle and parameter
        self.declare_partials("*", "*")
        self.set_check_partial_options(
            wrt="particles", method="fd", form="central", step=PARTICLE_STEP
        )
        seal = self.options["seal"]
        check_parameters_by_differences(self, seal, self._parameters, PARAMETER_STEP)

    def compute(self, inputs, outputs):
        self._failed = None
        try:
            result = self._analysis(inputs)
            with analysis_errors():
                values = result.admissible_values(self._measures)
        except Exception as error:
            # else recorder files would show values of the last design for this one
            for name in outputs:
                outputs[name] = np.nan
            if isinstance(error, om.AnalysisError):
                self._failed = _bytes(inputs)
                # NaN particles follow a failure; its own reason is kept
                if not np.isnan(inputs["particles"]).all():
                    self._reason = str(error)
            raise
        self._reason = ""
        for name, value in values.items():
            outputs[name] = value
        # the checks of the state are part of require_possible and cached: they cost nothing here
        warn_of_faults(self.msginfo, result.faults, self._reported)

    def compute_partials(self, inputs, partials):
        # no path, no derivative: NaN, which optimisers recognise
        if self._has_failed(inputs):
            outputs = [measure.name for measure in self._measures]
            for block in product(outputs, ("particles", *self._parameters)):
                partials[block] = np.nan
            return
        gradient = particle_gradient(
            self._analysis(inputs), self._parameters, self._measures, self.options["sensitivity"]
        )
        for name, by_measure in gradient.items():
            for measure, rows in by_measure.items():
                if name == "particles":
                    # dm/dX_1 = 0 on the axis
                    rows[:, self._on_axis, 0] = 0.0
                # rows (m, n, 2) of the particles are flat (m, 2 n) in OpenMDAO
                partials[measure, name] = rows.reshape(len(rows), -1)

    def contact_states(self) -> dict[str, str]:
        """Return the contact states of the last design by their names (``dsa.contact_kinks``)."""
        return {} if self._result is None else contact_states(self._result.path)

    def faults(self) -> tuple[str, ...]:
        """Return the faults that make the last design's result not trustworthy, one line each."""
        return () if self._result is None else self._result.faults

    def _has_failed(self, inputs) -> bool:
        """Return whether the design failed here, or upstream, where NaN particles result."""
        failed = self._failed is not None and self._failed == _bytes(inputs)
        return failed or np.isnan(inputs["particles"]).all()

    def _analysis(self, inputs):
        self.refuse_complex_step()
        # values checked first: inadmissible ones are a failure of the design, not of the code
        values = {name: float(inputs[name][0]) for name in self._parameters}
        with admissible_design():
            seal = self.options["seal"].with_parameters(values)
            _check_finite(inputs["particles"], self._reason)
        particles = inputs["particles"]
        if self._on_axis.any():
            particles = particles.copy()
            particles[self._on_axis, 0] = 0.0
        with analysis_errors():
            result = self._cache.analyze_particles(
                seal,
                particles,
                factor_memory=self.options["factor_memory"],
                callback=self.options["callback"],
            )
            result.require_possible()
        self._result = result
        return result


def _check_finite(particles, reason: str) -> None:
    """Raise ValueError for particles that are not finite, with the reason of an earlier failure."""
    bad = np.flatnonzero(~np.isfinite(particles).all(axis=1))
    # NewtonSolver ignores a failure in its subsystems and evaluates their residuals after it
    if reason and np.isnan(particles).all():
        raise ValueError(f"the particles are NaN, as after the last failed analysis: {reason}")
    if bad.size:
        x, y = particles[bad[0]]
        raise ValueError(f"particles[{bad[0]}] = ({x}, {y}) is not finite")


def _bytes(inputs) -> bytes:
    return b"".join(np.asarray(inputs[name]).tobytes() for name in inputs)
