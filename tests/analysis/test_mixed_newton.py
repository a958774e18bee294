"""Mixed iterations: what they linearise, and what they spare stiff contact."""

from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis import load_path
from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.mixed_newton import mixed_newton
from seal_mdao.analysis.newton import newton
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.predictor import predict
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.contact.boundary_curve import kinematics, masters, rings
from seal_mdao.contact.friction import SLIP
from seal_mdao.contact.kinematics import linearized_positions, normal_gaps
from seal_mdao.contact.self_mixed import Linearization
from seal_mdao.geometry.pose import Pose
from seal_mdao.geometry.profile import circle_profile, flat_profile

EXAMPLES = Path(__file__).parents[2] / "examples"
FOLDED_LIP = Path(__file__).parents[1] / "contact" / "folded_lip.toml"
RADIUS = 4.0


def stiff(name, normal, tangent):
    """An example with these penalties at every contact."""
    seal = sm.build_seal(sm.read_seal_file(EXAMPLES / name))
    own = {label: normal for label in seal.scalars if label.endswith("normal_penalty")}
    own |= {label: tangent for label in seal.scalars if label.endswith("tangent_penalty")}
    return seal.with_parameters(own)


def problem_of(result):
    """The problem of an analysis, for iterations of one's own."""
    return PathProblem(result.path.discretization, result.seal.terms())


def expected(profile, pose, x, *linearized):
    """What ``linearized_positions`` makes of arrays that stay as they are."""
    copies = tuple(part.copy() for part in linearized)
    linearized_positions(profile, pose, x, *copies)
    return copies


def gaps(profile, pose, x):
    """Normal gaps of points."""
    out = np.empty(len(x))
    normal_gaps(profile, pose, np.ascontiguousarray(x), out)
    return out


# ---- the linearised place ----

POSE = Pose.of((0.3, -0.2), 0.4, (1.0, 0.5))


def beside_circle(gap, angle):
    """A point with a gap from the circle, and its normal there."""
    profile = circle_profile((0.4, 1.0), RADIUS)
    away = np.array([np.cos(angle), np.sin(angle)])
    return profile, POSE.places(np.array([[0.4, 1.0] + (RADIUS + gap) * away]))


@pytest.mark.parametrize("gap", [-0.02, 0.05])
def test_a_point_beside_a_circle_has_the_gap_of_its_linearisation(gap):
    profile, before = beside_circle(gap, 0.7)
    place, normal, at = expected(profile, POSE, before, before, np.zeros((1, 2)), np.zeros(1))
    np.testing.assert_array_equal(place, before)
    assert at[0] == pytest.approx(gap, abs=1e-12)
    now = before + np.array([0.2, -0.35])
    linear = gap + (normal * (now - before)).sum()
    missed = gaps(profile, POSE, now)[0] - linear
    assert missed > 1e-3
    place, normal, at = expected(profile, POSE, now, place, normal, at)
    assert at[0] == pytest.approx(linear, abs=1e-12)
    assert gaps(profile, POSE, place)[0] == pytest.approx(linear, abs=1e-12)
    np.testing.assert_allclose(now - place, missed * normal, rtol=0.0, atol=1e-14)


def test_a_straight_profile_moves_no_place():
    before, now = np.array([[0.2, 0.1]]), np.array([[1.7, -0.3]])
    linearized = expected(flat_profile(), POSE, before, before, np.zeros((1, 2)), np.zeros(1))
    place, _, at = expected(flat_profile(), POSE, now, *linearized)
    np.testing.assert_allclose(place, now, rtol=0.0, atol=1e-14)
    assert at[0] == pytest.approx(gaps(flat_profile(), POSE, now)[0], abs=1e-14)


def test_a_point_far_from_where_it_was_linearised_stays_where_it_is():
    profile, before = beside_circle(0.1, 0.7)
    linearized = expected(profile, POSE, before, before, np.zeros((1, 2)), np.zeros(1))
    now = beside_circle(0.1, 2.7)[1]
    np.testing.assert_array_equal(expected(profile, POSE, now, *linearized)[0], now)


# ---- the linearised volumetric strain ----


def test_the_volume_strain_is_linear_in_the_increment(nominal):
    """(s(u + du) - s(u - du)) / 2 is the linear part: in two dimensions det F has no third."""
    problem, step = problem_of(nominal), nominal.path.steps[60]
    structure = problem.term("structure")
    table, raw = structure.cells.raw, problem.discretization.transformation.coefficients
    before, after = raw(step.d), raw(nominal.path.steps[61].d)

    def volume_strain(d):
        assert structure._assemble(table, d, 61.0, None, problem.discretization.layout.scatter[0],
                                   np.zeros(problem.discretization.layout.force_size),
                                   np.empty(0))  # fmt: skip
        return structure.deformation.volume_strain[0].copy()

    linear = 0.5 * (volume_strain(after) - volume_strain(2.0 * before - after))
    quadratic = structure._beyond_linear(table, after - before)
    assert np.abs(quadratic).max() > 1e-6
    found = volume_strain(after) - quadratic - volume_strain(before)
    np.testing.assert_allclose(found, linear, rtol=0.0, atol=1e-13)


# ---- the iterations ----


def test_at_equilibrium_they_are_newtons(nominal):
    """Where the increment is zero forces and tangent are those of Newton's method."""
    problem = problem_of(nominal)
    for step in nominal.path.steps[30::25]:
        plain, start = problem.assemble_at(step), problem.begin_mixed(step, step.fraction)
        mixed = problem.evaluate(step.d, step.fraction, step.before, start, mixed=True)
        scale = np.abs(plain.values).max()
        np.testing.assert_allclose(mixed.values, plain.values, rtol=0.0, atol=1e-11 * scale)
        np.testing.assert_allclose(mixed.residual, plain.residual, rtol=0.0, atol=1e-9)


