"""Supports do not reach across voids, round corners or across interfaces; nothing changes elsewhere."""

import numpy as np
import pytest
from clouds import rate_rows, rows
from scipy.optimize import minimize_scalar
from verification.bodies import Grid, fixed_components
from verification.solving import solve, tight

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.rkpm import visibility
from seal_mdao.rkpm.cells import support_radii
from seal_mdao.rkpm.consistent_gradients import integration_points
from seal_mdao.rkpm.tables import build_table
from seal_mdao.rkpm.visibility import hidden_pairs
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import boundary_particles, edge_points

RUBBER = sm.MooneyRivlin(80.0, 20.0, 4000.0)
BAR = Grid(12, 2)


def bar(bottom):
    return BAR.reference * [6.0, 1.0] + [0.0, bottom]


def bars(*bottoms):
    """Bars 6 x 1, each on its bottom, their left ends fixed, with supports of 1."""
    particles = np.vstack([bar(bottom) for bottom in bottoms])
    n = BAR.n_particles
    cells = np.vstack([BAR.cells + k * n for k in range(len(bottoms))])
    fixed = np.zeros((len(particles), 2), bool)
    for k in range(len(bottoms)):
        fixed[BAR.left + k * n] = True
    radius = np.full(len(particles), 1.0)
    hidden = hidden_pairs(cells, particles, radius)
    return Body(cells, radius, fixed, hidden_pairs=hidden), particles


def bent(body, particles, *densities):
    """Displacement under forces at the right end of every bar."""
    loads = []
    for k, density in enumerate(densities):
        end = BAR.right + k * BAR.n_particles
        where = boundary_particles(end, np.column_stack([np.roll(end, 1), np.roll(end, -1)]))
        loads.append(DeadLoad(f"end{k}", where, np.array(density), np.linspace(0.0, 1.0, 3)))
    path = solve(body, particles, (elastic_body(RUBBER), *loads), 2)
    return path.discretization, path.displacement()


def test_two_bars_do_not_feel_each_other():
    together, both = bars(0.0, 1.1)
    disc, moved = bent(together, both, (0.0, 1.0), (0.0, 0.0))
    alone, lower = bars(0.0)
    own, expected = bent(alone, lower, (0.0, 1.0))
    n, table, single = BAR.n_particles, disc.cells.gauss.raw, own.cells.gauss.raw
    at_edges, single_edges = disc.cells.edges.raw, own.cells.edges.raw
    size = single.start[-1]
    assert np.array_equal(table.start[: len(BAR.cells) + 1], single.start)
    assert np.array_equal(table.neighbours[:size], single.neighbours)
    assert single_edges.phi.size > 0
    assert np.array_equal(at_edges.phi[: single_edges.phi.size], single_edges.phi)
    assert single.grad.size > 0
    assert np.array_equal(table.grad[: single.grad.size], single.grad)
    assert (table.neighbours[size:] >= n).all()
    assert not moved[n:].any()
    # the matrix of both is eliminated in another order: rounding times its condition
    np.testing.assert_allclose(moved[:n], expected, rtol=0.0, atol=1e-12)
    assert np.abs(expected).max() > 0.1
    forces = [
        elastic_body(RUBBER).on(d, 0).forces(u, 0.0) for d, u in ((disc, moved), (own, moved[:n]))
    ]
    assert np.array_equal(forces[0][:n], forces[1])
    assert not forces[0][n:].any()


def test_bars_that_see_each_other_are_glued():
    """What the mask is for: without it the load on one bar bends the other."""
    together, both = bars(0.0, 1.1)
    glued = Body(together.cells, together.support_radius, together.fixed)
    _, moved = bent(glued, both, (0.0, 1.0), (0.0, 0.0))
    assert np.abs(moved[BAR.n_particles :]).max() > 0.05


def slit(length):
    """A 4 x 4 square of 8 x 8 cells with a slit without width from the right, along y = 2."""
    grid = Grid(8, 8)
    particles, cells = grid.reference * 4.0, grid.cells.copy()
    on = [i for i in range(9) if particles[grid.particle(i, 4), 0] > 4.0 - length + 1e-9]
    above = {int(grid.particle(i, 4)): 81 + k for k, i in enumerate(on)}
    for cell in cells:
        if particles[cell, 1].mean() > 2.0:
            cell[:] = [above.get(int(corner), corner) for corner in cell]
    twins = list(above)
    return cells, np.vstack([particles, particles[twins]]), np.array(twins)


def test_the_two_lips_of_a_slit_are_apart_and_its_tip_is_not():
    cells, particles, lower = slit(3.0)
    radius = support_radii(cells, particles, 2.0)
    pairs = set(map(tuple, hidden_pairs(cells, particles, radius).tolist()))
    for k, particle in enumerate(lower):
        assert {(particle, 81 + k), (81 + k, particle)} <= pairs
    assert not any(first == second for first, second in pairs)
    tip = int(np.flatnonzero((particles == [1.0, 2.0]).all(axis=1))[0])
    assert tip not in {particle for pair in pairs for particle in pair}
    ends = particles[np.array(sorted(pairs))]
    assert ((ends[:, 0, 1] - 2.0) * (ends[:, 1, 1] - 2.0) <= 0.0).all()


