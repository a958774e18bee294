"""One design in many scenarios as an explicit component with exact partials."""

from concurrent.futures import Executor

import numpy as np
import openmdao.api as om

from seal_mdao.components.failures import warn_of_faults
from seal_mdao.components.options import (
    OPTIONAL,
    add_boundary_offsets,
    add_parameters,
    boundary_offsets,
    check_callable,
    check_outputs,
    check_parameters,
    check_parameters_by_differences,
    declare_derivative_options,
    declare_seal,
)
from seal_mdao.components.random_directions import RandomDirectionsComp
from seal_mdao.distributions import VALUE
from seal_mdao.scenarios.evaluate import evaluate
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import usual_workers
from seal_mdao.scenarios.task import SealTask, measures_with_values
from seal_mdao.scenarios.variation import Scenarios

POLICIES = ("raise", "leave_out")
LEAST_LEFT = 2
"""Least number of completed scenarios, for the standard deviation."""
CHECK_STEP = 1e-5
"""Step of ``check_partials``: offsets in mm, parameters relative, or absolute where nominally 0."""


def declare_scenario_options(options) -> None:
    """Declare the options common to the component and its group."""
    declare_seal(options)
    options.declare("scenarios", types=Scenarios, recordable=False, desc="Varied parameters.")
    declare_derivative_options(options)
    options.declare(
        "failed",
        default="raise",
        values=POLICIES,
        desc="Action if a scenario cannot be analysed: raise an AnalysisError, or exclude the "
        "scenario from the statistics and count it as failed.",
    )
    options.declare(
        "workers",
        types=(int, Processes, Executor),
        desc="Parallel analyses: 0 for serial, N for the number of processes, None for one process "
        "per core, or an executor of concurrent.futures.",
        **OPTIONAL,
    )
    text = "Function that is called with the index and the outcome of every finished scenario."
    options.declare("callback", check_valid=check_callable, desc=text, **OPTIONAL)


