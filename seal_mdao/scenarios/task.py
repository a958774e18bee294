"""Analysis of one scenario, in any process."""

import pickle
import time
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seal_mdao.dsa.sensitivity import METHODS, sensitivities
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.errors import LoadPathError
from seal_mdao.seals.clear_start import with_clear_starts
from seal_mdao.seals.result import (
    FACTOR_MEMORY,
    analyze_particles,
    frozen_measures,
    is_empty,
)
from seal_mdao.seals.seal import Seal
from seal_mdao.values import one_of

CACHED_TASKS = 4
"""Number of tasks that a worker process caches; a problem has one or two."""
_tasks = {}


class Outcome(NamedTuple):
    """Result of one scenario: values (M,) of all measures in succession, NaN if it failed, gradient
    (M, P + N) in boundary offsets and parameters of the task, or None, reason of a failure, duration,
    faults that make the result not trustworthy (``SealResult.faults``)."""

    values: np.ndarray
    gradient: np.ndarray | None
    failure: str
    seconds: float
    faults: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SealTask:
    """Common data of all scenarios, pickled once for every worker: the seal, measures with their points,
    names of the parameters that every scenario defines, and the method of gradients, if any.
    """

    seal: Seal
    measures: tuple
    parameters: tuple
    method: str = "auto"
    derivatives: bool = False

    def __post_init__(self):
        one_of("method", self.method, METHODS)

    @property
    def sizes(self) -> list:
        """Number of values of every measure."""
        return [measure.size(self.seal) for measure in self.measures]

    @property
    def count(self) -> int:
        """Number of values of all measures."""
        return sum(self.sizes)

    def by_measure(self, array: np.ndarray) -> dict:
        """Split the columns (..., M) by measure, each (..., m), by name."""
        ends = np.cumsum(self.sizes)[:-1]
        parts = np.split(array, ends, axis=-1)
        return {m.name: part for m, part in zip(self.measures, parts, strict=True)}

    @one_blas_thread
    def run(self, offsets: np.ndarray, parameters: np.ndarray) -> Outcome:
        """Analyse one scenario with offsets (P,), mm, and parameters (N,); failures are no exceptions.

        Profiles that would start inside the body start farther back (``seals.clear_start``).
        """
        begun, failure = time.perf_counter(), ""
        try:
            *found, faults = self._analyzed(offsets, parameters)
        except (ValueError, LoadPathError) as error:  # including inadmissible values
            found, faults = (np.full(self.count, np.nan), None), ()
            failure = " ".join(str(error).split())
        return Outcome(*found, failure, time.perf_counter() - begun, faults)

    def _analyzed(self, offsets, parameters):
        seal = self.seal.with_parameters(dict(zip(self.parameters, parameters, strict=True)))
        offsets = seal.check_offsets(offsets)
        # factors are kept for the sensitivities only
        memory = FACTOR_MEMORY if self.derivatives else 0.0
        particles = seal.particles(offsets)
        seal = with_clear_starts(seal, particles)
        result = analyze_particles(seal, particles, offsets, factor_memory=memory)
        values = np.concatenate([*result.admissible_values(self.measures).values()])
        if not self.derivatives:
            return values, None, result.faults
        rates = sensitivities(result, self.parameters, self.measures, self.method)
        rows = [np.atleast_2d(rates[measure.name]) for measure in self.measures]
        return values, np.vstack(rows), result.faults


def measures_with_values(seal: Seal, measures=None) -> tuple:
    """Return measures (standard ones for None) with their points, without empty ones, such as the gap of
    a closed contact."""
    found = frozen_measures(seal, measures)
    return tuple(measure for measure in found if not is_empty(measure, seal))


def run_task(key: str, packed: bytes | Path | None, offsets, parameters) -> Outcome | None:
    """Run one scenario of the task whose digest is ``key``, in a worker process.

    Parameters
    ----------
    packed : bytes, Path or None
        The pickled task, or its file. None at first, so that a scenario transfers its numbers only.

    Returns
    -------
    Outcome, or None
        None if this worker does not have the task yet: call again with ``packed``.
    """
    if key not in _tasks:
        if packed is None:
            return None
        # first in, first out
        while len(_tasks) >= CACHED_TASKS:
            del _tasks[next(iter(_tasks))]
        content = packed.read_bytes() if isinstance(packed, Path) else packed
        _tasks[key] = pickle.loads(content)
    return _tasks[key].run(offsets, parameters)
