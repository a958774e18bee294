"""Entries of links outside the blocks, and factors in another order, against dense linear algebra."""

from pathlib import Path

import numpy as np
import pytest
from bodies import dense
from scipy.sparse import csr_array

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.block_tridiagonal import BlockFactor
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.equilibrium.tangent_storage import ReorderedFactor, TangentStorage
from seal_mdao.seals.file.build import unchosen_seal

EXAMPLES = Path(__file__).parents[2] / "examples"
FOLDED = Path(__file__).parents[1] / "contact" / "folded_lip.toml"
COUNT = 40
FIXED = {0, 17}


def linked_chain(links):
    """Particles in a row, each coupled with two on either side, and links."""
    near = np.abs(np.subtract.outer(np.arange(COUNT), np.arange(COUNT))) <= 2
    linked = near.copy()
    for one, other in links:
        linked[one, other] = linked[other, one] = True
    equations = np.full((COUNT, 2), -1)
    free = np.array([[i not in FIXED, True] for i in range(COUNT)])
    equations[free] = np.arange(np.count_nonzero(free))
    # patterns with counts, as of ``couplings``
    body, whole = csr_array(2 * near.astype(np.int32)), csr_array(3 * linked.astype(np.int32))
    return TangentStorage(equations, body, whole), equations, near, linked


@pytest.fixture
def chain():
    """Links of the ends, and of particles that are neighbours anyway."""
    return linked_chain([(2, 37), (3, 37), (10, 12)])


def filled(chain, rng, acting=True):
    """Random entries of the matrix in the storage, and the matrix."""
    storage, equations, near, linked = chain
    numbered = equations >= 0
    particle = np.empty(storage.n, int)
    particle[equations[numbered]] = numbered.nonzero()[0]
    pattern = (linked if acting else near)[np.ix_(particle, particle)]
    matrix = np.where(pattern, rng.standard_normal(pattern.shape), 0.0)
    matrix += np.diag(np.full(storage.n, 12.0))
    values = np.zeros(storage.size)
    for row, column in np.argwhere(pattern):
        values[slot(storage, row, column)] = matrix[row, column]
    return values, matrix


def slot(storage, row, column):
    if storage.first[column] <= row < storage.end[column]:
        return storage.blocks.origins[column] + row
    own = storage.outside[storage.start[column] : storage.start[column + 1]]
    return storage.blocks.size + storage.start[column] + int(np.flatnonzero(own == row)[0])


def columns_outside(storage):
    """Columns of the entries outside the blocks."""
    return np.repeat(np.arange(storage.n), np.diff(storage.start))


def test_only_distant_entries_lie_outside_the_blocks(chain):
    storage, equations, *_ = chain
    # two components of (2, 37) and (3, 37), both ways
    assert storage.outside.size == 16
    rows = storage.outside[storage.start[equations[37, 0]] : storage.start[equations[37, 0] + 1]]
    assert rows.tolist() == [*equations[2], *equations[3]]


def test_links_at_all_distances_are_solved(rng):
    """Some lie in the blocks, among them those of the first and the last row of a column."""
    chain = linked_chain([(one, one + by) for one in (5, 6, 7, 8, 9) for by in range(3, 20)])
    storage, values, matrix = chain[0], *filled(chain, rng)
    for column in range(storage.n):
        rows = np.flatnonzero(matrix[:, column])
        beyond = rows[(rows < storage.first[column]) | (rows >= storage.end[column])]
        own = storage.outside[storage.start[column] : storage.start[column + 1]]
        np.testing.assert_array_equal(own, beyond)
    rhs = rng.standard_normal(storage.n)
    exact = np.linalg.solve(matrix, rhs)
    found = storage.factorize(values).solve(rhs)
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize("which", ["first", "last", "one direction"])
def test_some_entries_of_links_are_solved(chain, rng, which):
    """Contact acts between few points at a time, and friction not equally in both directions."""
    storage, (values, matrix) = chain[0], filled(chain, rng)
    n, columns = storage.outside.size, columns_outside(storage)
    acting = {"first": np.arange(n) == 0, "last": np.arange(n) == n - 1,
              "one direction": storage.outside < columns}[which]  # fmt: skip
    values[storage.blocks.size :][~acting] = 0.0
    matrix[storage.outside[~acting], columns[~acting]] = 0.0
    rhs = rng.standard_normal(storage.n)
    for transposed, own in ((False, matrix), (True, matrix.T)):
        exact = np.linalg.solve(own, rhs)
        found = storage.factorize(values).solve(rhs, transposed)
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("columns", [(), (3,)])
def test_links_are_solved(chain, rng, transposed, columns):
    values, matrix = filled(chain, rng)
    factor = chain[0].factorize(values)
    assert isinstance(factor, ReorderedFactor)
    rhs = rng.standard_normal((len(matrix), *columns))
    exact = np.linalg.solve(matrix.T if transposed else matrix, rhs)
    tolerance = 1e-14 * np.linalg.cond(matrix) * np.abs(exact).max()
    np.testing.assert_allclose(factor.solve(rhs, transposed), exact, rtol=0.0, atol=tolerance)
    assert factor.positive == (np.linalg.slogdet(matrix)[0] > 0.0)


