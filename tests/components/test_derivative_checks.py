"""OpenMDAO's own checks as users call them, and complex step where it is allowed."""

import numpy as np
import openmdao.api as om
import pytest
from openmdao.utils.assert_utils import assert_check_partials
from ring_files import ring
from seal_file.block_files import FIXED, LID, exact_seal, seal_of

import seal_mdao as sm
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp

OFFSETS = np.random.default_rng(1).uniform(-0.15, 0.15, 25)


def made(system, complex_step=True, mode="auto"):
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("seal", system, promotes=["*"])
    problem.setup(force_alloc_complex=complex_step, mode=mode)
    return problem


def test_check_partials_with_its_defaults_is_quick_and_right(short):
    """Along random directions: four analyses for two inputs, none marked."""
    cache = sm.AnalysisCache()
    problem = made(sm.SealGroup(seal=short, cache=cache))
    problem.set_val("boundary_offsets", OFFSETS)
    problem.run_model()
    before = cache.made
    for seed in range(3):
        np.random.seed(seed)  # OpenMDAO draws the directions from the global generator
        data = problem.check_partials(out_stream=None)
        assert cache.made - before <= 4 * (seed + 1)
        assert_check_partials(data, rtol=1e-4)
        assert set(data) == {"seal.geometry", "seal.section", "seal.contact"}


def test_check_partials_of_a_section_on_the_axis_of_revolution(tmp_path):
    """Particles on the axis stay there: a direction across it would give infinite hoop stretches."""
    text = ring(inner=0.0, translate=(0.0, -0.5))
    design = text + '[[design]]\nedges = ["side"]\nparameters = 3\nbound = 0.1\n'
    measures = '[[measure]]\ntype = "reaction"\n[[measure]]\ntype = "stress_norm"\n'
    seal = exact_seal(tmp_path, design + measures)
    problem = made(sm.SealGroup(seal=seal))
    problem.set_val("boundary_offsets", [0.03, -0.02, 0.05])
    problem.run_model()
    np.random.seed(1)
    assert_check_partials(problem.check_partials(out_stream=None), rtol=1e-4)
    totals = problem.compute_totals(["stress_norm"], ["boundary_offsets"], return_format="array")
    exact = sm.differentiate(sm.analyze(seal, [0.03, -0.02, 0.05]), ())["stress_norm"]
    np.testing.assert_allclose(totals, exact, rtol=1e-9)


def shape_model(seal):
    """Upstream length, offsets, area and particles, all by complex step."""
    group = om.Group()
    group.add_subsystem(
        "up",
        om.ExecComp(
            "boundary_offsets = t**2 * ones(25)", t=0.4,
            boundary_offsets={"shape": 25, "units": "mm"},
        ),
        promotes=["*"],
    )  # fmt: skip
    group.add_subsystem("geometry", sm.SplineGeometryComp(seal=seal), promotes=["*"])
    group.add_subsystem("section", sm.AreaComp(seal=seal), promotes=["*"])
    return group


def test_complex_step_passes_through_geometry_and_area(short, block_seal):
    for seal in (short, block_seal):
        tables = []
        for approximate in (False, True):
            group = shape_model(seal) if seal is short else sm.AreaComp(seal=seal)
            problem = om.Problem(om.Group(), reports=None)
            problem.model.add_subsystem("g", group, promotes=["*"])
            wrt = "t" if seal is short else "boundary_offsets"
            if approximate:
                problem.model.approx_totals(method="cs")
            problem.setup(force_alloc_complex=True)
            problem.run_model()
            of = ["area", "particles"] if seal is short else ["area"]
            tables.append(problem.compute_totals(of, [wrt], return_format="array"))
        assert np.abs(tables[0]).max() > 0.1
        np.testing.assert_allclose(tables[1], tables[0], rtol=1e-12, atol=1e-13)


@pytest.fixture
def block_seal():
    from pressed_block import pressed_block

    return pressed_block()


@pytest.mark.parametrize("system", [sm.SealGroup, RkpmContactComp])
def test_contact_refuses_complex_step(system, short):
    """It used to give zeros."""
    problem = made(system(seal=short))
    problem.model.approx_totals(method="cs")
    problem.run_model()
    with pytest.raises(RuntimeError, match="the contact analysis does not support complex steps"):
        problem.compute_totals(["reaction"], ["door_radius"])


def test_check_totals_by_complex_step_is_refused(short):
    problem = made(sm.SealGroup(seal=short))
    problem.run_model()
    with pytest.raises(RuntimeError, match="the contact analysis does not support complex steps"):
        problem.check_totals(["reaction"], ["door_radius"], method="cs", out_stream=None)


@pytest.mark.parametrize("seed", range(3))
def test_parameter_at_its_least_value_is_checked_by_steps_forward(tmp_path, seed):
    """A friction of 0; of either sign of the random numbers. Forward differences err by h f'' / 2: here
    h = 2e-5, and f'' / f' is 1.7."""
    seal = seal_of(tmp_path, FIXED, LID.replace("friction = 0.3", "friction = 0.0"))
    problem = om.Problem()
    problem.model.add_subsystem("seal", sm.SealGroup(seal=seal, parameters=["lid_friction"]))
    problem.setup()
    problem.run_model()
    np.random.seed(seed)
    data = problem.check_partials(out_stream=None, includes=["seal.contact"])["seal.contact"]
    block = data["reaction", "lid_friction"]
    assert abs(block["J_fd"]).max() > 100.0
    np.testing.assert_allclose(block["J_fwd"], block["J_fd"], rtol=1e-4)
