"""Internal force and tangent as exact derivatives of the projected energy; invariances."""

import numpy as np
import pytest
from bodies import CONSTANTS, dense, energy, internal, square, structure, wave

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.materials.isotropic import invariants
from seal_mdao.structure.deformation import deform

# a bulk modulus of zero would be that of a compressible law
UNITS = {"c10": (1.0, 0.0, 1e-30), "c01": (0.0, 1.0, 1e-30), "bulk": (0.0, 0.0, 1.0)}


# basis order, cells of a column, Gauss points, and inner radius
BODIES = [(1, 1, 2), (2, 1, 2), (1, 5, 2), (2, 5, 2), (1, 5, 1), (1, 1, 3)]
RINGS = [(1, 1, 2, 0.4), (2, 1, 2, 0.4), (1, 5, 2, 0.4)]


@pytest.fixture(params=BODIES, ids=str)
def body(request, rng):
    """A free square in a deformed state; basis order, pressure and Gauss points vary."""
    order, column, n_gauss = request.param
    disc = square(rng, order=order, fixed="nothing", column=column, n_gauss=n_gauss)
    d = wave(disc, 0.15) + rng.uniform(-0.01, 0.01, disc.particles.shape)
    return disc, d


@pytest.fixture(params=[*BODIES, *RINGS], ids=str)
def any_body(request, rng):
    """As ``body``, and such a square that is turned about an axis."""
    order, column, n_gauss, *inner = request.param
    disc = square(rng, 6, order, "nothing", column, n_gauss, *inner)
    return disc, wave(disc, 0.1) + rng.uniform(-0.01, 0.01, disc.particles.shape)


def slope(function, step):
    """Derivative at zero by the five-point formula."""
    values = [function(s * step) for s in (-2, -1, 1, 2)]
    return (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step)


@pytest.mark.parametrize("unit", UNITS)
def test_force_is_the_derivative_of_the_energy(any_body, rng, unit):
    """For each material constant alone; the five-point formula converges with its fourth power."""
    disc, d = any_body
    direction = rng.standard_normal(d.shape)
    force, _ = internal(disc, d, UNITS[unit], tangent=False)
    exact = force @ disc.layout.reduce(direction)
    errors = [
        abs(slope(lambda s: energy(disc, d + s * direction, UNITS[unit]), h) - exact)
        for h in (4e-4, 2e-4)
    ]
    scale = np.abs(force * disc.layout.reduce(direction)).sum()
    assert errors[1] < 1e-9 * scale
    if errors[0] > 1e-9 * scale:
        assert errors[0] > 8 * errors[1]


@pytest.mark.parametrize("unit", UNITS)
def test_tangent_is_the_derivative_of_the_force(any_body, rng, unit):
    disc, d = any_body
    _, values = internal(disc, d, UNITS[unit])
    matrix = dense(disc.layout, values)
    for _ in range(3):
        direction = rng.standard_normal(d.shape)

        def force(s, direction=direction):
            return internal(disc, d + s * direction, UNITS[unit], tangent=False)[0]

        exact = matrix @ disc.layout.reduce(direction)
        np.testing.assert_allclose(slope(force, 1e-4), exact, atol=1e-9 * np.abs(exact).max())


def test_tangent_is_symmetric(any_body):
    disc, d = any_body
    matrix = dense(disc.layout, internal(disc, d)[1])
    np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=1e-13 * np.abs(matrix).max())


def test_force_is_linear_in_the_material_constants(body):
    disc, d = body
    parts = [internal(disc, d, unit)[0] for unit in UNITS.values()]
    whole = internal(disc, d)[0]
    np.testing.assert_allclose(np.array(CONSTANTS) @ parts, whole, atol=1e-12 * np.abs(whole).max())


def test_force_without_tangent_is_the_same(any_body):
    disc, d = any_body
    np.testing.assert_array_equal(internal(disc, d)[0], internal(disc, d, tangent=False)[0])


def test_volume_strain_beyond_its_linearisation(any_body, rng):
    """What mixed iterations leave out of the pressure: s(d) - s(d - du) - s'(d - du) du."""
    disc, d = any_body
    term, du = structure(disc), 0.02 * rng.standard_normal(d.shape)

    def volume_strain(at):
        return term.deformation_of(at[None], [0.0]).volume_strain[0]

    linear = slope(lambda s: volume_strain(d - du + s * du), 1e-2)
    exact = volume_strain(d) - volume_strain(d - du) - linear
    # takes the state at d
    assert term.forces(d, 0.0) is not None
    found = term._beyond_linear(disc.cells.table, du)
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-10 * np.abs(linear).max())


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


@pytest.mark.parametrize("angle", [0.5, np.deg2rad(170.0), np.pi])
def test_rigid_motion_gives_no_force(body, angle):
    """Finite rotation about a far centre with a translation."""
    disc, _ = body
    centre, shift = np.array([3.0, -2.0]), np.array([0.4, 5.0])
    d = (disc.particles - centre) @ turned(angle).T + centre + shift - disc.particles
    force, _ = internal(disc, d)
    scale = np.abs(internal(disc, 0.3 * disc.particles)[0]).max()
    np.testing.assert_allclose(force, 0.0, atol=1e-11 * scale)
    assert energy(disc, d) == pytest.approx(0.0, abs=1e-11 * scale)


@pytest.mark.parametrize("angle", [0.5, np.deg2rad(170.0)])
def test_force_turns_with_the_body(body, angle):
    """Objectivity of the discrete force, pressure projection included."""
    disc, d = body
    r = turned(angle)
    more = (disc.particles + d) @ r.T - disc.particles
    free = disc.layout.equations
    before, after = internal(disc, d)[0][free], internal(disc, more)[0][free]
    np.testing.assert_allclose(after, before @ r.T, rtol=0.0, atol=1e-10 * np.abs(before).max())
    assert energy(disc, more) == pytest.approx(energy(disc, d), rel=1e-10)


