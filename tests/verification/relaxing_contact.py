"""Relaxing seals against finite elements: force, nominal peak pressure and recovery over the time.

The references are those of ``references/felupe_relaxation.py``.
"""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import leading_motion, profile_histories
from seal_mdao.seals.result import analyze
from seal_mdao.terms.ramp import StageTimes

REFERENCES = Path(__file__).parent / "references"


class RelaxationErrors(NamedTuple):
    """Errors at the times of the reference.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s.
    force, peak : ndarray, shape (n,)
        Over the largest value of the reference.
    height : ndarray, shape (n,)
        Of the crown, mm.
    """

    time: np.ndarray
    force: np.ndarray
    peak: np.ndarray
    height: np.ndarray


def _at(times, path, stages: StageTimes, values) -> np.ndarray:
    """Interpolate ``values`` of the steps over time in moves, over its logarithm in dwells."""
    corners, found = np.concatenate([[0.0], np.cumsum(stages.durations)]), []
    for at in times:
        stage = max(0, int(np.searchsorted(corners, at * (1.0 - 1e-12))) - 1)
        start, first = corners[stage], stages.first[stage]
        near = (path >= start * (1.0 - 1e-12)) & (path <= corners[stage + 1] * (1.0 + 1e-12))

        def scale(t, start=start, first=first):
            return np.log1p((t - start) / first) if np.isfinite(first) else t - start

        found.append(PchipInterpolator(scale(path[near]), values[near])(scale(at)))
    return np.array(found)


@cache
def relaxation_errors(name: str, friction: float) -> RelaxationErrors:
    """Analyze the seal file of a case with a friction."""
    known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
    own = known[f"with_friction_{friction}"]
    file = read_seal_file(REFERENCES / f"{name}.toml")
    file = replace(file, profiles=tuple(replace(p, friction=friction) for p in file.profiles))
    result = analyze(build_seal(file))
    result.require_converged()
    history, stages = profile_histories(result)[0], file.environment.time
    ends = np.asarray(leading_motion(result.seal).ends, float)
    # the times of the steps, which are ends[k] stages
    ends = ends[-len(history.travel) :]
    path = replace(stages, stages=np.append(0.0, ends)).at(np.arange(len(ends) + 1))
    crown = int(result.particles[:, 1].argmax())
    height = [result.particles[crown, 1]]
    height += [result.deformed(k)[crown, 1] for k in range(len(ends))]
    force = next(np.array(value) for key, value in own.items() if key.startswith("force"))
    errors = [
        (_at(known["time_s"], path, stages, np.append(0.0, values)) - np.array(wanted)) / np.max(wanted)
        for values, wanted in (
            (np.abs(history.force[:, 1]), force), (history.nominal_peak, own["peak_kPa"]),
        )
    ]  # fmt: skip
    heights = _at(known["time_s"], path, stages, np.array(height)) - own["height_mm"]
    return RelaxationErrors(np.array(known["time_s"]), *errors, heights)
