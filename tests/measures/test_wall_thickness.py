"""Smallest wall thickness: rings, sections of files, derivatives, limits."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.cli.examples import examples_folder
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.measures.wall_thickness import WallThickness
from seal_mdao.seals.file.build import unchosen_seal

BULB = (Path(__file__).parents[1] / "seal_file" / "bulb.toml").read_text()
WEIGHTS = np.array([1, -8, 8, -1]) / 12.0


class Ring:
    """A ring of straight sides, its hole off the centre of its outside."""

    def __init__(self, count, inner=4.0, outer=6.0, shift=(0.0, 0.0), turn=0.0):
        at = np.arange(2 * count).reshape(2, count)
        angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
        unit = [np.column_stack([np.cos(a), np.sin(a)]) for a in (angle, angle + turn)]
        self.particles = np.concatenate([inner * unit[0] + shift, outer * unit[1]])
        following = np.roll(at, -1, axis=1)
        cells = np.column_stack([at[0], at[1], following[1], following[0]])
        edges = {"outside": Edge(at[1], True), "hole": Edge(at[0, ::-1], True)}
        fixed = np.zeros((2 * count, 2), bool)
        fixed[0] = True
        self.body = Body(
            cells, np.full(2 * count, 3.0), fixed, edges, nominal=self.particles
        )  # fmt: skip

    @property
    def result(self):
        return SimpleNamespace(particles=self.particles, seal=SimpleNamespace(body=self.body))


def evaluated(measure, ring):
    """Value, and derivatives in the particles (n, 2)."""
    partials = SimpleNamespace(particles=np.zeros((1, *ring.particles.shape)))
    return measure.evaluate(ring.result, partials), partials.particles[0]


@pytest.mark.parametrize("deficit", [0.1, 0.02, 0.002])
@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_rings_of_straight_sides_are_exact_and_the_bound_is_below(shift, deficit):
    """A corner of the hole is (R - r) cos(pi / n) from the sides beside its ray; with the hole nearer to
    a corner of the outside it is on its ray, (R - r - e) cos(pi / n)."""
    count, measure = 40, WallThickness(deficit=deficit)
    ring = Ring(count, shift=(shift, 0.0))
    least = measure.distances(ring.body, ring.particles).size.min()
    assert least == pytest.approx((2.0 - shift) * np.cos(np.pi / count), rel=1e-13)
    value, _ = evaluated(measure, ring)
    assert (1.0 - deficit) * least <= value < least
    # equal distances have the largest deficit, and a lower order exceeds its bound
    equal = measure._smooth_minimum(np.ones(1000))[0]
    order = -np.log(1000.0) / np.log(equal)
    assert 1.0 - deficit <= equal
    assert 1000.0 ** (-1.0 / (order - 1.0)) < 1.0 - deficit
    # all round the same, many pairs are near to the smallest: much of the deficit is used
    assert shift or value < least * (1.0 - 0.5 * deficit)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, 0.4)])
def test_rings_converge_to_round_ones(shift):
    """R - r - e, with order two in the length of the sides."""
    measure, exact = WallThickness(), 2.0 - np.hypot(*shift)
    errors = [
        abs(measure.distances(ring.body, ring.particles).size.min() - exact)
        for ring in (Ring(count, shift=shift, turn=0.3 / count) for count in (40, 80, 160, 320))
    ]
    assert errors[-1] < 2e-4
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.abs(np.mean(orders) - 2.0) < 0.3


def test_the_place_is_in_the_middle_of_the_thinnest_wall():
    ring = Ring(60, shift=(0.0, 0.5))
    x, y = WallThickness().place(ring.result)
    # to one side, and to the sagitta of its chord
    side = 2.0 * np.pi * 6.0 / 60
    assert abs(x) < side
    assert y == pytest.approx(5.25, abs=0.5 * side**2 / 5.25)


@pytest.mark.parametrize("turn", [0.0, 0.04])
def test_derivatives_in_the_particles_against_central_differences(turn, rng):
    """With rays that agree, where points are as far from two sides, and with others."""
    ring, measure, h = Ring(40, turn=turn, shift=(0.1, 0.2)), WallThickness(), 1e-5
    way, start = rng.standard_normal(ring.particles.shape), ring.particles
    _, exact = evaluated(measure, ring)

    def moved(size):
        ring.particles = start + size * h * way
        return evaluated(measure, ring)[0]

    quotient = WEIGHTS @ [moved(s) for s in (-2, -1, 1, 2)] / h
    assert quotient == pytest.approx(np.sum(exact * way), rel=1e-7)
    # rigid motions change nothing; growth changes it by itself
    ring.particles = start
    value, _ = evaluated(measure, ring)
    np.testing.assert_allclose(exact.sum(axis=0), 0.0, atol=1e-12)
    assert np.sum(exact * start) == pytest.approx(value, rel=1e-12)


def test_a_hole_that_moves_thins_the_wall_by_as_much():
    ring = Ring(80, shift=(0.5, 0.0))
    _, exact = evaluated(WallThickness(deficit=0.005), ring)
    assert exact[:80].sum(axis=0) == pytest.approx([-1.0, 0.0], abs=0.02)


# ---- sections of files ----


def seal_of(folder, measure, text=BULB):
    path = folder / "seal.toml"
    for old, new in (("spacing = 0.9", "spacing = 1.6"), ("[0.0, -6.0]", "[0.0, -0.6]"),
                     ("steps = 60", "steps = 2"), ("[2.0, 0.0]", "[0.1, 0.0]"),
                     ("steps = 20", "steps = 1"), ("parameters = 12", "parameters = 5")):  # fmt: skip
        assert old in text
        text = text.replace(old, new)
    path.write_text(text.replace('type = "contact_width"\nprofile = "door"', measure))
    return sm.build_seal(path)


@pytest.fixture(scope="module")
def bulb(tmp_path_factory):
    return seal_of(tmp_path_factory.mktemp("wall"), 'type = "wall_thickness"')


def test_derivatives_in_the_design_and_by_both_methods(bulb, rng):
    """Of the bulb of a file; a step study: a quotient of second order has the error h^2."""
    offsets = rng.uniform(-0.1, 0.1, bulb.n_offsets)
    measure = bulb.standard[0]

    def at(offsets):
        return evaluated(measure, SimpleNamespace(
            particles=bulb.particles(offsets),
            result=SimpleNamespace(particles=bulb.particles(offsets), seal=bulb),
        ))  # fmt: skip

    _, by_particles = at(offsets)
    exact = np.tensordot(bulb.design_velocity, by_particles, 2)
    way = rng.standard_normal(bulb.n_offsets)
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        quotient = (at(offsets + h * way)[0] - at(offsets - h * way)[0]) / (2.0 * h)
        errors.append(abs(quotient / (exact @ way) - 1.0))
    assert errors[0] > errors[1] > errors[2]
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)
    h = 1e-4
    quotient = WEIGHTS @ [at(offsets + s * h * way)[0] for s in (-2, -1, 1, 2)] / h
    assert quotient == pytest.approx(exact @ way, rel=1e-6)
    result = sm.analyze(bulb, offsets, keep_factors=True)
    for method in ("direct", "adjoint"):
        found = sm.differentiate(result, tuple(bulb.scalars), [measure], method=method)
        np.testing.assert_allclose(found["wall_thickness"][0, : bulb.n_offsets], exact, rtol=1e-9)
        assert not found["wall_thickness"][0, bulb.n_offsets :].any()


def test_the_wall_of_the_bulb_is_found(bulb):
    """From y = 11.5 to 14: 2.5 mm at the top, 2.5 mm at the foot, and less where it is round."""
    measure, particles = bulb.standard[0], bulb.nominal_particles
    value, _ = evaluated(
        measure, SimpleNamespace(particles=particles, result=SimpleNamespace(
            particles=particles, seal=bulb))
    )  # fmt: skip
    assert 0.98 * 2.5 * 0.99 < value < 2.5


def test_named_edges_leave_out_the_others(tmp_path):
    """The foot of the bulb, from the base to the hole: 2.5 mm; the door's side may be thinner."""
    text = BULB.replace("[0.0, 7.0], radius", "[0.0, 7.6], radius")
    named = 'type = "wall_thickness"\nedges = ["base"]\nopposite = ["cavity"]\ndeficit = 0.01'
    values = []
    for measure in ('type = "wall_thickness"', named):
        seal = seal_of(tmp_path, measure, text)
        x = seal.nominal_particles
        values.append(evaluated(seal.standard[0], SimpleNamespace(
            particles=x, result=SimpleNamespace(particles=x, seal=seal)))[0])  # fmt: skip
    assert values[0] < 1.9 + 0.01
    assert values[1] == pytest.approx(3.1, rel=0.011)