def test_detours_round_a_corner_are_hidden():
    """An L: 8 x 8 cells without the upper right quarter."""
    grid = Grid(8, 8)
    particles, middle = grid.reference * 4.0, (grid.reference * 4.0)[grid.cells].mean(axis=1)
    cells = grid.cells[~(middle > 2.0).all(axis=1)]
    found = set(map(tuple, hidden_pairs(cells, particles, np.full(len(particles), 1.2)).tolist()))
    number = {tuple(x): i for i, x in enumerate(particles.tolist())}
    corner = np.array([2.0, 2.0])
    # on both faces, and inside on both sides of the corner
    for one, other, hidden in (
        ((2.0, 2.5), (2.5, 2.0), True), ((2.0, 3.0), (2.5, 2.0), True),
        ((2.0, 3.0), (2.5, 1.5), False), ((1.5, 2.5), (2.5, 1.5), False),
        ((2.0, 2.5), (2.5, 1.5), False), ((1.5, 3.0), (2.5, 2.0), True),
    ):  # fmt: skip
        x, y = np.array(one), np.array(other)
        round_it = np.hypot(*(corner - x)) + np.hypot(*(corner - y))
        # the corner is on the left of the straight line if that leaves the section
        leaves = (y - x)[0] * (corner - x)[1] - (y - x)[1] * (corner - x)[0] < -1e-12
        assert hidden == (leaves and round_it > 1.1 * np.hypot(*(x - y)))
        pair = number[one], number[other]
        assert (pair in found) == (pair[::-1] in found) == hidden


def test_interfaces_hide_the_inside_of_either_part_from_the_other():
    grid = Grid(8, 8)
    parts = (grid.reference[grid.cells].mean(axis=1)[:, 1] > 0.5).astype(int)
    particles = grid.reference * 4.0
    found = hidden_pairs(grid.cells, particles, np.full(len(particles), 1.2), parts)
    y = particles[found][..., 1] - 2.0
    assert (y[:, 0] * y[:, 1] < 0.0).all()
    # up to the corners of cells that a support reaches
    reach = max(1.5 * 1.2, 1.2 + np.hypot(0.5, 0.5))
    near = np.hypot(*(particles[:, None] - particles).transpose(2, 0, 1)) <= reach
    across = (particles[:, None, 1] - 2.0) * (particles[:, 1] - 2.0) < 0.0
    assert len(found) == (near & across).sum()
    assert hidden_pairs(grid.cells, particles, np.full(len(particles), 1.2)).size == 0


def test_nothing_is_hidden_where_there_is_no_void_near():
    seal = sm.door_seal()
    body, particles = seal.body, seal.nominal_particles
    assert hidden_pairs(body.cells, particles, body.support_radius).size == 0


@pytest.mark.parametrize("seed", [1, 2])
def test_pairs_are_those_of_a_search_over_all_radii(seed):
    """Against the definition: flood the cells through sides inside the ellipse, pair by pair."""
    cells, particles, _ = slit(2.5)
    rng = np.random.default_rng(seed)
    particles = particles + rng.uniform(-0.02, 0.02, particles.shape)
    radius = rng.uniform(0.9, 1.3, len(particles))
    found = hidden_pairs(cells, particles, radius)
    pairs = set(map(tuple, found.tolist()))
    for particle in rng.choice(len(particles), 12, replace=False):
        apart = np.hypot(*(particles - particles[particle]).T)
        for other in np.flatnonzero(apart <= 1.5 * radius[particle]):
            assert ((particle, other) in pairs) == (not joined(cells, particles, particle, other))
    assert len(pairs) > 300


def detour(x, y, a, b):
    """Least |p - x| + |p - y| of the points p between a and b."""

    def length(share):
        p = a + share * (b - a)
        return np.hypot(*(p - x)) + np.hypot(*(p - y))

    ends = length(0.0), length(1.0)
    return min(minimize_scalar(length, bounds=(0.0, 1.0), options={"xatol": 1e-10}).fun, *ends)


def joined(cells, particles, one, other):
    """Whether sides with a detour of at most 1.1 join a cell at a particle with one at the other."""
    x, y = particles[one], particles[other]
    owners = {}
    for number, cell in enumerate(cells):
        for a, b in zip(cell, np.roll(cell, -1), strict=True):
            if detour(x, y, particles[a], particles[b]) <= 1.1 * np.hypot(*(x - y)):
                owners.setdefault(frozenset((int(a), int(b))), []).append(number)
    reached = {number for number, cell in enumerate(cells) if one in cell}
    while True:
        more = {n for both in owners.values() if reached & set(both) for n in both} - reached
        if not more:
            return any(other in cells[number] for number in reached)
        reached |= more


