"""Fluid pressure: forces, work, tangent, derivatives, and an O-ring that passes the pressure on."""

import numpy as np
import pytest
from fluid_seals import SHEAR_MODULUS, peak, quotient, ring, states, steps_of
from scipy.interpolate import lagrange

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.loads.fluid_pressure import FluidPressure
from seal_mdao.loads.pressed_sides import INNER, POINTS
from seal_mdao.measures.contact_pressure import PointPressures
from seal_mdao.seals.file.build import boundaries_of
from seal_mdao.seals.file.edge_tables import FluidTable
from seal_mdao.seals.outline.contours import Arc, Contour, Line, Outline
from seal_mdao.seals.outline.outline_seal import outline_seal

PRESSURE = 1000.0
NAMES = (
    "c10", "bulk_modulus", "lid_normal_penalty", "lid_tangent_penalty", "lid_friction", "squeeze",
    "wall_normal_penalty", "wall_tangent_penalty", "fluid_pressure",
)  # fmt: skip
"""Without the friction of the wall, on which all points stick."""


@pytest.fixture(scope="module")
def pressed():
    result = sm.analyze(ring(PRESSURE, squeeze=0.6, close=4, steps=4), keep_factors=True)
    assert result.converged, result.failure
    return result


@pytest.fixture(scope="module")
def tables(pressed):
    return [sm.differentiate(pressed, NAMES, method=method) for method in ("direct", "adjoint")]


@pytest.fixture(scope="module")
def everywhere():
    """The term without profiles: all of the edge is wetted."""
    outline = Outline(Contour((
        Arc((0.0, 0.0), 3.0, 0.0, 0.5 * np.pi, "seal"),
        Line((0.0, 3.0), (0.0, 0.0), "left"), Line((0.0, 0.0), (3.0, 0.0), "bottom"),
    )))  # fmt: skip
    fluid = FluidTable(edges=("seal",), end="end", pressure=6.0 * SHEAR_MODULUS, steps=4)
    seal = outline_seal(
        *boundaries_of(outline, 0.4), sm.MooneyRivlin(500.0, 125.0, 400_000.0), n_steps=4,
        supports={"left": (0,), "bottom": (1,)}, contributions=[fluid.on],
    )  # fmt: skip
    return seal, sm.analyze(seal)


