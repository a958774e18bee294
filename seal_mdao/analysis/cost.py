"""Time and memory of an analysis, estimated before any of it is spent.

What grows fastest is the number of particles n_c that a background cell sees: the tangent of a cell has
(2 n_c)^2 entries. With n particles, m cells and q quadrature points in each, a load step takes

- q m n_c^2 times ``ENTRY_SECONDS``: assembly of the tangent, some 30 operations an entry,
- n times ``PARTICLE_SECONDS``: forces, histories and everything else that is done once a particle,
- (n n_c)^1.5 times ``FACTOR_SECONDS``: factorisation by nested dissection, whose largest front has
  about sqrt(n n_c) unknowns, some 40 operations each,

and the shape functions before the first one take m n_c times ``PAIR_SECONDS``. The constants were fitted
to seals of 174 to 12 180 particles with 15 to 49 of them a cell and 4 or 16 quadrature points, on a core
that does some 3e9 of these operations a second; they are good to a factor of two or three. Cut steps and
damped motion come on top.
"""

import math
import os
import sys
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao import values
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.errors import TooLargeError

ENTRY_SECONDS, PARTICLE_SECONDS, FACTOR_SECONDS = 5e-9, 1.5e-5, 1.3e-8
"""Of a load step, as above."""
PAIR_SECONDS = 2.5e-5
"""Of the shape functions."""
ENTRY_BYTES, VALUE_BYTES, PARTICLE_BYTES, STEP_BYTES = 35, 96, 30_000, 60
"""For each pair of particles a cell; quadrature point and particle a cell; particle; particle a step."""
LONG = 60.0
"""Seconds from which on an analysis is announced."""
MOST_HOURS = 24.0
"""Estimated hours from which on an analysis is refused; ``HOURS`` in the environment changes it."""
HOURS = "SEAL_MDAO_MAX_HOURS"


@dataclass(frozen=True)
class Cost:
    """What an analysis takes.

    Attributes
    ----------
    seconds : float
    memory : float
        GiB.
    """

    seconds: float
    memory: float

    def __str__(self) -> str:
        return f"{duration(self.seconds)} and {self.memory:.2g} GiB"


def duration(seconds: float) -> str:
    """Seconds in the unit in which they are read."""
    for unit, size in (("days", 86_400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.0f} s"


_SEEN = WeakKeyDictionary()
_ANNOUNCED = WeakKeyDictionary()


def _cells_in_sight(body: Body, particles: np.ndarray) -> int:
    """How many particles all cells see together, by their middles."""
    if body not in _SEEN:
        corners = particles[body.cells]
        middle = corners.mean(axis=1)
        half = np.linalg.norm(corners - middle[:, None], axis=2).max()
        reach = body.support_radius + 0.5 * half
        counts = cKDTree(middle).query_ball_point(particles, reach, return_length=True)
        _SEEN[body] = int(counts.sum())
    return _SEEN[body]


def analysis_cost(body: Body, particles: np.ndarray, n_steps: int) -> Cost:
    """Time and memory of ``n_steps`` load steps of a body."""
    pairs, n, q = _cells_in_sight(body, particles), body.n_particles, body.cell_map.n_points
    sight = pairs / len(body.cells)
    entries = pairs * sight
    step = ENTRY_SECONDS * q * entries + PARTICLE_SECONDS * n + FACTOR_SECONDS * (n * sight) ** 1.5
    memory = ENTRY_BYTES * entries + VALUE_BYTES * q * pairs + (
        PARTICLE_BYTES + STEP_BYTES * n_steps
    ) * n  # fmt: skip
    return Cost(PAIR_SECONDS * pairs + n_steps * step, memory / 2**30)


def machine_memory() -> float:
    """Memory of this machine, GiB."""
    import psutil  # here, for it takes longer to import than to ask

    return psutil.virtual_memory().total / 2**30


def most_hours() -> float:
    """Hours that an analysis may take by its estimate.

    Raises
    ------
    ValueError
        When the environment has something else than a number.
    """
    given = os.environ.get(HOURS, "")
    try:
        hours = float(given or MOST_HOURS)
    except ValueError:
        hours = math.nan
    return values.real(
        f"{HOURS} in the environment", given if math.isnan(hours) else hours, above=0.0
    )


def require_means(cost: Cost, body: Body, n_steps: int) -> None:
    """Refuse what does not fit into the machine, or takes longer than anybody waits.

    Raises
    ------
    TooLargeError
        With both numbers, and what to do.
    """
    there, hours = machine_memory(), most_hours()
    what = f"the analysis of {body.n_particles} particles in {n_steps} load steps would take about"
    fewer = "use fewer particles (rays, layers), Gauss points (n_gauss) or load steps (n_steps)"
    if cost.memory > there:
        raise TooLargeError(
            f"{what} {cost.memory:.3g} GiB, and this machine has {there:.3g} GiB; {fewer}, or a smaller "
            "support"
        )
    if cost.seconds > 3600.0 * hours:
        raise TooLargeError(
            f"{what} {duration(cost.seconds)}, and more than {hours:g} h are refused; {fewer}, a "
            f"smaller support, or set {HOURS} in the environment where that is meant"
        )


def announce(cost: Cost, body: Body, n_steps: int, least: float = LONG) -> None:
    """Write one line before an analysis of at least ``least`` seconds, once for a body and its steps."""
    if cost.seconds < least or n_steps in _ANNOUNCED.setdefault(body, set()):
        return
    _ANNOUNCED[body].add(n_steps)
    print(
        f"seal_mdao: an analysis of {body.n_particles} particles in {n_steps} load steps will take "
        f"about {cost}; Ctrl-C ends it",
        file=sys.stderr, flush=True,
    )  # fmt: skip
