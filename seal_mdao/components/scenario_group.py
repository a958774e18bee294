"""Group for one design of a seal in many scenarios: measures and their aggregates."""

import json

from seal_mdao.components.aggregate_comp import AggregateComp
from seal_mdao.components.area_comp import AreaComp
from seal_mdao.components.scenario_comp import ScenarioComp, declare_scenario_options
from seal_mdao.components.seal_group import DesignGroup
from seal_mdao.scenarios.task import measures_with_values
from seal_mdao.scenarios.variation import SCENARIOS_OPTION
from seal_mdao.values import real

SHARED = (
    "seal",
    "scenarios",
    "measures",
    "parameters",
    "sensitivity",
    "failed",
    "workers",
    "callback",
)
"""Options that the group passes to its scenario component."""


class ScenarioGroup(DesignGroup):
    """Group that computes aggregates of measures over scenarios from the design parameters of a
    seal.

    Promoted inputs: ``boundary_offsets`` (mm), the seal's own scalar inputs (``door_radius`` of the door
    seal) and those named in ``parameters``. Promoted outputs: ``area`` (mm**2) of the design itself, and
    of every measure ``<measure>_scenarios`` (S, m), ``<measure>_mean``, ``<measure>_std``,
    ``<measure>_highest``, ``<measure>_lowest`` and quantiles such as ``<measure>_q95``, each (m,);
    ``share_failed``.

    Parameters
    ----------
    seal : Seal
    scenarios : Scenarios
        Varied parameters; placements of profiles, such as ``lid_y``, may be among them.
    measures, parameters, sensitivity : optional
        As of ``SealGroup``.
    quantiles : sequence of float
        Levels of quantiles between 0 and 1, such as ``(0.95,)``.
    failed : {"raise", "leave_out"}
        A scenario that cannot be analysed: an ``AnalysisError``, or left out and counted.
    workers : int, Processes or Executor, optional
        0: in line; a number of processes; one per core when left out; or any executor of
        ``concurrent.futures``. A script with processes must keep what it runs under
        ``if __name__ == "__main__":``.
    callback : callable, optional
        Called with the number of every scenario that has finished, and its outcome.

    Examples
    --------
    >>> import numpy as np, seal_mdao as sm
    >>> friction = sm.Scenarios((sm.Variation("friction"),), np.array([[0.15], [0.25], [0.35]]))
    >>> group = sm.ScenarioGroup(seal=sm.door_seal(), scenarios=friction, quantiles=(0.95,))
    """

    def initialize(self):
        super().initialize()
        declare_scenario_options(self.options)
        self.options.declare(
            "quantiles",
            default=(),
            check_valid=_check_levels,
            desc="Levels of the computed quantiles of the measures, between 0 and 1, such as "
            "(0.95,).",
        )
        self.options.declare(
            SCENARIOS_OPTION,
            default=[],
            types=list,
            desc="Parameter values of the scenarios as JSON text; written by setup for recorder "
            "files.",
        )

    def setup(self):
        scenarios = self.options["scenarios"]
        # the settings of the seal in recorder files include its placement parameters
        names = (*scenarios.parameters, *self.options["parameters"])
        seal = self.options["seal"] = self.options["seal"].placed(names)
        self.options[SCENARIOS_OPTION] = [json.dumps(scenarios.table(seal))]
        super().setup()
        # selections by the nominal analysis are made once, so that outputs keep their sizes
        measures = measures_with_values(seal, self.options["measures"])
        shared = {name: self.options[name] for name in SHARED} | {"measures": measures}
        self.add_subsystem("section", AreaComp(seal=seal), promotes=["*"])
        self.add_subsystem("scenarios", ScenarioComp(**shared), promotes=["*"])
        aggregate = AggregateComp(
            shapes={m.name: (len(scenarios), m.size(seal)) for m in measures},
            units={m.name: seal.units.of(m.units) for m in measures},
            quantiles=tuple(self.options["quantiles"]),
        )
        self.add_subsystem("aggregates", aggregate, promotes=["*"])


def _check_levels(name, value):
    for level in value:
        real(f"every level in option {name!r}", level, above=0.0, below=1.0)
