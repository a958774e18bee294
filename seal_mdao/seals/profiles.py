"""Histories of the rigid profiles of an analysed seal: travel, forces, contact, step by step."""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.cost import duration
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.contact.self_contact import SelfContact
from seal_mdao.geometry.motion import Motion, step_fractions
from seal_mdao.measures.boundary_line import BoundaryLine, contact_fractions, ordered_points
from seal_mdao.measures.contact_modulus import ContactModulus
from seal_mdao.seals.fluids import fluid_pressures
from seal_mdao.seals.path_times import StageEnds, stage_ends, times_at

PARALLEL = 1e-9
"""Sine of the angle between stages that still go along one line."""
MIDDLES = 3
"""With up to so many stages their middles are key steps, too."""
TRAVEL, ROTATION = "travel (mm)", "rotation (°)"
"""What the load steps of a course are plotted against."""


def contacts(seal) -> tuple:
    """Return the definitions of the contacts of a seal with rigid profiles."""
    return tuple(term for term in seal.terms() if isinstance(term, RigidContact))


def self_contacts(seal) -> tuple:
    """Return the definitions of the contacts of a seal with itself."""
    return tuple(term for term in seal.terms() if isinstance(term, SelfContact))


class Course(NamedTuple):
    """Consecutive stages of a motion along one line, forwards and backwards, or about one pivot.

    Attributes
    ----------
    steps : slice
        Nominal steps.
    stages : tuple of int
        From 1.
    along : ndarray, shape (n,)
        Signed travel (mm), turn without travel (degrees), or pressure of a fluid (kPa) where nothing
        moves along the complete path, after each of its steps.
    axis : str
        ``TRAVEL``, ``ROTATION``, or the name of the pressure, with the unit.
    begin : float
        Travel or turn where it begins: zero, but the first travel of a seal is counted from its
        ``before_touch``.
    """

    steps: slice
    stages: tuple
    along: np.ndarray
    axis: str
    begin: float = 0.0


@dataclass(frozen=True, eq=False)
class ProfileHistory:
    """History of one profile over the n nominal steps of a load path.

    A profile that stands still has the stages and the travel of the first one that moves.

    Attributes
    ----------
    label : str
    stage : ndarray of int, shape (n,)
        From 1.
    travel, turn : ndarray, shape (n,)
        Distance (mm) and angle (degrees) since the stage began.
    place : ndarray, shape (n, 3)
        x, y (mm), angle (degrees) of the profile itself.
    force : ndarray, shape (n, 2)
        Of the seal on the profile, N/m.
    initial_force : ndarray, shape (2,)
        That where the load steps begin; zero without preliminary increments.
    width, nominal_width : ndarray, shape (n,)
        Deformed and undeformed length in contact, mm.
    peak, nominal_peak : ndarray, shape (n,)
        Highest true and nominal contact pressure of all points, kPa.
    load_segments : tuple of Course
    """

    label: str
    stage: np.ndarray
    travel: np.ndarray
    turn: np.ndarray
    place: np.ndarray
    force: np.ndarray
    initial_force: np.ndarray
    width: np.ndarray
    nominal_width: np.ndarray
    peak: np.ndarray
    nominal_peak: np.ndarray
    load_segments: tuple

    @property
    def main_component(self) -> int:
        """Component of the force that becomes larger along the path: 0 along x, 1 along y."""
        across, up = np.abs(self.force).max(axis=0, initial=0.0)
        return 0 if across > up else 1


def leading_contact(seal) -> RigidContact:
    """Return the contact with the leading profile: the first that moves, the first one if none does.

    Raises
    ------
    ValueError
        For a seal without profiles.
    """
    found = contacts(seal)
    if not found:
        raise ValueError(
            "the seal has no rigid profile, so there is no contact to evaluate; add a [[profile]] "
            "to the seal file"
        )
    return next((contact for contact in found if contact.motion.moves), found[0])


def moved_edges(seal) -> tuple:
    """Return the edges of a seal that follow rigid motions, those bonded to profiles included."""
    return tuple(getattr(seal.imposed(), "edges", ()))


