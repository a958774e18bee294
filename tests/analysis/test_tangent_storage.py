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


@pytest.fixture
def chain():
    """Particles in a row, each coupled with two on either side; links of the ends and of neighbours."""
    near = np.abs(np.subtract.outer(np.arange(COUNT), np.arange(COUNT))) <= 2
    linked = near.copy()
    for one, other in ((2, 37), (3, 37), (10, 12)):
        linked[one, other] = linked[other, one] = True
    equations = np.full((COUNT, 2), -1)
    free = np.array([[i not in FIXED, True] for i in range(COUNT)])
    equations[free] = np.arange(np.count_nonzero(free))
    # patterns with counts, as of ``couplings``
    body, whole = csr_array(2 * near.astype(np.int32)), csr_array(3 * linked.astype(np.int32))
    return TangentStorage(equations, body, whole), equations, near, linked


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


def test_only_distant_entries_lie_outside_the_blocks(chain):
    storage, equations, *_ = chain
    # two components of (2, 37) and (3, 37), both ways
    assert storage.outside.size == 16
    rows = storage.outside[storage.start[equations[37, 0]] : storage.start[equations[37, 0] + 1]]
    assert rows.tolist() == [*equations[2], *equations[3]]


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


def test_definiteness_with_links(chain, rng):
    values, matrix = filled(chain, rng)
    storage = chain[0]
    for row, column in np.argwhere(matrix):
        values[slot(storage, row, column)] = 0.5 * (matrix[row, column] + matrix[column, row])
    lowest = np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[:2]
    for shift, positive in ((0.9 * lowest[0], True), (lowest.mean(), False)):
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
    first = storage.factorize(values).solve(rhs)
    fewer = other.copy()
    fewer[storage.blocks.size] = 0.0
    for before in (other, fewer, filled(chain, rng, acting=False)[0]):
        storage.factorize(before)
        np.testing.assert_array_equal(storage.factorize(values).solve(rhs), first)


def test_a_link_of_the_ends_of_a_chain_takes_little_memory(chain, rng):
    """The chain is folded, so that its blocks are twice as large; one block would have n^2 entries."""
    factor = chain[0].factorize(filled(chain, rng)[0])
    assert factor.nbytes < 8 * 0.5 * chain[0].n ** 2


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
