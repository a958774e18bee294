"""Rubber that is confined on all sides, under pressures of many shear moduli: a uniform strain."""

import numpy as np
import pytest
from square_bodies import (
    AROUND,
    BULK_MODULUS,
    HEIGHT,
    SHEAR_MODULUS,
    inverse_tangent,
    rubber,
    section,
)

import seal_mdao as sm

REGION = (
    'region = [{ material = "two", at = [0.5, 3.0], line = [[-4, 1.5], [0.5, 2.2], [4, 1.5]] }]\n'
)
BETWEEN_WALLS = '[[symmetry]]\nedges = ["left", "right"]\nnormal = "x"\n[fixed]\nedges = ["base"]\n'
SIDE = (
    '[[moved]]\nedges = ["{}"]\ndirections = ["x"]\nstage = [{{ translate = [0, 0], steps = 1 }}]\n'
)
TURNED = '[fixed]\nedges = ["base"]\ndirections = ["y"]\n' + SIDE.format("right")
LID = SIDE.format("top").replace('"x"', '"y"').replace("[0, 0]", "[0, -TRAVEL]")


def body(left, right):
    """Tables of a body of the material ``one``."""
    return rubber("one") + section(left, right, 0.4, "one")


CASES = {
    "block": body(-4.0, 4.0) + BETWEEN_WALLS,
    "two materials": rubber("two") + body(-4.0, 4.0) + REGION + BETWEEN_WALLS,
    "cylinder": AROUND + body(0.0, 6.0) + TURNED,
    "ring": AROUND + body(0.5, 6.0) + TURNED + SIDE.format("left"),
}  # fmt: skip


@pytest.mark.parametrize("pressure", [1.0, 12.0])
@pytest.mark.parametrize("name", CASES)
def test_a_uniform_strain_stays_uniform(tmp_path, name, pressure):
    """u = -travel y / 4 to rounding: eps times the condition of the tangent and the number of terms of a
    force; by quadrature of the volume displacements oscillated above 1.5 to 9 shear moduli."""
    travel = pressure * SHEAR_MODULUS * HEIGHT / BULK_MODULUS
    path = tmp_path / "confined.toml"
    path.write_text(CASES[name] + LID.replace("TRAVEL", str(travel)), encoding="utf-8")
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    particles = result.seal.nominal_particles
    exact = particles * [0.0, -travel / HEIGHT]
    condition = np.linalg.cond(inverse_tangent(result))
    # a force has 4 + 3 terms of each of about 16 cells in the support of a particle
    rounding = 7 * 16 * np.finfo(float).eps * condition * travel
    assert rounding < 1e-8
    np.testing.assert_allclose(result.deformed() - particles, exact, rtol=0.0, atol=rounding)
    assert result.warnings == ()
