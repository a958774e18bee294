"""Single terms of the sensitivity equations: rates, transposes, sweeps, contractions."""

from itertools import pairwise

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis.body import (
    add_tributary_seeds,
    discretize,
    tributary_lengths,
    tributary_rates,
)
from seal_mdao.analysis.internal_force import assemble_internal
from seal_mdao.contact.friction import OPEN, STICK
from seal_mdao.dsa.adjoint import AdjointSweep
from seal_mdao.dsa.blocks import blocks
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.handed_on import handed_on, sticking
from seal_mdao.dsa.internal_rates import add_internal_rates
from seal_mdao.dsa.internal_seeds import add_internal_seeds
from seal_mdao.dsa.linearization import discretization_rates, local_contact, point_table_rates
from seal_mdao.dsa.parameters import SCALARS, parameter_rates
from seal_mdao.dsa.point_rates import (
    add_displacement_seeds,
    add_gradient_seeds,
    add_solution_rates,
    displacement_rates,
    gradient_rates,
    point_adjoint,
)
from seal_mdao.dsa.sensitivity import (
    _Wanted,
    adjoint_gradient,
    measure_count,
    particle_gradient,
    path_problem,
)
from seal_mdao.measures.functional import Seeds
from seal_mdao.measures.stress import von_mises_at
from seal_mdao.seal import analyze_particles
from seal_mdao.verification.differences import perturbed, same_sequence


@pytest.fixture
def disc(drawn):
    return drawn.path.discretization


@pytest.fixture
def velocity(rng):
    return rng.standard_normal((3, 174, 2))


def internal_force(discretization, constants, d):
    layout = discretization.layout
    force = np.zeros(layout.n_equations + 1)
    assemble_internal(
        discretization.cells.table, discretization.weights, constants, d, layout.force_scatter, force,
        np.empty(0),
    )  # fmt: skip
    return np.where(layout.equations >= 0, force[layout.equations], 0.0)


def test_tributary_lengths_add_up_to_the_free_boundary(drawn, disc):
    """Half edges: the two edges at the base corners count half."""
    outer = drawn.particles[drawn.model.grid.particle(np.arange(3, 56), 2)]
    edges = np.linalg.norm(np.diff(outer, axis=0), axis=1)
    total = edges.sum() - 0.5 * (edges[0] + edges[-1])
    assert disc.contact_length.sum() == pytest.approx(total, rel=1e-13)


def test_tributary_rates_against_central_differences(drawn, velocity):
    body, x = drawn.model.body, drawn.particles
    exact = tributary_rates(body, x, velocity)
    for p, v in enumerate(velocity):
        plus, minus = (tributary_lengths(body, x + s * 1e-5 * v) for s in (1, -1))
        np.testing.assert_allclose((plus - minus) / 2e-5, exact[p], atol=1e-8)


def test_tributary_seeds_are_the_transpose_of_their_rates(drawn, velocity, rng):
    body, x = drawn.model.body, drawn.particles
    seed, x_bar = rng.standard_normal((51, 2)), np.zeros((174, 2, 2))
    add_tributary_seeds(body, x, seed, x_bar)
    forward = seed.T @ tributary_rates(body, x, velocity).T
    np.testing.assert_allclose(np.einsum("aim,pai->mp", x_bar, velocity), forward, atol=1e-12)


def test_structural_fictitious_load_against_central_differences(drawn, disc, velocity):
    """a'_V of Eq. (46): the internal force at fixed coefficients when the particles move."""
    d, problem = drawn.end.d, path_problem(drawn)
    equations = disc.layout.equations
    rates = discretization_rates(disc, velocity)
    loads = np.zeros((1, disc.layout.n_equations + 1, 3))
    add_internal_rates(
        disc.cells.table, disc.weights, rates.cells, rates.weights, problem.constants, d[None],
        equations, loads,
    )  # fmt: skip
    load = loads[0]
    free = equations >= 0
    worst = []
    for step in (1e-5, 1e-6):
        forces = [
            internal_force(
                discretize(disc.body, disc.particles + s * step * velocity[0]),
                problem.constants,
                d,
            )
            for s in (1, -1)
        ]
        slope = (forces[0] - forces[1])[free] / (2 * step)
        exact = load[equations[free], 0]
        worst.append(np.abs(slope - exact).max() / np.abs(exact).max())
    # first order only where a support or a kernel knot lies exactly on a point
    assert worst[1] < 1e-6
    assert worst[0] < 2e-5


