"""What a design that cannot be analysed leaves behind."""

import numpy as np
import openmdao.api as om
import pytest

import seal_mdao as sm
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp

SIZES = (0.0, 1.3, 0.1)
"""Of the offsets of three designs; the wall of the second one is folded."""


def design(size):
    return size * np.concatenate([-np.ones(14), np.ones(11)])


def recorded(short, mode="rev"):
    """The recorded cases of the three designs, with derivatives."""
    cases = [[("boundary_offsets", design(size))] for size in SIZES]
    problem = om.Problem(driver=om.DOEDriver(om.ListGenerator(cases)), reports=None)
    problem.model.add_subsystem("seal", sm.SealGroup(seal=short), promotes=["*"])
    problem.model.add_design_var("boundary_offsets", lower=-2.0, upper=2.0)
    problem.model.add_objective("gap_square_sum")
    problem.model.add_constraint("von_mises", upper=200.0)
    problem.driver.add_recorder(om.SqliteRecorder("doe.sql"))
    problem.driver.recording_options["record_derivatives"] = True
    problem.setup(mode=mode)
    problem.run_driver()
    problem.cleanup()
    reader = om.CaseReader(problem.get_outputs_dir() / "doe.sql")
    return [reader.get_case(name) for name in reader.list_cases("driver", out_stream=None)]


@pytest.mark.parametrize("mode", ["fwd", "rev"])
@pytest.mark.filterwarnings("ignore:.*Inefficient choice of derivative mode")
def test_doe_with_a_failed_case_records_nan_for_it_and_goes_on(short, mode):
    cases = recorded(short, mode)
    for case, size in zip(cases, SIZES, strict=True):
        good = size != SIZES[1]  # OpenMDAO's DOEDriver writes that all have succeeded
        values = np.concatenate([case["gap_square_sum"], case["von_mises"]])
        slopes = case.derivatives["gap_square_sum", "boundary_offsets"]
        for found in (values, slopes):
            assert (np.isfinite(found) if good else np.isnan(found)).all()
        assert slopes.shape == (1, 25)


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
    made.set_val("particles", short.drawn_particles)
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
