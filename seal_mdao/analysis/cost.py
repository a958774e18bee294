"""Estimate time and memory of an analysis before it starts.

The number of particles n_c in the supports of a background cell matters most: the tangent of a cell
has (2 n_c)^2 entries. With n particles, m cells and q quadrature points in each, a load step takes

- q m n_c^2 times ``ENTRY_SECONDS``: assembly of the tangent, some 30 operations an entry,
- n times ``PARTICLE_SECONDS``: forces, histories and all other work once a particle,
- (n n_c)^1.5 times ``FACTOR_SECONDS``: factorisation by nested dissection, whose largest front has
  about sqrt(n n_c) unknowns, some 40 operations each,

and the shape functions before the first one take m n_c times ``PAIR_SECONDS``. The constants were fitted
to seals of 174 to 12 180 particles with 15 to 49 of them a cell and 4 or 16 quadrature points, on a core
of some 3e9 operations a second; they are accurate to a factor of two or three. Contact of the section
with itself couples walls, and its steps take ``SELF_CONTACT`` times as long. Cut steps and damped motion
are not included.
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
"""Seconds for each unit of work of a load step, as above."""
PAIR_SECONDS = 2.5e-5
"""Seconds for the shape functions of a pair (cell, particle)."""
SELF_CONTACT = 3.0
"""Factor on the time of a load step with self-contact."""
ENTRY_BYTES, VALUE_BYTES, PARTICLE_BYTES, STEP_BYTES = 35, 96, 30_000, 60
"""Bytes for each: pair of particles in a cell; quadrature point, or pair of area rows, and particle in a
cell; particle; particle and step."""
LONG = 60.0
"""Seconds above which an analysis is announced."""
MOST_HOURS = 24.0
"""Estimated hours above which an analysis is refused; environment variable ``HOURS`` changes it."""
HOURS = "SEAL_MDAO_MAX_HOURS"


@dataclass(frozen=True)
class Cost:
    """Estimated time and memory of an analysis.

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


UNITS = (
    ("years", 365.25 * 86_400.0), ("days", 86_400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0),
)  # fmt: skip
"""Units of time and their sizes, s."""
ROUND = 8e-4
"""Relative difference up to which a time is a number with two digits."""


def duration(seconds: float) -> str:
    """Format seconds with three digits in a readable unit, or in the next smaller unit if the
    number is round only there: 1000 h, not 41.7 days."""
    if seconds < 120.0:
        return f"{seconds:.0f} s" if seconds >= 10.0 else f"{seconds:.2g} s"
    fitting = [(unit, seconds / size) for unit, size in UNITS if seconds >= 2.0 * size]
    for unit, value in fitting[:2]:
        # a number of two digits within ROUND
        short = float(f"{value:.2g}")
        if math.isclose(short, value, rel_tol=ROUND):
            return f"{short:g} {unit}"
    unit, value = fitting[0]
    return f"{value:.3g} {unit}"


_SEEN = WeakKeyDictionary()
_ANNOUNCED = WeakKeyDictionary()


def _cells_in_sight(body: Body, particles: np.ndarray) -> int:
    """Estimate the number of pairs (cell, particle in its support), m n_c; cached for each body."""
    if body not in _SEEN:
        corners = particles[body.cells]
        # a particle counts for the cells with centres within its support radius and half the
        # half-diagonal of the largest cell, where some of their quadrature points lie
        middle = corners.mean(axis=1)
        half = np.linalg.norm(corners - middle[:, None], axis=2).max()
        reach = body.support_radius + 0.5 * half
        counts = cKDTree(middle).query_ball_point(particles, reach, return_length=True)
        _SEEN[body] = int(counts.sum())
    return _SEEN[body]


def analysis_cost(
    body: Body, particles: np.ndarray, n_steps: int, self_contact: bool = False
) -> Cost:
    """Estimate time and memory of ``n_steps`` load steps of a body, with self-contact or without."""
    pairs, n, q = _cells_in_sight(body, particles), body.n_particles, body.cell_map.n_points
    # sight = n_c, pairs = m n_c, entries = m n_c^2
    sight = pairs / len(body.cells)
    entries = pairs * sight
    step = ENTRY_SECONDS * q * entries + PARTICLE_SECONDS * n + FACTOR_SECONDS * (n * sight) ** 1.5
    step *= SELF_CONTACT if self_contact else 1.0
    # slots and values of the cells' tangents; shape functions and gradients; data by particle
    points = body.pressure.functions.shape[1] / body.pressure.cells
    memory = ENTRY_BYTES * entries + VALUE_BYTES * points * pairs + (
        PARTICLE_BYTES + STEP_BYTES * n_steps
    ) * n  # fmt: skip
    return Cost(PAIR_SECONDS * pairs + n_steps * step, memory / 2**30)


def machine_memory() -> float:
    """Return the memory of this machine, GiB."""
    import psutil  # here, for it takes longer to import than to ask

    return psutil.virtual_memory().total / 2**30


def most_hours() -> float:
    """Return the largest estimated time of an analysis that is allowed, hours.

    Raises
    ------
    ValueError
        For an environment variable that is not a positive number.
    """
    given = os.environ.get(HOURS, "")
    try:
        hours = float(given or MOST_HOURS)
    except ValueError:
        hours = math.nan
    return values.real(
        f"the environment variable {HOURS}", given if math.isnan(hours) else hours, above=0.0
    )


def require_means(cost: Cost, body: Body, n_steps: int) -> None:
    """Raise TooLargeError for an analysis that exceeds the memory of the machine or the allowed
    hours.

    Raises
    ------
    TooLargeError
        With estimate, limit and what to change.
    """
    there, hours = machine_memory(), most_hours()
    what = f"the analysis of {body.n_particles} particles in {n_steps} load steps needs about"
    fewer = (
        "use a larger particle spacing (spacing, or fewer rays and layers) or fewer load steps "
        "(steps, n_steps)"
    )
    if cost.memory > there:
        raise TooLargeError(
            f"{what} {cost.memory:.3g} GiB, and this machine has {there:.3g} GiB; {fewer}, or in "
            "Python a smaller kernel support (support)"
        )
    if cost.seconds > 3600.0 * hours:
        raise TooLargeError(
            f"{what} {duration(cost.seconds)}, more than the limit of {hours:g} h; {fewer}, in "
            "Python a smaller kernel support (support), or raise the limit with the environment "
            f"variable {HOURS} (hours)"
        )


def announce(cost: Cost, body: Body, n_steps: int, least: float = LONG) -> None:
    """Print one line before an analysis of at least ``least`` seconds, once for each body and number
    of steps."""
    if cost.seconds < least or n_steps in _ANNOUNCED.setdefault(body, set()):
        return
    _ANNOUNCED[body].add(n_steps)
    print(
        f"seal_mdao: an analysis of {body.n_particles} particles in {n_steps} load steps will take "
        f"about {cost}; Ctrl-C ends it",
        file=sys.stderr, flush=True,
    )  # fmt: skip
