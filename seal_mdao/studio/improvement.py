"""Improve a design: run the optimisation of the seal file from a design of the page and send every
analysis."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.file_optimization import file_task
from seal_mdao.optimization import RunOptions, optimization_problem
from seal_mdao.studio.workbench import Workbench


class ShownAnalyses(AnalysisCache):
    """Cache of analyses that reports every new one."""

    def __init__(self, show: Callable):
        super().__init__()
        self._show = show

    def analyze_particles(self, seal, particles, boundary_offsets=None, **options):
        """As ``AnalysisCache.analyze_particles``."""
        before = self.made
        result = super().analyze_particles(seal, particles, boundary_offsets, **options)
        if self.made > before and result.path.nominal_steps:
            self._show(result)
        return result


def improve(bench: Workbench, design: list, send: Callable) -> None:
    """Run the optimisation of ``[optimize]`` from a design, with its parameters.

    Every new analysis is sent as a state with its design; the last state has ``message``, how the run
    ended, and the best design.

    Raises
    ------
    SealFileError
        For a file without ``[optimize]`` or ``[[design]]``.
    StoppedError
        By ``bench.watch``.
    """
    offsets, parameters = bench.split(design)
    numbers = list(design[len(offsets) :])
    # limits and scales are those of the file; the parameters are those of the page
    task = file_task(bench.file, bench.nominal)
    seal = bench.seal.with_parameters(parameters)
    measures = tuple(own.with_parameters(seal.changed) for own in task.measures)
    count = 0

    def show(result) -> None:
        nonlocal count
        count += 1
        # X = X_0 + sum_p b_p V_p: the offsets of the particles
        own = _offsets_of(bench, result)
        send(bench.shown(result, [*own, *numbers]) | {"number": count})

    cache = ShownAnalyses(show)
    run = RunOptions(callback=lambda step: bench.watch(), cache=cache)
    problem = optimization_problem(replace(task, seal=seal, measures=measures), run)
    problem.set_val("boundary_offsets", offsets)
    try:
        driver = problem.run_driver()
        best = np.array(problem.get_val("boundary_offsets"), float)
        message = str(problem.driver.result.exit_status)
    finally:
        problem.cleanup()
    state = bench.analyze([*_within(bench, best), *numbers])
    send(state | {"message": message, "success": bool(driver.success), "number": count})


def _within(bench: Workbench, offsets) -> list[float]:
    """Take the rounding of an optimiser off offsets at their bounds."""
    pairs = zip(bench.numbers, offsets, strict=False)
    return [own.admissible(value) for own, value in pairs]


def _offsets_of(bench: Workbench, result) -> list[float]:
    """Return the offsets of an analysed design, by least squares of its particles."""
    moved = (result.particles - bench.seal.nominal_particles).ravel()
    velocity = bench.seal.design_velocity.reshape(bench.seal.n_offsets, -1)
    found = np.linalg.lstsq(velocity.T, moved)[0]
    return _within(bench, found)
