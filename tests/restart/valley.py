"""A constrained curved valley that is quick to analyse, fails in places, and can be cut off."""

import os
import signal
from pathlib import Path

import numpy as np
import openmdao.api as om

from seal_mdao.recording.recorder import RestartRecorder, record_all


class Valley(om.ExplicitComponent):
    """f = sum of (1 - x_i)^2 + 20 (x_{i+1} - x_i^2)^2 and g = |x|^2; calls are counted."""

    def initialize(self):
        self.options.declare("steep", default=20.0)
        self.options.declare("rounding", default=0.0)
        self.options.declare("on_call", default=None, recordable=False)
        self.options.declare("on_gradient", default=None, recordable=False)

    def setup(self):
        self.add_input("x", val=np.array([-1.0, 0.5, 0.3]))
        self.add_output("f")
        self.add_output("g")
        self.declare_partials("*", "*")
        self.calls = self.gradients = 0

    def compute(self, inputs, outputs):
        self.calls += 1
        x, steep = inputs["x"], self.options["steep"]
        if self.options["on_call"] is not None:
            self.options["on_call"](self, x)
        outputs["f"] = np.sum((1 - x[:-1]) ** 2) + steep * np.sum((x[1:] - x[:-1] ** 2) ** 2)
        outputs["g"] = (1.0 + self.options["rounding"]) * (x @ x)

    def compute_partials(self, inputs, partials):
        self.gradients += 1
        x, steep = inputs["x"], self.options["steep"]
        if self.options["on_gradient"] is not None:
            self.options["on_gradient"](self, x)
        bend = x[1:] - x[:-1] ** 2
        slope = np.zeros_like(x)
        slope[:-1] = -2 * (1 - x[:-1]) - 4 * steep * x[:-1] * bend
        slope[1:] += 2 * steep * bend
        partials["f", "x"], partials["g", "x"] = slope, 2 * x


def valley_problem(driver, on_call=None, steep=20.0):
    """The problem after setup, at its start; nothing is recorded yet."""
    problem = om.Problem(driver=driver, reports=None)
    problem.model.add_subsystem("valley", Valley(on_call=on_call, steep=steep), promotes=["*"])
    problem.model.add_design_var("x", lower=-3.0, upper=3.0, ref=2.0, ref0=0.5)
    problem.model.add_objective("f", ref=3.0)
    problem.model.add_constraint("g", upper=2.0, ref=2.0)
    problem.setup()
    return problem


def record(problem, path="cases.sql", append=False):
    """Record all that a restart needs."""
    record_all(problem.driver, RestartRecorder(Path(path).absolute(), append=append))
    return problem


def kill_at(call):
    """For ``on_call``: kill this process in this call."""

    def check(component, _):
        if component.calls == call:
            os.kill(os.getpid(), signal.SIGKILL)

    return check


def killed(run) -> bool:
    """Call ``run`` in a process of its own; returns whether it was killed."""
    child = os.fork()
    if child == 0:
        try:
            run()
        finally:
            os._exit(0)
    _, status = os.waitpid(child, 0)
    return os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL


def designs(path="cases.sql"):
    """Designs of all recorded cases in order, shape (n, 3)."""
    reader = om.CaseReader(str(path))
    names = reader.list_cases("driver", recurse=False, out_stream=None)
    cases = [reader.get_case(name) for name in names]
    assert len(set(names)) == len(names)
    return np.array([case.get_design_vars(scaled=False)["x"] for case in cases]).reshape(-1, 3)