class ScenarioComp(RandomDirectionsComp):
    """Measures of one design in S scenarios.

    Inputs: ``boundary_offsets`` (mm), the seal's own scalar inputs, those of ``parameters``; a scenario
    replaces, shifts or multiplies their values. A seal file's profiles get their placement parameters,
    ``<profile>_x``, ``_y`` and ``_angle``, where a scenario varies one.
    Outputs: ``<measure>_scenarios``, (S, m); rows of scenarios that failed and are left out are NaN,
    and their partials zero. Scenarios whose results are not trustworthy issue an
    ``UntrustworthyResultWarning``, once for every fault.

    Values and partials are computed together, for partials alone would repeat the analyses. Processes
    are started with the first evaluation and run until this process ends.
    """

    def initialize(self):
        declare_scenario_options(self.options)

    def setup(self):
        scenarios = self.options["scenarios"]
        names = (*scenarios.parameters, *self.options["parameters"])
        seal = self.options["seal"].placed(names)
        check_parameters(seal, self.options["parameters"])
        # all errors of the options are raised here, before processes are started
        scenarios.check(seal)
        _check_effect(scenarios, self.options["parameters"])
        measures = measures_with_values(seal, self.options["measures"])
        inputs = dict.fromkeys((*seal.inputs, *self.options["parameters"]))
        names = tuple(dict.fromkeys((*inputs, *scenarios.parameters)))
        check_outputs(seal, measures)
        # scenarios may vary parameters that are no inputs of the component
        self._task = SealTask(seal, measures, names, self.options["sensitivity"], derivatives=True)
        self._named, self._workers, self._last = tuple(inputs), _workers(self.options), None
        self._reported = set()
        self._check_admissible()
        add_boundary_offsets(self, seal)
        add_parameters(self, seal, inputs)
        for measure in measures:
            self.add_output(
                f"{measure.name}_scenarios", shape=(len(scenarios), measure.size(seal)),
                units=seal.units.of(measure.units), desc=measure.text,
            )  # fmt: skip

    def setup_partials(self):
        has_offsets = self._task.seal.n_offsets > 0
        # a seal without design parameters has no inputs unless there are scalar ones
        if has_offsets or self._named:
            self.declare_partials("*", "*")
        if has_offsets:
            self.set_check_partial_options(
                wrt="boundary_offsets", method="fd", form="central", step=CHECK_STEP
            )
        check_parameters_by_differences(self, self._task.seal, self._named, CHECK_STEP)

    def _check_admissible(self):
        """Raise ValueError for inadmissible scenarios before anything is analysed."""
        scenarios, design = self.options["scenarios"], self._design({})
        for number in range(len(scenarios)):
            try:
                self._task.seal.with_parameters(scenarios.values(number, design))
            except ValueError as error:
                raise ValueError(f"{scenarios.described(number)}: {error}") from error

    def _design(self, inputs) -> dict:
        """Collect the scalar parameters of the design, those varied by scenarios only included."""
        seal = self._task.seal
        return {
            name: float(inputs[name][0]) if name in inputs else float(seal.scalars[name].value)
            for name in self._task.parameters
        }

    def compute(self, inputs, outputs):
        found = self._evaluated(inputs)
        too_many = self._too_many(found.failures)
        if too_many:
            # else recorder files would show values of the last design for this one
            for name in outputs:
                outputs[name] = np.nan
            raise om.AnalysisError(too_many)
        # columns (S, M) of all measures, split by measure
        for name, values in self._task.by_measure(found.values).items():
            outputs[f"{name}_scenarios"] = values
        warn_of_faults(self.msginfo, self.faults(), self._reported)

    def faults(self) -> tuple[str, ...]:
        """Return the faults that make results of the last design not trustworthy, with the scenario."""
        if self._last is None:
            return ()
        return tuple(
            f"{self.options['scenarios'].described(number)}: {text}"
            for number, faults in enumerate(self._last[1].faults)
            for text in faults
        )

    def compute_partials(self, inputs, partials):
        found, task = self._evaluated(inputs), self._task
        gradients = found.gradients * (np.nan if self._too_many(found.failures) else 1.0)
        n = task.seal.n_offsets
        # columns of the gradients: boundary offsets first, then the scalar parameters of the task
        columns_of = ({"boundary_offsets": slice(0, n)} if n else {}) | {
            name: slice(n + task.parameters.index(name), n + task.parameters.index(name) + 1)
            for name in self._named
        }
        for name, columns in columns_of.items():
            parts = task.by_measure(np.moveaxis(gradients[:, :, columns], 2, 0))
            for measure, part in parts.items():  # (columns, S, m)
                partials[f"{measure}_scenarios", name] = part.reshape(len(part), -1).T

    def _evaluated(self, inputs):
        self.refuse_complex_step()
        offsets = np.array(boundary_offsets(inputs, self._task.seal), float)
        design = self._design(inputs)
        # values and partials of one point come from one evaluation, identified by its inputs' bits
        key = offsets.tobytes(), tuple(design.values())
        if self._last is None or self._last[0] != key:
            scenarios = self.options["scenarios"]
            self._last = (
                key,
                evaluate(
                    self._task, scenarios, offsets, design, self._workers, self.options["callback"]
                ),
            )
        return self._last[1]

    def _too_many(self, failures) -> str:
        """Return the message if more scenarios failed than the policy allows; else empty."""
        # the first failure represents all in the message
        failed = [number for number, text in enumerate(failures) if text]
        if not failed:
            return ""
        described = self.options["scenarios"].described(failed[0])
        first = f"{described} failed: {failures[failed[0]]}"
        if self.options["failed"] == "raise":
            return first
        if len(failures) - len(failed) >= LEAST_LEFT:
            return ""
        return (
            f"{len(failed)} of {len(failures)} scenarios could not be analysed, but at least "
            f"{LEAST_LEFT} analyses must succeed; {first}"
        )


def _check_effect(scenarios: Scenarios, parameters) -> None:
    """Raise ValueError for an input whose value every scenario replaces by its own."""
    for variation in scenarios.variations:
        replaced = set(variation.parameters) & set(parameters)
        if variation.kind == VALUE and replaced:
            name = min(replaced)
            raise ValueError(
                f"option 'parameters': the input {name!r} would have no effect, since the "
                f"variation {variation.name!r} of kind 'value' replaces it in every scenario; "
                "remove this input from 'parameters', or change the kind of the variation to "
                "'shift' or 'factor'"
            )


def _workers(options) -> int | Processes | Executor:
    """Convert the option ``workers`` to an object that persists between evaluations."""
    # processes are created once; a pool per evaluation would start them anew
    chosen = options["workers"]
    chosen = usual_workers() if chosen is None else chosen
    return Processes(chosen) if isinstance(chosen, int) and chosen else chosen
