"""Motion of a rigid profile along the load path: stages of translation and rotation about a pivot.

Within a stage position and angle go in a straight line from one waypoint to the next. Parameters of
the motion move the waypoints, so their share of every step is a number of the motion, not of a sweep.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seal_mdao.geometry.pose import Pose
from seal_mdao.values import array, require

ROUNDING = 1e-12
"""Relative difference up to which a travel counts as that of the whole path."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Waypoints of a profile, the load steps between them, and how parameters move them.

    Attributes
    ----------
    positions : ndarray, shape (n_stages + 1, 2)
        Translations at the start and at the end of every stage.
    angles : ndarray, shape (n_stages + 1,)
        Radians.
    steps : ndarray of int, shape (n_stages,)
        Nominal load steps of every stage.
    pivot : ndarray, shape (2,)
        Centre of rotation, in the profile's own frame.
    rates : ndarray, shape (n_parameters, n_stages + 1, 3)
        Derivatives of the waypoints (x, y, angle) with respect to the parameters ``names``.
    names : tuple of str
    room : ndarray, shape (2,)
        From the first waypoint to where the first load step begins: it lengthens that step, and is no
        part of the travel.
    shares : ndarray, shape (n_steps,), or None
        Of its stage that is done at the end of every step, 1 at that of the stage; None for equal steps.

    Raises
    ------
    ValueError
        For arrays that do not fit each other, numbers that are not finite, stages without steps, shares
        that do not increase to 1.
    """

    positions: np.ndarray
    angles: np.ndarray
    steps: np.ndarray
    pivot: np.ndarray = (0.0, 0.0)
    rates: np.ndarray | None = None
    names: tuple[str, ...] = ()
    room: np.ndarray = (0.0, 0.0)
    shares: np.ndarray | None = None

    def __post_init__(self):
        steps = np.array(self.steps)
        count, names = steps.size, tuple(self.names)
        require(
            steps.ndim == 1
            and count > 0
            and np.issubdtype(steps.dtype, np.integer)
            and steps.min() > 0,
            f"steps of a motion must be positive whole numbers, one a stage; got {self.steps!r}",
        )
        rates = np.zeros((0, count + 1, 3)) if self.rates is None else self.rates
        shapes = {
            "positions": (self.positions, (count + 1, 2)),
            "angles": (self.angles, (count + 1,)),
            "pivot": (self.pivot, (2,)),
            "room": (self.room, (2,)),
            "rates": (rates, (len(names), count + 1, 3)),
        }
        of = f"of a motion with {count} stage(s) and {len(names)} parameter(s)"
        for name, (given, shape) in shapes.items():
            object.__setattr__(self, name, array(f"{name} {of}", given, shape))
        require(
            self.room @ (self.positions[1] - self.positions[0]) <= 0.0,
            f"room of a motion must lie behind its first waypoint, got {self.room}",
        )
        require(len(set(names)) == len(names), f"names of a motion's parameters repeat: {names}")
        object.__setattr__(self, "steps", steps.astype(np.int64))
        object.__setattr__(self, "names", names)
        if self.shares is not None:
            object.__setattr__(self, "shares", self._checked_shares())

    def _checked_shares(self) -> np.ndarray:
        shares = np.array(self.shares, float)
        require(
            shares.shape == (self.n_steps,)
            and all(map(increases_to_one, np.split(shares, self._stage_ends[:-1]))),
            f"shares of a motion must increase to 1 in every stage of {self.steps.tolist()} steps, got "
            f"{self.shares!r}",
        )
        return shares

    def moved(self, values: Mapping[str, float]) -> "Motion":
        """The motion after its parameters have changed by ``values``.

        Raises
        ------
        ValueError
            For a parameter that it does not have.
        """
        unknown = [name for name in values if name not in self.names]
        require(not unknown, f"a motion with parameters {self.names} has no {unknown[:1]}")
        change = sum(
            (float(value) * self.rates[self.names.index(name)] for name, value in values.items()),
            np.zeros((len(self.angles), 3)),
        )
        return replace(
            self, positions=self.positions + change[:, :2], angles=self.angles + change[:, 2]
        )

    def with_placement(self, x: str = "", y: str = "", angle: str = "") -> "Motion":
        """The motion with further parameters that place all of it, by the names that are given.

        Parameters
        ----------
        x, y : str
            Of a translation of every waypoint.
        angle : str
            Of a rotation of the profile about its pivot, degrees.

        Raises
        ------
        ValueError
            For names that repeat.
        """
        units = {x: (1.0, 0.0, 0.0), y: (0.0, 1.0, 0.0), angle: (0.0, 0.0, np.pi / 180.0)}
        units.pop("", None)
        every = [np.tile(unit, (1, len(self.angles), 1)) for unit in units.values()]
        return replace(
            self, rates=np.concatenate([self.rates, *every]), names=(*self.names, *units)
        )

    def with_ends(self, ends) -> "Motion":
        """The same motion with its load steps ending elsewhere.

        Parameters
        ----------
        ends : sequence of float
            Where the new steps end, in nominal steps of this motion: increasing, the ends of all
            stages among them, the last one ``n_steps``.

        Raises
        ------
        ValueError
            For ends that do not increase or that leave out the end of a stage.
        """
        ends, stage_ends = np.asarray(ends, float), self._stage_ends
        require(
            ends.ndim == 1
            and ends.size > 0
            and ends[0] > 0.0
            and bool(np.all(np.diff(ends) > 0.0))
            and bool(np.isin(stage_ends, ends).all())
            and ends[-1] == self.n_steps,
            f"ends of load steps must increase and hold the ends of all stages "
            f"{stage_ends.tolist()}, got {ends.tolist()}",
        )
        stages = np.searchsorted(stage_ends, ends)
        shares = [self._share_in(*pair) for pair in zip(stages, ends, strict=True)]
        return replace(self, steps=np.bincount(stages), shares=np.array(shares))

    @cached_property
    def n_steps(self) -> int:
        """Nominal load steps of all stages."""
        return int(self.steps.sum())

    @cached_property
    def ends(self) -> np.ndarray:
        """Where the steps end, in stages, shape (n_steps,)."""
        own = [stage + self._own_shares(stage)[1:] for stage in range(self.steps.size)]
        return np.concatenate(own)

    @cached_property
    def _stage_ends(self) -> np.ndarray:
        return np.cumsum(self.steps)

    @cached_property
    def _nominal(self) -> np.ndarray:
        """x, y, angle at the start and after every nominal step, shape (n_steps + 1, 3)."""
        waypoints = np.column_stack([self.positions, self.angles])
        parts = [waypoints[:1]]
        for stage, ends in enumerate(pairwise(waypoints)):
            parts.append(self._within(stage, *ends))
        nominal = np.concatenate(parts)
        nominal[0, :2] += self.room
        return nominal

    def _within(self, stage: int, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """x, y, angle after every step of a stage from ``first`` to ``last``."""
        n = self.steps[stage]
        if self.shares is None:
            # one component at a time: linspace of arrays rounds otherwise where one stands still
            columns = [np.linspace(*pair, n + 1)[1:] for pair in zip(first, last, strict=True)]
            return np.column_stack(columns)
        along = first + self._own_shares(stage)[1:, None] * (last - first)
        along[-1] = last
        return along

    def _own_shares(self, stage: int) -> np.ndarray:
        """Shares of a stage done at its start and after each of its steps."""
        n, end = self.steps[stage], self._stage_ends[stage]
        if self.shares is None:
            return np.concatenate([[0.0], step_shares(n)])
        return np.concatenate([[0.0], self.shares[end - n : end]])

    def _share_in(self, stage: int, fraction: float) -> float:
        """Share of a stage done after ``fraction`` nominal steps, which are within it."""
        since = fraction - (self._stage_ends[stage] - self.steps[stage])
        if self.shares is None:
            return since / self.steps[stage]
        own = self._own_shares(stage)
        return float(np.interp(since, np.arange(own.size), own))

    def coordinates(self, fraction: float) -> np.ndarray:
        """x, y and angle after ``fraction`` nominal steps, shape (3,)."""
        first = self._step(fraction)
        share = fraction - first
        return self._nominal[first] + share * (self._nominal[first + 1] - self._nominal[first])

    def pose(self, fraction: float) -> Pose:
        """Place of the profile after ``fraction`` nominal steps."""
        x, y, angle = self.coordinates(fraction)
        return Pose.of((x, y), angle, self.pivot)

    def rates_at(self, fraction: float) -> np.ndarray:
        """Derivatives of x, y and angle with respect to the parameters, shape (n_parameters, 3)."""
        stage = int(np.searchsorted(self._stage_ends, self._step(fraction), side="right"))
        share = self._share_in(stage, fraction)
        first = self.rates[:, stage]
        return first + share * (self.rates[:, stage + 1] - first)

    @cached_property
    def _lengths(self) -> np.ndarray:
        """Travel of every stage, shape (n_stages,)."""
        return np.hypot(*np.diff(self.positions, axis=0).T)

    @property
    def travel(self) -> float:
        """How far the profile comes along its path; rotation is no travel."""
        return float(self._lengths.sum())

    def at_travel(self, travel: float) -> tuple[float, np.ndarray]:
        """When the profile has come so far along its path, the first time.

        Returns
        -------
        fraction : float
            Nominal steps done.
        rates : ndarray, shape (n_parameters,)
            Its derivatives with respect to the parameters.

        Raises
        ------
        ValueError
            For a travel that is negative or longer than the path.
        """
        lengths, ends = self._lengths, np.cumsum(self._lengths)
        require(
            0.0 <= travel <= ends[-1] * (1.0 + ROUNDING),
            f"a motion of {ends[-1]:.6g} along its path has no place after {travel:.6g}",
        )
        stage = min(int(np.searchsorted(ends, travel)), len(ends) - 1)
        before, length = ends[stage] - lengths[stage], lengths[stage]
        if length == 0.0:  # nothing has moved yet
            return 0.0, np.zeros(len(self.names))
        share = min(1.0, (travel - before) / length)
        ways, rates = np.diff(self.positions, axis=0), np.diff(self.rates[:, :, :2], axis=1)
        units = ways / np.where(lengths == 0.0, 1.0, lengths)[:, None]
        growth = (rates * units).sum(axis=2)
        slopes = -(growth[:, :stage].sum(axis=1) + share * growth[:, stage]) / length
        fraction, per_share = self._after(stage, share)
        if fraction < 1.0 and self.room.any():
            across = rates[:, 0] @ self.room - growth[:, 0] * (units[0] @ self.room)
            return self._in_first_step(
                travel, -units[0] @ self.room, growth[:, 0], -across / length
            )
        return fraction, per_share * slopes

    def _after(self, stage: int, share: float) -> tuple[float, float]:
        """Nominal steps done after a share of a stage, and their derivative with respect to it."""
        n = int(self.steps[stage])
        done = int(self._stage_ends[stage]) - n
        if self.shares is None:
            return done + share * n, n
        own = self._own_shares(stage)
        step = min(int(np.searchsorted(own, share, side="right")), n) - 1
        length = own[step + 1] - own[step]
        return done + step + (share - own[step]) / length, 1.0 / length

    def _in_first_step(self, travel, room, length_rates, room_rates) -> tuple[float, np.ndarray]:
        """``at_travel`` within the first nominal step, which is longer by ``room``."""
        first = self._own_shares(0)[1]
        way = first * self._lengths[0] + room
        share = (travel + room) / way
        return share, (room_rates - share * (first * length_rates + room_rates)) / way

    def _step(self, fraction: float) -> int:
        """The nominal step under way; the last one at the end."""
        require(
            0.0 <= fraction <= self.n_steps,
            f"a motion of {self.n_steps} steps has no place after {fraction} of them",
        )
        return min(int(fraction), self.n_steps - 1)


@dataclass(frozen=True)
class Stage:
    """One stage of a motion, relative to where the stage before has ended.

    Attributes
    ----------
    steps : int or tuple of float
        How many equal ones, or the share of the stage that is done at the end of each of them.
    translate : pair of float
        Travel.
    rotate : float
        Degrees, counter-clockwise about the pivot.
    rates : mapping of str to (dx, dy, degrees)
        Derivatives of ``translate`` and ``rotate`` with respect to named parameters. Later stages
        begin where this one ends, so they are moved too.
    """

    steps: int | tuple[float, ...]
    translate: tuple[float, float] = (0.0, 0.0)
    rotate: float = 0.0
    rates: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)

    @property
    def n_steps(self) -> int:
        """How many load steps."""
        return len(step_shares(self.steps))


def step_shares(steps: int | tuple[float, ...]) -> np.ndarray:
    """Share that is done at the end of every step, of so many equal ones or as it is given."""
    return np.array(steps) if isinstance(steps, tuple) else np.arange(1, steps + 1) / steps


def increases_to_one(shares) -> bool:
    """Whether these can be the shares done at the ends of some steps, the last one all."""
    return bool(shares[-1] == 1.0 and np.all(np.diff(shares, prepend=0.0) > 0.0))


def staged_motion(stages: Sequence[Stage], start=(0.0, 0.0), angle=0.0, pivot=(0.0, 0.0)) -> Motion:
    """The motion of these stages, one after the other, from ``start`` (2,) and ``angle`` (degrees).

    Examples
    --------
    Close by 3 mm, a parameter "depth"; then open again by 10 degrees:

    >>> motion = staged_motion(
    ...     [Stage(20, (0.0, -3.0), rates={"depth": (0.0, -1.0, 0.0)}), Stage(10, rotate=10.0)])
    >>> motion.n_steps, motion.names
    (30, ('depth',))
    """
    require(len(stages) > 0, "a motion needs at least one stage")
    names = tuple(dict.fromkeys(name for stage in stages for name in stage.rates))
    units = np.array([1.0, 1.0, np.pi / 180.0])
    travel = np.array([[*stage.translate, stage.rotate] for stage in stages], float) * units
    first = np.array([*start, angle], float) * units
    waypoints = np.cumsum(np.vstack([first, travel]), axis=0)
    rates = np.zeros((len(names), len(stages) + 1, 3))
    for i, stage in enumerate(stages):
        for name, rate in stage.rates.items():
            rates[names.index(name), i + 1 :] += np.asarray(rate, float) * units
    equal = not any(isinstance(stage.steps, tuple) for stage in stages)
    return Motion(
        waypoints[:, :2], waypoints[:, 2], [stage.n_steps for stage in stages], pivot, rates, names,
        shares=None if equal else np.concatenate([step_shares(stage.steps) for stage in stages]),
    )  # fmt: skip


def straight_motion(start, end, steps: int, rates: Mapping[str, tuple] | None = None) -> Motion:
    """Translation from ``start`` to ``end`` (2,) in ``steps`` load steps.

    Parameters
    ----------
    rates : mapping of str to pair of float, optional
        Derivatives of ``end`` with respect to named parameters; the start stays.
    """
    rates = {} if rates is None else rates
    still = np.zeros(3)
    ends = [(still, (*map(float, rate), 0.0)) for rate in rates.values()]
    waypoints = np.array(ends).reshape(len(rates), 2, 3)
    return Motion([start, end], np.zeros(2), [steps], rates=waypoints, names=tuple(rates))
