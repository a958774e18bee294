"""PARDISO gives the same solutions; without pypardiso the error names the extra."""

import gc
import glob
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from bodies import dense, internal, square, wave
from scipy.sparse import csr_array

import seal_mdao as sm
from seal_mdao.equilibrium.linear_solver import storage_for
from seal_mdao.equilibrium.pardiso import import_pypardiso
from seal_mdao.seals.door.door_seal import with_options


def test_missing_pypardiso_is_an_error_of_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "pypardiso", None)
    with pytest.raises(ImportError, match=r"seal_mdao\[pardiso\]") as raised:
        import_pypardiso()
    assert "\n" not in str(raised.value)


SEARCHING = """
import ctypes.util, glob

def search(*given, **more):
    raise AssertionError("MKL is searched for")

glob.glob = ctypes.util.find_library = search
from seal_mdao.equilibrium.pardiso import import_pypardiso
import_pypardiso()
"""


def test_mkl_beside_python_is_not_searched_for():
    """The search starts programs and walks through all folders of the environment."""
    pytest.importorskip("pypardiso")
    if not glob.glob(f"{sys.prefix}/lib/libmkl_rt*"):
        pytest.skip("MKL is elsewhere")
    subprocess.run([sys.executable, "-c", SEARCHING], check=True, timeout=120)


def test_factors_solve_and_outlive_the_next_factorisation(rng):
    pytest.importorskip("pypardiso")
    disc = square(rng, solver="pardiso")
    layout = disc.layout
    values = internal(disc, np.where(disc.body.fixed, 0.0, wave(disc, 0.05)))[1]
    values[: layout.storage.size] *= 1.0 + 0.1 * rng.standard_normal(layout.storage.size)
    matrix, rhs = dense(layout, values), rng.standard_normal((layout.n_equations, 3))
    first = layout.factorize(values)
    second = layout.factorize(2.0 * values)
    tolerance = 1e-14 * np.linalg.cond(matrix)
    for factor, share in ((first, 1.0), (second, 0.5)):
        exact = share * np.linalg.solve(matrix, rhs)
        back = share * np.linalg.solve(matrix.T, rhs)
        scale = max(np.abs(exact).max(), np.abs(back).max())
        assert np.abs(factor.solve(rhs) - exact).max() < tolerance * scale
        assert np.abs(factor.solve(rhs[:, 0]) - exact[:, 0]).max() < tolerance * scale
        assert np.abs(factor.solve(rhs, transposed=True) - back).max() < tolerance * scale
        assert factor.nbytes > 0


def random_tangent(rng):
    """A layout, a buffer with an unsymmetric tangent, and a right-hand side."""
    disc = square(rng, n=12, solver="pardiso")
    layout = disc.layout
    values = internal(disc, np.where(disc.body.fixed, 0.0, wave(disc, 0.05)))[1]
    values[: layout.storage.size] *= 1.0 + 0.1 * rng.standard_normal(layout.storage.size)
    return layout, values, rng.standard_normal(layout.n_equations)


def test_rough_factors_have_single_precision_and_exact_ones_double(rng):
    pytest.importorskip("pypardiso")
    layout, values, rhs = random_tangent(rng)
    matrix = dense(layout, values)
    rough = layout.factorize_roughly(values)
    condition = np.linalg.cond(matrix)
    for transposed, system in ((False, matrix), (True, matrix.T)):
        exact = np.linalg.solve(system, rhs)
        error = np.abs(rough.solve(rhs, transposed) - exact).max() / np.abs(exact).max()
        assert 1e-9 < error < np.finfo(np.float32).eps * condition
    found, expected = rough.exact().solve(rhs), layout.factorize(values).solve(rhs)
    np.testing.assert_array_equal(found, expected)
    assert rough.positive == layout.factorize(values).positive


def test_kept_factors_share_a_handle_and_leave_their_place_to_others(rng):
    pytest.importorskip("pypardiso")
    layout, values, rhs = random_tangent(rng)
    exact = layout.factorize(values).solve(rhs)
    kept = [layout.factorize(2.0**k * values) for k in range(6)]
    handle = kept[0].handle
    assert all(factor.handle is handle for factor in kept)
    assert len({factor.number for factor in kept}) == 6
    assert kept[2].exact() is kept[2]
    left = {kept.pop(1).number, kept.pop(3).number}
    more = [layout.factorize(8.0 * values) for _ in range(2)]
    last = layout.factorize(16.0 * values)
    assert left <= {factor.number for factor in (*more, last)}
    # powers of two scale every number of a factorisation exactly
    for factor, scale in zip((*kept, *more, last), (1, 4, 8, 32, 8, 8, 16), strict=True):
        np.testing.assert_allclose(scale * factor.solve(rhs), exact, rtol=1e-12)


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
def test_the_collector_may_take_the_handle_before_its_factors(rng):
    pytest.importorskip("pypardiso")
    layout, values, _ = random_tangent(rng)
    ring = [layout.factorize(values) for _ in range(3)]
    ring[0].handle.factors = ring  # the handle holds what holds it
    handle, layout = ring[0].handle, None
    handle.__del__()
    for factor in ring:
        factor.__del__()
    assert not handle._dropped
    del ring, handle, factor
    gc.collect()


