"""A seal file without [[design]] in OpenMDAO: values and derivatives of its scalar inputs."""

import json
import re

import numpy as np
import openmdao.api as om
import pytest
from openmdao.utils.assert_utils import assert_check_partials

import seal_mdao as sm
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.report.write import write_report

BLOCK = """
[material.rubber]
law = "neo_hookean"
c10 = 300.0
bulk_modulus = 1000.0
[section]
material = "rubber"
spacing = 1.0
outer = [
  { edge = "base", line = [[-3.0, 0.0], [3.0, 0.0]] },
  { edge = "right", line = [[3.0, 0.0], [3.0, 4.0]] },
  { edge = "top", line = [[3.0, 4.0], [-3.0, 4.0]] },
  { edge = "left", line = [[-3.0, 4.0], [-3.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "lid"
friction = 0.2
normal_penalty = 1e4
tangent_penalty = 1e3
contact = ["top"]
line = [[-20.0, 0.0], [20.0, 0.0]]
start = [0.0, 4.15]
stage = [{ translate = [0.0, -0.6], steps = 3 }, { translate = [0.3, 0.0], steps = 3 }]
[[measure]]
type = "reaction"
"""
PARAMETERS = ("c10", "lid_friction", "lid_y")


@pytest.fixture(scope="module")
def seal(tmp_path_factory):
    path = tmp_path_factory.mktemp("block") / "block.toml"
    path.write_text(BLOCK)
    made = sm.build_seal(path).with_placements()
    assert made.n_offsets == 0
    return made


def scenario_group(seal, **options):
    hardness = sm.Scenarios((sm.Variation("c10", "factor"),), np.array([[0.9], [1.1]]))
    return sm.ScenarioGroup(seal=seal, scenarios=hardness, workers=0, **options)


def problem_of(group, mode="auto"):
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("seal", group, promotes=["*"])
    problem.setup(mode=mode)
    problem.run_model()
    return problem


def test_values_and_derivatives_are_those_of_the_analysis(seal):
    result = sm.analyze(seal)
    wanted = sm.differentiate(result, PARAMETERS)["reaction"]
    for mode in ("fwd", "rev"):
        problem = problem_of(sm.SealGroup(seal=seal, parameters=PARAMETERS), mode)
        assert problem.get_val("reaction") == result.value("reaction")
        assert problem.get_val("area") == pytest.approx(24.0, rel=1e-12)
        np.testing.assert_array_equal(problem.get_val("particles"), seal.nominal_particles)
        totals = problem.compute_totals(["reaction"], list(PARAMETERS), return_format="array")
        np.testing.assert_allclose(totals, wanted, rtol=1e-9)


def test_partials_agree_with_differences(seal):
    np.random.seed(1)  # OpenMDAO draws directions from the global generator
    for group in (
        sm.SealGroup(seal=seal, parameters=PARAMETERS), sm.SealGroup(seal=seal),
        scenario_group(seal, parameters=("lid_friction",)),
    ):  # fmt: skip
        data = problem_of(group).check_partials(
            out_stream=None, includes=["*contact", "*scenarios"]
        )
        assert data
        assert_check_partials(data, atol=1e-5, rtol=1e-4)


def test_scenarios_alone_are_an_analysis(seal):
    """Neither design parameters nor scalar inputs: the group has no inputs at all."""
    problem = problem_of(scenario_group(seal))
    softer, harder = problem.get_val("reaction_scenarios").ravel()
    assert softer < problem.get_val("reaction_mean")[0] < harder


@pytest.mark.parametrize("scenarios", [False, True])
def test_recorded_optimisation_has_pictures(seal, tmp_path, scenarios):
    """OpenMDAO's recorder saves design variables only; the shape is that of the file."""
    group, aim = sm.SealGroup(seal=seal, parameters=("lid_friction",)), "reaction"
    if scenarios:
        group, aim = scenario_group(seal, parameters=("lid_friction",)), "reaction_mean"
    problem = om.Problem(reports=None, driver=om.ScipyOptimizeDriver(maxiter=1, disp=False))
    problem.model.add_subsystem("seal", group, promotes=["*"])
    problem.model.add_design_var("lid_friction", lower=0.1, upper=0.3)
    problem.model.add_objective(aim)
    problem.driver.add_recorder(om.SqliteRecorder(tmp_path / "cases.sql"))
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    offsets, parameters = read_optimization(tmp_path / "cases.sql").seals[0].design(-1)
    assert offsets.shape == (0,)
    assert parameters["lid_friction"] == problem.get_val("lid_friction")
    text = write_report(tmp_path / "cases.sql").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL)[1])
    assert len(data["seals"]) == 1


def balanced(seal, subsystems, retry):
    """Return a problem that finds the position of the lid at which its force is 5.3 kN/m.

    The first step of Newton's method is too long: the material would be inverted.
    """
    prob = om.Problem(reports=None)
    balance = om.BalanceComp("y", units="mm", eq_units="N/m", rhs_val=5300.0, lhs_name="force")
    prob.model.add_subsystem("balance", balance)
    prob.model.add_subsystem("block", sm.SealGroup(seal=seal, parameters=("lid_y",)))
    prob.model.connect("balance.y", "block.lid_y")
    prob.model.connect("block.reaction", "balance.force")
    solver = om.NewtonSolver(solve_subsystems=subsystems, iprint=-1, atol=1e-8, rtol=1e-10)
    solver.linesearch = om.ArmijoGoldsteinLS(retry_on_analysis_error=True) if retry else None
    prob.model.nonlinear_solver, prob.model.linear_solver = solver, om.DirectSolver()
    prob.setup()
    prob.set_val("balance.y", 0.0)
    return prob


@pytest.mark.parametrize("subsystems", [False, True])
def test_line_search_shortens_the_step_after_a_failed_analysis(seal, subsystems):
    prob = balanced(seal, subsystems, retry=True)
    prob.run_model()
    result = sm.analyze(seal, None, {"lid_y": prob.get_val("balance.y").item()})
    assert result.value(result.measure("reaction")) == pytest.approx([5300.0])
    assert prob.get_val("block.reaction") == pytest.approx([5300.0])


def test_reason_of_a_failure_that_newtons_method_ignores(seal):
    prob = balanced(seal, subsystems=True, retry=False)
    for _ in range(2):
        with pytest.raises(om.AnalysisError, match="must not be used") as caught:
            prob.run_model()
        assert str(caught.value).count("the particles are NaN") == 1
