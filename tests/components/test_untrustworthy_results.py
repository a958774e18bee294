"""Warnings of components and drivers about completed analyses whose results are not trustworthy."""

import re
import warnings

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import DESIGN, FIXED, LID, seal_of

import seal_mdao as sm
from seal_mdao.components.failures import warn_of_faults
from seal_mdao.drivers.optimizer_driver import OptimizerDriver, SolverEnd

CORNER = "the result is not trustworthy: material is inverted at the end of a fixed edge"
FAULT = "material is inverted near x = {}"


@pytest.fixture(scope="module")
def deep(tmp_path_factory):
    """A block pressed so deep that its material is inverted beside the fixed edge."""
    lid = LID.replace("[0, -0.5], steps = 3", "[0, -1.5], steps = 12")
    lid = lid.replace("normal_penalty", 'contact_points = "particles"\nnormal_penalty')
    return seal_of(tmp_path_factory.mktemp("deep"), FIXED, DESIGN, lid, spacing=1.3)


def test_group_warns_once_for_every_fault_and_not_for_derivatives(deep, problem):
    made = problem(sm.SealGroup(seal=deep))
    with pytest.warns(sm.UntrustworthyResultWarning) as found:
        made.run_model()
    said = [str(own.message) for own in found]
    assert any(CORNER in text for text in said)
    assert all(text.startswith("'seal.contact' <class RkpmContactComp>: ") for text in said)
    faults = made.model.seal.contact.faults()
    assert [text.partition("trustworthy: ")[2] for text in said] == list(faults)
    assert faults == sm.analyze(deep).faults
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # another design has the same faults with other numbers
        made.set_val("boundary_offsets", 0.02)
        made.compute_totals(["reaction"], ["boundary_offsets"])
        made.run_model()
    assert made.model.seal.contact.faults() != faults


def test_warning_that_is_an_error_stops_every_run(deep, problem):
    made = problem(sm.SealGroup(seal=deep))
    with warnings.catch_warnings():
        warnings.simplefilter("error", sm.UntrustworthyResultWarning)
        for _ in range(2):
            with pytest.raises(sm.UntrustworthyResultWarning, match=CORNER):
                made.run_model()


def test_scenarios_name_the_scenario_with_the_fault(deep, problem):
    numbers = np.array([[0.2], [-1.2]])
    varied = sm.Scenarios((sm.Variation("lid_y", "shift"),), 1.2 + numbers)
    made = problem(sm.ScenarioGroup(seal=deep, scenarios=varied, workers=0))
    with pytest.warns(sm.UntrustworthyResultWarning) as found:
        made.run_model()
    assert all(
        re.search(r"trustworthy: scenario 2 of 2 \(lid_y \+ 0\): ", str(own.message))
        for own in found
    )


class FaultyComp(om.ExplicitComponent):
    """A component whose results have a fault that depends on its input."""

    def setup(self):
        self.add_input("x", 2.0)
        self.add_output("f", 0.0)
        self.declare_partials("f", "x", method="fd")

    def compute(self, inputs, outputs):
        outputs["f"] = (inputs["x"] - 1.0) ** 2
        self.at = float(inputs["x"][0])

    def faults(self):
        return (FAULT.format(round(self.at, 2)),) if self.at < 1.5 else ()


class AtOneDriver(OptimizerDriver):
    """An optimiser that knows the result."""

    def prepare(self, callbacks):
        return lambda x: SolverEnd(np.ones(1), True, "found")


@pytest.mark.parametrize("driver", [AtOneDriver, sm.SlsqpDriver])
@pytest.mark.parametrize("least", [-5.0, 1.8])
def test_drivers_report_the_faults_of_the_final_design(driver, least):
    made = om.Problem(driver=driver(disp=False), reports=None)
    made.model.add_subsystem("it", FaultyComp(), promotes=["*"])
    made.model.add_design_var("x", lower=least, upper=5.0)
    made.model.add_objective("f")
    made.setup()
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        made.run_driver()
    said = [str(own.message) for own in found]
    text = f"{driver.__name__}: final design: the result is not trustworthy: {FAULT.format(1.0)}"
    assert said == ([text] if least < 1.0 else [])


def test_faults_that_differ_in_numbers_are_the_same():
    faults = [text for place in ("1.5", "-2e-05", "3") for text in (FAULT.format(place), "stress")]
    with pytest.warns(sm.UntrustworthyResultWarning) as found:
        warn_of_faults("seal", faults, set())
    assert [str(own.message) for own in found] == [
        f"seal: the result is not trustworthy: {FAULT.format('1.5')}",
        "seal: the result is not trustworthy: stress",
    ]
