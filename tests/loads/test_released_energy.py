"""Energy balance of the increments: work of the loading, stored energy, friction."""

from dataclasses import replace

import numpy as np
import pytest
from air_ring import air_ring
from energy_bounds import energy_bounds

import seal_mdao as sm
from seal_mdao.loads.dead_load import DeadLoad


def loaded_ring(finer):
    """A sealed ring under a plate without friction that presses and shears it, and a growing load."""
    seal = air_ring(friction=0.0, finer=finer)
    n = seal.n_steps
    load = DeadLoad(
        "load", seal.body.edge_points("outer"), np.array([0.5, -0.8]), np.linspace(0.0, 1.0, n + 1)
    )
    return replace(seal, definitions=(*seal.definitions, load))


def test_bounds_of_all_terms_tend_to_zero_with_the_steps():
    """Any term that gave a wrong work or energy would leave its part of it."""
    sums, works = [], []
    for finer in (4, 8, 16):
        released, _, work = energy_bounds(sm.analyze(loaded_ring(finer)).path).T
        assert released.max() <= 1e-3 * work.max()
        sums.append(released.sum())
        works.append(work.sum())
    assert works[1] == pytest.approx(works[0], rel=0.1)
    assert sums[0] < 0.0
    assert sums[1] / sums[0] == pytest.approx(0.5, abs=0.1)
    assert sums[2] / sums[1] == pytest.approx(0.5, abs=0.05)
    assert abs(sums[2]) < 0.05 * works[2]