def areas(x):
    """Of the polygon of the particles from the origin, with the segments between it and the cubics."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    at = np.array([0.0, INNER, 1.0 - INNER, 1.0])
    slopes = np.array([lagrange(at, own).deriv()(0.5 + 0.5 * nodes) for own in np.eye(4)])
    shapes = np.array([lagrange(at, own)(0.5 + 0.5 * nodes) for own in np.eye(4)])
    bulge = 0.0
    for first in range(0, len(x) - 1, 3):
        place, along = (own.T @ (x[first : first + 4] - x[first]) for own in (shapes, slopes))
        bulge += 0.25 * weights @ (place[:, 0] * along[:, 1] - place[:, 1] * along[:, 0])
    return polygon_area(np.vstack([[0.0, 0.0], x[::3]]))[0] + bulge


# ---- the load ----


def test_resultant_and_moment_are_those_of_a_pressure(everywhere, rng):
    """On any line between two points: p times the chord turned, and half of p times the difference of
    the squares of the distances."""
    _, result = everywhere
    term = result.term("fluid")
    x = term.reference + 0.1 * rng.standard_normal(term.reference.shape)
    force = term.respond(x, 4.0, None).force
    way, pressure = x[-1] - x[0], term.pressure
    # the line comes from the left of the body: its right is inside
    np.testing.assert_allclose(
        force.sum(axis=0), -pressure * np.array([way[1], -way[0]]), rtol=1e-12
    )
    moment = (x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]).sum()
    expected = 0.5 * pressure * (x[-1] @ x[-1] - x[0] @ x[0])
    assert moment == pytest.approx(expected, rel=1e-11)


def test_its_work_is_pressure_times_the_area_that_it_takes(everywhere, rng):
    """Between two states with the same ends. The forces are linear in the places: the mean is exact."""
    _, result = everywhere
    term = result.term("fluid")
    x = [term.reference + 0.1 * rng.standard_normal(term.reference.shape) for _ in range(2)]
    for one in x:
        one[[0, -1]] = term.reference[[0, -1]]
    mean = sum(term.respond(one, 4.0, None).force for one in x) / 2.0
    # forces of the residual are minus those on the body, which is on the left on the way back
    work = -(mean * (x[1] - x[0])).sum()
    taken = areas(x[1][::-1]) - areas(x[0][::-1])
    assert work == pytest.approx(-term.pressure * taken, rel=1e-10)


def test_a_body_in_a_fluid_does_not_crumple(everywhere):
    """All round under 6 shear moduli it shrinks by p / K and stays round."""
    seal, result = everywhere
    assert result.converged, result.failure
    assert all(step.stable for step in result.path.steps)
    particles = seal.nominal_particles[seal.body.edge("seal").particles]
    moved = result.displacement()[seal.body.edge("seal").particles]
    strain = (moved * particles).sum(axis=1) / (particles**2).sum(axis=1)
    assert strain.mean() == pytest.approx(-0.5 * 6.0 * SHEAR_MODULUS / 400_000.0, rel=0.03)
    assert np.ptp(strain) < 1e-10 * abs(strain.mean())


def test_without_pressure_the_residual_is_what_it_was(pressed, rng):
    """To the last bit, at any place, at the end of the path."""
    seal, step = pressed.seal, pressed.path.steps[-1]
    terms = seal.with_parameters({"fluid_pressure": 0.0}).terms()
    way = 1e-3 * rng.standard_normal(step.d.shape)
    problem = PathProblem(pressed.path.discretization, terms)
    forces = problem.evaluate(step.d + way, step.fraction, step.before).forces
    alone = forces[:-1].sum(axis=0)
    assert problem.terms[-1].label == "fluid"
    assert not forces[-1].any()
    assert np.array_equal(forces.sum(axis=0), alone)


def test_a_seal_under_no_pressure_is_closed_as_before():
    """Its path, too: the fluid that waits is no load."""
    still = sm.analyze(ring(0.0, spacing=0.6, close=3, steps=2))
    assert still.converged, still.failure
    assert peak(still, -1) == pytest.approx(peak(still, 2), rel=1e-8)


@pytest.mark.parametrize("axis", [None, 12.0])
def test_the_fluid_has_to_overcome_the_true_contact_pressure(axis):
    """The normal force over the deformed length, as the measures of the contact pressure."""
    result = sm.analyze(ring(200.0, squeeze=0.6, close=4, steps=2, axis=axis))
    assert result.converged, result.failure
    term, found = result.term("fluid"), np.zeros((2, result.term("fluid").output_indices))
    index = {particle: i for i, particle in enumerate(term.particles)}
    for label in ("lid", "wall"):
        for row, nominal in enumerate((False, True)):
            points = PointPressures(result, label, nominal)
            at = [index[own] for own in result.term(label).where.at_particles]
            np.add.at(found[row], at, points.value)
    closing = result.response("fluid").outputs[:, 1]
    assert closing.max() > 1000.0
    np.testing.assert_allclose(closing, found[0], rtol=1e-12)
    assert np.abs(found[1] / np.where(closing, closing, 1.0) - 1.0)[closing > 0.0].max() > 0.03


# ---- tangent and derivatives ----


@pytest.mark.parametrize("step", [4, 5, -1])
def test_the_tangent_is_the_derivative_of_the_residual(pressed, rng, step):
    path = pressed.path
    here = path.nominal_steps[step]
    problem = PathProblem(path.discretization, pressed.seal.terms())
    factor, layout = problem.factorize_at(here), path.discretization.layout
    way = rng.standard_normal(layout.n_equations)
    # 1e-3 of the penetration of points in contact; rounding of stiff forces over it is 1e-9 of them
    h, spread = 1e-7, layout.gather(way)

    def residual(share):
        d = here.d + share * h * spread
        return problem.evaluate(d, here.fraction, here.before, tangent=False).residual

    found = np.array([1, -8, 8, -1]) @ [residual(s) for s in (-2, -1, 1, 2)] / (12 * h)
    np.testing.assert_allclose(factor.solve(found), way, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("number", [4, 5, 6])
def test_the_change_with_the_pressure_is_that_of_the_residual(pressed, number):
    """What the predictor takes for a higher pressure: the front moves, too."""
    term, step = pressed.term("fluid"), pressed.path.nominal_steps[number]
    response, h = step.responses[pressed.path.index_of("fluid")], 1e-4
    (change,) = term.changes(step, response, step.fraction + h)
    ends = [term.respond(response.x, step.fraction + s * h, None).force for s in (1, -1)]
    quotient = term.point_loads(0.5 * (ends[0] - ends[1]), np.ones(len(response.x), np.int64))
    np.testing.assert_allclose(change, quotient, rtol=0.0, atol=1e-5 * np.abs(quotient).max())
    assert term.changes(step, response, step.fraction) == []


def test_a_point_of_the_front_is_partly_wetted(pressed):
    """So the tests of tangent and derivatives see the weights change."""
    weight = pressed.response("fluid").outputs[:, 0]
    assert ((weight > 0.05) & (weight < 0.95)).any()
    assert weight[-1] == 0.0


def test_newton_converges_quadratically(pressed):
    """From a little beside equilibrium, with a front that moves."""
    step = pressed.path.steps[-1]
    problem = PathProblem(pressed.path.discretization, pressed.seal.terms())
    layout, sizes = pressed.path.discretization.layout, []
    rng = np.random.default_rng(1)
    d = step.d + 1e-5 * layout.gather(rng.standard_normal(layout.n_equations))
    iteration = None
    for _ in range(5):
        now = problem.evaluate(d, step.fraction, step.before, iteration)
        sizes.append(now.size)
        d, iteration = d - layout.gather(now.factorize().solve(now.residual)), now.iteration
    first = next(i for i, size in enumerate(sizes) if size < 1e-3)
    assert sizes[first + 1] < 1e3 * sizes[first] ** 2 or sizes[first + 1] < 1e-11
    assert sizes[-1] < 1e-11


def test_direct_and_adjoint_agree(pressed, tables):
    direct, adjoint = tables
    for measure in pressed.seal.standard:
        own = np.atleast_2d(direct[measure.name])
        size = np.abs(own).max(axis=1, keepdims=True)
        assert (np.abs(own - np.atleast_2d(adjoint[measure.name])) <= 1e-9 * size).all()


def check_along(pressed, tables, way, steps, limit=1e-6):
    """Truncation of fourth order and rounding stay below the limit."""
    exact = np.concatenate([np.atleast_2d(tables[0][m.name]) for m in pressed.seal.standard])
    for step in steps:
        found = quotient(pressed.seal, NAMES, step * way, pressed.seal.standard, states(pressed))
        size = np.abs(exact * way).sum(axis=1).max()
        assert size > 0.0
        assert (np.abs(found / step - exact @ way) <= limit * size).all()


@pytest.mark.parametrize("which", ["offsets", pytest.param("parameters", marks=pytest.mark.long)])
def test_derivatives_against_central_differences(pressed, tables, rng, which):
    """Of all measures; parameters of profiles belong to contact and fluid at once."""
    way = steps_of(pressed.seal, NAMES) * rng.uniform(0.5, 1.0, 4 + len(NAMES))
    if which == "offsets":
        way[4:] = 0.0
    else:
        way[:4] = 0.0
    check_along(pressed, tables, way, (3e-5,))


@pytest.mark.long
@pytest.mark.parametrize("place", range(4 + len(NAMES)))
def test_the_derivative_in_every_parameter(pressed, tables, place):
    """At two steps a decade apart."""
    way = steps_of(pressed.seal, NAMES) * (np.arange(4 + len(NAMES)) == place)
    check_along(pressed, tables, way, (1e-4, 1e-5))


# ---- an O-ring ----


def test_an_o_ring_passes_the_pressure_on():
    """Up to four times its own: the peak on the lid rises by 0.9 to 1.1 of the fluid's.

    From half of its own on; with less the flank on the wet side is still closing.
    """
    own = peak(sm.analyze(ring(0.0, steps=1)), -1)
    result = sm.analyze(ring(4.0 * own, steps=16))
    assert result.converged, result.failure
    for times in (0.5, 1.0, 2.0, 3.0, 4.0):
        rise = peak(result, 6 + round(4 * times) - 1) - own
        assert 0.9 <= rise / (times * own) <= 1.1
    weight = result.response("fluid").outputs[:, 0]
    assert weight[0] == 1.0
    assert weight[-1] == 0.0


BLOCK = """\
[material.rubber]
law = "neo_hookean"
c10 = 500.0
bulk_modulus = 20000.0
[section]
material = "rubber"
spacing = 1.0
outer = [
  { edge = "bottom", line = [[-3, 0], [3, 0]] }, { edge = "right", line = [[3, 0], [3, 4]] },
  { edge = "top", line = [[3, 4], [-3, 4]] }, { edge = "left", line = [[-3, 4], [-3, 0]] },
]
[fixed]
edges = ["bottom"]
[[profile]]
name = "lid"
contact = ["top"]
friction = 0.1
normal_penalty = 1e5
tangent_penalty = 1e4
line = [[-100.0, 4.0], [100.0, 4.0]]
stage = [{ translate = [0.0, -0.4], steps = 4 }, { steps = 4 }]
[[fluid]]
edge = EDGE
pressure = 100.0
"""


@pytest.mark.parametrize(
    ("edges", "sign"),
    [('["top", "left"]\nfrom = "end"', 1.0), ('["right", "top"]\nfrom = "start"', -1.0)],
)
def test_a_fluid_acts_on_a_free_side_up_to_the_corner_in_contact(tmp_path, edges, sign):
    """The force is p times the height of the deformed side, although its corner is dry."""
    (tmp_path / "block.toml").write_text(BLOCK.replace("EDGE", edges))
    result = sm.analyze(sm.build_seal(tmp_path / "block.toml"))
    assert result.converged, result.failure
    response = result.response("fluid")
    # the first dry particle is the corner; points of sides lie between the particles
    weight = response.outputs[:, 0]
    corner = int(weight.argmin())
    assert weight.tolist() == [1.0] * corner + [0.0] * (len(weight) - corner)
    height = abs(response.x[POINTS * corner, 1] - response.x[0, 1])
    assert 3.5 < height < 3.7
    # forces are those in the residual, against the fluid; kPa mm = N/m
    assert response.force[:, 0].sum() == pytest.approx(-sign * 100.0 * height, rel=1e-12)


def test_a_profile_that_is_placed_elsewhere_closes_the_edge_there(tmp_path):
    """The fluid takes the contact pressure of the placed profile: as with another start in the file, but
    that a profile that touches is moved off by 2e-9 of the size."""
    text = BLOCK.replace("EDGE", '["top", "left"]\nfrom = "end"')
    (tmp_path / "block.toml").write_text(text)
    seal = sm.build_seal(tmp_path / "block.toml").with_placements()
    placed = sm.analyze(seal, parameters={"lid_y": 0.1})
    (tmp_path / "block.toml").write_text(text.replace("[[-100.0, 4.0]", "[[-100.0, 4.1]").replace(
        "[100.0, 4.0]]", "[100.0, 4.1]]"
    ))  # fmt: skip
    other = sm.analyze(sm.build_seal(tmp_path / "block.toml"))
    closing, expected = (own.response("fluid").outputs[:, 1] for own in (placed, other))
    assert expected.max() > 300.0
    np.testing.assert_allclose(closing, expected, rtol=1e-6)
    forces = [own.path.reaction("lid")[-1] for own in (placed, other)]
    np.testing.assert_allclose(*forces, rtol=1e-6)


def test_messages_tell_of_the_fluid(pressed):
    term = pressed.term("fluid")
    words = term.describe(pressed.response("fluid"), pressed.path.steps[-1].fraction)
    assert words.startswith("fluid: 1000 kPa, ")
    assert words.endswith(" of 25 points wetted")


# ---- what is refused ----


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"pressure": -1.0}, "pressure of 'fluid' must be a number of at least 0, got -1.0"),
        ({"pressure": np.nan}, "pressure of 'fluid'"),
        ({"share": 0.0}, "share of 'fluid' must be a number above 0"),
        ({"share": 1.5}, "share of 'fluid'"),
        ({"end": "left"}, "end of 'fluid'"),
        (
            {"edge": np.array([1])},
            "the edge on which the fluid pressure 'fluid' acts needs at least two particles",
        ),
        (
            {"ramp": np.array([0.0, -1.0])},
            "the ramp of the fluid pressure 'fluid' must be a list of finite numbers of at least 0",
        ),
        (
            {"ramp": np.array([0.0, np.inf])},
            "the ramp of the fluid pressure 'fluid' must be a list of finite numbers of at least 0",
        ),
    ],
)
def test_bad_fluids_are_refused(changed, words):
    good = {"edge": np.arange(3), "end": "end", "pressure": 1.0, "ramp": np.array([0.0, 1.0])}
    with pytest.raises(ValueError, match=words):
        FluidPressure("fluid", **good | changed, contacts=())
