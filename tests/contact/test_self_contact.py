"""Contact of a section with itself: a ring pressed flat, a lip folded on its body."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from seal_file.block_files import FIXED, LID, seal_of
from squeezed_ring import itself, ring, ring_body

import seal_mdao as sm
from seal_mdao.contact.friction import SLIP, STICK, UNKNOWN, ContactLaw
from seal_mdao.contact.self_contact import SelfContact, SelfContactTerm
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.checks import findings

LIP = Path(__file__).parent / "folded_lip.toml"
RAYS, STEPS = 96, 23
QUOTIENT = np.array([1, -8, 8, -1])


def squeezed(kind, **options):
    found = sm.analyze(ring(kind, **{"rays": RAYS, "steps": STEPS, "bulk": 1000.0, **options}))
    assert found.converged, found.failure
    return found


def reactions(result):
    return result.path.reaction("plate")[:, 1]


def touching_steps(result):
    """Nominal steps from the first self-touch on."""
    return [i for i, r in enumerate(result.path.at_nominal("hole")) if r.branch.any()]


def states(result, labels):
    return np.hstack([[r.branch for r in result.path.responses(label)] for label in labels])


@pytest.fixture(scope="module")
def pressed():
    return squeezed("itself")


def test_a_ring_pressed_flat_is_two_halves_on_a_line(pressed):
    """The same particles, so the bound is that of the contact alone."""
    after = touching_steps(pressed)
    assert len(after) >= 3
    lines = reactions(squeezed("lines"))
    np.testing.assert_allclose(reactions(pressed)[after], lines[after], rtol=1e-3)
    assert (pressed.response("hole").branch != 0).sum() >= 6


@pytest.mark.parametrize(
    "friction",
    [pytest.param(0.0, marks=pytest.mark.release), pytest.param(0.5, marks=pytest.mark.long)],
)
def test_a_ring_pressed_flat_is_its_half_on_a_line(friction):
    """The cut of the half changes kernels there, which goes down with the distance of particles."""
    whole = squeezed("itself", rays=256, steps=46, friction=friction, bulk=8000.0)
    after, half = touching_steps(whole), squeezed("half", rays=256, steps=46, bulk=8000.0)
    assert len(after) >= 5
    np.testing.assert_allclose(reactions(whole)[after], reactions(half)[after], rtol=1e-3)
    assert 0.0 < penetration(whole) <= 0.02


def test_walls_that_meet_without_sliding_do_not_rub(pressed):
    rubbing = squeezed("itself", friction=0.5)
    assert not (rubbing.response("hole").branch == SLIP).any()
    np.testing.assert_allclose(reactions(rubbing), reactions(pressed), rtol=1e-5)


def penetration(result):
    """Deepest place of a particle in the other wall over all steps, mm; by symmetry the walls meet on
    the mid-plane."""
    upper = result.term("hole").reference[:, 1] > 1e-9
    return -2.0 * min(answer.x[upper, 1].min() for answer in result.path.at_nominal("hole"))


def test_no_point_is_far_through_the_other_wall(pressed):
    assert 0.0 < penetration(pressed) <= 0.02


@pytest.mark.long
def test_walls_in_contact_do_not_cross_but_by_their_penalty(pressed):
    """A result says their penetration from 1 % of the wall on, and 10 % are none."""
    assert not any("crosses" in text or "inside each other" in text for text in pressed.warnings)
    for penalty, impossible in ((100.0, False), (2.0, True)):
        softer = sm.analyze(
            ring("itself", rays=RAYS, steps=STEPS, bulk=1000.0),
            None,
            {"hole_normal_penalty": penalty},
        )
        (found,) = [f for f in findings(softer.path) if "inside each other" in f.text]
        assert "the penalty of the contact 'hole' is too small" in found.text
        assert found.impossible == impossible
        assert not any("crosses" in text for text in softer.warnings)


def test_which_wall_is_called_master_does_not_matter(pressed):
    """The term alone at the same places, for equilibrium has Newton's tolerance."""
    body, term = ring_body(RAYS), pressed.term("hole")
    x = pressed.response("hole").x
    problem = pressed.path.problem
    own = term.respond(x, 1.0, term.no_history())
    turned = itself(body, 0.0, turned=True).on(problem.discretization, term.index)
    order = [int(np.flatnonzero(turned_hole(body) == p)[0]) for p in term.where.of_particles]
    back = np.argsort(order)
    other = turned.respond(x[back], 1.0, turned.no_history())
    size = np.abs(own.force).max()
    np.testing.assert_allclose(other.force[order], own.force, rtol=0.0, atol=1e-10 * size)
    np.testing.assert_allclose(own.force.sum(axis=0), 0.0, atol=1e-12 * size)
    moment = x[:, 0] * own.force[:, 1] - x[:, 1] * own.force[:, 0]
    assert abs(moment.sum()) <= 1e-11 * size


