"""The largest stress away from the ends of fixed edges: which points take part, and derivatives."""

from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.measures.singular_points import (
    FIXED_END,
    REENTRANT_CORNER,
    away_from_singular,
    singular_points,
)
from seal_mdao.measures.stress import LargestVonMises
from seal_mdao.structure.elastic_body import elastic_body

BULB = (Path(__file__).parents[1] / "seal_file" / "bulb.toml").read_text()
for old, new in (
    ("spacing = 0.9", "spacing = 1.6"), ("[0.0, -6.0]", "[0.0, -2.2]"), ("steps = 60", "steps = 8"),
    ("[2.0, 0.0]", "[0.3, 0.0]"), ("steps = 20", "steps = 2"), ("parameters = 12", "parameters = 4"),
):  # fmt: skip
    assert old in BULB
    BULB = BULB.replace(old, new)
DISTANCE = 1.5
MEASURES = """
[[measure]]
type = "von_mises"
[[measure]]
type = "von_mises"
name = "elsewhere"
away_from_singular = 1.5
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("bulb") / "bulb.toml"
    path.write_text(BULB + MEASURES)
    found = sm.analyze(sm.build_seal(path), keep_factors=True)
    found.require_converged()
    return found


def value(result, name):
    (measure,) = (own for own in result.seal.standard if own.name == name)
    return result.value(measure)[0]


def test_singular_points_of_a_fixed_corner():
    """Of an L-shaped section whose re-entrant corner lies in the middle of a fixed edge only the ends of
    this edge, else the corner itself."""
    numbers = np.arange(9).reshape(3, 3)
    x = np.column_stack([np.tile(np.arange(3.0), 3), np.repeat(np.arange(3.0), 3)])
    corners = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]
    cells = np.column_stack([own.ravel() for own in corners])[:3]
    fixed = np.zeros((9, 2), bool)
    body = Body(cells, np.full(9, 2.0), fixed, {})
    (point,) = singular_points(body, x, elastic_body(sm.NeoHookean(100.0, 1e4)))
    assert (point.kind, *point.place) == (REENTRANT_CORNER, 1.0, 1.0)
    fixed[[5, 4, 7]] = True
    body = Body(cells, np.full(9, 2.0), fixed, {})
    found = singular_points(body, x, elastic_body(sm.NeoHookean(100.0, 1e4)))
    assert [(own.kind, *own.place) for own in found] == [
        (FIXED_END, 2.0, 1.0), (FIXED_END, 1.0, 2.0)
    ]  # fmt: skip


def half_block(top: float, base):
    """The right half of a block of 4 mm by 2 mm with a plane of symmetry at x = 0, whose particle on the
    top is at the height ``top``, and a base of which the components ``base`` are fixed."""
    numbers = np.arange(9).reshape(3, 3)
    x = np.column_stack([np.tile(np.arange(3.0), 3), np.repeat(np.arange(3.0), 3)])
    x[3, 1], x[6, 1] = 0.5 * top, top
    corners = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]
    fixed = np.zeros((9, 2), bool)
    fixed[::3, 0] = True
    fixed[np.ix_(range(3), base)] = True
    cells = np.column_stack([own.ravel() for own in corners])
    return Body(cells, np.full(9, 2.0), fixed, {}), x


@pytest.mark.parametrize(
    ("top", "base", "points"),
    [
        (2.0, [1], []),
        (2.0, [0, 1], [(FIXED_END, 2.0, 0.0)]),
        (0.8, [1], [(REENTRANT_CORNER, 0.0, 0.8)]),
        (1.8, [1], []),
    ],
)
def test_singular_points_of_a_half_are_those_of_the_whole(top, base, points):
    """A fixed edge does not end in a plane of symmetry, where its mirror image continues it, and a notch
    may have its corner there."""
    found = singular_points(*half_block(top, base), elastic_body(sm.NeoHookean(100.0, 1e4)))
    assert [(own.kind, *own.place) for own in found] == points


DISC = """\
[model]
kinematics = "axisymmetric"
[material.rubber]
law = "neo_hookean"
c10 = 400.0
bulk_modulus = 8e4
[section]
spacing = 0.4
outer = [
  { edge = "base", line = [[0.0, 0.0], [3.0, 0.0]] },
  { edge = "side", line = [[3.0, 0.0], [3.0, 2.0]] },
  { edge = "top", line = [[3.0, 2.0], [0.0, 2.0]] },
  { edge = "axis", line = [[0.0, 2.0], [0.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[moved]]
edges = ["top"]
stage = [{ translate = [0.0, -0.1], steps = 1 }]
"""


def test_the_stress_of_a_bonded_disc_is_finite_on_its_axis(tmp_path):
    path = tmp_path / "disc.toml"
    path.write_text(DISC)
    seal = sm.build_seal(path)
    found = singular_points(seal.body, seal.nominal_particles, seal.definitions[0])
    assert sorted(tuple(own.place) for own in found) == [(3.0, 0.0), (3.0, 2.0)]


@pytest.mark.parametrize("excess", [0.05, 0.01])
@pytest.mark.parametrize("count", [10, 500, 20000])
def test_the_order_of_the_norm_is_the_smallest_within_the_excess(count, excess):
    """Of equal stresses at all points the norm is n^(1/p) times as large."""
    order = LargestVonMises(excess=excess).order(count)
    assert count ** (1.0 / order) <= 1.0 + excess < count ** (1.0 / (order - 1))


def test_only_stress_away_from_the_ends_of_the_base_counts(result):
    """The corners of the base are at x = -4 and 4 mm, y = 0."""
    places, stress = result.section_stress()
    away = np.hypot(np.abs(places[:, 0]) - 4.0, places[:, 1])
    assert stress[away <= DISTANCE].max() > 1.1 * stress[away > DISTANCE].max()
    largest = stress[away > DISTANCE].max()
    assert largest <= value(result, "elsewhere") <= 1.05 * largest
    assert value(result, "von_mises") >= stress.max()
    (measure,) = (own for own in result.seal.standard if own.name == "elsewhere")
    assert measure.points(result.seal).tolist() == np.flatnonzero(away > DISTANCE).tolist()


def test_the_points_are_those_of_the_nominal_section(result):
    """A design moves particles, and the same take part."""
    seal = result.seal
    offsets = np.full(seal.n_offsets, 0.3)
    moved = sm.analyze(seal, offsets)
    assert np.abs(moved.particles - result.particles).max() > 0.1
    (measure,) = (own for own in seal.standard if own.name == "elsewhere")
    assert (measure.points(moved.seal) == measure.points(seal)).all()


def test_derivatives(result):
    """Direct and adjoint, and central differences whose step is varied."""
    seal = result.seal
    direct = sm.differentiate(result, ("c10",), method="direct")["elsewhere"]
    adjoint = sm.differentiate(result, ("c10",), method="adjoint")["elsewhere"]
    np.testing.assert_allclose(direct, adjoint, rtol=0.0, atol=1e-9 * np.abs(direct).max())
    direction = np.linspace(1.0, -0.5, seal.n_offsets)
    exact = direct[0, : seal.n_offsets] @ direction
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        ends = [value(sm.analyze(seal, way * step * direction), "elsewhere") for way in (1.0, -1.0)]
        errors.append(abs((ends[0] - ends[1]) / (2.0 * step) - exact) / abs(exact))
    # the error falls with the square of the step
    assert errors[-1] < 1e-5
    assert errors[-1] < 0.5 * errors[0]


def test_a_distance_that_leaves_nothing_is_refused(result, tmp_path):
    with pytest.raises(ValueError, match="the farthest one is 1"):
        away_from_singular(result.seal, 50.0)
    path = tmp_path / "bulb.toml"
    path.write_text(BULB + MEASURES.replace("1.5", "50.0"))
    with pytest.raises(sm.SealFileError, match=r"\('elsewhere'\): no point of the section is"):
        sm.build_seal(path)


def test_wrong_distance():
    with pytest.raises(ValueError, match="away_from_singular of 'largest_von_mises' must be"):
        LargestVonMises(away_from_singular=-1.0)
