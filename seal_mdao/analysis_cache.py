"""Cache of analyses, so that no design is analysed twice."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.seals.chosen_path import without_factors
from seal_mdao.seals.result import SealResult, analyze_particles, analyzed_with
from seal_mdao.seals.seal import Seal

KEPT_MEMORY = 0.5
"""GiB for cached analyses without their factors: some 190 of the door seal."""

MOST_MEMORY = 1e6
"""Largest memory that can be set, GiB."""


class AnalysisCache:
    """Cache of analyses by all their inputs: the seal with its parameters, and the particles.

    The same inputs give the same bits, so a cached analysis equals a new one. Only completed paths are
    cached, the newest with the factors of its tangents, the others without: the sensitivities factorise
    again. The least recently used analysis is removed first when the memory is full.

    Parameters
    ----------
    memory : float
        GiB, 0 to 1e6; the newest analysis is cached whatever its size.

    Attributes
    ----------
    made : int
        Number of analyses computed, not found in the cache.
    """

    def __init__(self, memory: float = KEPT_MEMORY):
        self.made = 0
        self._memory = (
            values.real("memory of AnalysisCache, GiB,", memory, 0.0, MOST_MEMORY) * 2**30
        )
        # dicts in order of use, the least recently used first; _newest: key of the one with factors
        self._results, self._sizes, self._newest = {}, {}, None

    def analyze(
        self,
        seal: Seal,
        boundary_offsets: np.ndarray | None = None,
        parameters: dict | None = None,
        *,
        keep_factors: bool = False,
        callback: Callable | None = None,
    ) -> SealResult:
        """Analyse a design as ``seal_mdao.analyze``, or return the cached result."""
        return analyzed_with(
            self.analyze_particles, seal, boundary_offsets, parameters, keep_factors, callback
        )

    def analyze_particles(
        self,
        seal: Seal,
        particles: np.ndarray,
        boundary_offsets: np.ndarray | None = None,
        *,
        factor_memory: float = 0.0,
        callback: Callable | None = None,
    ) -> SealResult:
        """Analyse particles as ``seals.result.analyze_particles`` does, through the cache.

        ``callback`` is called in analyses that are computed.
        """
        particles = np.ascontiguousarray(particles, float)
        # the bits of all inputs; offsets only label the result, they act through the particles
        key = seal.key, particles.tobytes()
        result = self._results.pop(key, None)
        if result is None:
            self.made += 1
            result = analyze_particles(
                seal, particles, factor_memory=factor_memory, callback=callback
            )
            if result.converged:
                self._free_memory(key, result)
        # removed above and inserted again: now the most recently used
        if result.converged:
            self._results[key] = result
        # its seal is an equal one, or that with profiles that start farther back
        return replace(result, boundary_offsets=boundary_offsets)

    def _free_memory(self, key, result: SealResult) -> None:
        """Free memory for a new result; the one before it loses its factors."""
        if self._newest in self._results:
            before = self._results[self._newest]
            self._results[self._newest] = replace(before, path=without_factors(before.path))
        self._newest, self._sizes[key] = key, held_bytes(without_factors(result.path))
        while self._results and sum(self._sizes.values()) > self._memory:
            oldest = next(iter(self._results))
            del self._results[oldest], self._sizes[oldest]


def held_bytes(record) -> int:
    """Sum the bytes of all arrays in nested dataclasses, lists and tuples."""
    if isinstance(record, np.ndarray):
        return record.nbytes
    if isinstance(record, list | tuple):
        return sum(map(held_bytes, record))
    if isinstance(record, PathProblem):
        # not a dataclass; its terms refer to arrays of the discretisation
        return held_bytes(record.discretization)
    if is_dataclass(record):
        return sum(held_bytes(getattr(record, f.name)) for f in fields(record))
    return 0
