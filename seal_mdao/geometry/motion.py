"""Motion of a rigid profile along the load path: stages of translation and rotation about a pivot.

Within a stage position and angle vary linearly from one waypoint to the next. Parameters of the motion
move the waypoints, so the rate of every pose with respect to them is known before the analysis.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seal_mdao.geometry.pose import Pose
from seal_mdao.values import array, require

ROUNDING = 1e-12
"""Relative difference up to which a travel counts as that of the complete path."""
BEFORE = -np.inf
"""Path parameter before all preliminary increments."""


class Cached(dict):
    """Values of a function of the load parameter, each computed once.

    Unlike a function with ``functools.cache`` it can be pickled, as results are by process pools.
    """

    def __init__(self, function):
        self.function = function

    def __missing__(self, fraction):
        value = self[fraction] = self.function(fraction)
        return value

    def __call__(self, fraction):
        return self[fraction]


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion of a profile: waypoints, load steps between them, and rates with respect to parameters.

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
    clearance : ndarray, shape (2,)
        Clearance, from the first waypoint to where the first load step begins: it lengthens that step
        and does not count as travel.
    retraction : ndarray, shape (n_preliminary, 2)
        Displacements, from where the first load step begins, at the path parameters -1, -2, ...: the
        preliminary increments, in which profiles alone move, begin there. None for no increments.
    fractions : ndarray, shape (n_steps,), or None
        Fraction of its stage completed at the end of every step, 1 at the last; None for equal steps.
    durations : ndarray, shape (n_stages,), or None
        Time of every stage, s; NaN for a stage whose time follows from a speed. None: NaN for all.

    Raises
    ------
    ValueError
        For arrays that do not fit each other, infinite numbers, stages without steps, fractions
        that do not increase to 1.
    """

    positions: np.ndarray
    angles: np.ndarray
    steps: np.ndarray
    pivot: np.ndarray = (0.0, 0.0)
    rates: np.ndarray | None = None
    names: tuple[str, ...] = ()
    clearance: np.ndarray = (0.0, 0.0)
    retraction: np.ndarray | None = None
    fractions: np.ndarray | None = None
    durations: np.ndarray | None = None

    def __post_init__(self):
        steps = np.array(self.steps)
        count, names = steps.size, tuple(self.names)
        require(
            steps.ndim == 1
            and count > 0
            and np.issubdtype(steps.dtype, np.integer)
            and steps.min() > 0,
            "the numbers of load steps of a motion must be positive integers, one per stage, got "
            f"{self.steps!r}",
        )
        rates = np.zeros((0, count + 1, 3)) if self.rates is None else self.rates
        retraction = np.zeros((0, 2)) if self.retraction is None else self.retraction
        shapes = {
            "positions": (self.positions, (count + 1, 2)),
            "angles": (self.angles, (count + 1,)),
            "pivot": (self.pivot, (2,)),
            "clearance": (self.clearance, (2,)),
            "retraction": (retraction, (len(retraction), 2)),
            "rates": (rates, (len(names), count + 1, 3)),
        }
        of = f"of a motion with {count} stage(s) and {len(names)} parameter(s)"
        for name, (given, shape) in shapes.items():
            object.__setattr__(self, name, array(f"{name} {of}", given, shape))
        require(
            self.clearance @ (self.positions[1] - self.positions[0]) <= 0.0,
            "the clearance of a motion (its displacement before the start) must point against the "
            f"first displacement of the motion, got {self.clearance}",
        )
        require(
            len(set(names)) == len(names),
            f"the parameters of a motion must have different names, got {names}",
        )
        object.__setattr__(self, "steps", steps.astype(np.int64))
        object.__setattr__(self, "names", names)
        if self.fractions is not None:
            object.__setattr__(self, "fractions", self._checked_fractions())
        durations = np.full(count, np.nan) if self.durations is None else self.durations
        object.__setattr__(self, "durations", np.array(durations, float))
        require(
            self.durations.shape == (count,) and not np.any(self.durations <= 0.0),
            f"the durations of a motion must be positive, one per stage, got {self.durations!r}",
        )

    def _checked_fractions(self) -> np.ndarray:
        fractions = np.array(self.fractions, float)
        require(
            fractions.shape == (self.n_steps,)
            and all(map(increases_to_one, np.split(fractions, self._stage_ends[:-1]))),
            "the fractions of a motion at which load steps end must increase to 1 in every stage "
            f"of {self.steps.tolist()} steps, got {self.fractions!r}",
        )
        return fractions

    def moved(self, values: Mapping[str, float]) -> "Motion":
        """Change the parameters by ``values`` and return the new motion.

        Raises
        ------
        ValueError
            For an unknown parameter.
        """
        unknown = [name for name in values if name not in self.names]
        require(
            not unknown,
            f"unknown parameter {unknown[:1]} of a motion; its parameters are {self.names}",
        )
        # waypoints are linear in the parameters: w + sum_p dw/dp (change of p)
        change = sum(
            (float(value) * self.rates[self.names.index(name)] for name, value in values.items()),
            np.zeros((len(self.angles), 3)),
        )
        return replace(
            self, positions=self.positions + change[:, :2], angles=self.angles + change[:, 2]
        )

    def unit(self, name: str) -> str | None:
        """Return the unit of a parameter: mm if it translates waypoints by 1 mm per unit, deg if it
        rotates them by one degree, None otherwise."""
        rates = self.rates[self.names.index(name)]
        # dw/dp = (x', y', angle') of the waypoints that the parameter moves
        rates = rates[rates.any(axis=1)]
        length, angle = np.hypot(*rates[:, :2].T), np.abs(rates[:, 2])
        for unit, own, other in (("mm", length, angle), ("deg", np.degrees(angle), length)):
            if len(rates) and np.allclose(own, 1.0) and not other.any():
                return unit
        return None

    def with_placement(self, x: str = "", y: str = "", angle: str = "") -> "Motion":
        """Add parameters that translate or rotate the complete motion, for the names that are given.

        Parameters
        ----------
        x, y : str
            Name of a translation of every waypoint.
        angle : str
            Name of a rotation of the profile about its pivot, degrees.

        Raises
        ------
        ValueError
            For names that repeat.
        """
        # dw/dp of every waypoint: (1, 0, 0), (0, 1, 0), (0, 0, pi/180)
        units = {x: (1.0, 0.0, 0.0), y: (0.0, 1.0, 0.0), angle: (0.0, 0.0, np.pi / 180.0)}
        units.pop("", None)
        every = [np.tile(unit, (1, len(self.angles), 1)) for unit in units.values()]
        return replace(
            self, rates=np.concatenate([self.rates, *every]), names=(*self.names, *units)
        )

    def with_ends(self, ends) -> "Motion":
        """Divide the same motion into other load steps.

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
            "the fractions of a motion at which load steps end must increase and contain the ends "
            f"of all stages {stage_ends.tolist()}, got {ends.tolist()}",
        )
        # the stage of a step is the first whose end is not before the end of the step
        stages = np.searchsorted(stage_ends, ends)
        fractions = [self._fraction_of_stage(*pair) for pair in zip(stages, ends, strict=True)]
        return replace(self, steps=np.bincount(stages), fractions=np.array(fractions))

    @cached_property
    def n_steps(self) -> int:
        """Nominal load steps of all stages."""
        return int(self.steps.sum())

    @property
    def begins_at(self) -> float:
        """Path parameter at which it begins: 0, or minus the number of preliminary increments."""
        return -float(len(self.retraction))

    @cached_property
    def ends(self) -> np.ndarray:
        """Ends of the steps, counted in stages, shape (n_steps,)."""
        own = [stage + self._stage_fractions(stage)[1:] for stage in range(self.steps.size)]
        return np.concatenate(own)

    @cached_property
    def _stage_ends(self) -> np.ndarray:
        return np.cumsum(self.steps)

    @cached_property
    def _nominal(self) -> np.ndarray:
        """Nominal x, y, angle at the start and after every step, shape (n_steps + 1, 3)."""
        waypoints = np.column_stack([self.positions, self.angles])
        parts = [waypoints[:1]]
        for stage, ends in enumerate(pairwise(waypoints)):
            parts.append(self._within(stage, *ends))
        nominal = np.concatenate(parts)
        # only the start of the first step is moved back by the clearance
        nominal[0, :2] += self.clearance
        return nominal

    def _within(self, stage: int, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Interpolate x, y, angle after every step of a stage from ``first`` to ``last``."""
        n = self.steps[stage]
        if self.fractions is None:
            # one component at a time: linspace of arrays rounds differently where one is constant
            columns = [np.linspace(*pair, n + 1)[1:] for pair in zip(first, last, strict=True)]
            return np.column_stack(columns)
        # w = w_first + phi (w_last - w_first); the end exactly
        along = first + self._stage_fractions(stage)[1:, None] * (last - first)
        along[-1] = last
        return along

    def _stage_fractions(self, stage: int) -> np.ndarray:
        """Collect the completed fractions of a stage at its start and after each of its steps."""
        n, end = self.steps[stage], self._stage_ends[stage]
        if self.fractions is None:
            return np.concatenate([[0.0], step_fractions(n)])
        return np.concatenate([[0.0], self.fractions[end - n : end]])

    def _fraction_of_stage(self, stage: int, fraction: float) -> float:
        """Compute the completed fraction of a stage after ``fraction`` nominal steps."""
        # nominal steps since the start of the stage
        since = fraction - (self._stage_ends[stage] - self.steps[stage])
        if self.fractions is None:
            return since / self.steps[stage]
        own = self._stage_fractions(stage)
        return float(np.interp(since, np.arange(own.size), own))

    def coordinates(self, fraction: float) -> np.ndarray:
        """Compute x, y and angle after ``fraction`` nominal steps, shape (3,); negative ones are those
        of the preliminary increments, before which the profile stands still."""
        if fraction < 0.0:
            # w = w_0 + r(-s), linear between r(0) = 0, r(1), r(2), ...
            columns = np.vstack([np.zeros(2), self.retraction]).T
            at = np.arange(len(self.retraction) + 1)
            moved = [np.interp(-fraction, at, column) for column in columns]
            return self._nominal[0] + [*moved, 0.0]
        first = self._step(fraction)
        within = fraction - first
        # w = w_k + (s - k) (w_(k+1) - w_k) in nominal step k
        return self._nominal[first] + within * (self._nominal[first + 1] - self._nominal[first])

    def pose(self, fraction: float) -> Pose:
        """Compute the pose of the profile after ``fraction`` nominal steps."""
        x, y, angle = self.coordinates(fraction)
        return Pose.of((x, y), angle, self.pivot)

    def rates_at(self, fraction: float) -> np.ndarray:
        """Differentiate x, y and angle with respect to the parameters, shape (n_parameters, 3)."""
        # the retraction is fixed
        fraction = max(fraction, 0.0)
        stage = int(np.searchsorted(self._stage_ends, self._step(fraction), side="right"))
        phi = self._fraction_of_stage(stage, fraction)
        # w = (1 - phi) w_first + phi w_last with phi fixed: w' likewise
        first = self.rates[:, stage]
        return first + phi * (self.rates[:, stage + 1] - first)

    @cached_property
    def _lengths(self) -> np.ndarray:
        """Travel of every stage, shape (n_stages,)."""
        return np.hypot(*np.diff(self.positions, axis=0).T)

    @property
    def travel(self) -> float:
        """Length of the path of the profile, without rotation."""
        return float(self._lengths.sum())

    @property
    def moves(self) -> bool:
        """Whether the profile moves at all."""
        return bool(np.ptp(self.positions, axis=0).any() or np.ptp(self.angles))

    @property
    def travels(self) -> np.ndarray:
        """Length of the path at the start and after every nominal step, shape (n_steps + 1,).

        The clearance is no travel.
        """
        return self._accumulated(self._lengths)

    @property
    def timing(self) -> tuple[np.ndarray, np.ndarray]:
        """Travel in stages without a duration (mm), and time in the stages with one (s).

        Both at the start and after every nominal step, shape (n_steps + 1,). At a speed v a load step
        takes the change of the first over v plus the change of the second.
        """
        # lengths of the stages without a duration, durations of the others
        given = ~np.isnan(self.durations)
        travel = np.where(given, 0.0, self._lengths)
        return self._accumulated(travel), self._accumulated(np.where(given, self.durations, 0.0))

    @property
    def timed_travel_rates(self) -> np.ndarray:
        """Derivatives of the travel of ``timing`` with respect to the parameters, shape
        (n_parameters, n_steps + 1)."""
        growth = np.where(np.isnan(self.durations), self._growth, 0.0)
        rows = [self._accumulated(own) for own in growth]
        return np.array(rows).reshape(len(self.names), self.n_steps + 1)

    @property
    def _directions(self) -> np.ndarray:
        """Unit vectors of the stages, shape (n_stages, 2); zero of a stage without travel."""
        # u_k = chord_k / L_k
        lengths = np.where(self._lengths == 0.0, 1.0, self._lengths)
        return np.diff(self.positions, axis=0) / lengths[:, None]

    @property
    def _growth(self) -> np.ndarray:
        """Derivatives of the travel of every stage, shape (n_parameters, n_stages); zero of a stage
        without travel."""
        # L_k = |chord_k|,  L_k' = u_k . chord_k'
        return (np.diff(self.rates[:, :, :2], axis=1) * self._directions).sum(axis=2)

    def _accumulated(self, sizes: np.ndarray) -> np.ndarray:
        """Sum what grows linearly by ``sizes`` (n_stages,) in the stages, shape (n_steps + 1,)."""
        # s = sum of the stages before + phi L of the present one
        before = np.concatenate([[0.0], np.cumsum(sizes)])
        own = [
            before[stage] + self._stage_fractions(stage)[1:] * size
            for stage, size in enumerate(sizes)
        ]
        return np.concatenate([[0.0], *own])

    def at_travel(self, travel: float) -> tuple[float, np.ndarray]:
        """Find the first time at which the profile has covered ``travel`` along its path.

        Returns
        -------
        fraction : float
            Number of nominal steps completed.
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
            f"a travel of {travel:.6g} mm is beyond the end of the motion, which is at a travel of "
            f"{ends[-1]:.6g}",
        )
        stage = min(int(np.searchsorted(ends, travel)), len(ends) - 1)
        before, length = ends[stage] - lengths[stage], lengths[stage]
        if length == 0.0:  # nothing has moved yet
            return 0.0, np.zeros(len(self.names))
        # phi = (travel - sum_(k < s) L_k) / L_s
        phi = min(1.0, (travel - before) / length)
        units, growth = self._directions, self._growth
        # travel = sum_(k < s) L_k + phi L_s is fixed:  phi' = -(sum_(k < s) L_k' + phi L_s') / L_s
        slopes = -(growth[:, :stage].sum(axis=1) + phi * growth[:, stage]) / length
        fraction, per_phi = self._after(stage, phi)
        if fraction < 1.0 and self.clearance.any():
            # u_0' . c = (chord_0' . c - L_0' u_0 . c) / L_0;  the distance added is -u_0 . c
            rates = self.rates[:, 1, :2] - self.rates[:, 0, :2]
            across = rates @ self.clearance - growth[:, 0] * (units[0] @ self.clearance)
            return self._in_first_step(
                travel, -units[0] @ self.clearance, growth[:, 0], -across / length
            )
        return fraction, per_phi * slopes

    def _after(self, stage: int, phi: float) -> tuple[float, float]:
        """Compute the nominal steps done after a fraction ``phi`` of a stage, and d(steps)/d(phi)."""
        n = int(self.steps[stage])
        before = int(self._stage_ends[stage]) - n
        if self.fractions is None:
            return before + phi * n, n
        own = self._stage_fractions(stage)
        step = min(int(np.searchsorted(own, phi, side="right")), n) - 1
        length = own[step + 1] - own[step]
        return before + step + (phi - own[step]) / length, 1.0 / length

    def _in_first_step(
        self, travel, clearance, length_rates, clearance_rates
    ) -> tuple[float, np.ndarray]:
        """Evaluate ``at_travel`` within the first nominal step, which is longer by ``clearance``."""
        first = self._stage_fractions(0)[1]
        length = first * self._lengths[0] + clearance
        # phi_1 fraction of stage 0 in its first step, length = phi_1 L_0 + r with clearance r:
        # fraction = (travel + r) / length,  fraction' = (r' - fraction (phi_1 L_0' + r')) / length
        part = (travel + clearance) / length
        return part, (clearance_rates - part * (first * length_rates + clearance_rates)) / length

    def _step(self, fraction: float) -> int:
        """Return the index of the current nominal step; the last one at the end."""
        require(
            0.0 <= fraction <= self.n_steps,
            f"load step {fraction} is beyond the end of the motion, which has {self.n_steps} steps",
        )
        return min(int(fraction), self.n_steps - 1)


@dataclass(frozen=True)
class Stage:
    """One stage of a motion, relative to the end of the stage before.

    Attributes
    ----------
    steps : int or tuple of float
        Number of equal steps, or the fraction of the stage completed at the end of each step.
    translate : pair of float
        Travel.
    rotate : float
        Degrees, counter-clockwise about the pivot.
    rates : mapping of str to (dx, dy, degrees)
        Derivatives of ``translate`` and ``rotate`` with respect to named parameters. Later stages
        begin at the end of this one, so they are moved too.
    duration : float, optional
        Time of the stage, s; None where it follows from a speed, or does not matter.
    """

    steps: int | tuple[float, ...]
    translate: tuple[float, float] = (0.0, 0.0)
    rotate: float = 0.0
    rates: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    duration: float | None = None

    @property
    def n_steps(self) -> int:
        """Number of load steps."""
        return len(step_fractions(self.steps))

    @property
    def moves(self) -> bool:
        """Whether it translates or rotates."""
        return any(self.translate) or bool(self.rotate)


def step_fractions(steps: int | tuple[float, ...]) -> np.ndarray:
    """Compute the completed fraction at the end of every step, of equal steps or as given."""
    return np.array(steps) if isinstance(steps, tuple) else np.arange(1, steps + 1) / steps


def increases_to_one(fractions) -> bool:
    """Return whether these are fractions at the ends of steps: increasing, the last one 1."""
    return bool(fractions[-1] == 1.0 and np.all(np.diff(fractions, prepend=0.0) > 0.0))


def staged_motion(stages: Sequence[Stage], start=(0.0, 0.0), angle=0.0, pivot=(0.0, 0.0)) -> Motion:
    """Build the motion of stages in succession, from ``start`` (2,) and ``angle`` (degrees).

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
    # waypoint k = start + sum of the travels of the stages before; angles in radians
    travel = np.array([[*stage.translate, stage.rotate] for stage in stages], float) * units
    first = np.array([*start, angle], float) * units
    waypoints = np.cumsum(np.vstack([first, travel]), axis=0)
    rates = np.zeros((len(names), len(stages) + 1, 3))
    for i, stage in enumerate(stages):
        for name, rate in stage.rates.items():
            # a stage moves its own end and all later waypoints
            rates[names.index(name), i + 1 :] += np.asarray(rate, float) * units
    equal = not any(isinstance(stage.steps, tuple) for stage in stages)
    return Motion(
        waypoints[:, :2], waypoints[:, 2], [stage.n_steps for stage in stages], pivot, rates, names,
        fractions=None if equal else np.concatenate([step_fractions(stage.steps) for stage in stages]),
        durations=[np.nan if stage.duration is None else stage.duration for stage in stages],
    )  # fmt: skip


def path_motion(motions: Iterable[Motion]) -> Motion:
    """Return the motion whose stages are those of the path: the first one that moves or has several
    stages, or the first of all where there is none."""
    motions = tuple(motions)
    return next((own for own in motions if own.moves or len(own.steps) > 1), motions[0])


def straight_motion(start, end, steps: int, rates: Mapping[str, tuple] | None = None) -> Motion:
    """Build a translation from ``start`` to ``end`` (2,) in ``steps`` load steps.

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
