"""Rubber that softens: blocks against the closed form of homogeneous states, the half disc against
independent finite elements."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.special import erf

import seal_mdao as sm
from seal_mdao.calibration.data import material_tests
from seal_mdao.calibration.softening_fit import fit_softening
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import profile_histories
from verification.relaxing import PLANE_STRAIN, UNIAXIAL, Rubber, balanced, isochoric_stress

REFERENCES = Path(__file__).parent / "references"
RUBBER = Rubber(80.0, 20.0, 2e4, (), ())
LAW = {"r": 2.0, "m": 4.0, "beta": 0.2}
STEPS = 4
FILE = """\
[model]
kinematics = "{kinematics}"
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 2e4
softening = {{ r = 2.0, m = 4.0, beta = 0.2 }}
[section]
material = "rubber"
spacing = 1.5
outer = [
  {{ edge = "base", line = [[0, 0], [4, 0]] }}, {{ edge = "right", line = [[4, 0], [4, 5]] }},
  {{ edge = "top", line = [[4, 5], [0, 5]] }}, {{ edge = "left", line = [[0, 5], [0, 0]] }},
]
[[symmetry]]
edges = ["base"]
normal = "y"
{supports}
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{stages}]
"""
SIDE = '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'
CASES = {
    "plane strain": (PLANE_STRAIN, "plane_strain", SIDE, 4.0),
    # N of kPa mm^2
    "uniaxial": (UNIAXIAL, "axisymmetric", "", 1e-3 * np.pi * 4.0**2),
}


def energy(F) -> float:
    """W = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3)."""
    C, J = F.T @ F, np.linalg.det(F)
    first = np.trace(C)
    second = 0.5 * (first**2 - np.trace(C @ C))
    return RUBBER.c10 * (J ** (-2 / 3) * first - 3.0) + RUBBER.c01 * (J ** (-4 / 3) * second - 3.0)


def softened_force(state, stretches):
    """Nominal stress of the block along a path of stretches, by Newton's method for the free one."""
    largest, x, found = 0.0, 1.0, []

    def factor(F):
        below = largest - energy(F)
        return 1.0 - (
            erf(below / (LAW["m"] + LAW["beta"] * largest)) / LAW["r"] if below > 0 else 0
        )

    for stretch in stretches:
        # S = eta S_iso: S_iso and a further (eta - 1) S_iso
        F, P, x = balanced(
            RUBBER, state, stretch, lambda F: (factor(F) - 1.0) * isochoric_stress(RUBBER, F), x
        )
        largest = max(largest, energy(F))
        found.append(P)
    return np.array(found)


@pytest.mark.parametrize(("state", "kinematics", "supports", "area"), CASES.values(), ids=CASES)
@pytest.mark.parametrize("travel", [-1.0, 1.5])
def test_cycles_of_a_block(tmp_path, state, kinematics, supports, area, travel):
    """Press, release, press further, release: the force at every load step is that of the closed form,
    eta(W, W_max) times that of the elastic block but for its volume."""
    corners = np.array([0.0, 1.0, 0.2, 1.5, 0.0]) * travel
    stages = ", ".join(
        f"{{ translate = [0.0, {own:.17g}], steps = {STEPS} }}" for own in np.diff(corners)
    )
    path = tmp_path / "block.toml"
    path.write_text(FILE.format(kinematics=kinematics, supports=supports, stages=stages))
    result = sm.analyze(sm.build_seal(read_seal_file(path)))
    result.require_converged()
    moved = np.interp(np.arange(1, 4 * STEPS + 1) / STEPS, np.arange(5), corners)
    expected = softened_force(state, 1.0 + moved / 5.0)
    force = -result.path.reaction("top")[:, 1] / area
    # Newton's tolerance of the residual, relative to the forces
    np.testing.assert_allclose(force, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    # it softens: half of the elastic stress is the limit
    elastic = balanced(RUBBER, state, 1.0 + moved[5] / 5.0, lambda F: 0.0 * F, 1.0)[1]
    assert 0.5 < force[5] / elastic < 0.9


def test_constants_from_the_force_of_a_block(tmp_path):
    """Two cycles of an analysis as a cyclic test: the fit, which supposes no change of volume, returns
    the constants of the file but for a part of the order of 100 kPa over the bulk modulus, here 5e-5."""
    _, kinematics, supports, area = CASES["uniaxial"]
    corners = np.array([0.0, 1.0, 0.2, 1.5, 0.3])
    stages = ", ".join(
        f"{{ translate = [0.0, {own:.17g}], steps = 6 }}" for own in np.diff(corners)
    )
    text = FILE.format(kinematics=kinematics, supports=supports, stages=stages)
    path = tmp_path / "block.toml"
    path.write_text(text.replace("bulk_modulus = 2e4", "bulk_modulus = 2e6"))
    result = sm.analyze(sm.build_seal(read_seal_file(path)))
    result.require_converged()
    stretch = 1.0 + np.interp(np.arange(1, 25) / 6.0, np.arange(5), corners) / 5.0
    stress = -result.path.reaction("top")[:, 1] / area
    found = fit_softening("mooney_rivlin", material_tests({"uniaxial": (stretch, stress)}))
    expected = {"c10": 80.0, "c01": 20.0, **{"softening_" + name: own for name, own in LAW.items()}}
    fitted = {name: found.tested_law.constants[name] for name in expected}
    assert fitted == pytest.approx(expected, rel=3e-4)


@pytest.mark.long
def test_the_softening_disc_against_finite_elements(figure):
    """Force and nominal peak pressure in press, release, further press and release, over their largest
    values."""
    known = json.loads((REFERENCES / "softening_disc.json").read_text(encoding="utf-8"))
    result = sm.analyze(build_seal(read_seal_file(REFERENCES / "softening_disc.toml")))
    result.require_converged()
    history = profile_histories(result)[0]
    every = len(history.force) // len(known["travel_mm"])
    for what, found, key in (
        ("force", np.abs(history.force[:, 1]), "force_N_per_m"),
        ("peak pressure", history.nominal_peak, "peak_kPa"),
    ):
        wanted = np.array(known[key])
        error = np.abs(found[every - 1 :: every] - wanted).max() / wanted.max()
        figure(f"softening_disc: {what}", error, 1e-2)
