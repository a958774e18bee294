"""Component for mean, deviation, extremes and quantiles of measures over scenarios."""

from functools import partial

import numpy as np
import openmdao.api as om

from seal_mdao.scenarios import scenario_statistics

ALWAYS = {
    "mean": (scenario_statistics.mean, "Mean"),
    "std": (scenario_statistics.deviation, "Standard deviation"),
    "highest": (scenario_statistics.highest, "Smooth largest value (KS)"),
    "lowest": (scenario_statistics.lowest, "Smooth smallest value (KS)"),
}
"""Function and description by the suffix of the output's name."""


class AggregateComp(om.ExplicitComponent):
    """Aggregates over scenarios, with exact partials; complex step works as well.

    Of the input ``<measure>_scenarios`` (S, m): ``<measure>_mean``, ``_std``, ``_highest``, ``_lowest``,
    and ``_q95`` for the quantile 0.95, each (m,). Rows that are NaN, scenarios that failed, are left
    out; ``share_failed`` is their fraction. At a design that failed all rows are NaN, and the partials
    are NaN too.
    """

    def initialize(self):
        self.options.declare("shapes", types=dict, desc="(S, m) of every measure by name.")
        self.options.declare("units", types=dict, desc="Unit of every measure by name.")
        self.options.declare("quantiles", default=(), desc="Levels of quantiles between 0 and 1.")

    def setup(self):
        # every function returns the aggregate (m,) and its derivatives (S, m)
        self._functions = dict(ALWAYS)
        for level in self.options["quantiles"]:
            own = partial(scenario_statistics.quantile, level=level)
            self._functions[quantile_name(level)] = own, f"Smooth {100 * level:g} % quantile"
        # scenarios that failed are left out of all aggregates
        self.add_output("share_failed", val=0.0, desc="Fraction of scenarios that failed.")
        for name, shape in self.options["shapes"].items():
            units = self.options["units"][name]
            self.add_input(f"{name}_scenarios", shape=shape, units=units)
            for ending, (_, text) in self._functions.items():
                self.add_output(f"{name}_{ending}", shape=shape[1], units=units, desc=f"{text}.")

    def setup_partials(self):
        for name, (scenarios, count) in self.options["shapes"].items():
            # output j depends on entries (s, j) of all scenarios s: flat index s m + j, row j
            rows = np.tile(np.arange(count), scenarios)
            for ending in self._functions:
                self.declare_partials(
                    f"{name}_{ending}", f"{name}_scenarios", rows=rows, cols=np.arange(rows.size)
                )
        # scenarios that failed are NaN, of which a relative step would be NaN as well
        self.set_check_partial_options(wrt="*", method="cs", form="central", step_calc="rel_avg")

    def compute(self, inputs, outputs):
        for name in self.options["shapes"]:
            values = inputs[f"{name}_scenarios"]
            completed = _completed(values)
            # over completed scenarios only
            for ending, (function, _) in self._functions.items():
                outputs[f"{name}_{ending}"] = function(values[completed])[0]
        # a scenario fails in all measures: they have the same NaN rows
        outputs["share_failed"] = 1.0 - np.mean(completed)

    def compute_partials(self, inputs, partials):
        for name, shape in self.options["shapes"].items():
            values = inputs[f"{name}_scenarios"]
            completed = _completed(values)
            for ending, (function, _) in self._functions.items():
                # partials of failed scenarios are zero, those of a failed design NaN; complex values in
                # complex step
                gradient = np.full(shape, 0.0 if completed.any() else np.nan, values.dtype)
                if completed.any():
                    gradient[completed] = function(values[completed])[1]
                partials[f"{name}_{ending}", f"{name}_scenarios"] = gradient.ravel()


def quantile_name(level: float) -> str:
    """Return the suffix of the output's name: q95 for 0.95, q97_5 for 0.975."""
    return f"q{100 * level:.10g}".replace(".", "_")


def _completed(values) -> np.ndarray:
    """Return whether every scenario was completed, shape (S,)."""
    return ~np.isnan(values).any(axis=1)
