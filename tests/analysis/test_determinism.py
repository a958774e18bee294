"""Same inputs, same bits, whatever was computed in between."""

import gc
import os
import subprocess
import sys

import numpy as np
import psutil
import pytest
from verification.differences import contact_states

import seal_mdao as sm
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp  # noqa: F401

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


def test_sensitivities_are_repeated_bit_for_bit(random_design, nominal):
    for method in ("direct", "adjoint"):
        first = sm.differentiate(random_design, method=method)
        sm.differentiate(nominal, method="adjoint")
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


BITS = """
import hashlib
import numpy as np
import seal_mdao as sm
seal = sm.door_seal(depth=3.0, n_steps=35)
result = sm.analyze(seal, np.linspace(-0.1, 0.1, 25), {"door_radius": 4.1})
rates = sm.differentiate(result)
parts = result.deformed(), result.reaction, result.von_mises, result.gap, rates.von_mises, rates.gap
print(hashlib.sha256(b"".join(np.ascontiguousarray(x).tobytes() for x in parts)).hexdigest())
"""


@pytest.mark.long
def test_number_of_blas_threads_changes_no_bit():
    found = set()
    for number in ("1", "2", "8"):
        threads = dict.fromkeys(
            ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), number
        )
        done = subprocess.run(
            [sys.executable, "-c", BITS], env={**os.environ, **threads}, check=True,
            capture_output=True, text=True,
        )  # fmt: skip
        assert len(done.stdout.split()) == 1
        found.add(done.stdout)
    assert len(found) == 1


@pytest.mark.long
def test_memory_stays_flat_over_many_analyses():
    """Of designs that differ, with what OpenMDAO's component keeps: one result stays, not all."""
    seal, rng = sm.door_seal(depth=0.5, n_steps=10), np.random.default_rng(3)
    cache = sm.AnalysisCache(memory=0.0)

    def grown(count):
        for _ in range(count):
            offsets = rng.uniform(-0.1, 0.1, seal.n_offsets)
            assert cache.analyze(seal, offsets, keep_factors=True).converged
        gc.collect()
        return psutil.Process().memory_info().rss

    before = grown(10)
    # a result with the factors of its ten steps has 9 MB; forty of them would be 360
    assert grown(40) - before < 20e6


@pytest.mark.long
def test_random_designs_complete_and_their_order_changes_no_bit():
    """Up to the bounds of the designs, +-0.5 mm, some near +-0.2 mm."""
    rng, seal = np.random.default_rng(71), sm.door_seal()
    designs = [
        size * rng.uniform(-1.0, 1.0, seal.n_offsets) for size in (0.2, 0.5) for _ in range(8)
    ]
    found = [sm.analyze(seal, offsets) for offsets in designs]
    assert sum(result.converged for result in found) >= len(designs) - 1
    for result, offsets in zip(reversed(found), reversed(designs), strict=True):
        again = sm.analyze(seal, offsets)
        assert again.converged == result.converged
        if again.converged:
            assert bits(again) == bits(result)
