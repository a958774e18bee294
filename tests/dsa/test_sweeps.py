"""Both methods of differentiation along the path: what is solved and carried on, invariances."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from verification.differences import perturbed, same_sequence

import seal_mdao as sm
from seal_mdao.contact.friction import CARRIED, OPEN, STICK, XI
from seal_mdao.contact.rigid_forces import slip_slopes
from seal_mdao.dsa.adjoint import AdjointSweep
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.factors import blocks
from seal_mdao.dsa.parameters import parameter_rates
from seal_mdao.dsa.sensitivity import Wanted, adjoint_gradient, particle_gradient
from seal_mdao.measures.measure import stacked
from seal_mdao.seals.result import analyze_particles


def rates_of(result, names=("door_radius",)):
    """Rates of all offsets, then scalars."""
    return parameter_rates(result.seal.design_velocity, names)


def test_blocks_cover_all_steps_in_order(monkeypatch):
    monkeypatch.setattr("seal_mdao.dsa.factors.BLOCK_BYTES", 8 * 100 * 3 * 4)
    assert [list(block) for block in blocks(range(9, -1, -1), 100, 3)] == [
        [9, 8, 7, 6], [5, 4, 3, 2], [1, 0],
    ]  # fmt: skip
    assert [list(block) for block in blocks([5, 2], 10**6, 3)] == [[5], [2]]


def test_short_blocks_give_the_same_sensitivities(nominal, monkeypatch):
    whole = [sm.differentiate(nominal, method=method) for method in ("direct", "adjoint")]
    monkeypatch.setattr("seal_mdao.dsa.factors.BLOCK_BYTES", 8 * 334 * 26 * 10)
    for method, expected in zip(("direct", "adjoint"), whole, strict=True):
        found = sm.differentiate(nominal, method=method)
        for name in ("von_mises", "gap", "reaction"):
            a, b = found[name], expected[name]
            np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-11 * np.abs(b).max())


@pytest.mark.parametrize("name", ["boundary_offsets[3]", "door_radius"])
def test_rates_of_every_step_of_the_path(random_design, name):
    """d', gaps, forces and history at several places in the path, not at its end only."""
    result = random_design
    p = 3 if name.startswith("boundary") else 25
    places, door = (20, 60, 104), result.path.index_of("door")
    found = DirectSweep(result.path, rates_of(result)).run(measured=places)
    assert set(found) == set(places)
    step = 1e-5
    plus, minus = (perturbed(result, name, s * step) for s in (1, -1))
    assert same_sequence(plus, result)
    assert same_sequence(minus, result)
    equations = result.path.discretization.layout.equations
    free = equations >= 0
    for place in places:
        a, b = plus.path.steps[place], minus.path.steps[place]
        here, one, other = found[place], a.responses[door], b.responses[door]
        contact = [rates[..., p] for rates in here.terms[door]]
        pairs = [
            ((a.d - b.d)[free], here.solution[equations[free], p]),
            (one.force - other.force, contact[0]),
            (one.gap - other.gap, contact[2][:, 0]),
            (one.history.variables - other.history.variables, here.history[door][..., p]),
        ]
        for difference, expected in pairs:
            scale = max(np.abs(expected).max(), 1e-3)
            np.testing.assert_allclose(
                difference / (2 * step), expected, rtol=0.0, atol=2e-5 * scale
            )


def end_rates(result, measured=None, history=True):
    """Rates at the end of the path; without history, those of the last step alone."""
    rates = rates_of(result)
    sweep, last = DirectSweep(result.path, rates), len(result.path.steps) - 1
    if not history:
        # in the block of the whole sweep: in another one the products are rounded otherwise
        size = result.path.discretization.layout.n_equations
        *_, block = blocks(range(last + 1), size, rates.count)
        steps, none = [result.path.steps[place] for place in block], np.zeros((51, 3, rates.count))
        return sweep.step(steps[-1], (None, none), sweep.explicit_loads(steps)[-1])
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
    pairs = zip(
        (passed.solution, *passed.terms[1]), (solved.solution, *solved.terms[1]), strict=True
    )
    for a, b in pairs:
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-10 * np.abs(b).max())


def test_steps_passed_by_with_incremental_friction(tight):
    """Slip begins again at every step, so points that stay in stick carry their place."""
    model = sm.door_seal(friction_history="incremental", depth=3.0, n_steps=35, newton=tight)
    result = sm.analyze(model, keep_factors=True)
    solved = end_rates(result, measured=range(len(result.path.steps))).solution
    scale = np.abs(solved).max()
    np.testing.assert_allclose(end_rates(result).solution, solved, rtol=0.0, atol=1e-10 * scale)


def test_few_parameters_and_few_measures_are_solved_for_themselves(random_design):
    """With fewer of them than displacements carried on, both methods take the shorter way."""
    path, last = random_design.path, len(random_design.path.steps) - 1
    none = np.empty((0, *random_design.particles.shape))
    one = DirectSweep(path, parameter_rates(none, ("door_radius",))).run()
    for found, expected in zip(one[last].terms[1], end_rates(random_design).terms[1], strict=True):
        a, b = found[..., 0], expected[..., 25]
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-10 * np.abs(b).max())
    wanted = Wanted(random_design, random_design.measures())
    last_gap = random_design.measures(("gap",))[0]
    alone = stacked([replace(last_gap, points=last_gap.points[-1:]).of(random_design)[1]])
    single = AdjointSweep(path, path.discretization.table_at(alone.at), 1).run(alone.seeds)
    whole = wanted.by_name(adjoint_gradient(random_design, wanted, ()).particles)["gap"][-1]
    np.testing.assert_allclose(
        single.particles[0], whole, rtol=0.0, atol=1e-10 * np.abs(whole).max()
    )


