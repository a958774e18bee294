"""OpenMDAO components: values, partials, totals, and the call patterns of drivers."""

import re
from dataclasses import replace

import numpy as np
import openmdao.api as om
import pytest
from openmdao.utils.assert_utils import assert_check_partials, assert_check_totals

import seal_mdao as sm
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp
from seal_mdao.components.scenario_comp import ScenarioComp
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.seals.door.door_seal import with_options
from seal_mdao.seals.result import analyze_particles

MEASURES = ("von_mises", "gap", "gap_square_sum", "reaction")
OFFSETS = np.random.default_rng(11).uniform(-0.15, 0.15, 25)


class Counted:
    """Counts the load steps of all analyses."""

    def __init__(self):
        self.steps = 0

    def __call__(self, step):
        self.steps += 1


def outputs(problem, names=(*MEASURES, "area", "particles")):
    return {name: problem.get_val(name).copy() for name in names}


def same_bits(first, second):
    for name, values in first.items():
        np.testing.assert_array_equal(values, second[name], err_msg=name)


def test_group_gives_what_the_numerics_give(problem, short):
    made = problem(sm.SealGroup(seal=short), boundary_offsets=OFFSETS, door_radius=4.1)
    made.run_model()
    result = sm.analyze(short, OFFSETS, {"door_radius": 4.1})
    np.testing.assert_array_equal(made.get_val("von_mises"), result.von_mises)
    np.testing.assert_array_equal(made.get_val("gap"), result.gap)
    np.testing.assert_array_equal(made.get_val("reaction"), result.reaction[-1])
    np.testing.assert_array_equal(made.get_val("particles"), result.particles)
    assert made.get_val("gap_square_sum")[0] == result.gap_square_sum
    assert made.get_val("area")[0] == result.area


def test_units_are_converted(problem, short):
    made = problem(sm.SealGroup(seal=short))
    made.set_val("boundary_offsets", 1e-3 * OFFSETS, units="m")
    made.set_val("door_radius", 0.41, units="cm")
    made.run_model()
    result = sm.analyze(short, OFFSETS, {"door_radius": 4.1})
    np.testing.assert_allclose(made.get_val("von_mises", units="Pa"), 1e3 * result.von_mises, 1e-7)
    assert made.get_val("area", units="cm**2")[0] == pytest.approx(1e-2 * result.area, rel=1e-12)
    np.testing.assert_allclose(
        made.get_val("reaction", units="kN/m"), 1e-3 * result.reaction[-1], rtol=1e-7
    )


def test_nothing_set_is_the_drawn_seal(problem, short):
    made = problem(sm.SealGroup(seal=short))
    made.run_model()
    nominal = sm.analyze(short)
    np.testing.assert_array_equal(made.get_val("boundary_offsets"), 0.0)
    np.testing.assert_array_equal(made.get_val("von_mises"), nominal.von_mises)
    assert made.get_val("door_radius")[0] == short.scalars["door_radius"].value


def test_partials_of_the_geometry_are_exact(problem):
    made = problem(sm.SplineGeometryComp(seal=sm.door_seal()), boundary_offsets=OFFSETS)
    made.run_model()
    with pytest.warns(om.DerivativesWarning, match="finite difference was used"):
        data = made.check_partials(out_stream=None)
    assert_check_partials(data, atol=1e-11, rtol=1e-11)


def test_partials_of_the_geometry_are_sparse():
    velocity = sm.door_seal().design_velocity
    made = om.Problem(reports=None)
    comp = made.model.add_subsystem("geometry", sm.SplineGeometryComp(seal=sm.door_seal()))
    made.setup()
    made.final_setup()
    meta = comp._subjacs_info["geometry.particles", "geometry.boundary_offsets"]
    assert len(meta["rows"]) == np.count_nonzero(velocity) < 0.5 * velocity.size


def test_partials_of_the_area_are_exact(problem):
    made = problem(sm.AreaComp(seal=sm.door_seal()), boundary_offsets=OFFSETS)
    made.run_model()
    with pytest.warns(om.DerivativesWarning, match="finite difference was used"):
        data = made.check_partials(out_stream=None)
    assert_check_partials(data, atol=1e-9, rtol=1e-10)


@pytest.mark.parametrize("system", [sm.AreaComp, sm.SplineGeometryComp, ScenarioComp])
def test_offsets_are_described_for_every_kind_of_seal(system, problem, short):
    """Not as those of the door seal's rays alone."""
    more = {"scenarios": sm.Scenarios((), np.zeros((2, 0)))} if system is ScenarioComp else {}
    made = problem(system(seal=short, **more))
    made.final_setup()
    (found,) = made.model.get_io_metadata("input", ["desc"], includes="*boundary_offsets").values()
    for words in ("door seal", "along the normals of the nominal boundary"):
        assert words in found["desc"]


