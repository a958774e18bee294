"""What a design that cannot be analysed leaves behind."""

import numpy as np
import openmdao.api as om
import pytest
from openmdao.core.driver import Driver

import seal_mdao as sm
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp
from seal_mdao.recording.recorded_optimization import read_optimization

SIZES = (0.0, 1.3, 0.1, 3.0, 0.05)
"""Of the offsets of five designs; those of the second fold the wall, those of the fourth exceed it."""

FAILED = (1.3, 3.0)


def design(size):
    return size * np.concatenate([-np.ones(14), np.ones(11)])


def recorded(short, mode, alone):
    """The recorded cases of the designs, with derivatives."""
    cases = [[("boundary_offsets", design(size))] for size in SIZES]
    problem = om.Problem(driver=om.DOEDriver(om.ListGenerator(cases)), reports=None)
    if alone:
        problem.model = sm.SealGroup(seal=short)
    else:
        problem.model.add_subsystem("seal", sm.SealGroup(seal=short), promotes=["*"])
    problem.model.add_design_var("boundary_offsets", lower=-4.0, upper=4.0)
    problem.model.add_objective("gap_square_sum")
    problem.model.add_constraint("von_mises", upper=200.0)
    problem.driver.add_recorder(om.SqliteRecorder("doe.sql"))
    problem.driver.recording_options["record_derivatives"] = True
    problem.setup(mode=mode)
    problem.run_driver()
    problem.cleanup()
    reader = om.CaseReader(problem.get_outputs_dir() / "doe.sql")
    return [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]


@pytest.mark.parametrize("alone", [False, True], ids=["in a model", "the model"])
@pytest.mark.parametrize("mode", ["fwd", "rev"])
@pytest.mark.filterwarnings("ignore:.*Inefficient choice of derivative mode")
def test_doe_with_a_failed_case_records_nan_for_it_and_continues(short, mode, alone):
    """A group that is the complete model owns the independent variables: they keep their values."""
    cases = recorded(short, mode, alone)
    for case, size in zip(cases, SIZES, strict=True):
        good = size not in FAILED  # OpenMDAO's DOEDriver writes that all have succeeded
        values = np.concatenate([case["gap_square_sum"], case["von_mises"]])
        slopes = case.derivatives["gap_square_sum", "boundary_offsets"]
        for found in (values, slopes):
            assert (np.isfinite(found) if good else np.isnan(found)).all()
        assert slopes.shape == (1, 25)


class ContinuingDriver(Driver):
    """Run the model at several values of c10, as drivers of OpenMDAO that continue after failures do:
    without the components that run before or after an optimisation."""

    def __init__(self):
        super().__init__()
        self.supports["optimization"] = True
        self.found = []

    def run(self):
        problem = self._problem()
        for value in (80.0, -5.0, 90.0):
            problem.set_val("c10", value)
            try:
                with problem.model._relevance.nonlinear_active("iter"):
                    self._run_solve_nonlinear()
            except om.AnalysisError:
                pass
            self.found.append(problem.get_val("reaction")[1])
        return False


@pytest.mark.parametrize("grouped", [False, True])
def test_components_that_run_before_the_optimisation_keep_their_values(short, grouped):
    """With c10 as the only design variable the particles are computed once."""
    problem = om.Problem(driver=ContinuingDriver(), reports=None)
    problem.options["group_by_pre_opt_post"] = grouped
    seal = sm.SealGroup(seal=short, measures=("reaction",), parameters=("c10",))
    problem.model.add_subsystem("seal", seal, promotes=["*"])
    problem.model.add_design_var("c10", lower=-10.0, upper=200.0)
    problem.model.add_objective("reaction", index=1)
    problem.setup()
    problem.run_driver()
    expected = [sm.analyze(short, None, {"c10": c10}).value("reaction")[1] for c10 in (80.0, 90.0)]
    assert problem.driver.found == [expected[0], pytest.approx(np.nan, nan_ok=True), expected[1]]


def failing(seal, problem):
    made = problem(RkpmContactComp(seal=seal))
    made.run_model()
    made.set_val("particles", seal.particles(design(SIZES[1])))
    return made


