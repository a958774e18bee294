"""Equation numbers, blocks, and factors of block tridiagonal matrices against dense linear algebra."""

from pathlib import Path

import numpy as np
import pytest
from bodies import dense, internal, square, wave
from scipy.sparse import csr_array

import seal_mdao as sm
from seal_mdao.equilibrium import block_tridiagonal
from seal_mdao.equilibrium.block_tridiagonal import (
    BlockTridiagonal,
    block_ends,
    farthest_coupled,
)
from seal_mdao.equilibrium.corrected_factor import CorrectedFactor
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.equilibrium.eigenmodes import nearest_mode
from seal_mdao.equilibrium.tangent_layout import equation_numbers, tangent_layout

EXAMPLES = Path(__file__).parents[2] / "examples"
ENDS = np.array([4, 6, 11, 18, 20])


@pytest.fixture
def bent(rng):
    """A deformed body on springs: its layout, the entries of its tangent, and itself."""
    disc = square(rng, n=9, fixed="nothing")
    layout, values = disc.layout, internal(disc, wave(disc, 0.01))[1]
    diagonal = layout.storage.diagonal()
    values[diagonal] *= rng.uniform(1.05, 1.15, diagonal.size)
    assert len(layout.storage.blocks.rows) > 2
    return layout, values, disc


@pytest.fixture
def blocks(rng):
    """A storage with blocks of all sizes, random entries, and their matrix."""
    storage = BlockTridiagonal(ENDS)
    values, matrix = rng.standard_normal(storage.size), np.zeros((storage.n, storage.n))
    for own, stored in zip(storage.rows, storage.stored, strict=True):
        for column in range(own.start, own.stop):
            for row in range(stored.start, stored.stop):
                matrix[row, column] = values[storage.origins[column] + row]
    return storage, values, matrix


def pattern(ends):
    """Coupled equations of a block tridiagonal matrix, one component a particle."""
    block = np.searchsorted(ends, np.arange(ends[-1]), side="right")
    return np.abs(block[:, None] - block) <= 1


def test_every_entry_has_a_place_of_its_own(blocks):
    storage, values, matrix = blocks
    assert np.count_nonzero(matrix) == values.size == np.count_nonzero(pattern(ENDS))
    np.testing.assert_array_equal(matrix != 0.0, pattern(ENDS))
    np.testing.assert_array_equal(values[storage.diagonal()], np.diag(matrix))


@pytest.mark.parametrize("transposed", [False, True])
def test_factors_solve_one_and_several_right_hand_sides(blocks, rng, transposed):
    """Of an unsymmetric matrix."""
    storage, values, matrix = blocks
    rhs = rng.standard_normal((storage.n, 3))
    exact = np.linalg.solve(matrix.T if transposed else matrix, rhs)
    factor = storage.factorize(values)
    # rounding times condition, of the matrix and of its leading blocks
    worst = max(np.linalg.cond(matrix[:end, :end]) for end in ENDS)
    tolerance = 1e-14 * worst * np.abs(exact).max()
    for found, expected in (
        (factor.solve(rhs, transposed), exact),
        (factor.solve(rhs[:, 0].copy(), transposed), exact[:, 0]),
    ):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance)


def test_factors_leave_the_matrix_each_other_and_the_right_hand_side_as_they_are(blocks, rng):
    storage, values, _ = blocks
    given, rhs = values.copy(), rng.standard_normal(storage.n)
    before = rhs.copy()
    factor = storage.factorize(given)
    found = factor.solve(rhs)
    storage.factorize(2.0 * given)
    np.testing.assert_array_equal(given, values)
    given[:] = 0.0
    np.testing.assert_array_equal(factor.solve(rhs), found)
    np.testing.assert_array_equal(rhs, before)


@pytest.mark.parametrize("smallest", [0.0, 1e-14])
@pytest.mark.parametrize("transposed", [False, True])
def test_a_singular_leading_block_costs_no_digits(blocks, rng, smallest, transposed):
    """As beside a limit point of a part of the body: rows are exchanged across blocks."""
    storage, values, matrix = blocks
    first = storage.rows[0]
    # the last row of the first block is nearly zero
    change = matrix[first, first].copy()
    change[-1] *= smallest
    values = values.copy()
    for column in range(first.stop):
        values[storage.origins[column] + np.arange(first.stop)] = change[:, column]
    matrix[first, first] = change
    rhs = rng.standard_normal(storage.n)
    factor = storage.factorize(values)
    assert len(factor.rows) == 1
    exact = np.linalg.solve(matrix.T if transposed else matrix, rhs)
    tolerance = 1e-14 * np.linalg.cond(matrix) * np.abs(exact).max()
    np.testing.assert_allclose(factor.solve(rhs, transposed), exact, rtol=0.0, atol=tolerance)
    assert factor.positive == (np.linalg.slogdet(matrix)[0] > 0.0)


def test_usual_matrices_are_factorised_in_blocks(bent):
    layout, values, _ = bent
    assert len(layout.factorize(values).rows) == len(layout.storage.blocks.rows)


def test_tangent_of_a_body_is_solved(bent, rng):
    layout, values, _ = bent
    matrix, rhs = dense(layout, values), rng.standard_normal(layout.n_equations)
    exact = np.linalg.solve(matrix, rhs)
    tolerance = 1e-14 * np.linalg.cond(matrix) * np.abs(exact).max()
    found = layout.factorize(values).solve(rhs)
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=tolerance)


def test_singular_tangent_is_an_error(bent):
    layout, values, _ = bent
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        layout.factorize(np.zeros_like(values))