BLOCK = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 0.5
outer = [
  { edge = "foot", line = [[-5.0, 0.0], [5.0, 0.0]] },
  { edge = "right", line = [[5.0, 0.0], [5.0, 2.0]] },
  { edge = "top", arc = { start = [5.0, 2.0], through = [0.0, 4.0], end = [-5.0, 2.0] } },
  { edge = "left", line = [[-5.0, 2.0], [-5.0, 0.0]] },
]
[fixed]
edges = ["foot"]
[[profile]]
name = "door"
friction = 0.2
contact = ["right", "top", "left"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 4.0]
stage = [{ translate = [0.0, -0.6], steps = 3 }]
[[measure]]
type = "wall_thickness"
edges = ["top"]
opposite = ["foot"]
"""


def test_two_bodies_have_no_wall_between_them():
    """Groups of particles that no cell joins are not two sides of one wall."""
    one, shift = Ring(20), np.array([20.0, 0.0])
    other = one.particles + shift
    edges = one.body.edges | {
        f"other_{name}": Edge(edge.particles + 40, True) for name, edge in one.body.edges.items()
    }
    ring = Ring(20)
    ring.particles = np.concatenate([one.particles, other - [7.5, 0.0]])
    ring.body = Body(
        np.concatenate([one.body.cells, one.body.cells + 40]), np.full(80, 3.0),
        np.ones((80, 2), bool), edges, nominal=ring.particles,
    )  # fmt: skip
    # the bodies are 0.5 mm apart, their walls 2 mm
    found = WallThickness().distances(ring.body, ring.particles)
    assert found.size.min() == pytest.approx(2.0 * np.cos(np.pi / 20), rel=1e-12)


def test_what_has_no_wall_is_refused():
    ring = Ring(20)
    with pytest.raises(ValueError, match="deficit of 'wall_thickness'"):
        WallThickness(deficit=1.0)
    with pytest.raises(ValueError, match="needs both edges and opposite, the two sides of a"):
        WallThickness(edges=("outside",))
    with pytest.raises(ValueError, match="outside and outside, share a point"):
        WallThickness(("outside",), ("outside",)).distances(ring.body, ring.particles)
    alone = Ring(20)
    alone.body = Body(
        ring.body.cells, np.full(40, 3.0), np.zeros((40, 2), bool),
        {"outside": ring.body.edges["outside"]}, nominal=ring.particles,
    )  # fmt: skip
    with pytest.raises(ValueError, match="the section has no hole"):
        WallThickness().distances(alone.body, alone.particles)


def test_the_example_with_a_least_wall_begins_where_it_decides():
    """The walls are thinner than the limit at first, and within the bounds of the design thicker."""
    file = sm.read_seal_file(examples_folder() / "vented_bulb.toml")
    (least,) = (own.lower for own in file.optimize.constraints if own.measure == "wall_thickness")
    seal = unchosen_seal(file)
    (measure,) = (own for own in seal.standard if own.name == "wall_thickness")
    sizes = []
    for outward in (0.0, 0.1):
        # the outside moves along its outward normal
        offsets = np.repeat([outward, 0.0], 8)
        found = measure.distances(seal.body, seal.particles(offsets))
        sizes.append(found.size.min())
    assert 0.97 * least < sizes[0] < 1.02 * least
    assert sizes[1] > least + 0.05


def test_a_wall_that_is_nearest_along_the_side_of_the_section(tmp_path):
    """The middle of the nearest line lies on a free edge, or outside of it by rounding."""
    path = tmp_path / "block.toml"
    path.write_text(BLOCK, encoding="utf-8")
    assert sm.read_seal_file(path).measures[0].opposite == ("foot",)