def moving_parts(seal) -> list:
    """List the contacts with the profiles of a seal, then the moved edges that are in no contact."""
    profiles = contacts(seal)
    known = {own.label for own in profiles}
    return [*profiles, *(own for own in moved_edges(seal) if own.label not in known)]


def leading_part(seal):
    """Return the contact with the first profile that moves, or the first edges that do; where nothing
    moves the first of all.

    Raises
    ------
    ValueError
        For a seal without profiles and moved edges.
    """
    parts = moving_parts(seal) or [leading_contact(seal)]
    return next((own for own in parts if own.motion.moves), parts[0])


def motions(seal) -> list[Motion]:
    """List the motions of the profiles of a seal, then those of moved edges."""
    return [own.motion for own in moving_parts(seal)]


def path_stages(seal) -> StageEnds | None:
    """Return the stages of the path with their times; None for a seal whose stages take no time."""
    return stage_ends(seal, motions(seal))


def leading_motion(seal) -> Motion | None:
    """Return the motion of ``leading_part``; None without profiles and moved edges."""
    return leading_part(seal).motion if moving_parts(seal) else None


def profile_histories(result) -> tuple[ProfileHistory, ...]:
    """Evaluate every profile of a result along its path, complete or up to where it ended."""
    return tuple(_history(result, contact) for contact in contacts(result.seal))


def moving_histories(result) -> tuple[ProfileHistory, ...]:
    """Evaluate every profile of a result along its path, then moved edges, which are in no contact."""
    return tuple(_history(result, own) for own in moving_parts(result.seal))


def _history(result, contact) -> ProfileHistory:
    # a profile that stands still shows the stages of the leading one
    motion = contact.motion if contact.motion.moves else leading_motion(result.seal)
    number = np.array([step.nominal for step in result.path.nominal_steps], int)
    stage = stage_of(motion, number)
    since = _waypoints(motion)[stage - 1]
    moved = _coordinates(motion, number) - since
    at_steps = np.zeros((len(number), 4))
    if isinstance(contact, RigidContact):
        modulus = ContactModulus(result, contact.label)
        for index, step in enumerate(result.path.nominal_steps):
            at_steps[index] = _contact_at(result, contact, index, modulus.after(step.fraction))
    return ProfileHistory(
        contact.label, stage, np.hypot(moved[:, 0], moved[:, 1]), moved[:, 2],
        _coordinates(contact.motion, number), result.path.reaction(contact.label),
        result.path.initial_force(contact.label),
        *at_steps.reshape(-1, 4).T, courses(result.seal, motion, len(number)),
    )  # fmt: skip


def _contact_at(result, contact, step: int, moduli) -> tuple:
    """Compute deformed and undeformed width in contact, highest true and nominal pressure of a step,
    with the ``moduli`` (k,) of the contact points, kPa."""
    response, where = result.path.at_nominal(contact.label)[step], result.term(contact.label).where
    # widths of the sides in contact, deformed and undeformed
    ring, widths = ordered_points(where), []
    for particles in (result.deformed(step), result.particles):
        length = BoundaryLine(where, ring, particles).length
        # width = sum over the sides of the length that touches
        ends = contact_fractions(
            response.gap[ring], length, moduli[ring], contact.law.normal_penalty
        )
        widths.append(length @ ends.fraction)
    pressures = true_pressure(result, contact, step), nominal_pressure(contact, response)
    return (*widths, *(values.max() for values in pressures))


def nominal_pressure(contact: RigidContact, response) -> np.ndarray:
    """Compute the pressure w_n |g_n| of the points, force over undeformed length, shape (k,), kPa."""
    # p = w_n |g_n|
    return np.where(response.state != OPEN, -contact.law.normal_penalty * response.gap, 0.0)


def true_pressure(result, contact: RigidContact, step: int = -1) -> np.ndarray:
    """Compute the true (Cauchy) pressure of the points after a nominal step, shape (k,), kPa."""
    where, response = contact.where, result.path.at_nominal(contact.label)[step]
    # force over deformed length, or area of a ring: p = w_n |g_n| L / l
    stretch = where.measures(result.deformed(step)) / where.measures(result.particles)
    return nominal_pressure(contact, response) / stretch


