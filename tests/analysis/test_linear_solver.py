"""Equation numbers, scatter and factors: both layouts hold the same matrix and solve it."""

from pathlib import Path

import numpy as np
import pytest
from bodies import dense, internal, square, wave

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.equilibrium.eigenmodes import nearest_mode
from seal_mdao.equilibrium.linear_solver import SOLVERS, BandedStorage
from seal_mdao.equilibrium.tangent_layout import equation_numbers, tangent_layout

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def pair(rng):
    """The same deformed body in both layouts, with its two tangents."""
    state = rng.bit_generator.state
    out = []
    for solver in ("banded", "superlu"):
        rng.bit_generator.state = state
        disc = square(rng, solver=solver)
        d = np.where(disc.body.fixed, 0.0, wave(disc, 0.05))
        out.append((disc.layout, internal(disc, d)[1], disc))
    return out


def by_particle(layout, matrix):
    """Rows and columns in the order of the free components of the particles."""
    order = layout.equations[layout.equations >= 0]
    return matrix[np.ix_(order, order)]


def test_both_layouts_hold_the_same_matrix(pair):
    first, second = (by_particle(layout, dense(layout, values)) for layout, values, _ in pair)
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("transposed", [False, True])
def test_factors_solve_one_and_several_right_hand_sides(pair, rng, transposed):
    """Of an unsymmetric matrix: a skew part is added within the pattern."""
    for layout, values, _ in pair:
        matrix = dense(layout, values)
        skew = values.copy()
        skew[:-1] *= 1.0 + 0.1 * rng.standard_normal(skew.size - 1)
        matrix = dense(layout, skew)
        rhs = rng.standard_normal((layout.n_equations, 3))
        exact = np.linalg.solve(matrix.T if transposed else matrix, rhs)
        factor = layout.factorize(skew.copy())
        tolerance = 1e-14 * np.linalg.cond(matrix) * np.abs(exact).max()
        for found, expected in (
            (factor.solve(rhs, transposed=transposed), exact),
            (factor.solve(rhs[:, 0].copy(), transposed=transposed), exact[:, 0]),
        ):
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance)


def test_factors_leave_the_matrix_each_other_and_the_right_hand_side_as_they_are(pair, rng):
    for layout, values, _ in pair:
        given, rhs = values.copy(), rng.standard_normal(layout.n_equations)
        before = rhs.copy()
        factor = layout.factorize(given)
        found = factor.solve(rhs)
        layout.factorize(2.0 * given)
        np.testing.assert_array_equal(given, values)
        np.testing.assert_array_equal(factor.solve(rhs), found)
        np.testing.assert_array_equal(rhs, before)
        assert factor.exact() is factor


def test_singular_tangent_is_an_error(pair):
    for layout, values, _ in pair:
        with pytest.raises(np.linalg.LinAlgError, match="singular"):
            layout.factorize(np.zeros_like(values))


def test_equations_number_the_free_components_once(pair):
    for layout, _, disc in pair:
        fixed = disc.body.fixed
        assert np.all(layout.equations[fixed] == -1)
        np.testing.assert_array_equal(
            np.sort(layout.equations[~fixed]), np.arange(layout.n_equations)
        )


def test_gather_and_reduce_are_inverse_on_free_components(pair, rng):
    for layout, _, disc in pair:
        vector = rng.standard_normal(layout.n_equations)
        spread = layout.gather(vector)
        np.testing.assert_array_equal(layout.reduce(spread), vector)
        assert not spread[disc.body.fixed].any()
        several = rng.standard_normal((layout.n_equations, 2))
        np.testing.assert_array_equal(layout.gather(several)[..., 1], layout.gather(several[:, 1]))


def test_components_can_be_fixed_one_by_one(rng):
    """A roller: the solution is zero in the fixed component only."""
    disc = square(rng, fixed="nothing")
    fixed = np.zeros((36, 2), bool)
    fixed[:6, 0], fixed[0, 1] = True, True
    tables = [disc.cells.table]
    layout = tangent_layout(equation_numbers(fixed, tables), tables, solver="banded")
    assert layout.n_equations == 72 - 7
    np.testing.assert_array_equal(layout.equations < 0, fixed)


def test_unknown_solver_is_refused(rng):
    disc = square(rng)
    with pytest.raises(ValueError, match="solver"):
        tangent_layout(disc.layout.equations, [disc.cells.table], solver="cholesky")
    assert "cholesky" not in SOLVERS


def test_automatic_choice_takes_the_band_for_a_ring_and_compressed_columns_for_wide_bodies(rng):
    narrow = square(rng, n=6).layout
    wide = square(rng, n=40).layout
    assert isinstance(narrow.storage, BandedStorage)
    assert not isinstance(wide.storage, BandedStorage)


def test_equations_are_numbered_with_the_particles_that_averages_couple(tmp_path):
    """Numbered for the cells alone, the band of this bulb was a third wider, too wide for a band."""
    text = (EXAMPLES / "ten_year_seal.toml").read_text(encoding="utf-8")
    text = text.replace("duration = ", "steps = 1\nduration = ").replace(
        "friction = 0.25",
        'friction = 0.25\ncontact_points = "averages"\nnormal_penalty = 1e4\ntangent_penalty = 5e2',
    )
    (tmp_path / "bulb.toml").write_text(text, encoding="utf-8")
    seal = sm.build_seal(sm.read_seal_file(tmp_path / "bulb.toml"))
    disc = discretize(seal.body, seal.nominal_particles, seal.definitions)
    tables = [disc.cells.raw, *(own.raw for own in disc.tables if own is not None)]
    of_cells = tangent_layout(seal.body.equations(), tables, disc.transformation, "banded")
    assert disc.layout.storage.width < of_cells.storage.width
    assert isinstance(disc.layout.storage, BandedStorage)


@pytest.mark.parametrize("solver", ["banded", "superlu", "pardiso"])
def test_factors_know_the_sign_of_eigenvalues(rng, solver):
    """A tangent shifted past its lowest eigenvalues; the determinant of an unsymmetric one."""
    if solver == "pardiso":
        pytest.importorskip("pypardiso")
    disc = square(rng, solver=solver)
    layout, values = (
        disc.layout,
        internal(disc, np.where(disc.body.fixed, 0.0, wave(disc, 0.05)))[1],
    )
    lowest = np.linalg.eigvalsh(dense(layout, values))[:3]
    diagonal = layout.storage.diagonal()

    def shifted(shift, skew=0.0):
        buffer = values.copy()
        buffer[diagonal] -= shift
        buffer[:-1] *= 1.0 + skew * rng.standard_normal(buffer.size - 1)
        return buffer

    between = np.array([0.9 * lowest[0], 0.5 * lowest[:2].sum(), 0.5 * lowest[1:].sum()])
    for place, shift in enumerate(between):
        factor = layout.factorize(shifted(shift), symmetric=True)
        assert factor.positive == (place == 0)
        value, mode = nearest_mode(factor, layout.n_equations, True, negative=place > 0)
        exact = lowest[0] - shift if place == 0 else lowest[place - 1] - shift
        assert value == pytest.approx(exact, rel=1e-5)
        residual = dense(layout, shifted(shift)) @ mode - value * mode
        assert np.abs(residual).max() < 1e-4 * abs(lowest[2])
    if layout.storage.has_sign:
        for shift in between:
            unsymmetric = shifted(shift, skew=1e-3)
            sign = np.linalg.slogdet(dense(layout, unsymmetric))[0]
            assert layout.factorize(unsymmetric).positive == (sign > 0.0)