def test_internal_seeds_are_the_transpose_of_internal_rates(drawn, disc, velocity, rng):
    """-lambda . f' from the rates of B and w equals the seeds on B and w times those rates."""
    d, problem = np.array([step.d for step in drawn.path.steps[-3:]]), path_problem(drawn)
    equations, table = disc.layout.equations, disc.cells.table
    rates = discretization_rates(disc, velocity)
    loads = np.zeros((3, disc.layout.n_equations + 1, 3))
    add_internal_rates(
        table, disc.weights, rates.cells, rates.weights, problem.constants, d, equations, loads
    )
    # one adjoint in the first step, none in the second, three in the third
    first, mix = np.array([0, 1, 1, 4]), rng.standard_normal((4, 2))
    adjoints = rng.standard_normal((disc.layout.n_equations + 1, 4))
    adjoints[-1] = 0.0
    adjoint = np.array([adjoints[:, i:j] @ mix[i:j] for i, j in pairwise(first)])
    grad_bar, weight_bar = np.zeros((table.grad.size, 2)), np.zeros((*disc.weights.shape, 2))
    constants_bar = np.zeros((3, 2))
    add_internal_seeds(
        table, disc.weights, problem.constants, d, first, adjoints, mix, equations, grad_bar,
        weight_bar, constants_bar,
    )  # fmt: skip
    ahead = -np.einsum("kem,kep->mp", adjoint[:, :-1], loads[:, :-1])
    back = np.einsum("cqm,pcq->mp", weight_bar, rates.weights)
    q = disc.weights.shape[1]
    for cell in range(table.n_groups):
        active = rates.cells.active[rates.cells.start[cell, 0] : rates.cells.start[cell + 1, 0]]
        low, high = rates.cells.start[cell : cell + 2, 1]
        here = slice(2 * q * table.start[cell], 2 * q * table.start[cell + 1])
        block = rates.cells.grad[2 * low : 2 * high].reshape(-1, active.size)
        back[:, active] += grad_bar[here].T @ block
    size = np.einsum("kem,kep->mp", np.abs(adjoint[:, :-1]), np.abs(loads[:, :-1]))
    np.testing.assert_allclose(back, ahead, rtol=0.0, atol=1e-12 * size.max())
    # the force is linear in C10, C01 and K
    free = equations >= 0
    for unit, seed in zip(np.eye(3), constants_bar, strict=True):
        force = np.array([internal_force(disc, tuple(unit), one)[free] for one in d])
        own = adjoint[:, equations[free]]
        scale = np.einsum("kem,ke->m", np.abs(own), np.abs(force))
        exact = -np.einsum("kem,ke->m", own, force)
        np.testing.assert_allclose(seed, exact, rtol=0.0, atol=1e-12 * scale.max())


def test_blocks_cover_all_steps_in_order(monkeypatch):
    monkeypatch.setattr("seal_mdao.dsa.blocks.BLOCK_BYTES", 8 * 100 * 3 * 4)
    assert [list(block) for block in blocks(range(9, -1, -1), 100, 3)] == [
        [9, 8, 7, 6], [5, 4, 3, 2], [1, 0],
    ]  # fmt: skip
    assert [list(block) for block in blocks([5, 2], 10**6, 3)] == [[5], [2]]


def test_short_blocks_give_the_same_sensitivities(drawn, monkeypatch):
    whole = [sm.differentiate(drawn, method=method) for method in ("direct", "adjoint")]
    monkeypatch.setattr("seal_mdao.dsa.blocks.BLOCK_BYTES", 8 * 334 * 26 * 10)
    for method, expected in zip(("direct", "adjoint"), whole, strict=True):
        found = sm.differentiate(drawn, method=method)
        for name in ("von_mises", "gap", "reaction"):
            a, b = getattr(found, name), getattr(expected, name)
            np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-11 * np.abs(b).max())


