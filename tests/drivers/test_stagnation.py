"""Ends at a jump of the model, around which an optimiser tries designs without end."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.drivers.optimizer_driver import OptimizerDriver, SolverEnd
from seal_mdao.drivers.stagnation import PATIENCE

HALVINGS = 60


class HalvingDriver(OptimizerDriver):
    """An optimiser that halves its steps to and fro across x0 = 1, until it is stopped."""

    def prepare(self, callbacks):
        def solve(start):
            self.tried = 0
            while self.tried < HALVINGS and not callbacks.stopping:
                # values of objective and constraints are asked for one after the other
                for _ in range(2):
                    callbacks.values(np.array([1.0 + (-0.5) ** self.tried, start[1]]))
                self.tried += 1
            return SolverEnd(start, False, "no step is accepted")

        return solve


class JumpComp(om.ExplicitComponent):
    """Objective (x0 - 3)^2 + (x1 - x0^2)^2, and a constraint that jumps by ``height`` at x0 = 1."""

    def initialize(self):
        self.options.declare("height")

    def setup(self):
        self.add_input("x", val=np.zeros(2))
        self.add_output("f", val=0.0)
        self.add_output("stress", val=0.0)

    def setup_partials(self):
        self.declare_partials("*", "*")

    def compute(self, inputs, outputs):
        x = inputs["x"]
        outputs["f"] = (x[0] - 3.0) ** 2 + (x[1] - x[0] ** 2) ** 2
        outputs["stress"] = 40.0 + 0.1 * x[0] + self.options["height"] * (x[0] > 1.0)

    def compute_partials(self, inputs, partials):
        x = inputs["x"]
        off = x[1] - x[0] ** 2
        partials["f", "x"] = [2.0 * (x[0] - 3.0) - 4.0 * x[0] * off, 2.0 * off]
        partials["stress", "x"] = [0.1, 0.0]


def run(driver, height, start=(-2.0, 3.0)):
    prob = om.Problem(reports=False)
    prob.model.add_subsystem("comp", JumpComp(height=height), promotes=["*"])
    prob.model.add_design_var("x", lower=-5.0, upper=5.0)
    prob.model.add_objective("f")
    prob.model.add_constraint("stress", upper=42.0)
    prob.driver = driver
    prob.setup()
    prob.set_val("x", start)
    return prob, prob.run_driver()


def test_a_jump_ends_the_run_and_is_named():
    prob, result = run(HalvingDriver(), 4.0)
    assert not result.success
    # 4 of 44.1 kPa
    assert "the model jumps" in result.exit_status
    assert "'stress' by 9.07%" in result.exit_status
    assert "the objective" not in result.exit_status
    assert "best feasible design found is the result" in result.exit_status
    # x0 of all designs is within 4; (1 + 1/2) 2^-k < 4e-3 for k = 9 and the PATIENCE - 1 after it
    assert prob.driver.tried == 9 + PATIENCE
    assert prob.get_val("stress")[0] <= 42.0


@pytest.mark.parametrize("height", [0.0, 0.2])
def test_small_steps_of_a_smooth_model_are_no_stagnation(height):
    """A jump of 0.2 of 40 kPa is smaller than those that are reported."""
    prob, result = run(HalvingDriver(), height)
    assert result.exit_status == "no step is accepted"
    assert prob.driver.tried == HALVINGS


def test_uno_begins_once_more_at_the_best_point():
    """The limit of stress is exceeded beyond the jump, where the minimum of the objective is."""
    starts = []

    class WatchedDriver(sm.UnoDriver):
        def prepare(self, callbacks):
            again = callbacks.try_again

            def try_again():
                starts.append((callbacks.firm.x.copy(), again()))
                return starts[-1][1]

            callbacks.try_again = try_again
            return super().prepare(callbacks)

    prob, _ = run(WatchedDriver(maxiter=60), 4.0, (-1.0, 2.0))
    assert len(starts) == 1
    design, allowed = starts[0]
    assert allowed
    assert design[0] <= 1.0
    assert prob.get_val("stress")[0] <= 42.0
