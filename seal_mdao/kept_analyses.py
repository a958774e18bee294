"""Analyses that are kept, so that nothing is analysed twice."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace

import numpy as np

from seal_mdao.errors import LoadPathError
from seal_mdao.measures.selection import MeasurePoints
from seal_mdao.model import SealModel
from seal_mdao.seal import FACTOR_MEMORY, SealResult, analyze_particles

KEPT_MEMORY = 0.5
"""GiB for kept analyses without their factors: some 190 of the door seal."""


class KeptAnalyses:
    """Analyses by all that they depend on: model, particles, door radius.

    The same inputs give the same bits, so a kept analysis is what a new one would be. Only completed
    paths are kept, the newest with the factors of its tangents, the others without: the sensitivities
    make them again. What was looked at least recently goes first when the memory is full.

    Parameters
    ----------
    memory : float
        GiB; the newest analysis stays whatever its size.

    Attributes
    ----------
    made : int
        Analyses that were made.
    """

    def __init__(self, memory: float = KEPT_MEMORY):
        self.made = 0
        self._memory = memory * 2**30
        self._results, self._sizes, self._newest = {}, {}, None

    def analyze(
        self,
        model: SealModel,
        boundary_offsets: np.ndarray | None = None,
        door_radius: float | None = None,
        *,
        points: MeasurePoints | None = None,
        keep_factors: bool = False,
        callback: Callable | None = None,
    ) -> SealResult:
        """As ``seal_mdao.analyze``; the measures are taken at ``points``, or where ``points()`` says."""
        offsets, radius = (
            model.check_offsets(boundary_offsets),
            model.check_door_radius(door_radius),
        )
        is_drawn = radius == model.drawn_door_radius and not offsets.any()
        if points is None and not is_drawn:
            with suppress(LoadPathError):  # told when the measures are asked for
                points = self.points(model, callback)
        result = self.analyze_particles(
            model, model.particles(offsets), radius, points=points,
            factor_memory=FACTOR_MEMORY if keep_factors else 0.0, callback=callback,
        )  # fmt: skip
        return replace(result, boundary_offsets=offsets, frozen_points=points)

    def points(self, model: SealModel, callback: Callable | None = None) -> MeasurePoints:
        """Places of the measures, from the path of the drawn seal.

        Raises
        ------
        LoadPathError
            When the drawn seal's path cannot be completed.
        """
        return self.analyze_particles(model, model.particles(), callback=callback).points

    def analyze_particles(
        self,
        model: SealModel,
        particles: np.ndarray,
        door_radius=None,
        *,
        points: MeasurePoints | None = None,
        factor_memory: float = 0.0,
        callback: Callable | None = None,
    ) -> SealResult:
        """As ``seal_mdao.seal.analyze_particles``; ``callback`` hears of analyses that are made."""
        particles = np.ascontiguousarray(particles, float)
        key = model, particles.tobytes(), model.check_door_radius(door_radius)
        result = self._results.pop(key, None)
        if result is None:
            self.made += 1
            result = analyze_particles(
                model, particles, door_radius, points=points, factor_memory=factor_memory,
                callback=callback,
            )  # fmt: skip
            if result.converged:
                self._make_room(key, result)
        if result.converged:
            self._results[key] = result
        return replace(result, frozen_points=points)

    def _make_room(self, key, result: SealResult) -> None:
        """For a new result; the one before it loses its factors."""
        if self._newest in self._results:
            self._results[self._newest] = without_factors(self._results[self._newest])
        self._newest, self._sizes[key] = key, held_bytes(without_factors(result).path)
        while self._results and sum(self._sizes.values()) > self._memory:
            oldest = next(iter(self._results))
            del self._results[oldest], self._sizes[oldest]


def held_bytes(record) -> int:
    """Bytes of the arrays in records of records."""
    if isinstance(record, np.ndarray):
        return record.nbytes
    if isinstance(record, list | tuple):
        return sum(map(held_bytes, record))
    if is_dataclass(record):
        return sum(held_bytes(getattr(record, f.name)) for f in fields(record))
    return 0


def without_factors(result: SealResult) -> SealResult:
    """The same analysis; sensitivities make the factors of its tangents again."""
    steps = [replace(step, factor=None) for step in result.path.steps]
    return replace(result, path=replace(result.path, steps=steps))