PARAMETERS = ("c10", "friction", "depth", "tangent_penalty")


@pytest.mark.parametrize("method", ["adjoint", pytest.param("direct", marks=pytest.mark.long)])
def test_partials_of_the_contact_analysis(problem, short, method):
    """Along random directions of all particle coordinates, and for every scalar input."""
    comp = RkpmContactComp(seal=short, sensitivity=method, parameters=PARAMETERS)
    made = problem(comp, particles=short.particles(OFFSETS), door_radius=4.1)
    made.run_model()
    check = {"method": "fd", "form": "central"}
    comp.set_check_partial_options(wrt="particles", step=3e-6, directional=True, **check)
    comp.set_check_partial_options(wrt=("door_radius", "depth"), step=1e-5, **check)
    comp.set_check_partial_options(wrt="friction", step=2e-5, **check)
    comp.set_check_partial_options(wrt=("c10", "tangent_penalty"), step=1e-2, **check)
    # OpenMDAO draws the direction from the global generator
    np.random.seed(4)
    data = made.check_partials(out_stream=None, compact_print=True)
    assert_check_partials(data, atol=1e-5, rtol=2e-5)


def test_totals_of_the_group(problem, short):
    """Through geometry, area and contact: those of the numerics, and those of differences."""
    made = problem(sm.SealGroup(seal=short), boundary_offsets=OFFSETS, door_radius=4.1)
    made.run_model()
    of, wrt = [*MEASURES, "area"], ["boundary_offsets", "door_radius"]
    found = made.compute_totals(of=of, wrt=wrt)
    exact = sm.differentiate(sm.analyze(short, OFFSETS, {"door_radius": 4.1}))
    tables = {**exact.rows, "area": np.append(short.area(OFFSETS)[1], 0.0)}
    for name in of:
        table = np.atleast_2d(tables[name])
        both = np.hstack([found[name, parameter] for parameter in wrt])
        # sums over particles in another order
        np.testing.assert_allclose(both, table, rtol=0.0, atol=1e-11 * np.abs(table).max())
    data = made.check_totals(
        of=of, wrt=["door_radius"], form="central", step=1e-5, out_stream=None, compact_print=True
    )
    assert_check_totals(data, atol=1e-5, rtol=1e-5)


def test_optional_inputs_start_at_the_values_of_the_seal(problem, short):
    seal = with_options(short, friction=0.3)
    made = problem(sm.SealGroup(seal=seal, parameters=PARAMETERS))
    values = {name: made.get_val(name)[0] for name in PARAMETERS}
    assert values == {"c10": 80.0, "friction": 0.3, "depth": 7.0, "tangent_penalty": 100.0}
    made.set_val("friction", 0.2)
    made.run_model()
    result = sm.analyze(with_options(seal, friction=0.2))
    points = list(sm.analyze(seal).measure("gap").points)
    np.testing.assert_array_equal(made.get_val("reaction"), result.reaction[-1])
    # the places of the measures stay those of the seal that was given
    np.testing.assert_array_equal(made.get_val("gap"), result.contact.gap[points])


def totals(problem):
    return problem.compute_totals(of=["gap_square_sum"], wrt=["boundary_offsets"],
                                  return_format="array")[0]  # fmt: skip


def test_totals_after_check_totals_are_those_of_the_point_itself(problem, short):
    """The last compute of check_totals was at a perturbed point."""
    made = problem(sm.SealGroup(seal=short), boundary_offsets=OFFSETS, door_radius=4.1)
    made.run_model()
    before = totals(made)
    made.check_totals(
        of=["gap_square_sum"], wrt=["door_radius"], form="forward", step=1e-3, out_stream=None
    )
    np.testing.assert_array_equal(totals(made), before)


def check_partials_at_inputs(problem, seal):
    """The contact component's partials are those at the inputs that it has now."""
    problem.final_setup()  # before OpenMDAO 3.43 the model has not got the values until then
    particles = problem.model.get_val("seal.particles", from_src=False)
    radius = problem.model.get_val("seal.door_radius", from_src=False)
    found = problem.compute_totals(
        of=["von_mises", "reaction"], wrt=["door_radius", "particles"], return_format="array"
    )
    result = analyze_particles(seal.with_parameters({"door_radius": radius[0]}), particles)
    measures = sm.analyze(seal).measures()
    exact = particle_gradient(result, ("door_radius",), measures)
    for rows, name in ((slice(0, 7), "von_mises"), (slice(7, 9), "reaction")):
        np.testing.assert_array_equal(found[rows, 0], exact["door_radius"][name][:, 0])
        by_particles = exact["particles"][name]
        np.testing.assert_array_equal(found[rows, 1:], by_particles.reshape(len(by_particles), -1))
    return found