def test_a_point_with_zero_gap_is_at_a_kink(pressed):
    """An open point near the other wall, moved there, and a step at which it has a gap."""
    term, step = pressed.term("hole"), pressed.end
    response, before = pressed.response("hole"), step.before[pressed.path.index_of("hole")]
    assert not any(part.size for part in term.kinks(response, step.fraction, before))
    points, _, now = term._followed(response.x)
    chosen = int(np.flatnonzero(now.gap > 0.0)[now.gap[now.gap > 0.0].argmin()])
    x, point = response.x.copy(), points[chosen]
    for _ in range(4):  # Newton's method, for the projection moves as well
        points, _, now = term._followed(x)
        (chosen,) = np.flatnonzero(points == point)
        normal = now.gap_1[chosen, :2]
        x[point] -= now.gap[chosen] * normal / (normal @ normal)
    found = term.kinks(term.respond(x, step.fraction, before).copied(), step.fraction, before)
    assert point in found.touching
    assert found.slips.all()


def test_a_point_at_the_friction_limit_is_at_a_kink(folded):
    """The friction is that at which a point that sticks has its limit, w_t |g_t| = mu w_n |g_n|."""
    path, number = folded.path, folded.path.index_of("self_contact")
    (definition,) = (own for own in folded.seal.terms() if own.label == "self_contact")
    chosen = 0
    for last, step in pairwise(path.steps):
        response, before = step.responses[number], step.before[number]
        stick = (last.responses[number].branch == STICK) & (response.branch == STICK)
        for point in np.flatnonzero(stick):
            term = folded.term("self_contact")
            points, _, now = term._followed(response.x)
            gap = now.gap[np.flatnonzero(points == point)[0]]
            ratio = term.law.tangent_penalty / term.law.normal_penalty
            limit = ratio * abs(response.history.variables[point, 2] / gap)
            for friction, at_limit in ((limit, True), (1.01 * limit, False)):
                changed = definition.with_parameters({"self_contact_friction": friction})
                other = changed.on(path.discretization, number)
                found = other.kinks(response, step.fraction, before)
                assert (point in found.slipping) == at_limit
        chosen += stick.sum()
    assert chosen >= 5


@pytest.mark.parametrize(("segments", "known"), [(2.9, True), (3.1, False), (-3.1, False)])
def test_a_point_that_jumps_over_segments_begins_contact_again(folded, segments, known):
    term, step = folded.term("self_contact"), folded.end
    number = folded.path.index_of("self_contact")
    points, _, now = term._followed(step.responses[number].x)
    history = step.responses[number].history
    variables = history.variables.copy()
    variables[points, 0] = now.xi - segments
    closed = history.state[points] != UNKNOWN
    found = term._before(points, now, history._replace(variables=variables))
    assert closed.any()
    assert np.array_equal(found.state[closed] != UNKNOWN, np.full(closed.sum(), known))
    np.testing.assert_allclose(found.change, segments if known else 0.0, rtol=0.0, atol=1e-12)
    assert np.array_equal(found.size, variables[points, 1] if known else now.size)