def test_displacement_seeds_are_the_transpose_of_solution_rates(disc, rng):
    table, equations, n = disc.contact.table, disc.layout.equations, disc.layout.n_equations
    points = np.array([3, 20, 20, 47])
    solution, seed = rng.standard_normal((n, 4)), rng.standard_normal((4, 2, 3))
    moved, pulled = np.zeros((51, 2, 4)), np.zeros((n + 1, 3))
    add_solution_rates(table, equations, solution, moved)
    add_displacement_seeds(table, points, seed, equations, pulled)
    np.testing.assert_allclose(
        pulled[:-1].T @ solution, np.einsum("kim,kip->mp", seed, moved[points]), atol=1e-11
    )


def test_point_adjoint_is_the_field_of_the_adjoint_coefficients(disc, rng):
    points = np.array([50, 2, 17])
    adjoint, out = rng.standard_normal((disc.layout.n_equations + 1, 3)), np.empty((3, 2, 3))
    adjoint[-1] = 0.0
    equations, table = disc.layout.equations, disc.contact.table
    point_adjoint(table, points, adjoint, equations, out)
    fields = np.zeros((51, 174))
    for k in range(51):
        near = slice(table.start[k], table.start[k + 1])
        fields[k, table.neighbours[near]] = table.phi[near]
    exact = np.einsum("ka,aim->kim", fields, adjoint[equations])
    np.testing.assert_allclose(out, exact[points], atol=1e-13)


def test_gradient_seeds_are_the_transpose_of_gradient_rates(drawn, disc, rng):
    """On d' and on B at the stress particles."""
    table = disc.table_at(drawn.points.stress)
    d, equations, n = drawn.end.d, disc.layout.equations, disc.layout.n_equations
    velocity = rng.standard_normal((2, 174, 2))
    shape = discretization_rates(disc, velocity)
    rates = point_table_rates(disc, table, velocity, shape.matrix)
    solution, seed = rng.standard_normal((n, 2)), rng.standard_normal((7, 4, 1))
    f_rate = np.empty((7, 4, 2))
    gradient_rates(table.table, rates, d, equations, solution, f_rate)
    d_bar, grad_bar = np.zeros((n + 1, 1)), np.zeros((table.table.grad.size, 1))
    add_gradient_seeds(table.table, seed, d, equations, d_bar, grad_bar)
    back = d_bar[:-1, 0] @ solution
    for k in range(7):
        active = rates.active[rates.start[k, 0] : rates.start[k + 1, 0]]
        low, high = rates.start[k : k + 2, 1]
        here = slice(2 * table.table.start[k], 2 * table.table.start[k + 1])
        back[active] += grad_bar[here, 0] @ rates.grad[2 * low : 2 * high].reshape(-1, active.size)
    ahead = np.einsum("krs,kr->s", f_rate, seed[..., 0])
    np.testing.assert_allclose(back, ahead, rtol=1e-10)


def test_displacement_rates_at_fixed_coefficients(drawn, disc, velocity):
    """sum_I Phi_I' d_I at the contact points against central differences."""
    d = drawn.end.d
    rates = discretization_rates(disc, velocity)
    found = np.zeros((51, 2, 3))
    displacement_rates(disc.contact.table, rates.contact, d, found)
    sides = []
    for sign in (1, -1):
        moved = discretize(disc.body, disc.particles + sign * 1e-6 * velocity[0])
        table, out = moved.contact.table, np.zeros((51, 2))
        for k in range(51):
            near = slice(table.start[k], table.start[k + 1])
            out[k] = table.phi[near] @ d[table.neighbours[near]]
        sides.append(out)
    slope = (sides[0] - sides[1]) / 2e-6
    np.testing.assert_allclose(slope, found[..., 0], atol=1e-6 * np.abs(found).max())