def c_ring(a, b, first, last, moment):
    """A C-ring whose ends carry the tractions of pure bending, held at its back.

    Returns the body, particles, loads, and the exact turn of one end against the other. Stress
    function A ln r + B r^2 ln r + C r^2 (S. P. Timoshenko, J. N. Goodier, Theory of Elasticity,
    Arts. 29 and 31): sigma_theta = -A / r^2 + B (3 + 2 ln r) + 2 C, u_theta = 4 B r theta / E.
    """
    grid = Grid(120, 4)
    share = grid.reference
    angle, r = first + (last - first) * share[:, 0], b - (b - a) * share[:, 1]
    particles = r[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    n = (b**2 - a**2) ** 2 - 4.0 * (a * b * np.log(b / a)) ** 2
    A = -4.0 * moment / n * (a * b) ** 2 * np.log(b / a)
    B = -2.0 * moment / n * (b**2 - a**2)
    C = moment / n * (b**2 - a**2 + 2.0 * (b**2 * np.log(b) - a**2 * np.log(a)))
    loads = []
    for name, row, end, sign in (
        ("lower", grid.left[::-1], first, -1),
        ("upper", grid.right, last, 1),
    ):
        where = edge_points(np.column_stack([row[:-1], row[1:]]))
        radius = np.hypot(*where.points.at(particles).T)
        stress = -A / radius**2 + B * (3.0 + 2.0 * np.log(radius)) + 2.0 * C
        along = np.array([-np.sin(end), np.cos(end)])
        loads.append(DeadLoad(name, where, sign * stress[:, None] * along, np.array([0.0, 1.0])))
    back = grid.particle(60, np.array([2, 0]))
    fixed = fixed_components(len(particles), x=back[:1], y=back)
    shear, bulk = RUBBER.shear_modulus, RUBBER.bulk_modulus
    young, poisson = (
        9 * bulk * shear / (3 * bulk + shear),
        (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear),
    )
    turn = 4.0 * B * (last - first) * (1.0 - poisson**2) / young
    return grid, particles, fixed, loads, turn


@pytest.mark.parametrize("hides", [True, False])
def test_c_ring_springs_open(hides):
    """A slit of 0.1 beneath supports of 0.5: the exact turn of a curved bar, or hardly any."""
    half = 0.05 / 3.5
    grid, particles, fixed, loads, turn = c_ring(3.0, 4.0, half, 2 * np.pi - half, 0.02)
    radius = support_radii(grid.cells, particles, 2.0)
    assert radius.min() > 0.3
    hidden = hidden_pairs(grid.cells, particles, radius)
    options = {"hidden_pairs": hidden} if hides else {}
    body = Body(grid.cells, radius, fixed, **options)
    path = solve(body, particles, (elastic_body(RUBBER), *loads), 1, options=tight(RUBBER))
    moved = path.displacement()
    opening = moved[grid.right, 1] - moved[grid.left, 1]
    exact = turn * np.hypot(*particles[grid.left].T)
    if hides:
        np.testing.assert_allclose(opening, exact, rtol=0.02)
    else:
        assert np.abs(opening).max() < 0.5 * np.abs(exact).min()


def test_rates_are_exact_beside_a_slit(rng):
    """What is hidden stays so when the particles move: differences of smooth shape functions."""
    cells, particles, _ = slit(3.0)
    radius = support_radii(cells, particles, 2.0)
    hidden = hidden_pairs(cells, particles, radius)
    body = Body(cells, radius, np.zeros(particles.shape, bool), hidden_pairs=hidden)
    _, points = integration_points(body.cell_map, body.edge_rule)
    table, n = build_table(body.cloud(particles), points), len(particles)
    velocity, step = rng.uniform(-1.0, 1.0, (1, n, 2)), 1e-5
    rates = table.raw_rates(velocity)
    exact = rate_rows(table.raw, rates, n, 1)[0][..., 0]
    sides = [
        rows(build_table(body.cloud(particles + s * step * velocity[0]), points).raw, n)[0]
        for s in (1, -1)
    ]
    # truncation: third derivatives of the kernel, some 1e2 over a support of 1, times step^2
    np.testing.assert_allclose((sides[0] - sides[1]) / (2 * step), exact, rtol=0.0, atol=1e-7)
    assert np.abs(exact).max() > 1.0


def test_particles_far_from_the_boundary_are_not_examined(monkeypatch):
    """Two thick bars beside each other: the pairs are those of an examination of every particle."""
    grid = Grid(14, 14)
    particles = np.vstack([grid.reference * 6.0, grid.reference * 6.0 + [6.3, 0.0]])
    cells = np.vstack([grid.cells, grid.cells + grid.n_particles])
    radius = np.full(len(particles), 0.9)
    examined = []
    visible = visibility._visible
    monkeypatch.setattr(
        visibility, "_visible", lambda *given: examined.append(len(given[-1])) or visible(*given)
    )
    found = hidden_pairs(cells, particles, radius)
    zeros = np.zeros(len(particles))
    monkeypatch.setattr(visibility, "_boundary_distances", lambda *given: zeros)
    assert np.array_equal(found, hidden_pairs(cells, particles, radius))
    assert len(found) > 100
    few, every = examined
    assert few < 0.8 * every