def test_without_friction_the_force_is_the_gradient_of_a_potential(pressed, rng):
    """The step is a tenth of the smallest penetration, so that the same points touch."""
    term, response = pressed.term("hole"), pressed.response("hole")
    assert term.conservative
    way, h = rng.standard_normal(response.x.shape), 1e-8

    def potential(share):
        x = response.x + share * h * way
        return term.potential(None, term.respond(x, 1.0, term.no_history()))

    quotient = np.array([1, -8, 8, -1]) @ [potential(s) for s in (-2, -1, 1, 2)] / (12 * h)
    assert (response.force * way).sum() == pytest.approx(quotient, rel=1e-6)


def turned_hole(body):
    return itself(body, 0.0, turned=True).loops[0]


@pytest.fixture(scope="module")
def lip():
    seal = sm.build_seal(sm.read_seal_file(LIP))
    return replace(seal, newton=sm.NewtonOptions(tolerance=1e-10))


@pytest.fixture(scope="module")
def folded(lip):
    result = sm.analyze(lip, keep_factors=True)
    assert result.converged, result.failure
    return result


@pytest.fixture(scope="module")
def tables(folded):
    names = tuple(folded.seal.scalars)
    return [sm.differentiate(folded, names, method=method) for method in ("direct", "adjoint")]


def test_the_tip_slides_along_the_body(folded):
    at = [r.branch for r in folded.path.at_nominal("self_contact")]
    assert sum((branch == SLIP).any() for branch in at) >= 3


def test_derivatives_in_the_constants_of_the_law(folded):
    """Of the forces and of the history at fixed positions: the law of each pass has half of the
    penalties."""
    path, term = folded.path, folded.term("self_contact")
    number, step = path.index_of("self_contact"), path.nominal_steps[-1]
    response, before = step.responses[number], step.before[number]
    (definition,) = (own for own in folded.seal.terms() if own.label == "self_contact")
    local = term.linearize(response, step.fraction, before).sparse.toarray()
    assert {"self_contact_normal_penalty", "self_contact_tangent_penalty"} < {*definition.scalars}
    for column, (name, scalar) in enumerate(definition.scalars.items(), term.inputs[3].start):
        h = 1e-3 * scalar.value

        def moved(share, name=name, value=scalar.value, h=h):
            changed = definition.with_parameters({name: value + share * h})
            found = changed.on(path.discretization, number).respond(response.x, 0.0, before)
            assert np.array_equal(found.branch, response.branch)
            return np.concatenate([found.force.ravel(), found.history.variables.ravel()])

        quotient = QUOTIENT @ [moved(share) for share in (-2, -1, 1, 2)] / (12.0 * h)
        size = np.abs(quotient).max()
        assert size > 0.0
        np.testing.assert_allclose(
            local[: quotient.size, column], quotient, rtol=0.0, atol=1e-8 * size, err_msg=name
        )


def test_neighbours_along_a_closed_boundary_do_not_touch():
    """Of a circle of 20 points those up to three sides apart, also over its first point."""
    angle = 2.0 * np.pi * np.arange(20) / 20
    x = 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    law = ContactLaw(1e3, 1e3, 0.0, True)
    found = SelfContact("self", (np.arange(20),), np.ones(20, bool), x, law).may_touch()
    apart = np.abs(np.arange(20)[:, None] - np.arange(20))
    assert np.array_equal(found, (apart > 3) & (apart < 17))


def test_walls_may_penetrate_by_half_of_the_thinnest():
    """Of a bar with the thickness 2 all points, also those that are far from each other."""
    lower = np.column_stack([np.arange(11.0), np.zeros(11)])
    upper = lower[::-1] + np.array([0.0, 2.0])
    x = np.concatenate([lower, [[10.0, 1.0]], upper, [[0.0, 1.0]]])
    law = ContactLaw(1e3, 1e3, 0.0, True)
    n = len(x)
    reach = SelfContact("self", (np.arange(n),), np.ones(n, bool), x, law).reach()
    assert reach.max() == 1.0
    assert reach.min() >= 0.5


def test_direct_and_adjoint_agree(folded, tables):
    direct, adjoint = tables
    for measure in folded.seal.standard:
        size = np.abs(direct[measure.name]).max()
        assert np.abs(direct[measure.name] - adjoint[measure.name]).max() <= 1e-9 * size