@pytest.mark.parametrize("acting", [True, False])
def test_definiteness(chain, rng, acting):
    """With two negative eigenvalues the determinant is positive, the matrix is not."""
    values, matrix = filled(chain, rng, acting)
    storage = chain[0]
    for row, column in np.argwhere(matrix):
        values[slot(storage, row, column)] = 0.5 * (matrix[row, column] + matrix[column, row])
    lowest = np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[:3]
    shifts = 0.9 * lowest[0], 0.5 * (lowest[0] + lowest[1]), 0.5 * (lowest[1] + lowest[2])
    for shift, positive in zip(shifts, (True, False, False), strict=True):
        moved = values.copy()
        moved[storage.diagonal()] -= shift
        assert storage.factorize(moved, symmetric=True).positive == positive


def test_without_acting_links_the_blocks_are_those_of_the_body(chain, rng):
    values, matrix = filled(chain, rng, acting=False)
    factor = chain[0].factorize(values)
    assert isinstance(factor, BlockFactor)
    rhs = rng.standard_normal(len(matrix))
    assert factor.solve(rhs) == pytest.approx(np.linalg.solve(matrix, rhs), rel=1e-11)


def test_the_same_matrix_has_the_same_factor(chain, rng):
    """Whatever was factorised before."""
    storage, rhs = chain[0], rng.standard_normal(chain[0].n)
    values, other = filled(chain, rng)[0], filled(chain, rng)[0]
    fewer = other.copy()
    # only particles 2 and 37 are linked
    entries = np.stack([storage.outside, columns_outside(storage)])
    fewer[storage.blocks.size :][np.isin(entries, chain[1][3]).any(axis=0)] = 0.0
    alone = filled(chain, rng, acting=False)[0]
    matrices = fewer, values, other, alone
    first = [linked_chain([(2, 37), (3, 37), (10, 12)])[0].factorize(own).solve(rhs)
             for own in matrices]  # fmt: skip
    for before in matrices:
        for own, expected in zip(matrices, first, strict=True):
            storage.factorize(before)
            np.testing.assert_array_equal(storage.factorize(own).solve(rhs), expected)


def test_a_link_of_the_ends_of_a_chain_takes_little_memory(chain, rng):
    """The chain is folded, so that its blocks are twice as large; one block would have n^2 entries."""
    factor = chain[0].factorize(filled(chain, rng)[0])
    assert factor.nbytes < 8 * 0.5 * chain[0].n ** 2


def test_links_that_do_not_act_take_no_memory(rng):
    """The order of the equations is that of the acting links alone."""
    fewer, more = linked_chain([(2, 20)]), linked_chain([(2, 20), (11, 36)])
    values = filled(more, rng)[0]
    values[more[0].blocks.size :][np.isin(more[0].outside, more[1][[11, 36]])] = 0.0
    alone, found = fewer[0].factorize(filled(fewer, rng)[0]), more[0].factorize(values)
    np.testing.assert_array_equal(found.place, alone.place)
    assert found.nbytes == alone.nbytes < more[0].factorize(filled(more, rng)[0]).nbytes


def test_the_order_of_the_body_stays_where_it_takes_fewer_operations(rng):
    """As for a link that is little longer than the blocks."""
    near, far = linked_chain([(10, 15)]), linked_chain([(2, 37)])
    places = [own[0].factorize(filled(own, rng)[0]).place for own in (near, far)]
    np.testing.assert_array_equal(places[0], np.arange(near[0].n))
    assert not np.array_equal(places[1], np.arange(far[0].n))


def test_walls_in_contact_are_solved(rng):
    """Tangents of a lip that folds onto its base: while it is open, and after it has touched."""
    result = sm.analyze(sm.build_seal(sm.read_seal_file(FOLDED)))
    assert result.converged
    path, kinds = result.path, set()
    problem = PathProblem(path.discretization, result.seal.terms())
    layout = path.discretization.layout
    for step in path.steps:
        assembly = problem.assemble_at(step)
        matrix, rhs = dense(layout, assembly.values), rng.standard_normal(layout.n_equations)
        factor = assembly.factorize()
        kinds.add(type(factor))
        exact = np.linalg.solve(matrix, rhs)
        tolerance = 1e-14 * np.linalg.cond(matrix) * np.abs(exact).max()
        np.testing.assert_allclose(factor.solve(rhs), exact, rtol=0.0, atol=tolerance)
    assert kinds == {BlockFactor, ReorderedFactor}


def test_self_contact_of_many_points_needs_no_dense_matrix():
    """Walls all round may touch each other, so that blocks for all pairs are nearly one."""
    file = sm.read_seal_file(EXAMPLES / "bump_stop.toml")
    seal = unchosen_seal(file)
    layout = discretize(seal.body, seal.nominal_particles, seal.terms()).layout
    assert layout.storage.blocks.size < 0.5 * layout.n_equations**2
    assert layout.storage.size < 0.75 * layout.n_equations**2