def test_partials_without_any_run(problem, short):
    """set_val + compute_totals asks for partials with no compute at all."""
    made = problem(RkpmContactComp(seal=short), particles=short.particles(OFFSETS))
    check_partials_at_inputs(made, short)


def test_partials_after_computes_elsewhere(problem, short):
    """Run at one point, run at another, set back without a run, run again."""
    made = problem(RkpmContactComp(seal=short), particles=short.particles(OFFSETS))
    found = []
    for radius in (4.1, 4.3):
        made.set_val("door_radius", radius)
        made.run_model()
        found.append(check_partials_at_inputs(made, short))
    made.set_val("door_radius", 4.1)
    check_partials_at_inputs(made, short)
    made.run_model()
    found.append(check_partials_at_inputs(made, short))
    np.testing.assert_array_equal(found[2], found[0])
    assert np.abs(found[1] - found[0]).max() > 1e-3


def test_partials_after_an_analysis_that_failed(problem, short):
    """What was kept of the last good point is not given out for a bad one."""
    newton = sm.NewtonOptions(max_iterations=5, max_cuts=0, damped_iterations=0)
    seal = with_options(short, newton=newton)
    made = problem(RkpmContactComp(seal=seal))
    made.run_model()
    check_partials_at_inputs(made, seal)
    made.set_val("particles", seal.particles(5.0 * OFFSETS))
    with pytest.raises(om.AnalysisError):
        made.run_model()
    found = made.compute_totals(of=["reaction"], wrt=["door_radius"], return_format="array")
    assert np.isnan(found).all()


def test_running_twice_gives_the_same_bits_and_analyses_once(problem, short):
    counted = Counted()
    made = problem(sm.SealGroup(seal=short, callback=counted), boundary_offsets=OFFSETS)
    made.run_model()
    first = outputs(made)
    made.run_model()
    same_bits(first, outputs(made))
    assert counted.steps == short.n_steps
    totals(made)
    assert counted.steps == short.n_steps


def test_coming_back_gives_the_same_bits(problem, short):
    """No warm start from another design."""
    made = problem(sm.SealGroup(seal=short), boundary_offsets=OFFSETS)
    made.run_model()
    first, first_totals = outputs(made), totals(made)
    made.set_val("boundary_offsets", -OFFSETS)
    made.run_model()
    totals(made)
    made.set_val("boundary_offsets", OFFSETS)
    made.run_model()
    same_bits(first, outputs(made))
    np.testing.assert_array_equal(totals(made), first_totals)


def test_two_problems_do_not_disturb_each_other(problem, short):
    one = problem(sm.SealGroup(seal=short), boundary_offsets=OFFSETS)
    two = problem(sm.SealGroup(seal=with_options(short, friction=0.3)), boundary_offsets=OFFSETS)
    one.run_model()
    first = outputs(one)
    two.run_model()
    assert np.abs(two.get_val("reaction") - one.get_val("reaction")).max() > 1e-3
    one.run_model()
    same_bits(first, outputs(one))


def test_path_that_cannot_be_completed_is_an_analysis_error(problem, short):
    """The nominal seal passes with five iterations a step and no cut; a distorted design does not."""
    newton = sm.NewtonOptions(max_iterations=5, max_cuts=0, damped_iterations=0)
    made = problem(sm.SealGroup(seal=with_options(short, newton=newton)))
    made.run_model()
    nominal = outputs(made)
    made.set_val("boundary_offsets", 5.0 * OFFSETS)
    with pytest.raises(om.AnalysisError) as error:
        made.run_model()
    for word in ("load step", "y = ", "relative residual", "points in contact", "n_steps"):
        assert word in str(error.value)
    # and the problem is usable afterwards
    made.set_val("boundary_offsets", np.zeros(25))
    made.run_model()
    same_bits(nominal, outputs(made))