def test_they_find_the_equilibrium_that_newton_finds(nominal):
    problem = problem_of(nominal)
    for before, step in zip(nominal.path.steps[40::20], nominal.path.steps[41::20], strict=False):
        increment = Increment(
            problem, step.fraction, before.after, nominal.seal.newton, before,
            problem.factorize_at(before),
        )  # fmt: skip
        guess = predict(increment)[0]
        one, two = newton(increment, guess), mixed_newton(increment, guess)
        assert one.status is two.status is Status.CONVERGED
        np.testing.assert_allclose(two.d, one.d, rtol=0.0, atol=1e-9)
        assert len(two.residuals) <= len(one.residuals) + 1


def test_what_newtons_method_solves_stays_as_it_is(drawn_model, monkeypatch):
    def never(*_):
        raise AssertionError("mixed iterations where Newton's method converges")

    monkeypatch.setattr(load_path, "mixed_newton", never)
    assert sm.analyze(drawn_model).step_cuts == 0


@pytest.mark.parametrize(("penalties", "most"), [((1e5, 1e3), 3), ((1e6, 1e4), 3)])
def test_a_lip_bent_over_a_stiff_corner_is_hardly_cut(penalties, most):
    """Newton's method alone cuts 87 and 189 times."""
    result = sm.analyze(stiff("lip.toml", *penalties))
    assert result.converged
    assert result.step_cuts <= most
    assert result.newton_iterations.sum() < 450


def test_an_equilibrium_far_away_is_refused(monkeypatch):
    """The step is cut then as if the mixed iterations had failed."""
    seal = stiff("lip.toml", 1e4, 1e2)
    found = []

    def far(_, guess):
        found.append(guess)
        return Solution(Status.CONVERGED, guess + 10.0, ())

    monkeypatch.setattr(load_path, "mixed_newton", far)
    refused = sm.analyze(seal)
    monkeypatch.setattr(load_path, "mixed_newton", lambda _, d: Solution(Status.SINGULAR, d, ()))
    failed = sm.analyze(seal)
    assert found
    assert refused.step_cuts == failed.step_cuts > 0
    np.testing.assert_array_equal(refused.path.steps[-1].d, failed.path.steps[-1].d)


# ---- self-contact ----

N_RING = 24


def unloaded(m):
    """Direction of slip, forces and slopes of m points that are open."""
    return np.zeros(m, int), np.zeros((m, 2)), np.zeros((m, 2, 2))


def outside_a_ring(*angles):
    """Linearisations of a point 0.1 outside a closed curve of radius R, at angles of one segment."""
    turn = 2.0 * np.pi * np.arange(N_RING) / N_RING
    curve, ring = RADIUS * np.column_stack([np.cos(turn), np.sin(turn)]), rings([N_RING, 1])
    point, segments = np.array([N_RING]), np.array([3])
    nodes = np.column_stack([point, masters(segments, ring)])
    found = []
    for share in angles:
        angle = turn[3] + share * turn[1]
        away = (RADIUS + 0.1) * np.array([[np.cos(angle), np.sin(angle)]])
        x = np.vstack([curve, away])
        now = kinematics(x, nodes, segments, np.array([share]), ring)
        found.append(Linearization(x, point, nodes, now, *unloaded(1)))
    return ring, *found


def test_a_point_that_went_along_a_wall_misses_what_the_wall_bends():
    """About s^2/(2 R), as the expected gap is that over the tangent, and nothing where none bends."""
    ring, one, other = outside_a_ring(0.4, 0.6)
    way = (RADIUS + 0.1) * 0.2 * 2.0 * np.pi / N_RING
    (missed,) = one.missed(other.x, other.points, other.kinematics, ring)
    assert missed == pytest.approx(way**2 / (2.0 * RADIUS), rel=0.05)
    assert one.missed(one.x, one.points, one.kinematics, ring) == pytest.approx(0.0, abs=1e-15)


def test_a_point_that_faced_no_wall_or_another_one_misses_nothing():
    ring, one, other = outside_a_ring(0.4, 0.6)
    far = one.kinematics._replace(gap=one.kinematics.gap + 1.0)  # what it leads to is off by 1
    assert one._replace(kinematics=far).missed(other.x, other.points, other.kinematics, ring) == 0.0
    faced = [one.points[:0], one.nodes[:0], type(far)(*(part[:0] for part in far))]
    assert Linearization(one.x, *faced, *unloaded(0)).missed(one.x, one.points, far, ring) == 0.0


@pytest.fixture(scope="module")
def folded():
    return sm.analyze(sm.build_seal(sm.read_seal_file(FOLDED_LIP)))


def test_at_equilibrium_they_are_newtons_with_self_contact(folded):
    problem, place = problem_of(folded), folded.path.index_of("self_contact")
    touching = [step for step in folded.path.steps if (step.responses[place].branch == SLIP).any()]
    for step in touching[::4]:
        plain, known = problem.assemble_at(step), problem.begin_mixed(step, step.fraction)
        mixed = problem.evaluate(step.d, step.fraction, step.before, known, mixed=True)
        assert mixed.unconverged == 0
        scale = np.abs(plain.values).max()
        np.testing.assert_allclose(mixed.values, plain.values, rtol=0.0, atol=1e-11 * scale)
        np.testing.assert_allclose(mixed.residual, plain.residual, rtol=0.0, atol=1e-9)
    assert len(touching) >= 4


def test_slip_direction_of_rigid_contact_is_that_of_the_linearisation_before():
    """An evaluation in between, where a point is open, does not reset it: without that 9 cuts."""
    result = sm.analyze(sm.door_seal(friction=0.05))
    assert result.converged
    assert result.step_cuts <= 2
