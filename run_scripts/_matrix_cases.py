"""The cases of the optimisation matrix: factors, single changes, random combinations."""

from dataclasses import asdict, dataclass, replace

import numpy as np

import seal_mdao as sm
from seal_mdao.model import SealModel

START_SIZE = 0.2
"""Largest offset and change of radius of a random start, mm."""


@dataclass(frozen=True)
class Case:
    """One variant of the paper's case.

    Attributes
    ----------
    corner_x, friction, friction_history, segments :
        As for ``SealModel``.
    parameters : int
        26, or 10 for a symmetric section with 5 outer and 4 inner control values.
    start : int
        0 for the drawn seal, else the seed of a random start.
    """

    corner_x: float = 2.0
    friction: float = 0.25
    parameters: int = 26
    friction_history: str = "accumulated"
    segments: int | None = None
    start: int = 0

    @property
    def name(self) -> str:
        """What differs from the paper's case."""
        base = asdict(Case())
        changes = [f"{k} {v}" for k, v in asdict(self).items() if v != base[k]]
        return ", ".join(changes) or "paper"

    def model(self, **more) -> SealModel:
        """The seal model of the case."""
        options = {k: v for k, v in asdict(self).items() if k not in ("parameters", "start")}
        if self.parameters == 10:
            options |= {"symmetric": True, "outer_parameters": 5, "inner_parameters": 4}
        return sm.door_seal(**options, **more)

    def design(self, model: SealModel) -> tuple[np.ndarray, float]:
        """Offsets and door radius of the start."""
        if self.start == 0:
            return np.zeros(model.n_offsets), model.drawn_door_radius
        size = START_SIZE
        change = np.random.default_rng(self.start).uniform(-size, size, model.n_offsets + 1)
        return change[:-1], model.drawn_door_radius + change[-1]


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