def test_outputs_of_a_failed_design_are_nan(short, problem):
    made = failing(short, problem)
    with pytest.raises(om.AnalysisError, match="folded"):
        made.run_model()
    for name in ("von_mises", "gap", "gap_square_sum", "reaction"):
        assert np.isnan(made.get_val(name)).all()
    made.set_val("particles", short.nominal_particles)
    made.run_model()
    assert np.isfinite(made.get_val("von_mises")).all()
    assert np.isfinite(
        made.compute_totals(["reaction"], ["door_radius"], return_format="array")
    ).all()


def test_partials_of_a_failed_design_that_was_not_run_are_an_error(short, problem):
    """NaN only where the user has had the error already."""
    made = problem(RkpmContactComp(seal=short), particles=short.particles(design(SIZES[1])))
    made.final_setup()
    with pytest.raises(om.AnalysisError, match="folded"):
        made.compute_totals(["reaction"], ["door_radius"])
    with pytest.raises(om.AnalysisError, match="folded"):
        made.run_model()
    assert np.isnan(made.compute_totals(["reaction"], ["door_radius"], return_format="array")).all()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_particles_from_upstream_that_are_no_numbers_are_a_failed_analysis(short, problem, value):
    made = problem(RkpmContactComp(seal=short))
    particles = short.nominal_particles.copy()
    particles[3, 1] = value
    made.set_val("particles", particles)
    with pytest.raises(om.AnalysisError, match=r"rejects this design: particles\[3\]"):
        made.run_model()


def test_scenarios_of_an_inadmissible_design_are_a_failed_analysis(short, problem):
    scenarios = sm.Scenarios((sm.Variation("friction"),), np.array([[0.2], [0.3]]))
    made = problem(sm.ScenarioGroup(seal=short, scenarios=scenarios, workers=0))
    for name, value in (("door_radius", -1.0), ("boundary_offsets", 3.0)):
        made.set_val(name, value)
        with pytest.raises(om.AnalysisError, match=name):
            made.run_model()
        assert np.isnan(made.get_val("reaction_mean")).all()


@pytest.mark.parametrize("kind", ["scenarios", "component"])
def test_restart_recorder_marks_failed_cases_of_every_kind_of_seal(short, kind):
    """OpenMDAO's DOEDriver records every case as a success."""
    if kind == "scenarios":
        varied = sm.Scenarios((sm.Variation("friction"),), np.array([[0.2], [0.3]]))
        system = sm.ScenarioGroup(
            seal=short, scenarios=varied, measures=("reaction",), parameters=("c10",), workers=0
        )
    else:
        system = RkpmContactComp(seal=short, measures=("reaction",), parameters=("c10",))
    cases = [[("c10", value)] for value in (80.0, -5.0, 90.0)]
    problem = om.Problem(driver=om.DOEDriver(om.ListGenerator(cases)), reports=None)
    problem.model.add_subsystem("seal", system, promotes=["*"])
    problem.model.add_design_var("c10", lower=-10.0, upper=200.0)
    problem.model.add_objective("reaction_mean" if kind == "scenarios" else "reaction", index=1)
    problem.driver.add_recorder(sm.RestartRecorder("doe.sql"))
    problem.driver.recording_options["record_derivatives"] = True
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    reader = om.CaseReader(problem.get_outputs_dir() / "doe.sql")
    found = [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]
    assert [case.success for case in found] == [1, 0, 1]
    for case in found:
        (slopes,) = case.derivatives.values()
        assert (np.isfinite(slopes) if case.success else np.isnan(slopes)).all()


class Price(om.ExplicitComponent):
    """A component of a user that fails for some forces."""

    def setup(self):
        self.add_input("force", units="N/m")
        self.add_output("price")
        self.declare_partials("*", "*", method="fd")

    def compute(self, inputs, outputs):
        if inputs["force"] > 50.0:
            raise om.AnalysisError("no price for this force")
        outputs["price"] = 2.0 * inputs["force"]


