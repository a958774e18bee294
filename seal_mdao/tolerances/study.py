"""A tolerance study: samples analysed, recorded as they finish, resumed where they ended."""

import json
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from hashlib import sha256

import numpy as np

from seal_mdao.scenarios.evaluate import points_of
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import run_scenarios
from seal_mdao.scenarios.task import Outcome, SealTask
from seal_mdao.scenarios.variation import Scenarios
from seal_mdao.seals.result import frozen_measures, is_empty
from seal_mdao.seals.seal import Seal
from seal_mdao.tolerances.first_order import FirstOrder, first_order
from seal_mdao.tolerances.record import StudyRecord
from seal_mdao.tolerances.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class ToleranceStudy:
    """What is studied.

    Attributes
    ----------
    seal : Seal
    tolerances : Tolerances
    measures : tuple of Measure or str, optional
        The seal's standard ones when left out.
    offsets : ndarray, shape (P,), optional
        Boundary offsets of the design, mm; the drawn seal when left out.
    design : dict of str to float, optional
        Scalar parameters of the design that are not those of the seal.
    label : str
        Which seal this is; studies of another label do not go on in the same file.
    """

    seal: Seal
    tolerances: Tolerances
    measures: tuple | None = None
    offsets: np.ndarray | None = None
    design: dict | None = None
    label: str = ""

    @cached_property
    def task(self) -> SealTask:
        """What is done with every sample."""
        found = frozen_measures(self.seal, self.measures)
        kept = tuple(measure for measure in found if not is_empty(measure, self.seal))
        varied = [name for own in self.tolerances.variations for name in own.parameters]
        return SealTask(self.seal, kept, tuple(dict.fromkeys((*varied, *(self.design or {})))))

    @cached_property
    def nominal(self) -> dict:
        """Scalar parameters of the design by name."""
        own = {name: float(self.seal.scalars[name].value) for name in self.task.parameters}
        return own | (self.design or {})

    @cached_property
    def boundary(self) -> np.ndarray:
        """Boundary offsets of the design, mm."""
        return self.seal.check_offsets(self.offsets)

    @property
    def inputs(self) -> tuple:
        """Names of all that varies."""
        offsets = tuple(f"boundary_offsets[{i}]" for i in range(self.seal.n_offsets))
        numbers = tuple(variation.name for variation in self.tolerances.variations)
        return numbers if self.tolerances.boundary is None else numbers + offsets

    @property
    def outputs(self) -> tuple:
        """Names of all values that are measured."""
        return tuple(
            measure.name if size == 1 else f"{measure.name}[{i}]"
            for measure, size in zip(self.task.measures, self.task.sizes, strict=True)
            for i in range(size)
        )

    @property
    def units(self) -> tuple:
        """Of ``outputs``."""
        pairs = zip(self.task.measures, self.task.sizes, strict=True)
        return tuple(unit for measure, size in pairs for unit in [measure.units] * size)

    def settings(self, method: str, seed: int, count: int) -> dict:
        """What a file of samples is known by."""
        design = json.dumps([self.boundary.tolist(), self.nominal])
        varied = [[asdict(t.variation), repr(t.distribution)] for t in self.tolerances.scattered]
        return {
            "seal": self.label or self.seal.settings(),
            "design": sha256(design.encode()).hexdigest(),
            "tolerances": json.dumps([varied, repr(self.tolerances.boundary)]),
            "measures": json.dumps(self.outputs),
            "number of samples": str(count),
            "method": method,
            "seed": str(seed),
        }

    def first_order(self) -> FirstOrder:
        """The estimate from the gradient at the middle of all tolerances.

        Raises
        ------
        LoadPathError
            When the middle cannot be analysed.
        """
        return first_order(replace(self.task, derivatives=True), self.tolerances, self.boundary,
                           self.nominal)  # fmt: skip

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
        """Analyse all samples that the file ``path`` has no results of, and give them all.

        Parameters
        ----------
        path : str or Path
            SQLite file (``record``); made when there is none.
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
            table = record.samples(_table(made)[:, : len(self.inputs)])
            scenarios = self._scenarios(table)
            finished = record.finished
            points = points_of(scenarios, self.boundary, self.nominal)
            left = [point for point in points if point.index not in finished]
            for number, outcome in run_scenarios(self.task, left, workers):
                record.add(number, outcome)
                if callback is not None:
                    callback(number, outcome)
            _, messages, seconds, values = record.results()
        return Sampled(scenarios, values, messages, seconds)

    def _scenarios(self, table) -> Scenarios:
        k = len(self.tolerances.scattered)
        offsets = (
            table[:, k:] if table.shape[1] > k else np.zeros((len(table), self.seal.n_offsets))
        )
        return Scenarios(self.tolerances.variations, table[:, :k], offsets)


@dataclass(frozen=True, eq=False)
class Sampled:
    """All samples of a study, analysed.

    Attributes
    ----------
    scenarios : Scenarios
    values : ndarray, shape (S, M)
        NaN in rows that failed.
    messages : list of str
        Of failures; empty for those completed.
    seconds : ndarray, shape (S,)
    """

    scenarios: Scenarios
    values: np.ndarray
    messages: list
    seconds: np.ndarray

    @property
    def completed(self) -> np.ndarray:
        """Which samples have values, shape (S,)."""
        return np.array([not message for message in self.messages])


def _table(scenarios: Scenarios) -> np.ndarray:
    return np.hstack([scenarios.numbers, scenarios.offsets])