def test_a_path_does_not_depend_on_whether_its_factors_are_kept():
    pytest.importorskip("pypardiso")
    model = sm.door_seal(depth=2.0, n_steps=10, solver="pardiso")
    plain, kept = (sm.analyze(model, keep_factors=keep) for keep in (False, True))
    assert np.array_equal(plain.displacement(), kept.displacement())
    again, once = (sm.differentiate(result, method="adjoint") for result in (plain, kept))
    assert np.array_equal(again.von_mises, once.von_mises)


def test_analysis_and_sensitivities_do_not_depend_on_the_solver(tight):
    pytest.importorskip("pypardiso")
    model = sm.door_seal(depth=3.0, n_steps=14, start=10.03, newton=tight)
    band, other = (
        sm.analyze(with_options(model, solver=solver), keep_factors=True)
        for solver in ("banded", "pardiso")
    )
    np.testing.assert_allclose(other.reaction, band.reaction, rtol=0.0, atol=1e-7)
    for method in ("direct", "adjoint"):
        found, expected = (sm.differentiate(r, method=method) for r in (other, band))
        scale = np.abs(expected.von_mises).max()
        np.testing.assert_allclose(found.von_mises, expected.von_mises, rtol=0.0, atol=1e-7 * scale)


def test_factors_that_are_kept_do_not_look_for_the_library_again(rng, monkeypatch):
    """pypardiso would walk through the whole environment for each."""
    pytest.importorskip("pypardiso")
    layout = square(rng, solver="pardiso").layout

    def walk(*args, **options):
        raise AssertionError("looks for the library")

    monkeypatch.setattr(glob, "glob", walk)
    values = np.zeros(layout.size)
    values[layout.storage.diagonal()] = 2.0
    kept = [layout.factorize(values.copy()) for _ in range(3)]
    ones = np.ones(layout.n_equations)
    for factor in kept:
        np.testing.assert_array_equal(factor.solve(ones), 0.5 * ones)


def test_threads_share_a_factor_and_a_storage(rng):
    """Each solves with both transposes, and factorises matrices of its own in between."""
    pytest.importorskip("pypardiso")
    disc = square(rng, n=12, solver="pardiso")
    layout = disc.layout
    values = internal(disc, np.where(disc.body.fixed, 0.0, wave(disc, 0.05)))[1]
    values[: layout.storage.size] *= 1.0 + 0.1 * rng.standard_normal(layout.storage.size)
    factor, rhs = layout.factorize(values.copy()), rng.standard_normal(layout.n_equations)
    expected = [factor.solve(rhs, transposed=flag) for flag in (False, True)]

    def solutions(scale):
        found = []
        for _ in range(20):
            other = layout.factorize(scale * values)
            found += [factor.solve(rhs, transposed=flag) for flag in (False, True)]
            found += [scale * other.solve(rhs, transposed=flag) for flag in (False, True)]
        return found

    with ThreadPoolExecutor(4) as pool:
        by_thread = list(pool.map(solutions, (1.0, 2.0, 4.0, 8.0)))
    # powers of two scale every number of a factorisation exactly
    for found in by_thread:
        for place, solution in enumerate(found):
            np.testing.assert_allclose(solution, expected[place % 2], rtol=1e-12)


def test_automatic_choice_for_a_wide_body_takes_pardiso_when_it_is_there(rng):
    pytest.importorskip("pypardiso")
    disc = square(rng, n=5)
    everything = csr_array(np.ones((25, 25)))
    storage = storage_for("auto", 18, 10_000, disc.layout.equations, everything)
    assert type(storage).__name__ == "PardisoStorage"


OPTIMIZE = """
import sys

import numpy as np
import openmdao.api as om
from scipy.sparse import eye_array

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import with_options
from seal_mdao.equilibrium.pardiso import import_pypardiso
from seal_mdao.seals.door.door_seal import with_options

driver, when = sys.argv[1:]
if when == "after PARDISO":
    import_pypardiso().spsolve(eye_array(9).tocsr(), np.ones(9))
a = np.random.default_rng(3).normal(size=(40, 20))
problem = om.Problem(reports=False)
cup = om.ExecComp("f = sum((dot(a, x) - 1.0) ** 4)", f=1.0, x=np.zeros(20), a=a)
problem.model.add_subsystem("cup", cup, promotes=["*"])
problem.model.add_design_var("x", lower=-0.2, upper=0.2)
problem.model.add_objective("f")
problem.driver = getattr(sm, driver)()
problem.setup()
problem.run_driver()
print(problem["x"].tobytes().hex())
"""


@pytest.mark.parametrize("driver", ["UnoDriver", "IpoptDriver"])
def test_bits_of_an_optimisation_do_not_hang_on_pardiso(driver):
    pytest.importorskip("pypardiso")
    said = [
        subprocess.run(
            [sys.executable, "-c", OPTIMIZE, driver, when],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()[-1]
        for when in ("alone", "after PARDISO")
    ]
    assert said[0] == said[1]