def test_internal_forces_are_in_equilibrium(body):
    """No resultant and no moment about the deformed places, for any displacement."""
    disc, d = body
    force = internal(disc, d)[0][disc.layout.equations]
    x = disc.particles + d
    size = np.abs(force).sum()
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12 * size)
    assert np.sum(x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]) == pytest.approx(
        0.0, abs=1e-12 * size
    )


HOMOGENEOUS = np.array([[0.3, 0.2], [-0.1, -0.15]])


def test_homogeneous_deformation_has_the_energy_of_one_point(body):
    """Linear fields are reproduced, so F is the same at every quadrature point."""
    disc, _ = body
    c10, c01, bulk = CONSTANTS
    F = np.eye(2) + HOMOGENEOUS
    t, j = invariants(F)
    exact = sm.MooneyRivlin(c10, c01, bulk).energy(t, j) + 0.5 * bulk * (j - 1) ** 2
    area = disc.weights.sum()
    assert area == pytest.approx(1.0, rel=1e-13)
    found = energy(disc, disc.particles @ HOMOGENEOUS.T)
    assert found == pytest.approx(area * exact, rel=1e-10)


def test_virial_of_a_homogeneous_deformation_is_area_times_stress(body):
    """sum_I f_I X_I^T = int P, from the linear reproducing condition alone."""
    disc, _ = body
    c10, c01, bulk = CONSTANTS
    F = np.eye(2) + HOMOGENEOUS
    cof = np.array([[F[1, 1], -F[1, 0]], [-F[0, 1], F[0, 0]]])
    stress = sm.MooneyRivlin(c10, c01, bulk).stress(F) + bulk * (np.linalg.det(F) - 1) * cof
    force = internal(disc, disc.particles @ HOMOGENEOUS.T)[0][disc.layout.equations]
    np.testing.assert_allclose(force.T @ disc.particles, stress, rtol=1e-10)


@pytest.mark.parametrize(("order", "column"), [(1, 1), (2, 1), (1, 9), (2, 3)])
def test_homogeneous_deformation_leaves_inner_particles_without_force(rng, order, column):
    """The linear patch test in its local form: consistent integration makes it exact."""
    disc = square(rng, n=10, order=order, fixed="nothing", column=column)
    x, reach = disc.particles, disc.body.support_radius[0]
    force = internal(disc, x @ HOMOGENEOUS.T)[0][disc.layout.equations]
    inner = np.all((x > reach) & (x < 1 - reach), axis=1)
    assert inner.sum() >= 4
    np.testing.assert_allclose(force[inner], 0.0, atol=1e-12 * np.abs(force).max())


def test_projection_uses_the_mean_volume_change_of_each_cell(rng):
    """With the bulk term alone the energy is K/2 sum_c V_c (a/V_c - 1)^2 of the deformed areas a, whose
    linear part is that of the quadrature, and whose other part is that of the area rows."""
    disc = square(rng, fixed="nothing")
    d = wave(disc, 0.2)
    q, points = disc.weights.shape[1], disc.cells.table.group_size
    table, total = disc.cells.table, 0.0
    for cell in range(table.n_groups):
        low, high = table.start[cell], table.start[cell + 1]
        grad = table.grad[2 * points * low : 2 * points * high].reshape(points, 2, -1)
        slopes = np.einsum("qja,ai->qij", grad, d[table.neighbours[low:high]])
        change = disc.weights[cell] @ np.trace(slopes[:q], axis1=1, axis2=2)
        change += np.linalg.det(slopes[q:]).sum()
        total += 0.5 * change**2 / disc.weights[cell].sum()
    assert energy(disc, d, UNITS["bulk"]) == pytest.approx(total, rel=1e-12)


def test_inverted_point_has_no_answer(rng):
    disc = square(rng, fixed="nothing")
    d = np.zeros_like(disc.particles)
    d[14] = [1.0, 1.0]
    term, layout = structure(disc), disc.layout
    inverted = deform(disc.cells.table, disc.weights, term.functions, d, term.deformation)
    assert np.any(disc.body.cells[inverted] == 14)
    force = np.zeros(layout.force_size)
    assert term.add(d, disc.transformation.coefficients(d), 0.0, None, force, np.empty(0)) is None
    assert term.forces(d, 0.0) is None


def test_a_ring_turned_through_its_axis_has_no_answer(rng):
    """Mirrored at the axis it has the volumes J = 1 of the undeformed ring, with h = det F = -1."""
    disc = square(rng, fixed="nothing", inner=0.4)
    d = np.column_stack([-2.0 * disc.particles[:, 0], 0.0 * disc.particles[:, 1]])
    term = structure(disc)
    f = term.deformation_of(d[None], [0.0]).f[0]
    np.testing.assert_allclose(
        f[..., [0, 4, 5]],
        np.broadcast_to([-1.0, 0.0, -1.0], (*f.shape[:2], 3)),
        rtol=0.0,
        atol=1e-9,
    )
    assert term.forces(d, 0.0) is None


def test_particles_must_fit_the_body(rng):
    disc = square(rng)
    with pytest.raises(ValueError, match="shape"):
        discretize(disc.body, disc.particles[:-1])
    broken = disc.particles.copy()
    broken[7, 1] = np.nan
    with pytest.raises(ValueError, match="the particle with the index 7"):
        discretize(disc.body, broken)