def test_restart_recorder_marks_failed_cases_of_other_components(short):
    """The outputs of the component that failed have the values of the case before."""
    cases = [[("c10", value)] for value in (40.0, 160.0, 45.0)]
    problem = om.Problem(driver=om.DOEDriver(om.ListGenerator(cases)), reports=None)
    group = sm.SealGroup(seal=short, measures=("reaction",), parameters=("c10",))
    problem.model.add_subsystem("seal", group, promotes=["*"])
    problem.model.add_subsystem("shop", Price(), promotes=["price"])
    problem.model.connect("reaction", "shop.force", src_indices=[1])
    problem.model.add_design_var("c10", lower=-10.0, upper=200.0)
    problem.model.add_objective("price")
    problem.driver.add_recorder(sm.RestartRecorder("doe.sql"))
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    path = problem.get_outputs_dir() / "doe.sql"
    reader = om.CaseReader(path)
    found = [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]
    assert [case.success for case in found] == [1, 0, 1]
    assert found[1].msg.endswith("no price for this force")
    history = read_optimization(path)
    assert (len(history.objective), history.failed) == (2, 1)


def test_restart_recorder_does_not_mark_scenarios_that_were_left_out(short):
    numbers = np.array([[0.2, 0.0], [0.3, 0.0], [0.3, -5.0]])  # the last one has no such material
    varied = sm.Scenarios((sm.Variation("friction"), sm.Variation("c10", "shift")), numbers)
    problem = om.Problem(driver=om.DOEDriver(om.ListGenerator([[("c10", 4.0)]])), reports=None)
    group = sm.ScenarioGroup(
        seal=short, scenarios=varied, measures=("reaction",), parameters=("c10",), workers=0,
        failed="leave_out",
    )  # fmt: skip
    problem.model.add_subsystem("seal", group, promotes=["*"])
    problem.model.add_design_var("c10", lower=0.0, upper=200.0)
    problem.model.add_objective("reaction_mean", index=1)
    problem.driver.add_recorder(sm.RestartRecorder("doe.sql"))
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    case = om.CaseReader(problem.get_outputs_dir() / "doe.sql").get_case(0)
    assert problem.get_val("share_failed") == pytest.approx(1.0 / 3.0)
    assert case.success == 1


@pytest.mark.parametrize("kind", ["seal", "scenarios"])
def test_design_after_a_failed_one_in_a_model_with_feedback(short, kind):
    """The NaN of the failed design are not the values from which the solver of the loop starts."""
    options = {"seal": short, "parameters": ("c10",), "measures": ("reaction",)}
    if kind == "seal":
        group, force = sm.SealGroup(**options), "seal.reaction"
    else:
        friction = sm.Scenarios((sm.Variation("friction"),), np.array([[0.2]]))
        group = sm.ScenarioGroup(**options, scenarios=friction, workers=0)
        force = "seal.reaction_highest"
    cases = [[("seal.boundary_offsets", design(size))] for size in (1.3, 0.1, 1.3, 0.05)]
    problem = om.Problem(driver=om.DOEDriver(om.ListGenerator(cases)), reports=None)
    stiffening = om.ExecComp(
        "c10 = 80 + 0.01 * force", c10={"units": "kPa"}, force={"units": "N/m"}
    )
    problem.model.add_subsystem("stiffening", stiffening)
    problem.model.add_subsystem("seal", group)
    problem.model.connect("stiffening.c10", "seal.c10")
    problem.model.connect(force, "stiffening.force", src_indices=[1])
    problem.model.nonlinear_solver = om.NonlinearBlockGS(iprint=-1, rtol=1e-9)
    problem.model.add_design_var("seal.boundary_offsets")
    problem.model.add_objective(force, index=1)
    problem.driver.add_recorder(om.SqliteRecorder("doe.sql"))
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    reader = om.CaseReader(problem.get_outputs_dir() / "doe.sql")
    found = [case[force][1] for case in reader.get_cases("driver")]
    assert np.isnan(found).tolist() == [True, False, True, False]
    # the last design alone
    problem.setup()
    problem.set_val("seal.boundary_offsets", design(0.05))
    problem.run_model()
    assert found[-1] == pytest.approx(problem.get_val(force)[1], rel=1e-7)
