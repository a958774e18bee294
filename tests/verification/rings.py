"""Seal files of bodies of revolution against axisymmetric finite elements and plane strain.

The references are those of ``references/felupe_rings.py``. Forces are those of the complete ring, N.
"""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import leading_motion, profile_histories
from seal_mdao.seals.result import analyze

REFERENCES = Path(__file__).parent / "references"
EXAMPLES = Path(__file__).parents[2] / "examples"
DISCS = {"ring_disc_2": 2.0, "ring_disc_5": 5.0}
"""Thicknesses of the bonded discs, mm."""
RADIUS = 10.0
"""Of the bonded discs, mm."""


class RingErrors(NamedTuple):
    """Relative errors at the ends of the stages.

    Attributes
    ----------
    force, peak : ndarray, shape (k,)
        Of the force and of the highest nominal contact pressure, which is nan for bonded plates.
    uncertainty : ndarray, shape (k,)
        Of the force of the finite elements.
    """

    force: np.ndarray
    peak: np.ndarray
    uncertainty: np.ndarray


def reference(name: str) -> dict:
    """Read the finite elements of a case."""
    return json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))


@cache
def ring_result(name: str, spacing: float | None = None):
    """Analyze the seal file of a case, or the example, at its own spacing or another, mm.

    Spacings of edges change in proportion.
    """
    path = REFERENCES / f"{name}.toml"
    file = read_seal_file(path if path.exists() else EXAMPLES / path.name)
    if spacing is not None:
        own, section = file.section.edge_spacing, file.section
        finer = {edge: h * spacing / section.spacing for edge, h in own.items()}
        file = replace(file, section=replace(section, spacing=spacing, edge_spacing=finer))
    result = analyze(build_seal(file))
    result.require_converged()
    return result


def stage_forces(result) -> np.ndarray:
    """Force along the motion, of the axis or the radius, at the ends of the stages, N."""
    motion = leading_motion(result.seal)
    ends, along = motion.ends, int(np.ptp(motion.positions, axis=0).argmax())
    steps = [int(np.abs(ends - k).argmin()) for k in range(1, round(ends[-1]) + 1)]
    # that of a profile, or of the moved edges of a bonded disc
    labels = [own.label for own in profile_histories(result)] or ["plate"]
    return np.abs(result.path.reaction(labels[0])[steps, along])


def stage_peaks(result, count: int) -> np.ndarray:
    """Highest nominal contact pressure at the ends of the stages, kPa; nan without contact."""
    for history in profile_histories(result):
        last = [np.flatnonzero(history.stage == k + 1)[-1] for k in range(count)]
        return history.nominal_peak[last]
    return np.full(count, np.nan)


def ring_errors(name: str, spacing: float | None = None) -> RingErrors:
    """Errors of a case against finite elements."""
    known, result = reference(name), ring_result(name, spacing)
    force = stage_forces(result) / known["force_N"] - 1.0
    peak = np.full(len(force), np.nan)
    if "peak_kPa" in known:
        peak = stage_peaks(result, len(force)) / known["peak_kPa"] - 1.0
    return RingErrors(force, peak, np.array(known["relative_uncertainty"]))


def gent_lindley_modulus(thickness: float, shear: float, bulk: float) -> float:
    """Apparent modulus of a bonded disc at small strain, kPa.

    E_a = E (1 + 2 S^2) with the shape factor S = radius / (2 thickness) of an incompressible rubber
    (A. N. Gent and P. B. Lindley, Proc. Instn Mech. Engrs 173 (1959) 111), in series with the bulk
    modulus, 1/E_a + 1/K. It holds for small strain and for S from about one on: the pressure is taken as
    parabolic over the radius, which a thick disc does not have, and the bulk modulus in series is an
    estimate that fails from S^2 near K / E on.
    """
    shape = RADIUS / (2.0 * thickness)
    incompressible = 3.0 * shear * (1.0 + 2.0 * shape**2)
    return 1.0 / (1.0 / incompressible + 1.0 / bulk)


def apparent_modulus(name: str, force: float) -> float:
    """Force over area and strain of the first stage of a disc, kPa, of a force, N."""
    strain = reference(name)["travel_mm"][0] / DISCS[name]
    return 1e3 * force / (np.pi * RADIUS**2 * strain)