@pytest.mark.parametrize("name", ["boundary_offsets[3]", "door_radius"])
def test_rates_of_every_step_of_the_path(random_design, name):
    """d', gaps, forces and history at several places in the path, not at its end only."""
    result = random_design
    rates = parameter_rates(result.model)
    p = rates.names.index(name)
    places = (20, 60, 104)
    found = DirectSweep(result.path, path_problem(result), rates).run(measured=places)
    assert set(found) == set(places)
    step = 1e-5
    plus, minus = (perturbed(result, name, s * step) for s in (1, -1))
    assert same_sequence(plus, result)
    assert same_sequence(minus, result)
    equations = result.path.discretization.layout.equations
    free = equations >= 0
    for place in places:
        a, b = plus.path.steps[place], minus.path.steps[place]
        here = found[place]
        exact = here.solution[equations[free], p]
        pairs = [
            ((a.d - b.d)[free], exact),
            (a.gap - b.gap, here.gap[:, p]),
            (a.force - b.force, here.force[:, :, p]),
            (a.after.variables - b.after.variables, here.history[:, :, p]),
        ]
        for difference, expected in pairs:
            scale = max(np.abs(expected).max(), 1e-3)
            np.testing.assert_allclose(
                difference / (2 * step), expected, rtol=0.0, atol=2e-5 * scale
            )


def end_rates(result, measured=None, history=True):
    """Rates at the end of the path; without history, those of the last step alone."""
    rates = parameter_rates(result.model)
    sweep, last = DirectSweep(result.path, path_problem(result), rates), len(result.path.steps) - 1
    if not history:
        end = result.path.steps[-1]
        return sweep.step(end, np.zeros((51, 3, rates.count)), sweep.explicit_loads([end])[0])
    return sweep.run(measured)[last]


def test_without_friction_the_last_step_alone_is_enough(frictionless):
    """Solving all steps with their histories gives the same rates: nothing is carried."""
    alone = end_rates(frictionless, history=False)
    every = end_rates(frictionless, measured=range(len(frictionless.path.steps)))
    scale = np.abs(every.solution).max()
    np.testing.assert_allclose(alone.solution, every.solution, rtol=0.0, atol=1e-12 * scale)


def test_with_friction_the_last_step_alone_is_not_enough(random_design):
    alone, swept = end_rates(random_design, history=False), end_rates(random_design)
    change = np.abs(alone.solution - swept.solution).max()
    assert change > 0.1 * np.abs(swept.solution).max()


def test_steps_passed_by_hand_on_all_that_matters(random_design):
    """No more is solved for than the displacements of points that stick in the next step."""
    last = len(random_design.path.steps) - 1
    solved = end_rates(random_design, measured=range(last + 1))
    passed = end_rates(random_design)
    for name in ("solution", "gap", "force"):
        a, b = getattr(passed, name), getattr(solved, name)
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-10 * np.abs(b).max())


def test_few_parameters_and_few_measures_are_solved_for_themselves(random_design):
    """With fewer of them than displacements handed on, both methods take the shorter way."""
    rates = parameter_rates(random_design.model)
    column = rates.names.index("door_radius")
    problem = path_problem(random_design)
    last = len(random_design.path.steps) - 1
    one = parameter_rates(
        random_design.model, ("door_radius",), np.empty((0, *random_design.particles.shape))
    )
    found = DirectSweep(random_design.path, problem, one).run()[last].gap[:, 0]
    expected = end_rates(random_design).gap[:, column]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
    wanted = _Wanted.of(random_design, ())
    whole = adjoint_gradient(random_design, wanted)
    seeds = wanted.functional.seeds[last]
    alone = Seeds(seeds.gap[-1:], seeds.force[-1:], seeds.gradient[-1:])
    single = AdjointSweep(random_design.path, problem, wanted.table, 1).run({last: alone})
    exact = whole.particles[-1] - wanted.functional.particles[-1]
    np.testing.assert_allclose(
        single.particles[0], exact, rtol=0.0, atol=1e-10 * np.abs(exact).max()
    )


def test_a_point_that_goes_on_sticking_hands_on_its_natural_coordinate_alone(random_design):
    problem, steps = path_problem(random_design), random_design.path.steps
    seen = set()
    for step, following in pairwise(steps):
        used = sticking(following)
        points, directions = handed_on(used, local_contact(problem, step, used))
        assert set(points) == set(np.flatnonzero(following.after.state == STICK))
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-14)
        for i in set(points):
            went_on = step.after.state[i] == STICK and step.before.state[i] != OPEN
            assert np.sum(points == i) == (1 if went_on else 2)
            seen.add(bool(went_on))
    assert seen == {True, False}
    assert sticking(None).size == 0


