"""Bodies that are heated, swollen or stretched along their axis, against closed forms."""

import numpy as np
import pytest
from scipy.optimize import brentq

from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.environment import Environment, Growth
from seal_mdao.structure.region import Region
from seal_mdao.terms.ramp import Ramp, ramp_of_stages
from verification.bodies import Grid, fixed_components, grid_body, scattered
from verification.revolution import BULK, C01, C10, principal_stress
from verification.solving import grown, holding_forces, solve, tight

RUBBER = MooneyRivlin(C10, C01, BULK)
FOAM = Hyperfoam((100.0,), (4.0,), (0.2,))
SIZE = np.array([4.0, 2.0])
STEPS = 3
GRID = Grid(8, 4)
# rounding of sums over a point's neighbours, over the strain
ROUNDING = 1e-12


def ramp(start, value):
    return ramp_of_stages(start, [value], [STEPS])


def body_of(material, stretch=None, hot=None, growth=None):
    """A body in an environment: axial stretch at the end, and temperature from 20 degrees."""
    environment = Environment(
        None if stretch is None else ramp(1.0, stretch), None if hot is None else ramp(20.0, hot)
    )
    return ElasticBody((Region(material, growth=growth or Growth()),), environment)


def solved(elastic, fixed, inner=0.0, axisymmetric=False, imposed=None):
    X = scattered(GRID, 0.2, 4) * SIZE + [inner, 0.0]
    body = grid_body(GRID, X, fixed, axisymmetric=axisymmetric)
    return X, solve(body, X, (elastic,), STEPS, imposed, tight(RUBBER))


@pytest.mark.parametrize("material", [RUBBER, FOAM], ids=["rubber", "foam"])
@pytest.mark.parametrize("around", [False, True], ids=["long", "ring"])
def test_free_expansion_leaves_no_stress(material, around):
    # theta = (1 + alpha (T - T_0)) S^(1/3)
    theta = (1.0 + 1e-3 * 80.0) * 1.1 ** (1.0 / 3.0)
    growth = Growth(1e-3, ramp(1.0, 1.1))
    elastic = body_of(material, None if around else theta, 100.0, growth)
    n = GRID.n_particles
    fixed = fixed_components(n, x=() if around else GRID.left, y=GRID.bottom)
    # a long seal grows by theta along its axis at the end alone
    X, path = solved(elastic, fixed, 3.0 if around else 0.0, around)
    np.testing.assert_allclose(path.displacement(), (theta - 1.0) * X, rtol=0.0, atol=1e-11)
    # forces of this strain, were it held
    held = max(material.initial_bulk_modulus, material.bulk_modulus) * (theta**3 - 1.0) * SIZE.max()
    held *= 2e-3 * np.pi * 7.0 if around else 1.0
    assert np.abs(holding_forces(path)[-1]).max() <= ROUNDING * held
    stress = path.problem.terms[0].pressure(
        path.problem.terms[0].deformation_of(path.steps[-1].d[None], [STEPS])
    )
    assert np.abs(stress).max() <= ROUNDING * BULK


def test_a_confined_block_presses_with_the_growth_that_it_is_denied():
    n = GRID.n_particles
    every = GRID.boundary
    growth = Growth(2e-4)
    _, path = solved(body_of(RUBBER, hot=120.0, growth=growth), fixed_components(n, every, every))
    theta = 1.0 + 2e-4 * 100.0
    # p = K (1 / theta^3 - 1) on the height of 2 mm
    force = holding_forces(path)[-1]
    exact = BULK * (1.0 / theta**3 - 1.0) * SIZE[1]
    assert force[GRID.right, 0].sum() == pytest.approx(exact, rel=1e-12)
    assert force[GRID.left, 0].sum() == pytest.approx(-exact, rel=1e-12)


def test_a_stretched_section_that_is_held_presses_as_its_stretches_do():
    """Per length of the stretched seal."""
    n, h = GRID.n_particles, 1.06
    every = GRID.boundary
    _, path = solved(body_of(RUBBER, stretch=h), fixed_components(n, every, every))
    # P_1 of the stretches (1, 1, h), over h
    exact = principal_stress(1.0, 1.0, h)[0] / h * SIZE[1]
    assert holding_forces(path)[-1][GRID.right, 0].sum() == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("h", [0.9, 1.2])
def test_a_stretched_section_contracts_as_in_uniaxial_tension(h):
    fixed = fixed_components(GRID.n_particles, x=GRID.left, y=GRID.bottom)
    X, path = solved(body_of(RUBBER, stretch=h), fixed)
    # P_1 = 0 of the stretches (s, s, h)
    s = brentq(lambda s: principal_stress(s, s, h)[0], 0.5, 2.0, xtol=1e-15, rtol=1e-14)
    np.testing.assert_allclose(path.displacement(), (s - 1.0) * X, rtol=0.0, atol=1e-10)


def test_moduli_follow_the_temperature():
    """A block whose top is moved; all of its stress but the pressure is proportional to the factor."""
    fixed = fixed_components(GRID.n_particles, [*GRID.bottom, *GRID.top], [*GRID.bottom, *GRID.top])
    u = np.zeros((GRID.n_particles, 2))
    u[GRID.top] = 0.2, -0.1
    table = np.array([[-50.0, 3.0], [20.0, 1.0], [100.0, 0.5]])
    # between the points of the table: 1 + (20 - T) 2 / 70 below, 1 - (T - 20) / 160 above
    for hot, factor in ((-15.0, 2.0), (60.0, 0.75)):
        growth = Growth(0.0, None, table)
        _, path = solved(body_of(RUBBER, hot=hot, growth=growth), fixed, imposed=grown(u, STEPS))
        softer = MooneyRivlin(factor * C10, factor * C01, BULK)
        _, other = solved(body_of(softer), fixed, imposed=grown(u, STEPS))
        np.testing.assert_allclose(
            holding_forces(path)[-1], holding_forces(other)[-1], rtol=0.0, atol=1e-9
        )


def test_a_stretch_of_one_is_plane_strain_to_the_bit():
    fixed = fixed_components(GRID.n_particles, [*GRID.bottom, *GRID.top], [*GRID.bottom, *GRID.top])
    u = np.zeros((GRID.n_particles, 2))
    u[GRID.top] = 0.1, -0.3
    found = [
        solved(elastic, fixed, imposed=grown(u, STEPS))[1]
        for elastic in (body_of(RUBBER, stretch=1.0, hot=20.0), ElasticBody((Region(RUBBER),)))
    ]
    one, other = (path.steps[-1] for path in found)
    np.testing.assert_array_equal(one.d, other.d)
    assert one.residuals == other.residuals


def test_ramps_keep_their_values_in_other_load_steps():
    """Halved steps of the first stage and uneven ones of the second; values at the ends as before."""
    own = ramp_of_stages(20.0, [100.0, 60.0], [2, (0.25, 1.0)])
    np.testing.assert_allclose(own.at([0, 1, 2, 3, 4]), [20, 60, 100, 90, 60])
    np.testing.assert_allclose(own.at([0.5, 3.5]), [40, 75])
    other = own.with_ends([0.5, 1.0, 2.0, 2.5, 4.0])
    np.testing.assert_allclose(other.at([1, 2, 3, 4, 5]), [40, 60, 100, 95, 60])
    np.testing.assert_allclose(other.rates([3]), [1.0])
    assert own.extremes == (20.0, 100.0)
    assert isinstance(other, Ramp)
