"""Direct and adjoint sensitivities of every friction and door case, cut steps included."""

from functools import cache
from itertools import pairwise

import numpy as np
import openmdao.api as om
import pytest

from seal_mdao.components.seal_group import SealGroup
from verification.tolerances import TOLERANCES
from verification.two_methods import (
    DOORS,
    FRICTIONS,
    PATHS,
    RADIUS,
    analyze_case,
    case_model,
    method_difference,
)

OF = ["von_mises", "gap", "gap_square_sum", "reaction", "area"]
WRT = ["boundary_offsets", "door_radius", "friction", "c10", "depth"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("friction", FRICTIONS)
def test_direct_and_adjoint_agree(figure, friction, door, path):
    result = analyze_case(friction, door, path)
    if "cut" in path:
        assert result.step_cuts > 0
        assert any(step.nominal < 0 for step in result.path.steps)
    difference = method_difference(result)
    # two sums in another order: equal bits would mean that one method had been called twice
    assert difference > 0.0
    name = f"direct against adjoint: {friction}, {door} door, {path}"
    figure(name, difference, TOLERANCES["two_methods"])


def test_without_friction_the_contact_reaches_the_corner():
    """Else the three doors would be one case."""
    sideways = [analyze_case("frictionless", door, "40 steps").reaction[-1, 0] for door in DOORS]
    assert np.ptp(sideways[:2]) > 1e-3
    assert abs(sideways[2]) < 1e-9 < abs(sideways[0])


# fwd is the dearer choice here, as OpenMDAO says
pytestmark = pytest.mark.filterwarnings("ignore:.*Inefficient choice of derivative mode")


@pytest.fixture(scope="module")
def model():
    return case_model("accumulated", "corner", "40 steps")


def group_problem(model, mode, sensitivity, variables=WRT, response="gap_square_sum"):
    """The group at a random design with its derivatives not yet asked for."""
    problem = om.Problem(reports=None)
    group = SealGroup(seal=model, sensitivity=sensitivity, parameters=tuple(WRT[2:]))
    problem.model.add_subsystem("seal", group, promotes=["*"])
    for name in variables:
        problem.model.add_design_var(name)
    problem.model.add_constraint(response, upper=1.0)
    problem.setup(mode=mode)
    offsets = np.random.default_rng(7).uniform(-0.04, 0.04, model.n_offsets)
    problem.set_val("boundary_offsets", offsets)
    problem.set_val("door_radius", RADIUS)
    problem.run_model()
    return problem


@pytest.fixture(scope="module")
def totals(model):
    """Total derivatives of all measures by OpenMDAO's mode and the method of the partials."""

    @cache
    def compute(mode, sensitivity):
        problem = group_problem(model, mode, sensitivity)
        return problem.compute_totals(of=OF, wrt=WRT, return_format="array")

    return compute


def relative(found, exact):
    """Largest difference over the largest derivative of a measure in the parameters of one unit."""
    edges = np.cumsum([0, 25, 1, 1, 1, 1])
    return max(
        np.max(np.abs(f - e) / np.maximum(np.abs(e).max(axis=1, keepdims=True), 1e-12))
        for f, e in ((found[:, a:b], exact[:, a:b]) for a, b in pairwise(edges))
    )


@pytest.mark.parametrize("sensitivity", ["direct", "adjoint"])
def test_group_in_forward_and_reverse_mode(figure, totals, sensitivity):
    forward, reverse = (totals(mode, sensitivity) for mode in ("fwd", "rev"))
    assert forward.shape == (7 + 4 + 1 + 2 + 1, 25 + 4)
    name = f"SealGroup, {sensitivity} partials: fwd against rev"
    figure(name, relative(forward, reverse), TOLERANCES["two_methods"])


def test_group_with_direct_and_adjoint_partials(figure, totals):
    difference = relative(totals("fwd", "direct"), totals("rev", "adjoint"))
    figure("SealGroup: fwd, direct against rev, adjoint", difference, TOLERANCES["two_methods"])


def test_partials_take_the_cheaper_method_by_themselves(totals):
    """14 measures against 348 coordinates of particles: adjoint, bit for bit."""
    np.testing.assert_array_equal(totals("auto", "auto"), totals("rev", "adjoint"))


def test_mode_auto_takes_the_cheaper_direction(figure, model, totals):
    """Many parameters and one response: reverse. One parameter and seven stresses: forward."""
    many = group_problem(model, "auto", "auto")
    few = group_problem(model, "auto", "auto", ["door_radius"], "von_mises")
    for problem, mode in ((many, "rev"), (few, "fwd")):
        found = problem.compute_totals(of=OF, wrt=WRT, return_format="array")
        assert problem.model._mode == mode
        difference = relative(found, totals("fwd", "direct"))
        figure(f"SealGroup: auto ({mode}) against direct", difference, TOLERANCES["two_methods"])
