"""The cases of the optimisation matrix: single changes, combinations of factors, drawn cases."""

from dataclasses import asdict, dataclass, replace

import numpy as np

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of

CONTROL_VALUES = {26: (14, 11, False), 16: (8, 7, False), 10: (5, 4, True)}
"""Outer and inner control values, and whether they are mirrored, by the number of parameters, which
counts the door's radius too."""
FLAGS = ("keep_force", "clamp_load", "pressure_floor", "stress_norm", "gap_integral")
"""Attributes of ``DoorProblem`` that a case can set."""


@dataclass(frozen=True)
class Case:
    """One variant of the paper's case.

    Attributes
    ----------
    corner_x, friction, friction_history, segments :
        As for ``DoorOptions``.
    parameters : int
        One of ``CONTROL_VALUES``.
    start : int
        0 for the nominal seal, else the seed of a random start.
    start_size : float
        Largest offset and change of the radius of a random start, mm.
    flags : tuple of str
        Those of ``FLAGS`` that are set.
    """

    corner_x: float = 2.0
    friction: float = 0.25
    parameters: int = 26
    friction_history: str = "accumulated"
    segments: int | None = None
    start: int = 0
    start_size: float = 0.2
    flags: tuple = ()

    @property
    def name(self) -> str:
        """What differs from the paper's case."""
        base, here = asdict(Case()), asdict(self) | {"start_size": Case.start_size, "flags": ()}
        changes = [f"{k} {v}" for k, v in here.items() if v != base[k]]
        if self.start_size != Case.start_size:
            changes[-1] += f" within {self.start_size} mm"
        return ", ".join([*changes, *self.flags]) or "paper"

    def seal(self, **more) -> sm.Seal:
        """The seal of the case."""
        outer, inner, symmetric = CONTROL_VALUES[self.parameters]
        return sm.door_seal(
            corner_x=self.corner_x, friction=self.friction, segments=self.segments,
            friction_history=self.friction_history, outer_parameters=outer,
            inner_parameters=inner, symmetric=symmetric, **more,
        )  # fmt: skip

    def settings(self) -> dict:
        """The flags as arguments of ``DoorProblem``."""
        return dict.fromkeys(self.flags, True)

    def design(self, seal: sm.Seal) -> tuple[np.ndarray, float]:
        """Offsets and door radius of the start."""
        if self.start == 0:
            return np.zeros(seal.n_offsets), options_of(seal).nominal_door_radius
        size = self.start_size
        change = np.random.default_rng(self.start).uniform(-size, size, seal.n_offsets + 1)
        return change[:-1], options_of(seal).nominal_door_radius + change[-1]


FACTORS = {
    "corner_x": (0.0, 2.0, 4.0),
    "friction": (0.15, 0.25, 0.4),
    "parameters": (26, 10),
    "friction_history": ("accumulated", "incremental"),
    "segments": (None, 32),
    "start": (0, 1, 2, 3),
}


def single_changes() -> list[Case]:
    """The paper's case, and each factor alone."""
    changed = [replace(Case(), **{k: v}) for k, values in FACTORS.items() for v in values]
    return list(dict.fromkeys([Case(), *changed]))


def combinations(count: int, seed: int = 2000) -> list[Case]:
    """Random combinations of all factors, none twice and none of the single changes."""
    rng, known = np.random.default_rng(seed), single_changes()
    wanted = len(known) + count
    while len(known) < wanted:
        levels = {k: values[rng.integers(len(values))] for k, values in FACTORS.items()}
        if Case(**levels) not in known:
            known.append(Case(**levels))
    return known[wanted - count :]


DRAWN, DRAWN_SEED = 20, 271828
"""Number and seed of the drawn cases, set down with the rule before any of them was run."""
DRAWN_START = 0.3
FLAG_SHARE = 0.2


def drawn_cases(count: int = DRAWN, seed: int = DRAWN_SEED) -> list[Case]:
    """Cases drawn at random, one after the other.

    The friction coefficient is sampled uniformly from 0.1 to 0.5 and ``corner_x`` from 0 to 4 mm, both
    rounded to two decimals. The number of parameters is 26, 16 or 10, and both friction histories are
    equally likely. In half of the cases the door contour is exact, in the other half a polygon of 8 to
    64 segments. In three of four cases the initial design has random offsets within 0.3 mm, from a seed
    of 1 to 9999. Each of the options ``keep_force`` to ``gap_integral`` is set in one of five cases.
    """
    rng = np.random.default_rng(seed)
    return [_drawn_case(rng) for _ in range(count)]


def _drawn_case(rng: np.random.Generator) -> Case:
    friction, corner_x = rng.uniform(0.1, 0.5), rng.uniform(0.0, 4.0)
    parameters, history = rng.choice(list(CONTROL_VALUES)), rng.choice(FACTORS["friction_history"])
    exact, segments = rng.random() < 0.5, rng.integers(8, 65)
    at_random, start = rng.random() < 0.75, rng.integers(1, 10000)
    flagged = rng.random(len(FLAGS)) < FLAG_SHARE
    return Case(
        corner_x=round(corner_x, 2), friction=round(friction, 2), parameters=int(parameters),
        friction_history=str(history), segments=None if exact else int(segments),
        start=int(start) if at_random else 0,
        start_size=DRAWN_START if at_random else Case.start_size,
        flags=tuple(name for name, wanted in zip(FLAGS, flagged, strict=True) if wanted),
    )  # fmt: skip
