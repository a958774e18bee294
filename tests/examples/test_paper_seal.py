"""The paper's seal out of its file is the door seal."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from verification.flat_door_reference import REACTION

import seal_mdao as sm
from seal_mdao.measures.gap import GapSquareIntegral
from seal_mdao.seals.result import frozen_measures

FILE = Path(__file__).parents[2] / "examples" / "paper_seal.toml"
# the particles of both differ in the last digit, of which tangents of condition 2e5 pass on as much
ROUNDING = 2e5 * np.finfo(float).eps


@pytest.fixture(scope="module")
def both():
    seal, door = sm.build_seal(sm.read_seal_file(FILE)), sm.door_seal()
    return sm.analyze(seal, keep_factors=True), sm.analyze(door, keep_factors=True)


def test_the_cloud_is_that_of_the_door_seal(both):
    seal, door = (result.seal for result in both)
    assert np.abs(seal.nominal_particles - door.nominal_particles).max() < 1e-14
    assert np.array_equal(seal.body.cells, door.body.cells)
    assert np.array_equal(seal.body.fixed, door.body.fixed)
    assert np.abs(seal.body.support_radius - door.body.support_radius).max() < 1e-14
    assert not seal.body.hidden_pairs.size


def test_offsets_are_those_of_the_door_seal(both):
    """The hole is walked clockwise with the material on the left: outward is towards the centre."""
    seal, door = (result.seal for result in both)
    order = np.r_[0:14, 14, 24:14:-1]
    sign = np.r_[np.ones(14), -np.ones(11)]
    own = sign[:, None, None] * seal.design_velocity[order]
    assert np.abs(own - door.design_velocity).max() < 1e-13
    measures = frozen_measures(door, ("reaction", GapSquareIntegral("door")))
    exact, found = (sm.differentiate(result, (), measures, "adjoint") for result in both[::-1])
    for name in ("reaction", "gap_square_integral"):
        rows = np.atleast_2d(exact[name])[-1, :25]
        mine = np.atleast_2d(found[name])[-1, :25][order] * sign
        assert np.abs(mine - rows).max() < 1e-10 * np.abs(rows).max(), name


def test_the_path_is_that_of_the_door_seal(both):
    seal, door = both
    assert np.array_equal(seal.newton_iterations, door.newton_iterations)
    for step in range(105):
        assert np.abs(seal.displacement(step) - door.displacement(step)).max() < ROUNDING * 10.0
    for result_of in (lambda r: r.response("door").total, lambda r: r.response("door").gap):
        mine, known = result_of(seal), result_of(door)
        assert np.abs(mine - known).max() < ROUNDING * np.abs(known).max()


@pytest.mark.parametrize(
    ("spacing", "limit"), [(0.9, 0.03), pytest.param(0.45, 0.01, marks=pytest.mark.long)]
)
def test_other_particles_under_a_flat_door(spacing, limit):
    """With a spacing in place of rays: the independent finite elements at 2, 4, 6, 8 and 10 mm."""
    pytest.importorskip("netgen")
    file = sm.read_seal_file(FILE)
    flat = replace(file.profiles[0], segment=None, line=((-40.0, 0.0), (40.0, 0.0)))
    section = replace(file.section, spacing=spacing)
    result = sm.analyze(
        sm.build_seal(replace(file, section=section, profiles=(flat,), measures=(), optimize=None))
    )
    travel = 0.1 * np.arange(1, 106) - 0.5
    at = np.abs(travel - REACTION[:, :1]).argmin(axis=1)
    reaction = result.path.reaction("door")[at, 1]
    assert np.abs(reaction / REACTION[:, 1] - 1.0).max() < limit
