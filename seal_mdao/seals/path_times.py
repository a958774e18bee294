"""Times along the load path of a seal with relaxation or vented cavities."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seal_mdao.geometry.motion import path_motion
from seal_mdao.loads.vented_air import VentedAir
from seal_mdao.terms.ramp import at_fraction

SAME = 1e-9
"""Relative difference up to which the times of two cavities are one."""


class StageEnds(NamedTuple):
    """Ends of the stages of a load path, with their times.

    Attributes
    ----------
    steps : ndarray of int, shape (n_stages + 1,)
        Nominal steps completed at the start and at the end of every stage.
    times : ndarray, shape (n_stages + 1,)
        s.
    moves : ndarray of bool, shape (n_stages,)
        Whether a profile or an edge moves in the stage.
    dwells : ndarray of bool, shape (n_stages,)
        Whether nothing moves, heats or presses in the stage.
    """

    steps: np.ndarray
    times: np.ndarray
    moves: np.ndarray
    dwells: np.ndarray

    @property
    def durations(self) -> np.ndarray:
        """Durations of the stages, shape (n_stages,), s."""
        return np.diff(self.times)

    @property
    def closing(self) -> int:
        """Stage, from 0, at whose end the seal is closed: the first one after which nothing moves, the
        first of all where there is none."""
        before_rest = np.flatnonzero(self.moves[:-1] & ~self.moves[1:])
        return int(before_rest[0]) if before_rest.size else 0


def times_at(seal, fractions) -> np.ndarray | None:
    """Evaluate the time of the path of a ``Seal``.

    Parameters
    ----------
    seal : Seal
    fractions : sequence of float, shape (K,)
        Path parameters: numbers of nominal steps completed.

    Returns
    -------
    ndarray, shape (K,), or None
        s; None where no material relaxes and no stage of a seal with vented air has a duration, or where
        several cavities have different closing speeds.
    """
    terms = seal.terms()
    environment = terms[0].environment
    if environment is not None and environment.time is not None:
        return environment.time.at(fractions)
    vented = [own for own in terms if isinstance(own, VentedAir)]
    if not any(own.time.any() for own in vented):
        return None
    # t = s / v in stages at the closing speed v, of which there are none without it (s = 0), plus the
    # given durations
    clocks = [own.travel / (own.closing_speed or np.inf) + own.time for own in vented]
    if not all(np.allclose(own, clocks[0], rtol=SAME) for own in clocks):
        return None
    return np.array([at_fraction(clocks[0], fraction) for fraction in fractions])


def stage_ends(seal, motions) -> StageEnds | None:
    """Find the stages of the path of a ``Seal`` and their times; None as for ``times_at``, and without
    any stages.

    Parameters
    ----------
    motions : sequence of Motion
        Of the profiles and moved edges; that of ``path_motion`` has the stages of the path.
    """
    moving = [own for own in motions if own.moves]
    found = times_at(seal, [0.0]) if moving else None
    if found is None:
        return None
    steps = np.concatenate([[0], np.cumsum(path_motion(motions).steps)])
    # motions with other stages move all the time
    moves = np.array([
        any(len(own.steps) != len(steps) - 1 or _moves_in(own, number) for own in moving)
        for number in range(len(steps) - 1)
    ])  # fmt: skip
    environment = seal.terms()[0].environment
    timed = environment is not None and environment.time is not None
    dwells = np.isfinite(environment.time.first) if timed else ~moves
    return StageEnds(steps, times_at(seal, steps), moves, np.asarray(dwells))


def _moves_in(motion, number: int) -> bool:
    """Whether a motion changes position or angle in a stage, from 0."""
    ends = [*pairwise(np.column_stack([motion.positions, motion.angles]))][number]
    return bool(np.any(ends[0] != ends[1]))