def test_folded_section_is_an_analysis_error(problem, short):
    """A driver may try such a design; it should be able to step back."""
    made = problem(sm.SealGroup(seal=short))
    offsets = np.concatenate([np.full(14, -1.3), np.full(11, 1.3)])
    made.set_val("boundary_offsets", offsets)
    with pytest.raises(om.AnalysisError, match="folded") as error:
        made.run_model()
    # the parameter that contributes most to the motion of this place, from the outer or inner boundary
    found = re.search(
        r"background cell (\d+) near .*boundary_offsets\[(\d+)\] = ([-.\d]+) moves .* by ([.\d]+) mm",
        str(error.value),
    )
    cell, most, offset, by = map(float, found.groups())
    speeds = np.linalg.norm(short.design_velocity[:, short.body.cells[int(cell)]], axis=2)
    shares = np.abs(offsets) * speeds.max(axis=1)
    assert shares.argmax() == most
    assert offset == pytest.approx(offsets[int(most)], rel=1e-3)
    assert by == pytest.approx(shares.max(), rel=0.01)


def test_seal_without_opened_points_can_be_analysed(problem):
    """A shallow path: nothing has opened yet, so there is no gap and its square sum is zero."""
    shallow = sm.door_seal(depth=2.0, n_steps=10)
    assert sm.analyze(shallow).gap.size == 0
    made = problem(RkpmContactComp(seal=shallow))
    made.run_model()
    assert made.get_val("gap_square_sum")[0] == 0.0
    assert made.get_val("reaction")[1] > 1.0


@pytest.mark.parametrize("system", [sm.SealGroup, RkpmContactComp, sm.AreaComp,
                                    sm.SplineGeometryComp])  # fmt: skip
def test_seal_option_must_be_a_seal(system):
    with pytest.raises(TypeError, match="Seal"):
        system(seal="door seal")


@pytest.mark.parametrize("system", [sm.SealGroup, RkpmContactComp])
def test_wrong_options_are_refused_before_any_analysis(system, problem, short):
    with pytest.raises(ValueError, match="sensitivity"):
        system(seal=short, sensitivity="complex")
    counted = Counted()
    with pytest.raises(ValueError, match="stiffness"):
        problem(system(seal=short, parameters=("stiffness",), callback=counted))
    assert counted.steps == 0
    with pytest.raises(ValueError, match="twice"):
        system(seal=short, parameters=("friction", "friction"))
    with pytest.raises(ValueError, match="string"):
        system(seal=short, parameters="friction")


@pytest.mark.parametrize("name", ["particles", "boundary_offsets", "area", "door_radius", "c10"])
def test_a_measure_with_the_name_of_another_variable_is_refused(problem, short, name):
    (force,) = short.measures(("reaction",))
    measures = [replace(force, name=name)]
    with pytest.raises(ValueError, match=f"'{name}' has the name of another variable"):
        problem(sm.SealGroup(seal=short, measures=measures, parameters=("c10",)))


@pytest.mark.parametrize("group", [sm.SealGroup, sm.ScenarioGroup])
def test_no_measure_at_all_is_refused(problem, short, group):
    more = {}
    if group is sm.ScenarioGroup:
        more = {
            "scenarios": sm.Scenarios((sm.Variation("friction"),), [[0.2], [0.3]]),
            "workers": 0,
        }
    with pytest.raises(ValueError, match="none of the measures has a value for this seal"):
        problem(group(seal=short, measures=[], **more))


@pytest.mark.parametrize("method", ["auto", "direct", "adjoint"])
def test_derivatives_of_no_measure_are_an_empty_table(short, method):
    found = sm.differentiate(sm.analyze(short), ("c10",), [], method)
    assert found.rows == {}
    assert found.parameters[-1] == "c10"


def test_callback_must_be_callable(short):
    with pytest.raises(TypeError, match="callable"):
        RkpmContactComp(seal=short, callback="print")


@pytest.mark.parametrize("value", [np.zeros(24), np.zeros((2, 25))])
def test_offsets_of_a_wrong_shape_are_refused(problem, short, value):
    with pytest.raises(ValueError, match="boundary_offsets"):
        problem(sm.SealGroup(seal=short), boundary_offsets=value).final_setup()


@pytest.mark.parametrize(("name", "value"), [("door_radius", -1.0), ("door_radius", np.nan),
                                             ("boundary_offsets", np.nan),
                                             ("boundary_offsets", 5.0)])  # fmt: skip
def test_values_without_meaning_are_refused(problem, short, name, value):
    made = problem(sm.SealGroup(seal=short))
    made.set_val(name, value)
    with pytest.raises(om.AnalysisError, match=name):
        made.run_model()
    for output in ("particles", "area", "gap", "reaction"):
        assert np.isnan(made.get_val(output)).all()
