"""BLAS threads during analyses: one inside, the number from before outside, whatever happens."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import numpy as np
import pytest
from scipy.linalg import lapack
from threadpoolctl import threadpool_info, threadpool_limits

import seal_mdao as sm
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.errors import GeometryError

assert lapack  # SciPy's own BLAS library is loaded before anything is counted
SHORT = {"depth": 1.0, "n_steps": 8}


def blas_threads():
    return [
        library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"
    ]


@pytest.fixture(autouse=True)
def two_threads():
    """Two BLAS threads before and after, whatever the machine's number is."""
    with threadpool_limits(2, user_api="blas"):
        yield
        assert set(blas_threads()) == {2}


def test_one_thread_inside_and_the_number_from_before_outside():
    with one_blas_thread:
        assert set(blas_threads()) == {1}
        with one_blas_thread:
            assert set(blas_threads()) == {1}
        assert set(blas_threads()) == {1}
    assert set(blas_threads()) == {2}


def test_the_last_to_leave_restores_not_the_first_to_enter():
    """The order that left one thread for ever: A enters, B enters, A leaves, B leaves."""
    a_inside, b_inside, a_left = Event(), Event(), Event()

    def first():
        with one_blas_thread:
            a_inside.set()
            b_inside.wait(60)
        a_left.set()

    def second():
        a_inside.wait(60)
        with one_blas_thread:
            b_inside.set()
            a_left.wait(60)
            return blas_threads()

    with ThreadPoolExecutor(2) as pool:
        pool.submit(first)
        inside = pool.submit(second).result()
    assert set(inside) == {1}


def test_analyses_restore_the_number_of_threads():
    result = sm.analyze(sm.door_seal(**SHORT))
    assert set(blas_threads()) == {2}
    sm.differentiate(result, method="direct")
    sm.differentiate(result, method="adjoint")


def test_failed_analyses_restore_the_number_of_threads():
    few = sm.NewtonOptions(max_iterations=1, max_cuts=0, damped_iterations=1)
    assert not sm.analyze(sm.door_seal(depth=2.0, n_steps=2, newton=few)).converged
    assert set(blas_threads()) == {2}
    outward = np.full(25, 0.9)
    with pytest.raises(GeometryError):
        sm.analyze(sm.door_seal(start=9.51), outward)
    assert set(blas_threads()) == {2}

    def stop(step):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sm.analyze(sm.door_seal(**SHORT), callback=stop)


def test_concurrent_analyses_restore_the_number_of_threads_when_one_fails():
    few = sm.NewtonOptions(max_iterations=1, max_cuts=0, damped_iterations=1)
    models = [sm.door_seal(**SHORT, friction=mu) for mu in (0.1, 0.2, 0.3)]
    models.append(sm.door_seal(depth=2.0, n_steps=2, newton=few))
    inside = []

    def analyze(model):
        return sm.analyze(model, callback=lambda step: inside.append(set(blas_threads())))

    with ThreadPoolExecutor(4) as pool:
        converged = [result.converged for result in pool.map(analyze, models)]
    assert converged == [True, True, True, False]
    assert len(inside) >= 24
    assert all(seen == {1} for seen in inside)


@pytest.mark.parametrize("method", ["direct", "adjoint"])
def test_threads_share_a_result(method):
    """Its path, kept factors, tables and places of the measures, none of them touched before."""

    def analysis():
        return sm.analyze(sm.door_seal(depth=2.0, n_steps=16), keep_factors=True)

    exact, result = sm.differentiate(analysis(), method=method), analysis()
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: sm.differentiate(result, method=method), range(4)))
    for rates in found:
        for name in ("von_mises", "gap", "reaction"):
            np.testing.assert_array_equal(rates[name], exact[name])


BITS = """
import hashlib, json
from concurrent.futures import ThreadPoolExecutor
import numpy as np
import scipy.linalg
import seal_mdao as sm
from threadpoolctl import threadpool_info

def blas():
    return [x["num_threads"] for x in threadpool_info() if x["user_api"] == "blas"]

def bits(seed):
    model = sm.door_seal(depth=1.5, n_steps=12)
    offsets = np.random.default_rng(seed).uniform(-0.1, 0.1, model.n_offsets)
    result = sm.analyze(model, offsets, {"door_radius": 4.0 + 0.01 * seed}, keep_factors=True)
    rates = sm.differentiate(result, ("door_radius", "friction"), method=METHODS[seed % 2])
    everything = [
        result.deformed(), result.reaction, result.area, result.stress_field(), result.contact.gap,
        result.von_mises, result.gap, result.gap_square_sum, rates.von_mises, rates.gap,
        rates.gap_square_sum, rates.reaction,
    ]
    return [hashlib.sha256(np.ascontiguousarray(x).tobytes()).hexdigest() for x in everything]

METHODS = ("direct", "adjoint")
seeds = range(4)
before = blas()
serial = [bits(seed) for seed in seeds]
with ThreadPoolExecutor(4) as pool:
    threaded = list(pool.map(bits, seeds))
print(json.dumps([serial, threaded, before, blas()]))
"""


def test_analyses_in_four_threads_give_the_bits_of_serial_ones():
    """With two BLAS threads, on which both the rounding and the interleaving depend."""
    done = subprocess.run(
        [sys.executable, "-c", BITS], check=False, text=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "2"},
        capture_output=True, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    serial, threaded, before, after = json.loads(done.stdout.splitlines()[-1])
    assert threaded == serial
    assert after == before