@pytest.mark.parametrize("shape", [True, pytest.param(False, marks=pytest.mark.long)])
def test_derivatives_against_central_differences(folded, tables, shape, rng):
    """Along a random way through all offsets or all constants, with the same contact sequence. Newton's
    tolerance over the step is 1e-6 of a measure at the worst, here below the tenth part of the bound."""
    seal, names = folded.seal, tuple(folded.seal.scalars)
    values = np.array([scalar.value for scalar in seal.scalars.values()])
    way = rng.uniform(-1.0, 1.0, seal.n_offsets + len(names))
    way[: seal.n_offsets] *= shape
    way[seal.n_offsets :] *= values * (not shape)
    h, labels = 1e-4, ("rod", "self_contact")

    def moved(share):
        given = values + share * h * way[seal.n_offsets :]
        found = sm.analyze(
            seal, share * h * way[: seal.n_offsets], dict(zip(names, given, strict=True))
        )
        assert np.array_equal(states(found, labels), states(folded, labels))
        return np.array([found.value(measure)[0] for measure in seal.standard])

    quotient = QUOTIENT @ [moved(share) for share in (-2, -1, 1, 2)] / (12.0 * h)
    exact = np.array([tables[0][measure.name][0] @ way for measure in seal.standard])
    np.testing.assert_allclose(exact, quotient, rtol=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_the_path_is_the_same_with_masters_and_slaves_exchanged(friction):
    options = {"rays": 64, "friction": friction, "tolerance": 1e-11}
    one, other = (reactions(squeezed("itself", **options, turned=way)) for way in (False, True))
    np.testing.assert_allclose(other, one, rtol=0.0, atol=1e-10 * np.abs(one).max())


@pytest.mark.parametrize(
    "friction",
    [pytest.param(0.0, marks=pytest.mark.release), pytest.param(0.5, marks=pytest.mark.long)],
)
def test_derivatives_of_the_ring_against_central_differences(friction):
    """Steps where Newton's tolerance over them is below 1e-7 of the derivative."""
    options = {"rays": 64, "steps": STEPS, "bulk": 1000.0}
    seal = ring("itself", friction=friction, tolerance=1e-11, **options)
    base, steps = sm.analyze(seal), {"c10": 1e-4, "depth": 1e-4, "hole_normal_penalty": 3e-3}
    found = [
        sm.differentiate(base, tuple(steps), method=method)["reaction"][1]
        for method in ("direct", "adjoint")
    ]
    n = seal.n_offsets
    for place, name in enumerate([*range(n), *steps]):
        value = 0.0 if place < n else seal.scalars[name].value
        h = 1e-4 if place < n else steps[name] * (value or 1.0)

        def moved(share, place=place, name=name, value=value, h=h):
            offsets = share * h * np.eye(n)[place] if place < n else None
            other = sm.analyze(seal, offsets, {} if place < n else {name: value + share * h})
            assert np.array_equal(states(other, ("plate", "hole")), states(base, ("plate", "hole")))
            return other.value(Reaction("plate"))[1]

        quotient = QUOTIENT @ [moved(share) for share in (-2, -1, 1, 2)] / (12.0 * h)
        assert found[0][place] == pytest.approx(found[1][place], rel=1e-9)
        assert found[0][place] == pytest.approx(quotient, rel=1e-6)


def test_the_points_share_the_length_of_the_edges_that_may_touch():
    """Of a square of eight sides only the upper edge, of two sides, may touch: of the two points at
    each of its corners only the one on this edge, and it has half of a side."""
    x = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]], float)
    law = ContactLaw(1e3, 1e3, 0.0, True)
    contact = SelfContact("self", (np.arange(8),), np.isin(np.arange(8), [4, 5, 6]), x, law)
    assert contact.where.of_particles.tolist() == [0, 0, 1, 2, 2, 3, 4, 4, 5, 6, 6, 7]
    assert contact.where.measures(x)[6:11].tolist() == [0.0, 0.5, 1.0, 0.5, 0.0]
    assert contact.may[6:11].tolist() == [False, True, True, True, False]


