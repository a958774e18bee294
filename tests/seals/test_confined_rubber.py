"""Rubber that is confined on all sides, under pressures of many shear moduli: a uniform strain."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem

RUBBER = """
[material.{name}]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 2e4
"""
SECTION = """
[section]
material = "one"
spacing = 0.4
outer = [
  { edge = "base", line = [[LEFT, 0.0], [RIGHT, 0.0]] },
  { edge = "right", line = [[RIGHT, 0.0], [RIGHT, 4.0]] },
  { edge = "top", line = [[RIGHT, 4.0], [LEFT, 4.0]] },
  { edge = "left", line = [[LEFT, 4.0], [LEFT, 0.0]] },
]
"""
REGION = (
    'region = [{ material = "two", at = [0.5, 3.0], line = [[-4, 1.5], [0.5, 2.2], [4, 1.5]] }]\n'
)
BETWEEN_WALLS = '[[symmetry]]\nedges = ["left", "right"]\nnormal = "x"\n[fixed]\nedges = ["base"]\n'
SIDE = (
    '[[moved]]\nedges = ["{}"]\ndirections = ["x"]\nstage = [{{ translate = [0, 0], steps = 1 }}]\n'
)
AROUND = '[fixed]\nedges = ["base"]\ndirections = ["y"]\n' + SIDE.format("right")
LID = SIDE.format("top").replace('"x"', '"y"').replace("[0, 0]", "[0, -TRAVEL]")
MODULUS, BULK, HEIGHT = 200.0, 2e4, 4.0

BLOCK = RUBBER.format(name="one") + SECTION.replace("LEFT", "-4.0").replace("RIGHT", "4.0")
CASES = {
    "block": BLOCK + BETWEEN_WALLS,
    "two materials": RUBBER.format(name="two") + BLOCK + REGION + BETWEEN_WALLS,
    "cylinder": '[model]\nkinematics = "axisymmetric"\n' + RUBBER.format(name="one")
    + SECTION.replace("LEFT", "0.0").replace("RIGHT", "6.0") + AROUND,
    "ring": '[model]\nkinematics = "axisymmetric"\n' + RUBBER.format(name="one")
    + SECTION.replace("LEFT", "0.5").replace("RIGHT", "6.0") + AROUND + SIDE.format("left"),
}  # fmt: skip


@pytest.mark.parametrize("pressure", [1.0, 12.0])
@pytest.mark.parametrize("name", CASES)
def test_a_uniform_strain_stays_uniform(tmp_path, name, pressure):
    """u = -travel y / 4 to rounding: eps times the condition of the tangent and the number of terms of a
    force; by quadrature of the volume displacements oscillated above 1.5 to 9 shear moduli."""
    travel = pressure * MODULUS * HEIGHT / BULK
    path = tmp_path / "confined.toml"
    path.write_text(CASES[name] + LID.replace("TRAVEL", str(travel)), encoding="utf-8")
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    particles = result.seal.nominal_particles
    exact = particles * [0.0, -travel / HEIGHT]
    problem = PathProblem(result.path.discretization, result.seal.terms())
    factor = problem.assemble_at(result.path.steps[-1]).factorize()
    inverse = factor.solve(np.eye(result.path.discretization.layout.n_equations))
    # a force has 4 + 3 terms of each of about 16 cells in the support of a particle
    rounding = 7 * 16 * np.finfo(float).eps * np.linalg.cond(inverse) * travel
    assert rounding < 1e-8
    np.testing.assert_allclose(result.deformed() - particles, exact, rtol=0.0, atol=rounding)
    assert result.warnings == ()
