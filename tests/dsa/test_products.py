"""Products with the Jacobian of measures against the Jacobian."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.dsa.parameters import parameter_rates
from seal_mdao.dsa.products import jvp, vjp
from seal_mdao.dsa.sensitivity import adjoint_gradient

MEASURES = ("von_mises", "gap", "gap_square_sum", "reaction")
NAMES = ("door_radius", "friction")


@pytest.fixture(scope="module")
def jacobian(random_design):
    return sm.differentiate(random_design, NAMES, MEASURES, method="adjoint")


def test_products_with_directions_are_columns_mixed(random_design, jacobian, rng):
    rates = parameter_rates(random_design.seal.design_velocity, NAMES)
    mix = rng.standard_normal((rates.count, 2))
    mixed = type(rates)(
        np.tensordot(mix.T, rates.velocity, 1), rates.names, rates.scalars @ mix
    )  # fmt: skip
    found = jvp(random_design, MEASURES, mixed)
    for name in MEASURES:
        expected = np.atleast_2d(jacobian[name]) @ mix
        scale = (np.abs(np.atleast_2d(jacobian[name])) @ np.abs(mix)).max()
        np.testing.assert_allclose(found[name], expected, rtol=0.0, atol=1e-10 * scale)


def test_products_with_weights_are_rows_mixed_by_one_sweep(
    random_design, jacobian, rng, monkeypatch
):
    counts = []

    def counted(result, wanted, names):
        counts.append(wanted.count)
        return adjoint_gradient(result, wanted, names)

    monkeypatch.setattr("seal_mdao.dsa.products.adjoint_gradient", counted)
    tables = {name: np.atleast_2d(jacobian[name]) for name in MEASURES}
    weights = {name: rng.standard_normal((2, len(table))) for name, table in tables.items()}
    found = vjp(random_design, weights, NAMES)
    assert counts == [2]
    velocity = random_design.seal.design_velocity
    shape = np.tensordot(found.particles, velocity, ((1, 2), (1, 2)))
    expected = sum(weights[name] @ table for name, table in tables.items())
    scale = sum(np.abs(weights[name]) @ np.abs(table) for name, table in tables.items()).max()
    rows = np.hstack([shape, found.of(NAMES)])
    np.testing.assert_allclose(rows, expected, rtol=0.0, atol=1e-10 * scale)
