"""Scenarios in an OpenMDAO model: exact partials of every aggregate, and what failures do."""

import re

import numpy as np
import openmdao.api as om
import pytest
from openmdao.utils.assert_utils import assert_check_partials

import seal_mdao as sm
from seal_mdao.components.aggregate_comp import ALWAYS, quantile_name

ENDINGS = (*ALWAYS, "q95")
MEASURES = ("gap_square_integral", "reaction")
OF = [f"{name}_{ending}" for name in MEASURES for ending in ENDINGS]
WRT = ["boundary_offsets", "door_radius", "c10"]


@pytest.fixture(scope="module")
def seal():
    """Short, with large steps; its middle opens."""
    return sm.door_seal(
        depth=8.0, n_steps=18, start=10.03, newton=sm.NewtonOptions(tolerance=1e-11)
    )


def scenarios():
    variations = (
        sm.Variation("friction"), sm.Variation("hardness", "factor", ("c10", "c01")),
        sm.Variation("door_radius", "shift"),
    )  # fmt: skip
    offsets = np.random.default_rng(2).normal(0.0, 0.03, (3, 25))
    return sm.Scenarios(
        variations,
        np.column_stack([[0.21, 0.26, 0.3], [0.93, 1.02, 1.1], [-0.07, 0.03, 0.09]]),
        offsets,
    )


def group_problem(seal, mode="auto", **options):
    options = {"scenarios": scenarios(), "measures": MEASURES, "workers": 0, **options}
    group = sm.ScenarioGroup(seal=seal, quantiles=(0.95,), parameters=("c10",), **options)
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("seal", group, promotes=["*"])
    problem.setup(mode=mode, force_alloc_complex=True)
    return problem


@pytest.fixture(scope="module")
def problem(seal):
    made = group_problem(seal)
    made.set_val("boundary_offsets", 0.05 * np.cos(np.arange(25)))
    made.run_model()
    return made


def test_every_aggregate_against_central_differences(problem):
    """Along one direction of all inputs; the quotient's own error from a second step."""
    ways = {"boundary_offsets": np.sin(np.arange(25.0)), "door_radius": 0.5, "c10": 20.0}
    start = {name: problem.get_val(name).copy() for name in ways}
    totals = problem.compute_totals(OF, WRT)

    def at(t):
        for name, way in ways.items():
            problem.set_val(name, start[name] + t * way)
        problem.run_model()
        return {name: problem.get_val(name).copy() for name in OF}

    h = 1e-5
    ends = {t: at(t * h) for t in (-2, -1, 1, 2)}
    at(0.0)
    for name in OF:
        exact = sum(totals[name, wrt] @ np.atleast_1d(way) for wrt, way in ways.items())
        near, far = ends[1][name] - ends[-1][name], ends[2][name] - ends[-2][name]
        fourth_order = (8.0 * near - far) / (12.0 * h)
        np.testing.assert_allclose(fourth_order, exact, rtol=0.0, atol=1e-5 * np.abs(exact).max())
        assert np.abs(exact).max() > 1e-4


def test_forward_and_reverse_are_the_same(seal, problem):
    tables = []
    for mode in ("fwd", "rev"):
        made = group_problem(seal, mode)
        made.set_val("boundary_offsets", 0.05 * np.cos(np.arange(25)))
        made.run_model()
        tables.append(made.compute_totals(OF, WRT, return_format="array"))
    assert np.abs(tables[0] - tables[1]).max() <= 1e-9 * np.abs(tables[0]).max()


def test_direct_and_adjoint_are_the_same(seal):
    tables = []
    for method in ("direct", "adjoint"):
        made = group_problem(seal, sensitivity=method)
        made.run_model()
        tables.append(made.compute_totals(OF, WRT, return_format="array"))
    assert np.abs(tables[0] - tables[1]).max() <= 1e-9 * np.abs(tables[0]).max()


@pytest.mark.long
def test_check_partials_is_clean(seal):
    made = group_problem(seal)
    np.random.seed(1)  # OpenMDAO draws directions from the global generator
    made.run_model()
    # a quarter of the default step: its error, 4e-5, falls with the square and more
    made.model.seal.scenarios.set_check_partial_options(
        wrt="door_radius", method="fd", form="central", step=1e-5, step_calc="abs"
    )
    data = made.check_partials(out_stream=None, compact_print=True)
    assert_check_partials(data, atol=1e-5, rtol=1e-5)


