"""Same inputs, same bits, whatever was computed in between."""

import numpy as np

import seal_mdao as sm
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp  # noqa: F401
from seal_mdao.verification.differences import contact_states

RADIUS = {"door_radius": 4.1}


def bits(result):
    """Everything of a result that a user can see, as bytes."""
    parts = [result.reaction, result.deformed(), result.newton_iterations, result.von_mises]
    parts += [result.gap, np.array(result.gap_square_sum), contact_states(result)]
    return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)


def test_analysis_is_repeated_bit_for_bit_after_others(drawn_model, random_offsets):
    """Other designs, other models, a failed path and sensitivities come in between."""
    first = sm.analyze(drawn_model, random_offsets, RADIUS)
    sm.analyze(drawn_model, -random_offsets, {"door_radius": 3.9})
    sm.analyze(sm.door_seal(door="flat", depth=1.0, n_steps=15))
    sm.analyze(sm.door_seal(newton=sm.NewtonOptions(max_iterations=4, max_cuts=0)))
    sm.differentiate(first, method="adjoint")
    second = sm.analyze(drawn_model, random_offsets, RADIUS)
    assert bits(first) == bits(second)


def test_keeping_factors_and_watching_change_no_bit(drawn_model, random_offsets, random_design):
    watched = sm.analyze(drawn_model, random_offsets, RADIUS, callback=lambda step: None)
    assert bits(watched) == bits(random_design)


def test_equal_models_give_the_same_bits(random_design, random_offsets, tight):
    again = sm.analyze(sm.door_seal(newton=tight), random_offsets.copy(), RADIUS)
    assert bits(again) == bits(random_design)


def test_sensitivities_are_repeated_bit_for_bit(random_design, drawn):
    for method in ("direct", "adjoint"):
        first = sm.differentiate(random_design, method=method)
        sm.differentiate(drawn, method="adjoint")
        second = sm.differentiate(random_design, method=method)
        for name in ("von_mises", "gap", "gap_square_sum", "reaction"):
            np.testing.assert_array_equal(first[name], second[name])


def test_sensitivities_with_and_without_kept_factors_have_the_same_bits(
    random_design, drawn_model, random_offsets
):
    bare = sm.analyze(drawn_model, random_offsets, RADIUS)
    assert bare.path.steps[-1].factor is None
    for method in ("direct", "adjoint"):
        with_factors = sm.differentiate(random_design, method=method)
        without = sm.differentiate(bare, method=method)
        np.testing.assert_array_equal(with_factors.von_mises, without.von_mises)
        np.testing.assert_array_equal(with_factors.gap, without.gap)
