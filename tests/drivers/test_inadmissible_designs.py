"""Components upstream that make designs which a seal does not admit: drivers step back."""

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of

RADIUS, AIM = 4.0, 0.6
"""Of the nominal door, mm, and the part of the way to radius zero at which the optimum lies."""

DRIVERS = {
    "uno": lambda: sm.UnoDriver(trust_radius=10.0),
    "ipopt": sm.IpoptDriver,
    "slsqp": sm.SlsqpDriver,
}


class Upstream(om.ExplicitComponent):
    """Radius and offsets from one number: beyond 1 the radius is negative, or the offsets exceed the
    wall, or nothing is a number."""

    def initialize(self):
        self.options.declare("seal")
        self.options.declare("kind", values=("radius", "wall", "nan"))

    def setup(self):
        n = self.options["seal"].n_offsets
        self.add_input("t", val=0.1)
        self.add_output("door_radius", units="mm", val=RADIUS)
        self.add_output("boundary_offsets", units="mm", val=np.zeros(n))
        self.add_output("distance", val=0.0)
        self.declare_partials("*", "t")
        wall = options_of(self.options["seal"]).section
        self._rate = wall.outer_radius - wall.inner_radius
        self._way = np.zeros(n)
        self._way[0] = 1.0

    def compute(self, inputs, outputs):
        t, kind = inputs["t"].item(), self.options["kind"]
        outputs["door_radius"] = RADIUS * (1.0 - t) if kind == "radius" else RADIUS
        # to the thickness of the wall at t = 1, hardly before
        reach = max(t, 0.0) ** 8 * self._rate if kind == "wall" else 0.01 * t
        outputs["boundary_offsets"] = np.nan if kind == "nan" and t > 1.0 else reach * self._way
        outputs["distance"] = 1e3 * (t - AIM) ** 2

    def compute_partials(self, inputs, partials):
        t, kind = inputs["t"].item(), self.options["kind"]
        partials["door_radius", "t"] = -RADIUS if kind == "radius" else 0.0
        slope = 8.0 * max(t, 0.0) ** 7 * self._rate if kind == "wall" else 0.01
        partials["boundary_offsets", "t"] = slope * self._way
        partials["distance", "t"] = 2e3 * (t - AIM)


@pytest.fixture(scope="module")
def quick():
    """A door that hardly presses: five steps."""
    return sm.door_seal(depth=0.6, n_steps=5)


def pressed_problem(quick, kind, driver):
    """Minimise a distance whose first gradient step leads far beyond what the seal admits."""
    problem = om.Problem(driver=driver, reports=None)
    model = problem.model
    model.add_subsystem("upstream", Upstream(seal=quick, kind=kind), promotes=["*"])
    model.add_subsystem("seal", sm.SealGroup(seal=quick, measures=("reaction",)), promotes=["*"])
    model.add_design_var("t", lower=-5.0, upper=50.0)
    model.add_objective("distance")
    model.add_constraint("reaction", lower=-1e3, indices=[1])
    problem.setup()
    return problem


@pytest.mark.parametrize("kind", ["radius", "wall", "nan"])
@pytest.mark.parametrize("name", DRIVERS)
def test_drivers_step_back_from_inadmissible_designs(quick, kind, name):
    problem = pressed_problem(quick, kind, DRIVERS[name]())
    found = problem.run_driver()
    assert found.success, found.exit_status
    assert problem.get_val("t") == pytest.approx([AIM], abs=1e-4)
    assert problem.driver.failed_analyses > 0
    assert np.isfinite(problem.get_val("reaction")).all()


@pytest.mark.parametrize("kind", ["radius", "wall", "nan"])
def test_scipys_own_driver_ends_with_an_analysis_error(quick, kind):
    """OpenMDAO's ScipyOptimizeDriver ends with the first exception that a model raises."""
    driver = om.ScipyOptimizeDriver(optimizer="SLSQP", disp=False)
    problem = pressed_problem(quick, kind, driver)
    with pytest.raises(om.AnalysisError, match="rejects this design"):
        problem.run_driver()
