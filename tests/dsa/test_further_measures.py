"""Optional measures: values, direct against adjoint, the component."""

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.measures.measure import Measure
from seal_mdao.seals.door.door_seal import FURTHER, STANDARD

NAMES = tuple(measure.name for measure in FURTHER)
PARAMETERS = ("door_radius", "normal_penalty", "tangent_penalty", "friction", "c10", "c01", "depth")


@pytest.fixture(scope="module")
def by_method(random_design):
    return {
        method: sm.differentiate(random_design, PARAMETERS, (*STANDARD, *NAMES), method)
        for method in ("direct", "adjoint")
    }


def measured(result, name):
    """Values of a measure of the door seal by its name."""
    return result.value(*result.measures((name,)))


@pytest.mark.parametrize("name", NAMES)
def test_direct_and_adjoint_agree(by_method, name):
    direct, adjoint = (np.atleast_2d(by_method[method][name]) for method in ("direct", "adjoint"))
    scale = np.abs(direct).max(axis=0)
    assert (np.abs(direct - adjoint) <= 1e-9 * scale).all()


def test_the_measures_of_always_do_not_change_with_the_further_ones(random_design, by_method):
    alone = sm.differentiate(random_design, PARAMETERS, method="adjoint")
    for name in ("von_mises", "gap", "reaction"):
        expected, found = alone[name], by_method["adjoint"][name]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


class Undefined(Measure):
    """A stress of inverted material: neither the value nor the derivatives are numbers."""

    name = "undefined"
    scalar = True

    def size(self, seal):
        return 1

    def evaluate(self, result, partials):
        partials.gradient()[0, -1] = np.nan
        return np.nan


@pytest.mark.parametrize("method", ["direct", "adjoint"])
def test_a_measure_without_a_value_leaves_the_derivatives_of_the_others(
    random_design, by_method, method
):
    measures = (Undefined(), *random_design.measures())
    found = sm.differentiate(random_design, PARAMETERS, measures, method)
    assert np.isnan(found["undefined"]).all()
    for name in ("von_mises", "gap", "reaction"):
        expected = by_method[method][name]
        np.testing.assert_allclose(
            found[name], expected, rtol=0.0, atol=1e-11 * np.abs(expected).max()
        )


def test_values_of_the_drawn_seal(nominal):
    """The norm bounds the stress, the patches press, the curve ends at the reaction."""
    stress = nominal.stress_field().max()
    assert stress <= measured(nominal, "stress_norm")[0] <= 1.1 * stress
    left, right = measured(nominal, "patch_pressure")
    deepest = 1e4 * nominal.max_penetration
    assert 0.5 * deepest < max(left, right) <= deepest
    assert min(left, right) > 5.0
    curve = measured(nominal, "reaction_curve")
    assert nominal.measure("reaction_curve").travels == (2.0, 4.0, 6.0, 8.0, 10.0)
    assert curve[-1] == nominal.reaction[-1, 1]
    # seven points 0.99 mm apart: their sum is the trapezoidal rule
    assert measured(nominal, "gap_square_integral")[0] == pytest.approx(
        nominal.gap_square_sum, rel=0.05
    )


@pytest.mark.parametrize("mode", ["fwd", "rev"])
def test_totals_of_the_group(mode, tmp_path):
    model = sm.door_seal(depth=7.0, n_steps=25, start=10.03)
    problem = om.Problem(
        sm.SealGroup(seal=model, measures=(*STANDARD, *NAMES)), reports=None, work_dir=tmp_path
    )
    problem.setup(mode=mode)
    problem.run_model()
    result = sm.analyze(model, keep_factors=True)
    exact = sm.differentiate(result, measures=NAMES)
    for name in NAMES:
        np.testing.assert_array_equal(problem.get_val(name), measured(result, name))
        totals = problem.compute_totals([name], ["boundary_offsets", "door_radius"])
        found = np.hstack([totals[name, w] for w in ("boundary_offsets", "door_radius")])
        np.testing.assert_allclose(
            found, np.atleast_2d(exact[name]), rtol=0.0, atol=1e-9 * np.abs(exact[name]).max()
        )


def test_unknown_repeated_and_empty_measures_are_refused(nominal):
    with pytest.raises(ValueError, match="stress_nrom"):
        sm.differentiate(nominal, measures=("stress_nrom",))
    with pytest.raises(ValueError, match="two measures named"):
        sm.SealGroup(measures=("stress_norm", "stress_norm"))
    with pytest.raises(ValueError, match="must be a sequence of measures"):
        sm.SealGroup(measures="stress_norm")
    shallow = sm.door_seal(depth=1.0, n_steps=15)
    problem = om.Problem(sm.SealGroup(seal=shallow, measures=("reaction_curve",)), reports=None)
    with pytest.raises(ValueError, match="the seal has no measure 'reaction_curve'"):
        problem.setup()
