"""Direct and adjoint sensitivities of the same paths: a check of both without any step size."""

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.dsa.sensitivity import Sensitivities, differentiate
from seal_mdao.seals.door.door_seal import door_seal
from seal_mdao.seals.result import SealResult, analyze
from seal_mdao.seals.seal import Seal

SCALARS = (
    "door_radius", "friction", "c10", "c01", "bulk_modulus", "depth", "normal_penalty",
    "tangent_penalty",
)  # fmt: skip
MEASURES = ("von_mises", "gap", "gap_square_sum", "reaction")
FRICTIONS = {
    "accumulated": {},
    "incremental": {"friction_history": "incremental"},
    # without friction the seal buckles sideways later; here its contact reaches the corner early
    "frictionless": {"friction": 0.0, "depth": 3.0, "corner_x": 0.5},
}
DOORS = {"corner": {}, "32 segments": {"segments": 32}, "flat": {"door": "flat"}}
PATHS = {
    "40 steps": {"n_steps": 40, "newton": NewtonOptions(tolerance=1e-11)},
    "5 steps, cut": {
        "n_steps": 5,
        "newton": NewtonOptions(tolerance=1e-11, max_iterations=3, damped_iterations=0),
    },
}
RADIUS = 4.05
NEARLY_ZERO = 1e-2


def case_model(friction: str, door: str, path: str) -> Seal:
    """A model of ``FRICTIONS`` x ``DOORS`` x ``PATHS``, pressed 7 mm (3 mm without friction)."""
    return door_seal(
        **{"depth": 7.0, "start": 10.03} | FRICTIONS[friction] | DOORS[door] | PATHS[path]
    )


def analyze_case(friction: str, door: str, path: str, seed: int = 7) -> SealResult:
    """That model at a random design within 0.04 mm of the nominal seal."""
    model = case_model(friction, door, path)
    offsets = np.random.default_rng(seed).uniform(-0.04, 0.04, model.n_offsets)
    result = analyze(model, offsets, {"door_radius": RADIUS}, keep_factors=True)
    result.require_converged()
    return result


def method_difference(result: SealResult) -> float:
    """Largest relative difference between both methods over every measure and parameter.

    Relative to the derivative itself or, below 1 % of the largest one of its measure, to that;
    derivatives in scalars are multiplied by the scalar, so that those of a measure have one unit.
    """
    direct, adjoint = (
        _table(differentiate(result, SCALARS, method=method)) for method in ("direct", "adjoint")
    )
    scalars = [result.seal.scalars[name].value or 1.0 for name in SCALARS]
    size = np.array([*np.ones(result.seal.n_offsets), *scalars])
    direct, adjoint = direct * size, adjoint * size
    entry = np.abs(direct)
    largest = entry.max(axis=1, keepdims=True)
    scale = np.where(entry < NEARLY_ZERO * largest, largest, entry)
    # a row that vanishes identically must do so in both
    return float((np.abs(direct - adjoint) / np.where(scale > 0.0, scale, 1.0)).max())


def _table(rates: Sensitivities) -> np.ndarray:
    return np.vstack([np.atleast_2d(getattr(rates, name)) for name in MEASURES])