def test_values_are_those_of_single_analyses(seal, problem):
    """Each scenario by itself, from its own numbers."""
    offsets, chosen = problem.get_val("boundary_offsets"), scenarios()
    for number, (friction, hardness, shift) in enumerate(chosen.numbers):
        alone = sm.analyze(
            seal,
            offsets + chosen.offsets[number],
            {"friction": friction, "c10": 80.0 * hardness, "c01": 20.0 * hardness,
             "door_radius": 4.0 + shift},
        )  # fmt: skip
        row = problem.get_val("reaction_scenarios")[number]
        np.testing.assert_array_equal(row, alone.reaction[-1])
    assert problem.get_val("share_failed")[0] == 0.0
    assert problem.get_val("area")[0] == seal.area(offsets)[0]


@pytest.fixture(scope="module")
def failing(seal):
    """Scenarios of which the last one fails: its boundary is folded."""
    made = scenarios()
    offsets = made.offsets.copy()
    offsets[2, ::2] += 1.9
    offsets[2, 1::2] -= 1.9
    return sm.Scenarios(made.variations, made.numbers, offsets)


def test_a_failed_scenario_is_an_analysis_error(seal, failing):
    made = group_problem(seal, scenarios=failing)
    text = (
        "scenario 3 of 3 (friction = 0.3, hardness * 1.1, door_radius + 0.09, boundary offsets of "
    )
    with pytest.raises(om.AnalysisError, match=re.escape(text + "its own) failed: ")):
        made.run_model()
    assert (
        np.isnan(made.get_val("reaction_mean")).any()
        or np.isnan(made.get_val("reaction_scenarios")).all()
    )


def test_a_failed_scenario_is_left_out_and_counted(seal, failing):
    made = group_problem(seal, scenarios=failing, failed="leave_out")
    made.run_model()
    assert made.get_val("share_failed")[0] == pytest.approx(1 / 3)
    rows = made.get_val("reaction_scenarios")
    assert np.isnan(rows[2]).all()
    np.testing.assert_allclose(made.get_val("reaction_mean"), rows[:2].mean(axis=0), rtol=1e-14)
    totals = made.compute_totals(["reaction_mean"], ["door_radius"], return_format="array")
    assert np.isfinite(totals).all()
    assert np.abs(totals).max() > 0.0


def test_too_few_left_is_an_analysis_error(seal, failing):
    twice = sm.Scenarios(failing.variations, failing.numbers[1:], failing.offsets[1:])
    made = group_problem(seal, scenarios=twice, failed="leave_out")
    with pytest.raises(
        om.AnalysisError,
        match=r"1 of \d scenarios could not be analysed, but at least \d analyses must succeed",
    ):
        made.run_model()


def test_numbers_that_a_seal_cannot_have_are_refused_before_any_analysis(seal):
    wrong = sm.Scenarios((sm.Variation("friction"),), [[0.2], [-0.1]])
    with pytest.raises(
        ValueError, match=r"scenario 2 of 2 \(friction = -0.1\): friction must be a number"
    ):
        group_problem(seal, scenarios=wrong)
    with pytest.raises(ValueError, match="every level in option 'quantiles'"):
        sm.ScenarioGroup(seal=seal, scenarios=wrong, quantiles=(1.5,))


def test_complex_step_is_refused(seal):
    made = om.Problem(reports=None)
    group = sm.ScenarioGroup(seal=seal, scenarios=scenarios(), measures=("reaction",), workers=0)
    made.model.add_subsystem("seal", group, promotes=["*"])
    made.model.approx_totals(method="cs")
    made.setup(force_alloc_complex=True)
    made.run_model()
    with pytest.raises(RuntimeError, match="does not support complex steps"):
        made.compute_totals(["reaction_mean"], ["door_radius"])


def test_names_of_quantiles():
    assert [quantile_name(level) for level in (0.05, 0.5, 0.975)] == ["q5", "q50", "q97_5"]