def test_points_that_stay_in_stick_pass_no_sensitivity_on(random_design):
    """Their elastic slip does not change with the place where they stuck; of others that stick in the
    next step one direction is wanted."""
    term, path = random_design.term("door"), random_design.path
    every, place, seen = np.arange(51), path.index_of("door"), set()
    for step, following in pairwise(path.steps):
        before, now = step.before[place], step.responses[place]
        local = term.linearize(now, step.fraction, before, every)
        after = following.responses[place]
        used = term.uses_history(after)
        points, directions = term.carried_directions(now, after, local[used], used)
        assert np.unique(points).size == points.size
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-14)
        for i in np.flatnonzero(after.state == STICK):
            went_on = now.state[i] == STICK and before.state[i] != OPEN
            speeds = now.history.variables[i, 1], before.variables[i, 1]
            same_speed = np.isclose(*speeds, rtol=1e-14, atol=0.0)
            assert (i in points) != (went_on and same_speed)
            seen.add((bool(went_on), bool(same_speed)))
        assert set(points) <= set(np.flatnonzero(after.state == STICK))
    assert {went_on for went_on, _ in seen} == {True, False}


def test_slopes_of_the_elastic_slip_are_those_of_complex_steps(random_design):
    """d g_t / d x_n through xi0 and what is carried, of points that were open or in contact."""
    term, path = random_design.term("door"), random_design.path
    place, seen = path.index_of("door"), set()
    for step, following in pairwise(path.steps):
        now, after = step.responses[place], following.responses[place]
        used = np.flatnonzero(after.state == STICK)
        local = np.random.default_rng(4).standard_normal((used.size, *term.local_shape))
        slopes, out = local[:, [XI, CARRIED], :2], np.full((used.size, 2, 2), np.nan)
        xi, gap = after.history.variables[:, 0], after.gap
        slip_slopes(term.curve, used, now.history, xi, gap, local, out)
        for k, i in enumerate(used):
            for c in range(2):
                xi_0, size, carried = now.history.variables[i] + 1e-30j * np.array(
                    [slopes[k, 0, c], 0.0, slopes[k, 1, c]]
                )
                slip = size * (xi[i] - xi_0)
                if now.state[i] == OPEN:
                    slip *= gap[i] / (gap[i] - carried)
                else:
                    slip += carried
                np.testing.assert_allclose(out[k, 0, c], slip.imag / 1e-30, rtol=1e-12, atol=1e-14)
            seen.add(int(now.state[i]))
    assert seen == {OPEN, STICK}  # after slip as after stick


def test_factors_beyond_the_memory_are_made_again(drawn_model):
    """The first that fit are kept; the sensitivities are the same to the last bit."""
    one = sm.analyze(drawn_model, keep_factors=True)
    size = one.path.steps[0].factor.nbytes / 2**30
    few = analyze_particles(drawn_model, drawn_model.nominal_particles, factor_memory=10.5 * size)
    assert [step.factor is not None for step in few.path.steps] == [True] * 10 + [False] * 95
    for method in ("direct", "adjoint"):
        expected, found = (sm.differentiate(r, method=method) for r in (one, few))
        np.testing.assert_array_equal(found.von_mises, expected.von_mises)
        np.testing.assert_array_equal(found.reaction, expected.reaction)


def test_particle_gradient_contracts_to_the_design_gradient(random_design):
    """dm/dp = sum dm/dX . V for every measure, by either method."""
    design = sm.differentiate(random_design)
    velocity = random_design.seal.design_velocity
    measures = random_design.measures()
    by_input = particle_gradient(random_design, ("door_radius",), measures)
    for name in ("von_mises", "gap", "gap_square_sum", "reaction"):
        exact = np.atleast_2d(design[name])
        contracted = np.einsum("mai,pai->mp", by_input["particles"][name], velocity)
        scale = np.abs(exact).max()
        np.testing.assert_allclose(contracted, exact[:, :25], rtol=0.0, atol=1e-10 * scale)
        np.testing.assert_allclose(by_input["door_radius"][name][:, 0], exact[:, 25], rtol=1e-9)


def test_particle_gradient_is_the_same_by_direct_and_adjoint(frictionless):
    """And with respect to scalars, which both methods take from the same sweep."""
    direct, adjoint = (
        particle_gradient(frictionless, ("c10", "depth"), frictionless.measures(), method)
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
    by_particles = particle_gradient(flat, (), flat.measures())["particles"]
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


def test_unknown_names_are_refused(nominal):
    with pytest.raises(ValueError, match="stiffness"):
        sm.differentiate(nominal, ("stiffness",))
    with pytest.raises(ValueError, match="complex"):
        sm.differentiate(nominal, method="complex")


def test_failed_path_has_no_sensitivities(buckled):
    with pytest.raises(sm.LoadPathError):
        sm.differentiate(buckled)