def test_a_section_that_overlaps_itself_is_refused():
    """The inside of the ring turned over: each wall is where the other one was."""
    body = ring_body(32)
    contact = itself(body, 0.0)
    seal = ring("itself", rays=32)
    particles = seal.nominal_particles.copy()
    particles[contact.loops[0], 1] *= -0.02
    term = sm.analyze(ring("itself", rays=32, depth=0.05, steps=1)).term("hole")
    response = term.respond(particles[contact.loops[0]], 0.0, term.no_history())
    with pytest.raises(sm.GeometryError, match="overlaps itself"):
        term.check_start(response)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"loops": (np.arange(5),)}, "at least 7 particles"),
        ({"touching": np.ones(3, bool)}, "one entry for each of the"),
        ({"law": ContactLaw(0.0, 1.0, 0.0, True)}, "normal_penalty of 'hole'"),
        ({"law": ContactLaw(1.0, 1.0, -1.0, True)}, "friction of 'hole'"),
    ],
)  # fmt: skip
def test_a_bad_contact_is_refused(changed, words):
    good = {
        "label": "hole", "loops": (np.arange(20),), "touching": np.ones(20, bool),
        "nominal": np.zeros((20, 2)), "law": ContactLaw(1.0, 1.0, 0.0, True),
    }  # fmt: skip
    with pytest.raises(ValueError, match=words):
        SelfContact(**{**good, **changed})


def energy_taken(result):
    """What the contact takes along the path at most, and what it stores at its end, mJ/m."""
    path = result.path
    (term,) = (term for term in path.problem.terms if isinstance(term, SelfContactTerm))
    own, steps, taken = path.responses(term.label), [path.start, *path.steps], 0.0
    before = [path.start.responses[path.index_of(term.label)], *own]
    for last, then, step, now in zip(steps, before, steps[1:], own, strict=False):
        taken -= term.released_energy(last, then, step.d, now, step.fraction).least
    return taken, term.potential(path.steps[-1].d, own[-1])


def test_the_energy_that_the_contact_takes_is_stored_but_for_friction(pressed):
    taken, stored = energy_taken(pressed)
    assert stored > 0.0
    assert taken == pytest.approx(stored, rel=1e-9)
    taken, stored = energy_taken(sm.analyze(sm.build_seal(sm.read_seal_file(LIP))))
    assert 1.2 * stored < taken < 2.0 * stored


def test_the_slip_of_the_friction_work_is_that_of_points_that_stick(folded, monkeypatch):
    """In mm: the elastic slip of points that stick grows by it."""
    path, term, slips = folded.path, folded.term("self_contact"), []
    monkeypatch.setattr(
        ContactLaw, "most_friction_work", lambda law, slip, gaps, length: slips.append(slip) or 0.0
    )
    number, sticking = path.index_of("self_contact"), 0
    for last, step in pairwise(path.steps):
        then, now = (own.responses[number].history for own in (last, step))
        term.released_energy(last, last.responses[number], step.d, step.responses[number], 0.0)
        stick = (then.state == STICK) & (now.state == STICK)
        sticking += stick.sum()
        grown = (now.variables - then.variables)[stick, 2]
        np.testing.assert_allclose(slips[-1][stick], grown, rtol=0.0, atol=1e-12)
    assert sticking >= 5


def test_faces_beside_a_convex_corner_are_no_walls_that_overlap(tmp_path):
    """In a design with an acute corner their outward normals are opposite, and each lies behind the
    other, as the two sides of a wall do; the nominal block has no walls."""
    contact = """[[design]]
edges = ["top"]
parameters = 4
bound = 0.5
[self_contact]
edges = ["top", "right"]
friction = 0.2
normal_penalty = 1e4
tangent_penalty = 1e3
"""
    seal = seal_of(tmp_path, FIXED, LID, contact)
    result = sm.analyze(seal, [-0.3, 0.0, 0.0, 0.0])
    assert result.converged
    assert not result.response("self_contact").branch.any()