def test_factors_beyond_the_memory_are_made_again(drawn_model):
    """The first that fit are kept; the sensitivities are the same to the last bit."""
    one = sm.analyze(drawn_model, keep_factors=True)
    size = one.path.steps[0].factor.nbytes / 2**30
    few = analyze_particles(drawn_model, drawn_model.drawn_particles, factor_memory=10.5 * size)
    assert [step.factor is not None for step in few.path.steps] == [True] * 10 + [False] * 95
    for method in ("direct", "adjoint"):
        expected, found = (sm.differentiate(r, method=method) for r in (one, few))
        np.testing.assert_array_equal(found.von_mises, expected.von_mises)
        np.testing.assert_array_equal(found.reaction, expected.reaction)


def test_particle_gradient_contracts_to_the_design_gradient(random_design):
    """dm/dp = sum dm/dX . V for every measure, by either method."""
    design = sm.differentiate(random_design)
    velocity = random_design.model.design_velocity
    by_input = particle_gradient(random_design)
    for name in ("von_mises", "gap", "gap_square_sum", "reaction"):
        exact = np.atleast_2d(getattr(design, name))
        contracted = np.einsum("mai,pai->mp", by_input["particles"][name], velocity)
        scale = np.abs(exact).max()
        np.testing.assert_allclose(contracted, exact[:, :25], rtol=0.0, atol=1e-10 * scale)
        np.testing.assert_allclose(by_input["door_radius"][name][:, 0], exact[:, 25], rtol=1e-9)


def test_particle_gradient_is_the_same_by_direct_and_adjoint(frictionless):
    """And with respect to scalars, which both methods take from the same sweep."""
    direct, adjoint = (
        particle_gradient(frictionless, ("c10", "depth"), method)
        for method in ("direct", "adjoint")
    )
    assert set(direct) == set(adjoint) == {"particles", "c10", "depth"}
    for wrt in direct:
        for name in ("von_mises", "reaction"):
            scale = np.abs(direct[wrt][name]).max()
            np.testing.assert_allclose(
                adjoint[wrt][name], direct[wrt][name], rtol=0.0, atol=1e-9 * scale
            )


def test_common_translation_of_seal_and_door_changes_nothing(flat):
    """Flat door: moving all particles sideways is no change at all."""
    by_particles = particle_gradient(flat)["particles"]
    sideways = np.abs(by_particles["von_mises"][:, :, 0].sum(axis=1))
    size = np.abs(by_particles["von_mises"]).sum(axis=(1, 2))
    np.testing.assert_array_less(sideways, 1e-8 * size)


def test_scaling_of_stiffnesses_scales_stresses_and_forces(random_design):
    """Homogeneity: stresses and reactions are of degree one in all moduli and penalties."""
    names = ("c10", "c01", "bulk_modulus", "normal_penalty", "tangent_penalty")
    found = sm.differentiate(random_design, names)
    values = np.array([80.0, 20.0, 8e4, 1e4, 1e2])
    stress, force = found.von_mises[:, 25:] @ values, found.reaction[:, 25:] @ values
    np.testing.assert_allclose(stress, random_design.von_mises, rtol=1e-7)
    np.testing.assert_allclose(force, random_design.reaction[-1], rtol=1e-6)
    gap = np.abs(found.gap[:, 25:] * values)
    np.testing.assert_array_less(
        np.abs((found.gap[:, 25:] * values).sum(axis=1)), 1e-7 * gap.sum(axis=1)
    )


def test_stress_rate_uses_the_same_points_as_the_measure(drawn):
    table = drawn.path.discretization.table_at(drawn.points.stress).table
    np.testing.assert_array_equal(
        von_mises_at(table, drawn.end.d, drawn.model.material)[0], drawn.von_mises
    )
    assert measure_count(drawn) == 7 + len(drawn.gap) + 2


def test_unknown_names_are_refused(drawn):
    with pytest.raises(ValueError, match="stiffness"):
        sm.differentiate(drawn, ("stiffness",))
    with pytest.raises(ValueError, match="complex"):
        sm.differentiate(drawn, method="complex")
    assert "stiffness" not in SCALARS


def test_failed_path_has_no_sensitivities(buckled):
    with pytest.raises(sm.LoadPathError):
        sm.differentiate(buckled)
