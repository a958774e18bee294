"""Small models for the driver tests."""

from __future__ import annotations

import numpy as np
import openmdao.api as om

TARGET = np.array([3.0, -2.0, 1.0, 0.5])
"""Target of `projection_problem`."""


class PlaneComp(om.ExplicitComponent):
    """A function of two variables with chosen points of failure.

    Options
    -------
    f, df : callable
        Function and gradient.
    hook, partials_hook : callable
        Called with ``x`` (and the number of the call) before the function or the gradient is
        evaluated; may raise.
    """

    def initialize(self):
        """Declare the options."""
        self.options.declare("f", recordable=False)
        self.options.declare("df", recordable=False)
        self.options.declare("hook", default=lambda x, call: None, recordable=False)
        self.options.declare("partials_hook", default=lambda x, call: None, recordable=False)

    def setup(self):
        """Declare inputs and outputs."""
        self.add_input("x", val=np.zeros(2))
        self.add_output("f", val=0.0)
        self.calls = self.partials_calls = 0
        self.visited = []

    def setup_partials(self):
        """Declare dense partials."""
        self.declare_partials("*", "*")

    def compute(self, inputs, outputs):
        """Evaluate the function."""
        self.calls += 1
        self.options["hook"](inputs["x"], self.calls)
        self.visited.append(inputs["x"].copy())
        outputs["f"] = self.options["f"](inputs["x"])

    def compute_partials(self, inputs, partials):
        """Evaluate the gradient."""
        self.partials_calls += 1
        self.options["partials_hook"](inputs["x"], self.partials_calls)
        partials["f", "x"] = self.options["df"](inputs["x"])


def quadratic(x):
    """Return a convex quadratic with its minimum 0 at (0, 1)."""
    return x[0] ** 2 + 5 * (x[1] - 1) ** 2


def d_quadratic(x):
    """Return the gradient of the quadratic."""
    return [2 * x[0], 10 * (x[1] - 1)]


def rosenbrock(x):
    """Return Rosenbrock's function, with its minimum 0 at (1, 1)."""
    return 100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2


def d_rosenbrock(x):
    """Return the gradient of Rosenbrock's function."""
    return [-400 * x[0] * (x[1] - x[0] ** 2) - 2 * (1 - x[0]), 200 * (x[1] - x[0] ** 2)]


def plane_problem(driver, start, f=quadratic, df=d_quadratic, **hooks):
    """Return a problem with two design variables between -10 and 10, set up at a start."""
    prob = _plane_model(driver, f=f, df=df, **hooks)
    return _ready(prob, start)


def constrained_problem(driver, start, formula, least, **hooks):
    """Return the problem of the quadratic with a formula in x that is to be at least a value."""
    prob = _plane_model(driver, f=quadratic, df=d_quadratic, **hooks)
    comp = om.ExecComp(f"g = {formula}", x=np.zeros(2))
    prob.model.add_subsystem("formula", comp, promotes=["*"])
    prob.model.add_constraint("g", lower=least)
    return _ready(prob, start)


def _plane_model(driver, **options):
    prob = om.Problem(driver=driver, reports=None)
    prob.model.add_subsystem("plane", PlaneComp(**options), promotes=["*"])
    prob.model.add_design_var("x", lower=-10, upper=10)
    prob.model.add_objective("f")
    return prob


def _ready(prob, start):
    prob.setup()
    prob.set_val("x", np.array(start, dtype=float))
    prob.driver.options["singular_jac_behavior"] = "ignore"
    return prob


def failing_where(condition):
    """Return a hook that raises AnalysisError where a condition on ``x`` holds."""

    def hook(x, call):
        if condition(x):
            raise om.AnalysisError("the analysis does not converge here")

    return hook


class BetzComp(om.ExplicitComponent):
    """Power coefficient of an actuator disc; its maximum 16/27 is the Betz limit, at a = 1/3."""

    def setup(self):
        """Declare inputs and outputs."""
        self.add_input("a", val=0.5)
        self.add_input("Area", val=10.0, units="m**2")
        self.add_input("rho", val=1.225, units="kg/m**3")
        self.add_input("Vu", val=10.0, units="m/s")
        self.add_output("Vr", val=0.0, units="m/s")
        self.add_output("Cp", val=0.0)
        self.add_output("power", val=0.0, units="W")

    def setup_partials(self):
        """Declare partials."""
        self.declare_partials("Vr", ["a", "Vu"])
        self.declare_partials("Cp", "a")
        self.declare_partials("power", ["a", "rho", "Area", "Vu"])

    def compute(self, inputs, outputs):
        """Evaluate the disc."""
        a, area, rho, speed = (inputs[name][0] for name in ("a", "Area", "rho", "Vu"))
        outputs["Vr"] = speed * (1 - a)
        outputs["Cp"] = 4 * a * (1 - a) ** 2
        outputs["power"] = 0.5 * rho * area * speed**3 * outputs["Cp"]

    def compute_partials(self, inputs, partials):
        """Evaluate the derivatives."""
        a, area, rho, speed = (inputs[name][0] for name in ("a", "Area", "rho", "Vu"))
        cp, slope = 4 * a * (1 - a) ** 2, 4 * (1 - a) * (1 - 3 * a)
        flow = 0.5 * rho * area * speed**3
        partials["Vr", "a"] = -speed
        partials["Vr", "Vu"] = 1 - a
        partials["Cp", "a"] = slope
        partials["power", "a"] = flow * slope
        partials["power", "rho"] = flow / rho * cp
        partials["power", "Area"] = flow / area * cp
        partials["power", "Vu"] = 3 * flow / speed * cp


def projection_problem(driver, **desvar_options):
    """Return a problem, not yet set up: x is to be near a target, s holds its squares."""
    prob = om.Problem(driver=driver, reports=None)
    model = prob.model
    length = {"shape": 4, "units": "m"}
    model.add_subsystem("ivc", om.IndepVarComp("x", np.zeros(4), units="m"), promotes=["*"])
    model.add_subsystem(
        "distance",
        om.ExecComp("f = sum((x - t)**2)", x=length, t=TARGET),
        promotes=["x", "f"],
    )
    squares = om.ExecComp("s = x**2", x=length, s={"shape": 4}, has_diag_partials=True)
    model.add_subsystem("squares", squares, promotes=["*"])
    model.add_design_var("x", **{"lower": -10.0, "upper": 10.0, **desvar_options})
    model.add_objective("f")
    return prob


def run_projection(prob, start=(0.0, 0.0, 0.0, 0.0)):
    """Set the problem up, run it from a start, check that it succeeds and return x."""
    prob.setup()
    prob.set_val("x", np.array(start))
    prob.driver.options["singular_jac_behavior"] = "ignore"
    result = prob.run_driver()
    assert result.success, result.exit_status
    return prob.get_val("x")
