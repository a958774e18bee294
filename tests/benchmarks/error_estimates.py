"""Compare estimated errors and error bars by particles with actual errors.

    python tests/benchmarks/error_estimates.py --out docs/benchmarks

The actual error is that against the value extrapolated from clouds with cells of a half and a quarter of
the size, in the same load steps. Writes ``error_estimates.json``; takes about ten minutes.
"""

import time
from pathlib import Path

from by_example import store

import seal_mdao as sm
from seal_mdao.accuracy.error_estimate import (
    ORDER,
    ComparedPaths,
    alike,
    estimate_errors,
)
from seal_mdao.accuracy.prolongation import Prolongation
from seal_mdao.accuracy.refined_file import refined_file
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.penalty_error import scale_of, standard_measures

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = (
    "paper_seal", "lip", "shaft_lip", "sealed_bulb", "vented_bulb", "stretched_strip", "slammed_strip",
    "weatherstrip", "o_ring",
)  # fmt: skip
"""Examples without creases, whose errors have a limit."""


def compared(name: str) -> dict:
    """Estimated and actual errors of the measures of an example, over their reference values."""
    file = sm.read_seal_file(EXAMPLES / f"{name}.toml")
    begun = time.process_time()
    seal = build_seal(file)
    result = sm.analyze(seal, keep_factors=True)
    analysis = time.process_time() - begun
    begun = time.process_time()
    estimates = estimate_errors(file, result)
    seconds = time.process_time() - begun
    paths = ComparedPaths(file, result, None)
    finest, measures = _finest(file, seal, paths)
    rows = {}
    for measure in standard_measures(result):
        fine = measure.on_refined(paths.fine, paths.kept)
        last = None if fine is None else fine.on_refined(finest, measures)
        if last is None:
            continue
        values = paths.coarse.value(measure), paths.fine.value(fine), finest.value(last)
        if len({own.shape for own in values}) == 1:
            scale = scale_of(measure, result)
            bar = estimates[measure.name].particle_bar
            rows[measure.name] = _errors(*values, scale) | {"bar": _digits(bar / scale)}
    return {
        "particles": [len(own.particles) for own in (result, paths.fine, finest)],
        "analysis_s": round(analysis, 2), "estimate_s": round(seconds, 2), "errors": rows,
    }  # fmt: skip


def _finest(file, seal, paths: ComparedPaths):
    """Analyse the cloud with all cells divided twice; also return the indices of the particles of that
    with cells divided once."""
    once = refined_file(file, seal)
    twice = refined_file(once.file, unchosen_seal(once.file))
    fine = alike(unchosen_seal(twice.file), seal).with_ends(paths.ends)
    steps = dict(enumerate(paths.fine.path.nominal_steps, 1))
    body = discretize(fine.body, fine.nominal_particles, fine.terms())
    found = paths.near(fine, Prolongation(paths.fine.path, steps, body, twice.parents))
    found.require_converged()
    return found, twice.particles


def _errors(coarse, fine, finest, scale: float) -> dict:
    """Estimated error of the coarse values, and their difference from the extrapolated ones."""
    factor = 1.0 / (1.0 - 0.5**ORDER)
    exact = fine + factor * (finest - fine)
    return {
        "estimated": _digits(factor * (coarse - fine) / scale),
        "actual": _digits((coarse - exact) / scale),
    }


def _digits(values) -> list[float]:
    return [float(f"{value:.3g}") for value in values]


def main(argv=None) -> int:
    return store(compared, NAMES, "error_estimates.json", __doc__, argv)


if __name__ == "__main__":
    raise SystemExit(main())