def contact_counts(response) -> dict[str, int]:
    """Count the points of a contact that touch, stick and slip."""
    state = response.state
    counts = {"contact": state != OPEN, "stick": state == STICK, "slip": state == SLIP}
    return {name: int(np.sum(points)) for name, points in counts.items()}


def contact_positions(result, label: str) -> np.ndarray:
    """Return the undeformed contact points, shape (k, 2), mm."""
    return result.term(label).where.points.at(result.particles)


def arc_length(result, label: str) -> np.ndarray:
    """Compute the undeformed arc length of the contact points from the first one, shape (k,), mm."""
    sides = np.hypot(*np.diff(contact_positions(result, label), axis=0).T)
    return np.concatenate([[0.0], np.cumsum(sides)])


def stage_of(motion: Motion, number: np.ndarray) -> np.ndarray:
    """Find the stage, from 1, to which nominal steps (from 0) belong."""
    return 1 + np.searchsorted(np.cumsum(motion.steps), number, side="right")


def moved_in_stage(seal, fraction: float) -> np.ndarray | None:
    """Return x, y (mm), angle (degrees) of the leading profile since its stage began.

    After any ``fraction`` of the load steps; None without profiles.
    """
    motion = leading_motion(seal)
    if motion is None:
        return None
    stage = min(np.searchsorted(np.cumsum(motion.steps), fraction), len(motion.steps) - 1)
    # x, y in mm, angle in degrees, from the waypoint where the stage begins
    here = np.array(motion.coordinates(fraction)) * (1.0, 1.0, np.degrees(1.0))
    return here - _waypoints(motion)[stage]


def stage_number(seal, fraction: float) -> int:
    """Return the number, from 1, of the stage of the leading profile in which a path parameter lies; 0
    for paths of a single stage or without profiles."""
    motion = leading_motion(seal)
    if motion is None or len(motion.steps) == 1:
        return 0
    # the step from 0 that ends at or after it
    return int(stage_of(motion, np.ceil(fraction) - 1))


def stage_travel(seal, fraction: float) -> float:
    """Return the travel of the leading profile since its stage began, mm; NaN without profiles.

    After any ``fraction`` of the load steps; in the first stage counted from ``before_touch``.
    """
    place = moved_in_stage(seal, fraction)
    if place is None:
        return float("nan")
    # |x - x_stage|, in the first stage less the travel before the first touch
    first = fraction <= leading_motion(seal).steps[0]
    return float(np.hypot(*place[:2])) - seal.before_touch * first


def _waypoints(motion) -> np.ndarray:
    """Return x, y (mm), angle (degrees) at the ends of the stages, the start first."""
    return np.column_stack([motion.positions, np.degrees(motion.angles)])


def _coordinates(motion, number) -> np.ndarray:
    """Evaluate x, y (mm), angle (degrees) after nominal steps, shape (n, 3)."""
    rows = np.array([motion.coordinates(float(n + 1)) for n in number]).reshape(-1, 3)
    return rows * (1.0, 1.0, np.degrees(1.0))


def courses(seal, motion: Motion, n_steps: int) -> tuple[Course, ...]:
    """Divide the first ``n_steps`` nominal steps of the motion of a profile of a seal, see
    ``load_segments``; where nothing moves and a fluid acts, they are one course over its pressure."""
    pressures = fluid_pressures(seal, np.arange(1.0, n_steps + 1.0))
    if motion.moves or not pressures or not n_steps:
        return load_segments(motion, n_steps, seal.before_touch)
    label, along = next(iter(pressures.items()))
    stages = tuple(range(1, 1 + int(stage_of(motion, np.array([n_steps - 1]))[0])))
    return (Course(slice(0, n_steps), stages, along, f"pressure of {label} (kPa)"),)


