"""Tolerance study: analyse samples, record them as they finish, resume after an interruption.

The samples are drawn in ``tolerance_set``, their statistics are in ``statistics``.
"""

import json
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from hashlib import sha256
from typing import NamedTuple

import numpy as np

from seal_mdao.errors import LoadPathError
from seal_mdao.scenarios.evaluate import points_of
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import run_scenarios
from seal_mdao.scenarios.task import Outcome, SealTask, measures_with_values
from seal_mdao.scenarios.variation import Scenarios
from seal_mdao.seals.seal import Seal
from seal_mdao.tolerances.first_order import FirstOrder
from seal_mdao.tolerances.record import StudyRecord
from seal_mdao.tolerances.tolerance_set import Tolerances


@dataclass(frozen=True, eq=False)
class ToleranceStudy:
    """A tolerance study of one design.

    Attributes
    ----------
    seal : Seal
    tolerances : Tolerances
    measures : tuple of Measure or str, optional
        The seal's standard ones by default.
    offsets : ndarray, shape (P,), optional
        Boundary offsets of the design, mm; zero by default.
    design : dict of str to float, optional
        Scalar parameters of the design that differ from those of the seal.
    label : str
        Identifies a seal without ``settings``; a file is continued by studies of the same label and
        the same seal only.
    """

    seal: Seal
    tolerances: Tolerances
    measures: tuple | None = None
    offsets: np.ndarray | None = None
    design: dict | None = None
    label: str = ""

    @cached_property
    def task(self) -> SealTask:
        """Task that is run at every sample."""
        measures = measures_with_values(self.seal, self.measures)
        # parameters of all variations and of the design, each once
        varied = [name for own in self.tolerances.variations for name in own.parameters]
        return SealTask(self.seal, measures, tuple(dict.fromkeys((*varied, *(self.design or {})))))

    @cached_property
    def nominal(self) -> dict:
        """Scalar parameters of the design by name."""
        # values of the design replace those of the seal
        own = {name: float(self.seal.scalars[name].value) for name in self.task.parameters}
        return own | (self.design or {})

    @cached_property
    def boundary(self) -> np.ndarray:
        """Boundary offsets of the design, mm."""
        return self.seal.check_offsets(self.offsets)

    @property
    def inputs(self) -> tuple:
        """Names of all varying quantities."""
        offsets = tuple(f"boundary_offsets[{i}]" for i in range(self.seal.n_offsets))
        numbers = tuple(variation.name for variation in self.tolerances.variations)
        return numbers if self.tolerances.boundary is None else numbers + offsets

    @property
    def outputs(self) -> tuple:
        """Names of all values of the measures."""
        return tuple(
            measure.name if size == 1 else f"{measure.name}[{i}]"
            for measure, size in zip(self.task.measures, self.task.sizes, strict=True)
            for i in range(size)
        )

    @property
    def units(self) -> tuple:
        """Units of ``outputs``."""
        pairs = zip(self.task.measures, self.task.sizes, strict=True)
        return tuple(
            unit
            for measure, size in pairs
            for unit in [self.task.seal.units.of(measure.units)] * size
        )

    def settings(self, method: str, seed: int, count: int) -> dict:
        """Return the settings that identify a file of samples."""
        # the design by its digest: one line in the file
        design = json.dumps([self.boundary.tolist(), self.nominal])
        varied = [[asdict(t.variation), repr(t.distribution)] for t in self.tolerances.scattered]
        return {
            # a drawing or a cloud beside the seal file is part of the settings only
            "seal": self.label + self.seal.settings(),
            "design": sha256(design.encode()).hexdigest(),
            "tolerances": json.dumps([varied, repr(self.tolerances.boundary)]),
            "measures": json.dumps(self.outputs),
            "number of samples": str(count),
            "method": method,
            "seed": str(seed),
        }

    def first_order(self) -> FirstOrder:
        """Estimate the scatter from one analysis, at the mean of all tolerances, and its gradient.

        Raises
        ------
        LoadPathError
            If it cannot be analysed.
        """
        middle, n = self.tolerances.middle(self.seal), self.seal.n_offsets
        # one analysis with gradient at the means of all numbers
        parameters = np.array([*middle.values(0, self.nominal).values()])
        outcome = replace(self.task, derivatives=True).run(self.boundary, parameters)
        if outcome.failure:
            raise LoadPathError(
                "the analysis of the seal with all parameters at the mean values of their "
                f"tolerances failed: {outcome.failure}"
            )
        # dm/dn = dm/dp dp/dn
        by_number = outcome.gradient[:, n:] @ middle.rates(0, self.nominal)[1]
        return FirstOrder(
            outcome.values,
            by_number,
            outcome.gradient[:, :n],
            self.tolerances.means,
            self.tolerances.deviations,
            self.tolerances.offsets_covariance(self.seal),
        )

    def run(
        self,
        path,
        count: int,
        *,
        method: str = "sobol",
        seed: int = 0,
        workers: int | Processes | Executor = 0,
        callback: Callable[[int, Outcome], None] | None = None,
    ) -> "Sampled":
        """Analyse all samples without results in the file ``path``, and return all.

        Parameters
        ----------
        path : str or Path
            SQLite file (``record``); created if it does not exist.
        count, method, seed
            As of ``Tolerances.samples``.
        workers
            As of ``scenarios.running.run_scenarios``.
        callback : callable, optional
            Called with every number and outcome as they finish.
        """
        settings = self.settings(method, seed, count)
        with StudyRecord(path, settings, self.inputs, self.outputs) as record:
            made = self.tolerances.samples(self.seal, count, method, seed)
            table = np.hstack([made.numbers, made.offsets])[:, : len(self.inputs)]
            # the samples of the file, if it exists: resumed with the same bits
            scenarios = self._scenarios(record.samples(table))
            finished = record.finished
            points = points_of(scenarios, self.boundary, self.nominal)
            left = [point for point in points if point.index not in finished]
            for number, outcome in run_scenarios(self.task, left, workers):
                # committed before anything else can fail
                record.add(number, outcome)
                if callback is not None:
                    callback(number, outcome)
            _, messages, seconds, values = record.results()
        return Sampled(scenarios, values, messages, seconds)

    def _scenarios(self, table) -> Scenarios:
        # columns: K numbers, then P offsets if the boundary varies
        k = len(self.tolerances.scattered)
        varied = table.shape[1] > k
        offsets = table[:, k:] if varied else np.zeros((len(table), self.seal.n_offsets))
        return Scenarios(self.tolerances.variations, table[:, :k], offsets)


class Sampled(NamedTuple):
    """All analysed samples of a study: scenarios, values (S, M) of the measures, NaN in failed rows,
    reasons of failures, empty for completed samples, and durations (S,), s."""

    scenarios: Scenarios
    values: np.ndarray
    messages: list
    seconds: np.ndarray

    @property
    def completed(self) -> np.ndarray:
        """Whether every sample has values, shape (S,)."""
        return np.array([not message for message in self.messages])