def test_memory_of_a_factor_is_that_of_its_blocks(blocks):
    storage, values, _ = blocks
    assert storage.factorize(values).nbytes == 8 * storage.size


def test_blocks_of_equations_are_coupled_with_their_neighbours_only(rng):
    """Random couplings: every coupling lies in the blocks, and no other division needs less work."""
    n = 30
    near = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    coupled = (near <= 1) | ((near < 6) & (rng.random((n, n)) < 0.2))
    coupled |= coupled.T
    coupling = csr_array(coupled.astype(np.int32))
    equations = np.column_stack([np.arange(n), np.full(n, -1)])
    farthest = farthest_coupled(equations, coupling)
    highest = [np.flatnonzero(row).max() for row in coupled]
    np.testing.assert_array_equal(farthest, np.maximum.accumulate(highest))
    ends, operations = block_ends(farthest)
    assert ends[-1] == n
    assert not np.any(coupled & ~pattern(ends))
    sizes = np.diff([0, *ends])
    one = 2.0 / 3.0 * sizes**3
    next_to = 2.0 * sizes[:-1] * sizes[1:] * (sizes[:-1] + sizes[1:])
    assert operations == pytest.approx(one.sum() + next_to.sum())
    # up to the farthest equation coupled with the block before
    for start, end, following in zip([0, *ends], ends, ends[1:], strict=False):
        assert following == max(highest[:end]) + 1, start


def test_bodies_that_are_not_coupled_have_blocks_of_their_own():
    coupling = csr_array(np.kron(np.eye(2), np.ones((3, 3))).astype(np.int32))
    equations = np.column_stack([np.arange(6), np.full(6, -1)])
    ends, operations = block_ends(farthest_coupled(equations, coupling))
    assert 3 in ends
    assert operations < 2.0 / 3.0 * 6**3


def test_blocks_of_a_thin_wall_are_small():
    """The work of a ring grows with its length, that of one block with the third power."""
    seal = sm.door_seal(rays=116)
    storage = discretize(seal.body, seal.nominal_particles, seal.definitions).layout.storage.blocks
    sizes = [own.stop - own.start for own in storage.rows]
    assert max(sizes) < 0.2 * storage.n
    assert len(sizes) > 6


def test_equations_number_the_free_components_once(rng):
    disc = square(rng)
    layout = disc.layout
    fixed = disc.body.fixed
    assert np.all(layout.equations[fixed] == -1)
    np.testing.assert_array_equal(np.sort(layout.equations[~fixed]), np.arange(layout.n_equations))


def test_gather_and_reduce_are_inverse_on_free_components(rng):
    disc = square(rng)
    layout = disc.layout
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
    layout = tangent_layout(equation_numbers(fixed, tables), tables)
    assert layout.n_equations == 72 - 7
    np.testing.assert_array_equal(layout.equations < 0, fixed)


def test_equations_are_numbered_with_the_particles_that_averages_couple(tmp_path):
    """Numbered for the cells alone, the factorisation of this bulb takes more operations."""
    text = (EXAMPLES / "ten_year_seal.toml").read_text(encoding="utf-8")
    text = text.replace("duration = ", "steps = 1\nduration = ").replace(
        "friction = 0.25",
        'friction = 0.25\ncontact_points = "averages"\nnormal_penalty = 1e4\ntangent_penalty = 5e2',
    )
    (tmp_path / "bulb.toml").write_text(text, encoding="utf-8")
    seal = sm.build_seal(sm.read_seal_file(tmp_path / "bulb.toml"))
    disc = discretize(seal.body, seal.nominal_particles, seal.definitions)
    tables = [disc.cells.raw, *(own.raw for own in disc.tables if own is not None)]
    of_cells = tangent_layout(seal.body.equations(), tables, disc.transformation)
    assert disc.layout.storage.size < of_cells.storage.size


def test_factors_know_the_sign_of_eigenvalues(bent, rng):
    """A tangent shifted past its lowest eigenvalues; the determinant of an unsymmetric one."""
    layout, values, _ = bent
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
        unsymmetric = shifted(shift, skew=1e-3)
        sign = np.linalg.slogdet(dense(layout, unsymmetric))[0]
        assert layout.factorize(unsymmetric).positive == (sign > 0.0)


def test_rounding_of_a_zero_eigenvalue_is_not_a_loss_of_stability(rng):
    """A body that nothing holds: three rigid motions."""
    disc = square(rng, n=9, fixed="nothing")
    d = np.zeros_like(disc.particles)
    values = internal(disc, d)[1]
    diagonal = disc.layout.storage.diagonal()
    rounded = block_tridiagonal.rounding(values[diagonal])
    assert abs(np.linalg.eigvalsh(dense(disc.layout, values))[0]) < rounded
    assert disc.layout.factorize(values, symmetric=True).positive
    values[diagonal] -= 3.0 * rounded
    assert not disc.layout.factorize(values, symmetric=True).positive


class Inverse:
    """A factor of a dense matrix."""

    def __init__(self, matrix):
        self.matrix = matrix

    def solve(self, rhs):
        return np.linalg.solve(self.matrix, rhs)


def test_corrected_factor_solves_with_the_sum(rng):
    matrix = 4.0 * np.eye(12) + rng.standard_normal((12, 12)) / 4.0
    columns, change = rng.standard_normal((3, 12)), rng.standard_normal((3, 3))
    change[:, 1] = 0.0  # singular, as that of a frictionless point
    rhs = rng.standard_normal(12)
    found = CorrectedFactor(Inverse(matrix), columns, change).solve(rhs)
    expected = np.linalg.solve(matrix + columns.T @ change @ columns, rhs)
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)
