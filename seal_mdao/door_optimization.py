"""Problem (71) of the door seal: close the gap, with limits of stress, area and offsets."""

from dataclasses import asdict, dataclass

import numpy as np

from seal_mdao.optimization import DESIGN, DRAWING, MEAN, Limit, Task
from seal_mdao.robust_optimization import RobustGoal
from seal_mdao.seals.door.door_seal import OFFSET_BOUND, STANDARD
from seal_mdao.seals.result import SealResult

AREA_LIMIT = 110.0
"""mm^2."""
STRESS_SHARE, STRESS_FLOOR = 0.8, 100.0
"""Each stress has to fall to this fraction of its start, but not below the floor (kPa)."""
FORCE_BAND = 0.1
"""Relative change of the vertical reaction that ``keep_force`` and ``clamp_load`` allow."""
PRESSURE_SHARE = 0.5
"""Fraction of the nominal seal's contact pressure that ``pressure_floor`` asks of each patch."""
NEGLIGIBLE_GAP = 1e-3
"""Gaps of the nominal seal, mm, below which there is nothing to optimise: a penalty leaves as much."""


@dataclass(frozen=True)
class DoorProblem:
    """Variants of problem (71), min gap_square_sum over boundary offsets and door radius.

    Attributes
    ----------
    keep_force : bool
        Keep the vertical reaction at the end of the path within 10 % of its start.
    clamp_load : bool
        Keep the complete load curve: the same at 2, 4, 6, 8 and 10 mm, as far as the door goes.
    pressure_floor : bool
        Keep half of the nominal seal's contact pressure in each patch.
    stress_norm : bool
        Limit the p-norm of the stress of all particles instead of seven stresses.
    gap_integral : bool
        Minimise the integral of g^2 over the gap region instead of the sum over points.
    """

    keep_force: bool = False
    clamp_load: bool = False
    pressure_floor: bool = False
    stress_norm: bool = False
    gap_integral: bool = False


def door_task(nominal: SealResult, problem: DoorProblem | None = None) -> Task:
    """Set up problem (71) with limits from the nominal seal.

    Parameters
    ----------
    nominal : SealResult
        The nominal door seal, analysed (``RunOptions.analyze``).
    problem : DoorProblem, optional

    Raises
    ------
    ValueError
        When no gap opens under the nominal seal: there is nothing to minimise.
    """
    problem = DoorProblem() if problem is None else problem
    _require_gap(nominal)
    cost = "gap_square_integral" if problem.gap_integral else "gap_square_sum"
    wanted = {
        "reaction_curve": problem.clamp_load, "patch_pressure": problem.pressure_floor,
        "stress_norm": problem.stress_norm, "gap_square_integral": problem.gap_integral,
    }  # fmt: skip
    measures = (*STANDARD, *(name for name, is_wanted in wanted.items() if is_wanted))
    # A <= 110 mm^2;  s <= max(0.8 s_0, 100 kPa) of seven particles, or of the p-norm
    limits = [_area_limit()]
    if problem.stress_norm:
        upper = _stress_limit(_value(nominal, "stress_norm"))[0]
        limits.append(Limit("stress_norm", upper=float(upper)))
    else:
        upper = _stress_limit(nominal.von_mises)
        limits.append(Limit("von_mises", upper=upper, ref=upper))
    # 0.9 F_0(t) <= F(t) <= 1.1 F_0(t)
    if problem.clamp_load:
        limits.append(_band("reaction_curve", _value(nominal, "reaction_curve")))
    if problem.pressure_floor:
        # p >= 0.5 p_0 of each patch
        floor = PRESSURE_SHARE * _value(nominal, "patch_pressure")
        limits.append(Limit("patch_pressure", lower=floor, ref=floor))
    if problem.keep_force:
        limits.append(_band("reaction", nominal.reaction[-1, 1:], entry=1))
    return Task(
        nominal.seal, cost, float(_value(nominal, cost)[0]), measures, _variables(nominal),
        tuple(limits), asdict(problem),
    )  # fmt: skip


def robust_door_task(nominal: SealResult, goal: RobustGoal) -> Task:
    """Set up problem (71) with its pressure floor for ``Robust``: limits of area and stress norm of the
    drawing, of the mean contact pressure of each patch, and a band of the reaction.

    Raises
    ------
    ValueError
        When no gap opens under the nominal seal.
    """
    _require_gap(nominal)
    cost, force = "gap_square_integral", float(nominal.reaction[-1, 1])
    floor = PRESSURE_SHARE * _value(nominal, "patch_pressure")
    stress = float(_stress_limit(_value(nominal, "stress_norm"))[0])
    # (1 - b) F_0 <= F <= (1 + b) F_0 in a fraction of all samples
    band = (1.0 - goal.band) * force, (1.0 + goal.band) * force
    limits = (
        _area_limit(),
        Limit("stress_norm", upper=stress, over=DRAWING),
        Limit("patch_pressure", floor, over=MEAN),
        Limit("reaction", *band, entry=1),
    )
    measures = (cost, "reaction", "patch_pressure", "stress_norm")
    start = float(_value(nominal, cost)[0])
    return Task(nominal.seal, cost, start, measures, _variables(nominal), limits)


def _require_gap(nominal: SealResult) -> None:
    largest = float(np.abs(nominal.gap).max(initial=0.0))
    if not largest > NEGLIGIBLE_GAP:
        raise ValueError(
            f"the nominal seal has no gap above {NEGLIGIBLE_GAP} mm between points in contact, so "
            f"there is no gap to minimise (largest gap {largest:.1g} mm); choose a larger "
            "depth or another door"
        )


def _value(nominal: SealResult, name: str) -> np.ndarray:
    """Values of a measure of the nominal seal."""
    return nominal.value(nominal.measure(name))


def _variables(nominal: SealResult) -> dict[str, dict]:
    """Boundary offsets and door radius, within ``OFFSET_BOUND``."""
    # scaled radius = R - R_0, of the order of the offsets
    radius = nominal.seal.nominal().scalars["door_radius"].value
    low, high = radius - OFFSET_BOUND, radius + OFFSET_BOUND
    middle = 0.5 * (low + high)
    return {
        "boundary_offsets": {"lower": -OFFSET_BOUND, "upper": OFFSET_BOUND},
        "door_radius": {"lower": low, "upper": high, "ref0": middle, "ref": middle + 1.0},
    }


def _area_limit() -> Limit:
    return Limit("area", upper=AREA_LIMIT, over=DESIGN)


def _stress_limit(start: np.ndarray) -> np.ndarray:
    """Upper limits of stresses, kPa."""
    return np.maximum(STRESS_SHARE * start, STRESS_FLOOR)


def _band(name: str, start: np.ndarray, entry: int | None = None) -> Limit:
    """Limits of forces within ``FORCE_BAND`` of their start."""
    return Limit(name, (1 - FORCE_BAND) * start, (1 + FORCE_BAND) * start, entry, ref=start)
