"""Time and memory of an analysis, estimated before any of it is spent.

What grows fastest is the number of particles n_c that a background cell sees: the tangent of a cell has
(2 n_c)^2 entries. The constants were fitted to seals of 174 to 2088 particles with 16 to 87 of them a
cell; they are good to a factor of two or so.
"""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.analysis.body import Body
from seal_mdao.errors import TooLargeError

ITERATIONS = 3
"""Newton iterations a load step."""
ENTRY_SECONDS, PARTICLE_SECONDS = 5e-9, 3e-5
"""Of an iteration: for each quadrature point and pair of particles that a cell sees; for a particle."""
ENTRY_BYTES, VALUE_BYTES, PARTICLE_BYTES, STEP_BYTES = 35, 96, 30_000, 60
"""For each pair of particles a cell; quadrature point and particle a cell; particle; particle a step."""


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


_SEEN = WeakKeyDictionary()


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
    pairs, n, q = _cells_in_sight(body, particles), body.n_particles, body.n_gauss**2
    entries = pairs * pairs / len(body.cells)
    iteration = ENTRY_SECONDS * q * entries + PARTICLE_SECONDS * n
    memory = ENTRY_BYTES * entries + VALUE_BYTES * q * pairs + (
        PARTICLE_BYTES + STEP_BYTES * n_steps
    ) * n  # fmt: skip
    return Cost(ITERATIONS * n_steps * iteration, memory / 2**30)


def machine_memory() -> float:
    """Memory of this machine, GiB."""
    import psutil  # here, for it takes longer to import than to ask

    return psutil.virtual_memory().total / 2**30


def require_room(cost: Cost, body: Body, n_steps: int) -> None:
    """Refuse what does not fit into the machine.

    Raises
    ------
    TooLargeError
        With both numbers.
    """
    there = machine_memory()
    if cost.memory > there:
        raise TooLargeError(
            f"the analysis of {body.n_particles} particles in {n_steps} load steps would take about "
            f"{cost.memory:.3g} GiB, and this machine has {there:.3g} GiB; use fewer particles (rays, "
            "layers), Gauss points (n_gauss) or load steps (n_steps), or a smaller support"
        )