def load_segments(motion: Motion, n_steps: int, before: float = 0.0) -> tuple[Course, ...]:
    """Divide the first ``n_steps`` nominal steps of a motion where its direction changes.

    Loading and unloading along one line are one course, so that they share an axis. The first travel is
    counted from ``before`` (mm) after its start.
    """
    waypoints, ends = _waypoints(motion), np.concatenate([[0], np.cumsum(motion.steps)])
    # neighbouring stages along one line, with the direction of the first that is not at rest
    groups = []
    for stage, ends_of_stage in enumerate(pairwise(waypoints)):
        moved = ends_of_stage[1] - ends_of_stage[0]
        if groups and _one_line(groups[-1][1], moved):
            first, direction = groups.pop()
            groups.append(((*first, stage), direction if direction.any() else moved))
        else:
            groups.append(((stage,), moved))
    found = []
    for stages, direction in groups:
        steps = slice(ends[stages[0]], min(ends[stages[-1] + 1], n_steps))
        if steps.start >= n_steps:
            break
        # signed travel (x - x_0) . e along the direction e of the first stage, or the angle of a turn
        turns = bool(direction[2]) and not direction[:2].any()
        unit = np.array([0.0, 0.0, 1.0]) if turns else np.append(direction[:2], 0.0)
        unit = unit / (np.linalg.norm(unit) or 1.0)
        # s = u . (x - x_begin), u along the first stage with a direction
        moved = _coordinates(motion, range(steps.start, steps.stop)) - waypoints[stages[0]]
        numbers = tuple(s + 1 for s in stages if ends[s] < n_steps)
        begin = 0.0 if turns or stages[0] else -before
        axis = ROTATION if turns else TRAVEL
        found.append(Course(steps, numbers, moved @ unit + begin, axis, begin))
    return tuple(found)


def _one_line(one, other) -> bool:
    """Return whether two stages (dx, dy, degrees) have one line or pivot, or one of them is a dwell."""
    if not (one.any() and other.any()):
        return True
    if one[2] or other[2]:
        return not (one[:2].any() or other[:2].any()) and bool(one[2] and other[2])
    # |a x b| <= eps |a| |b|
    across = one[0] * other[1] - one[1] * other[0]
    return abs(across) <= PARALLEL * np.hypot(*one[:2]) * np.hypot(*other[:2])


def key_steps(result) -> list[int]:
    """Choose nominal steps, from 0, for figures: ends of stages, and fractions of few of them."""
    done, motion = len(result.path.nominal_steps), leading_motion(result.seal)
    if not done:
        return []
    n = result.seal.n_steps
    stages, ends = (1, step_fractions(n)) if motion is None else (motion.steps.size, motion.ends)
    # quarters of one stage, halves of up to three, else ends of stages alone
    parts = 4 if stages == 1 else 2 if stages <= MIDDLES else 1
    # fractions of the stages, and the steps that end nearest to them
    wanted = np.arange(1, stages * parts + 1) / parts
    # fractions of the travel from the first touch on
    if result.seal.before_touch:
        share = result.seal.before_touch / np.hypot(*np.diff(motion.positions[:2], axis=0)[0])
        wanted[:parts] = share + (1.0 - share) * wanted[:parts]
    # of two that are as near the earlier one, whatever the rounding
    nearest = np.round(np.abs(ends[:, None] - wanted), 9).argmin(axis=0)
    return np.unique(np.minimum(nearest, done - 1)).tolist()


def caption(result, step: int) -> str:
    """Describe the state after a nominal step, as ``position`` does."""
    return position(result.seal, step + 1.0)


def position(seal, fraction: float) -> str:
    """Describe where the profiles are after a ``fraction`` of the load steps, the pressures of fluids,
    and the time where the seal has times."""
    time, pressures = times_at(seal, [fraction]), fluid_pressures(seal, [fraction]).items()
    # three digits, without an exponent
    after = [f"{label} {float(f'{p:.3g}'):g} kPa" for label, (p,) in pressures if p > 0.0]
    after += [] if time is None else [f"after {duration(time[0])}"]
    moved, stage = moved_in_stage(seal, fraction), stage_number(seal, fraction)
    if moved is None:
        return ", ".join([f"step {fraction:.4g} of {seal.n_steps}", *after])
    travel, turn = stage_travel(seal, fraction), moved[2]
    words = [f"travel {travel:.3g} mm"] if np.hypot(*moved[:2]) else []
    words += [f"turn {turn:.3g}°"] if turn else []
    head = [f"stage {stage}"] if stage else []
    return ", ".join([*head, *(words or ["at rest"]), *after])
