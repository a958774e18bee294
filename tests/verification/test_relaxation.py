"""Blocks and cylinders of seal files that relax, against solutions of homogeneous states."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.file.read import read_seal_file
from verification.relaxing import PLANE_STRAIN, UNIAXIAL, History, Rubber, convolution, recursion

RUBBER = Rubber(80.0, 20.0, 2e4, (0.3, 0.2), (1.0, 100.0))
STEPS = 6
FILE = """\
[model]
kinematics = "{kinematics}"
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 2e4
[material.rubber.viscoelastic]
g = [0.3, 0.2]
tau = [1.0, 100.0]
[section]
material = "rubber"
spacing = 1.0
outer = [
  {{ edge = "base", line = [[0, 0], [4, 0]] }}, {{ edge = "right", line = [[4, 0], [4, 5]] }},
  {{ edge = "top", line = [[4, 5], [0, 5]] }}, {{ edge = "left", line = [[0, 5], [0, 0]] }},
]
{supports}
[[moved]]
edges = ["top"]
directions = {directions}
stage = [
  {{ translate = {travel}, steps = {steps}, duration = 2.0 }},
  {{ steps = {steps}, duration = 500.0 }},
  {{ translate = {back}, steps = {steps}, duration = 5.0 }},
  {{ steps = {steps}, duration = 50.0 }},
]
"""
SYMMETRIC = """\
[[symmetry]]
edges = ["base"]
normal = "y"
"""
SIDE = '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'


def seal_of(folder, steps=STEPS, **keys):
    path = folder / "block.toml"
    path.write_text(FILE.format(steps=steps, **keys))
    seal = sm.build_seal(read_seal_file(path))
    result = sm.analyze(seal)
    result.require_converged()
    return result


def times_of(result):
    """Times at the start and after every load step, s."""
    times = result.seal.terms()[0].environment.time
    return times.at(np.arange(result.seal.n_steps + 1))


CASES = {
    "plane strain": (PLANE_STRAIN, "plane_strain", SYMMETRIC + SIDE, 4.0),
    "uniaxial": (UNIAXIAL, "axisymmetric", SYMMETRIC, np.pi * 4.0**2),
}


@pytest.mark.parametrize(("state", "kinematics", "supports", "area"), CASES.values(), ids=CASES)
@pytest.mark.parametrize("travel", [-1.0, 1.5])
def test_compressed_and_stretched_blocks(tmp_path, state, kinematics, supports, area, travel):
    """Ramp, hold, release and dwell: the force at every load step is that of the recursion, solved
    independently in three dimensions."""
    result = seal_of(
        tmp_path, kinematics=kinematics, supports=supports, directions='["y"]',
        travel=[0.0, travel], back=[0.0, -0.6 * travel],
    )  # fmt: skip
    corners = np.cumsum([0.0, travel, 0.0, -0.6 * travel, 0.0])
    moved = np.interp(np.arange(4 * STEPS + 1), STEPS * np.arange(5), corners)
    expected = recursion(RUBBER, state, times_of(result), 1.0 + moved / 5.0)
    # N per metre of kPa mm, and mN of kPa mm^2
    force = -result.path.reaction("top")[:, 1] / area
    if kinematics == "axisymmetric":
        force *= 1e3
    # Newton's tolerance of the residual, relative to the forces
    np.testing.assert_allclose(force, expected[1:], rtol=0.0, atol=1e-8 * np.abs(expected).max())


def test_the_force_converges_with_order_two_in_the_load_step(tmp_path):
    """A compressed block through ramp, hold and release against the exact convolution."""
    travel, errors, exact = -1.0, [], None
    for steps in (3, 6, 12):
        result = seal_of(
            tmp_path, steps, kinematics="plane_strain", supports=SYMMETRIC + SIDE,
            directions='["y"]', travel=[0.0, travel], back=[0.0, -0.6 * travel],
        )  # fmt: skip
        times = times_of(result)
        ends = times[::steps]
        corners = 1.0 + np.cumsum([0.0, travel, 0.0, -0.6 * travel, 0.0]) / 5.0
        if exact is None:
            # the ends of the stages are the same
            history = History(tuple(ends), tuple(corners))
            exact = convolution(RUBBER, PLANE_STRAIN, history, ends)
        force = -result.path.reaction("top")[steps - 1 :: steps, 1] / 4.0
        errors.append(np.abs(force - exact[1:]).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(rates > 1.8), rates
    assert errors[-1] < 2e-3 * np.abs(exact).max()
