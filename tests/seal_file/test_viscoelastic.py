"""Materials of seal files that relax: limits, derivatives through both histories, refusals."""

import numpy as np
import pytest
from block_files import (
    DESIGN,
    FIXED,
    LID,
    MOVED,
    exact_seal,
    foam,
    read,
    require_potentials,
    text,
    with_model,
)
from energy_bounds import energy_bounds
from quotients import quotients
from ring_files import ring
from two_rubbers import pressed_block

import seal_mdao as sm
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.plotting.field import fine_grid

SERIES = "\n[material.rubber.viscoelastic]\ng = [0.3, 0.2]\ntau = [1.0, 100.0]\n"
MEASURES = """\
[[measure]]
type = "von_mises"
count = 2
[[measure]]
type = "stress_norm"
"""
DWELL = """
stage = [
  { translate = [0, -0.5], steps = 3, duration = 0.5 }, { steps = 3, duration = 1e3 },
  { translate = [0, 0.1], steps = 2, duration = 2.0 },
]
"""


def relaxing(given: str, series: str = SERIES, stages: str = DWELL, model: str = "") -> str:
    """A seal file whose only rubber relaxes, and whose lid dwells and goes back."""
    head, section = given.split("[section]\n", 1)
    given = f"{head.rstrip()}{series}[section]\n{section}"
    given = given.replace("\nstage = [{ translate = [0, -0.5], steps = 3 }]\n", stages)
    given = given.replace(
        "[[profile.stage]]\ntranslate = [0.2, -0.5]\nsteps = 4\n",
        stages.replace("0, -0.5", "0.2, -0.5"),
    )
    return with_model(given, model) if model else given


HOT = "temperature = [60.0, 80.0, 80.0]"
SHIFTED = SERIES + "wlf = { c1 = 4.0, c2 = 150.0, reference = 23.0 }\n"
BLOCK = relaxing(text(FIXED, LID, DESIGN, MEASURES), SHIFTED, model=HOT)
AROUND = relaxing(
    ring() + '[[design]]\nedges = ["side"]\nparameters = 3\nbound = 0.3\n'
    '[[measure]]\ntype = "reaction"\n' + MEASURES,
    SERIES + 'moduli = "instantaneous"\n'
    "arrhenius = { activation_energy = 40.0, reference = 23.0 }\n",
    model=HOT,
)
HELD = relaxing(
    text(FIXED, MOVED, DESIGN, '[[measure]]\ntype = "reaction"\ncomponent = "y"\n', MEASURES,
         '[[measure]]\ntype = "reaction"\nedges = ["base"]\ncomponent = "x"\nname = "on_base"\n')
    .replace("stage = [{ translate = [0.3, -0.4], rotate = 4.0, steps = 4 }]\n",
             "stage = [{ translate = [0.3, -0.4], rotate = 4.0, steps = 3, duration = 0.5 },\n"
             "  { steps = 3, duration = 50.0 }, { translate = [0, 0.2], steps = 2, duration = 1.0 }]\n"),
)  # fmt: skip


TWO = (
    """
[material.soft]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 2e3
[material.soft.viscoelastic]
g = [0.3, 0.2]
tau = [1.0, 100.0]
[material.stiff]
law = "mooney_rivlin"
c10 = 320.0
c01 = 80.0
bulk_modulus = 6e3
[material.stiff.viscoelastic]
g = [0.4]
tau = [5.0]
"""
    + pressed_block(1.0)
    .replace("friction = 0.0", "friction = 0.2")
    .replace(
        "steps = 4\n",
        "steps = 3\nduration = 0.5\n[[profile.stage]]\nsteps = 3\nduration = 50.0\n"
        "[[profile.stage]]\ntranslate = [0.0, 0.1]\nsteps = 2\nduration = 1.0\n",
    )
    + '[[design]]\nedges = ["top"]\nparameters = 4\nbound = 0.3\n[[measure]]\ntype = "reaction"\n'
    + MEASURES
)
"""Two rubbers with series of different lengths."""


def analyzed(folder, content, **parameters):
    result = sm.analyze(exact_seal(folder, content), parameters=parameters)
    result.require_converged()
    return result


CASES = {"block": BLOCK, "ring": AROUND, "foam": foam(BLOCK), "held": HELD}


@pytest.fixture(scope="module", params=CASES.values(), ids=CASES)
def seal(request, tmp_path_factory):
    return exact_seal(tmp_path_factory.mktemp("relaxing"), request.param)


@pytest.fixture(scope="module")
def result(seal):
    found = sm.analyze(seal, keep_factors=True)
    found.require_converged()
    return found


def constants(seal):
    """Parameters of rubber, relaxation and environment."""
    return tuple(
        name for name in seal.scalars if not name.endswith(("penalty", "_x", "_y", "angle"))
    )


def test_direct_and_adjoint_agree_in_all_particles(result):
    """More parameters than contacts pass functions on: the stresses pass all displacements on."""
    measures = result.measures(("reaction",))
    direct, adjoint = (
        particle_gradient(result, (), measures, method)["particles"]["reaction"]
        for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=0.0, atol=1e-8 * np.abs(adjoint).max())


def test_direct_and_adjoint_agree(seal, result):
    direct, adjoint = (
        sm.differentiate(result, constants(seal), None, method) for method in ("direct", "adjoint")
    )
    for measure in seal.standard:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        assert np.all(np.abs(one).max(axis=1) > 0.0)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10 * np.abs(one).max())


def test_forces_are_those_of_the_potential_of_the_step(result, rng):
    require_potentials(result, rng)


STEPS = {
    "g_1": 1e-4, "tau_1": 1e-3, "tau_2": 1e-1, "time": 1e-1,
    "duration_1": 1e-4, "duration_2": 1e-1, "temperature": 1e-2, "wlf_c1": 1e-3,
    "wlf_c2": 1e-1, "activation_energy": 1e-2, "boundary_offsets[1]": 2e-5, "c10": 1e-2, "mu_1": 1e-2,
    "lid_friction": 1e-4, "plate_friction": 1e-5, "top_x_1": 1e-4,
}  # fmt: skip


@pytest.mark.parametrize("name", STEPS)
def test_derivatives_are_those_of_the_path(seal, result, name):
    known = (*(f"boundary_offsets[{i}]" for i in range(3)), *seal.scalars)
    if name not in known:
        pytest.skip("no parameter of this seal")
    direct = sm.differentiate(result, constants(seal), None, "direct")
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(seal, name, STEPS[name]).items():
        one = np.atleast_2d(direct[measure])[:, column]
        assert np.all(np.abs(one - quotient) <= bound), measure
        # a quotient that says nothing proves nothing; forces of points that stick know no friction
        assert bound.max() <= 1e-4 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-2), measure


def test_relaxation_at_rest_releases_no_energy(tmp_path):
    """In a dwell the body follows forces f that relaxation changes by df: the potential falls by half of
    their work df . du, up to third order, so that the bounds are -1/2 and 3/2 of it."""
    bounds = energy_bounds(analyzed(tmp_path, HELD).path)[3:6]
    least, most, work = bounds.T
    assert np.all(work > 0.0)
    np.testing.assert_allclose(least, -0.5 * work, rtol=2e-3)
    np.testing.assert_allclose(most, 1.5 * work, rtol=2e-3)


@pytest.mark.filterwarnings("ignore::seal_mdao.errors.KinkWarning")
def test_every_rubber_has_its_series(tmp_path):
    """Direct, adjoint and quotients in constants of two rubbers with series of different lengths. The
    plate touches at the start, where derivatives with respect to the shape are one-sided."""
    seal = exact_seal(tmp_path, TWO)
    result = sm.analyze(seal, keep_factors=True)
    direct, adjoint = (
        sm.differentiate(result, constants(seal), None, method) for method in ("direct", "adjoint")
    )
    steps = {"soft_g_1": 1e-4, "soft_tau_2": 1e-1, "stiff_g_1": 1e-4, "stiff_tau_1": 1e-3}
    for measure in seal.standard:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10 * np.abs(one).max())
    for name, step in steps.items():
        column = direct.parameters.index(name)
        for measure, (quotient, bound) in quotients(seal, name, step).items():
            one = np.atleast_2d(direct[measure])[:, column]
            assert np.all(np.abs(one - quotient) <= bound), (name, measure)
            assert bound.max() <= 1e-4 * np.abs(one).max(), (name, measure)


def test_the_lid_that_rests_needs_no_smaller_steps(result):
    """What relaxation drives is no jump: no step is halved."""
    assert result.path.step_cuts == 0
    assert len(result.path.steps) == 8


def test_pictures_show_the_stress_of_the_measures(seal, result):
    """At the particles, after the closing and at the end of the path."""
    grid = fine_grid(result, divisions=1)
    for step in (2, -1):
        shown, exact = np.sort(grid.von_mises(step)), np.sort(result.stress_field(step))
        np.testing.assert_allclose(shown, exact, rtol=1e-9, atol=1e-9 * exact.max())


@pytest.mark.parametrize(("duration", "long"), [(1e15, True), (1e-13, False)])
@pytest.mark.parametrize("around", [False, True], ids=["plane", "ring"])
def test_slow_and_fast_paths_are_elastic(tmp_path, duration, long, around):
    """The forces are those of the constants of long times, and of short ones, c / (1 - sum g)."""
    given = ring() if around else text(FIXED, LID)
    stages = DWELL
    for own in ("0.5 }", "1e3 }", "2.0 }"):
        stages = stages.replace(f"duration = {own}", f"duration = {duration} }}")
    label = "plate" if around else "lid"
    found = analyzed(tmp_path, relaxing(given, stages=stages)).path.reaction(label)
    elastic = relaxing(given, "\n", stages)
    for own in (f", duration = {duration}",):
        elastic = elastic.replace(own, "")
    factor = 1.0 if long else 2.0
    elastic = elastic.replace("c10 = 80.0", f"c10 = {80.0 * factor}")
    elastic = elastic.replace("c01 = 20.0", f"c01 = {20.0 * factor}")
    expected = analyzed(tmp_path, elastic).path.reaction(label)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_constants_of_short_times_are_those_of_long_times_with_the_rest(tmp_path):
    given = relaxing(text(FIXED, LID, MEASURES))
    short = given.replace("tau = [1.0, 100.0]", 'tau = [1.0, 100.0]\nmoduli = "instantaneous"')
    short = short.replace("c10 = 80.0", "c10 = 160.0").replace("c01 = 20.0", "c01 = 40.0")
    one, other = (analyzed(tmp_path, own) for own in (given, short))
    np.testing.assert_allclose(one.path.steps[-1].d, other.path.steps[-1].d, atol=1e-12)
    for measure in one.measures(None):
        np.testing.assert_allclose(one.value(measure), other.value(measure), rtol=1e-11)


def test_parts_of_zero_change_nothing(tmp_path):
    """Stresses through the history are those of the law then, in a foam, too."""
    for given in (text(FIXED, LID, MEASURES), foam(text(FIXED, LID, MEASURES)), ring() + MEASURES):
        none = relaxing(given, "\n[material.rubber.viscoelastic]\ng = [0.0]\ntau = [1.0]\n")
        elastic = relaxing(given, "\n")
        for own in ("0.5", "1e3", "2.0"):
            elastic = elastic.replace(f", duration = {own}", "")
        one, other = (analyzed(tmp_path, own) for own in (none, elastic))
        np.testing.assert_allclose(one.path.steps[-1].d, other.path.steps[-1].d, atol=1e-11)
        for measure in one.measures(None):
            np.testing.assert_allclose(one.value(measure), other.value(measure), rtol=1e-9)


def test_six_decades_of_rest_in_forty_steps(tmp_path):
    """Steps of a dwell are even in the logarithm of time: 40 of them are within 1e-3 of 640."""
    found = []
    series = "\n[material.rubber.viscoelastic]\ng = [0.15, 0.15, 0.15]\ntau = [1.0, 1e2, 1e4]\n"
    for steps in (40, 640):
        stages = DWELL.replace("steps = 3, duration = 1e3", f"steps = {steps}, duration = 1e6")
        path = analyzed(tmp_path, relaxing(text(FIXED, LID, spacing=1.0), series, stages)).path
        found.append(path.reaction("lid")[3 : 3 + steps, 1])
    coarse, fine = found[0], found[1][15::16]
    np.testing.assert_allclose(coarse, fine, rtol=1e-3)
    # the force falls to about that of long times
    assert fine[-1] < 0.7 * fine[0]


def test_times_of_the_path(tmp_path):
    seal = exact_seal(tmp_path, relaxing(text(FIXED, LID)))
    times = seal.terms()[0].environment.time
    np.testing.assert_allclose(times.at([0, 3, 6, 8]), [0.0, 0.5, 1000.5, 1002.5], rtol=1e-15)
    np.testing.assert_allclose(times.at([1.0, 2.0]), [0.5 / 3, 1.0 / 3], rtol=1e-14)
    # even in the logarithm of t_0 + t with t_0 = 1 s, the least relaxation time
    dwell = np.log(1.0 + times.at([3, 4, 5, 6]) - 0.5)
    np.testing.assert_allclose(np.diff(dwell), np.log(1001.0) / 3, rtol=1e-12)
    # in other steps the same times
    other = times.with_ends([1.5, 3.0, 4.0, 6.0, 8.0])
    np.testing.assert_allclose(other.at([0.5, 1.5, 2.5]), times.at([0.75, 2.25, 3.5]), rtol=1e-14)
    # dt/d(time of the path) by differences
    quotient = (
        times.with_value(1003.5).at([2.0, 4.3]) - times.with_value(1001.5).at([2.0, 4.3])
    ) / 2
    np.testing.assert_allclose(times.rates([2.0, 4.3]), quotient, rtol=1e-6)
    # all durations are proportional to the time, with one of them changed, too; its own rate
    other = seal.with_parameters({"time": 2005.0, "duration_2": 50.0}).terms()[0].environment
    np.testing.assert_allclose(other.time.at([3, 6, 8]), [1.0, 101.0, 105.0], rtol=1e-15)
    ends = [
        seal.with_parameters({"time": 2005.0, "duration_2": 50.0 + sign})
        .terms()[0]
        .environment.time
        for sign in (0.01, -0.01)
    ]
    quotient = (ends[0].at([2.0, 4.3, 7.0]) - ends[1].at([2.0, 4.3, 7.0])) / 0.02
    found = other.time_rates([2.0, 4.3, 7.0])["duration_2"]
    np.testing.assert_allclose(found, quotient, rtol=1e-6, atol=1e-12)
    assert found[0] == 0.0
    assert found[2] == 2.0
    assert seal.conditions()["time_s"] == pytest.approx(1002.5)
    assert seal.conditions(3)["time_s"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("swelling", "model", "dwells"),
    [
        ("[1.1, 1.1, 1.2]", "", True), ("1.1", "", True), ("[1.0, 1.1, 1.1]", "", False),
        ("1.1", "temperature = [60, 60, 40]", True), ("1.1", "temperature = [60, 40, 40]", False),
    ],
)  # fmt: skip
def test_time_is_linear_where_swelling_or_temperature_changes(tmp_path, swelling, model, dwells):
    """The ramps are linear in the completed part of a stage, so they are in time."""
    given = relaxing(text(FIXED, LID), model=model).replace(
        "c10 = 80.0\n",
        f"c10 = 80.0\nswelling = {swelling}\n" + ("expansion = 1e-4\n" if model else ""),
    )
    times = exact_seal(tmp_path, given).terms()[0].environment.time
    middle = times.at([4.5])[0] - 0.5
    assert middle == pytest.approx(np.sqrt(1001.0) - 1.0 if dwells else 500.0, rel=1e-12)


@pytest.mark.parametrize(("steps", "dwells"), [(2, True), (3, False)])
def test_time_is_linear_where_a_fluid_grows(tmp_path, steps, dwells):
    """The last of three stages has two steps; the pressure may begin in the second one."""
    fluid = '[[fluid]]\nedge = ["right", "top", "left"]\nfrom = "start"\npressure = 5.0\n'
    given = relaxing(text(FIXED, LID, fluid + f"steps = {steps}\n"))
    times = exact_seal(tmp_path, given).terms()[0].environment.time
    assert np.isfinite(times.first[1]) == dwells
    assert not np.isfinite(times.first[2])


REFUSED = [
    ("duration = 1e3 }", "steps = 3 }", "has no duration"),
    ("tau = [1.0, 100.0]", "tau = [1.0]", "a Prony series needs one relaxation time tau for"),
    ("g = [0.3, 0.2]", "g = [0.7, 0.4]", "their sum must be below 1"),
    ("g = [0.3, 0.2]", "g = [0.3, -0.2]", "g"),
    ("tau = [1.0, 100.0]", "tau = [1.0, 0.0]", "tau"),
    (
        "tau = [1.0, 100.0]",
        "tau = [1.0, 100.0]\nwlf = { c1 = 1.0, c2 = 50.0, reference = 23.0 }",
        "has no temperature",
    ),
    (
        "tau = [1.0, 100.0]",
        "tau = [1.0, 100.0]\nwlf = { c1 = 1.0, c2 = 50.0, reference = 23.0 }\n"
        "arrhenius = { activation_energy = 40.0, reference = 23.0 }",
        "the keys wlf and arrhenius are given together, but",
    ),
    ('type = "stress_norm"', 'type = "strain_energy"', "strain_energy is not available"),
]


@pytest.mark.parametrize(("old", "new", "words"), REFUSED, ids=[words for *_, words in REFUSED])
def test_what_does_not_fit_is_refused(tmp_path, old, new, words):
    given = relaxing(text(FIXED, LID, MEASURES))
    changed = (
        given.replace(old, new)
        if new != "steps = 3 }"
        else given.replace(", duration = 1e3 }", " }")
    )
    assert changed != given
    with pytest.raises(sm.SealFileError, match=words):
        read(tmp_path, changed)


def test_temperatures_below_the_law_of_the_shift_are_refused(tmp_path):
    given = relaxing(text(FIXED, LID), SHIFTED, model="temperature = -130.0")
    with pytest.raises(sm.SealFileError, match="valid only above -127 degC"):
        read(tmp_path, given)


def test_temperatures_for_other_stages_are_refused(tmp_path):
    given = relaxing(text(FIXED, LID), SHIFTED, model="temperature = [60.0, 80.0]")
    with pytest.raises(
        sm.SealFileError, match="has 2 numbers, but the motion of 'lid' has 3 stages"
    ):
        read(tmp_path, given)


def test_an_axial_stretch_is_refused(tmp_path):
    model = 'kinematics = "generalised_plane_strain"\naxial_stretch = 1.02'
    with pytest.raises(
        sm.SealFileError, match=r".viscoelastic\]: viscoelasticity cannot be combined"
    ):
        read(tmp_path, relaxing(text(FIXED, LID), model=model))


@pytest.mark.parametrize(
    ("name", "value"), [("g_1", 0.9), ("tau_1", -1.0), ("time", 0.0), ("duration_2", 0.0)]
)
def test_parameters_are_refused_where_the_file_would_be(tmp_path, name, value):
    with pytest.raises(ValueError, match=name.split("_")[0]):
        sm.analyze(exact_seal(tmp_path, relaxing(text(FIXED, LID))), parameters={name: value})


# ---- measures in time ----

IN_TIME = """\
[[measure]]
type = "reaction"
name = "at_stages"
stage = [1, 2]
[[measure]]
type = "reaction"
name = "at_times"
time = [0.2, 0.45, 30.0, 900.0, 1001.0]
[[measure]]
type = "retained_force"
stage = [1, 2]
[[measure]]
type = "retained_force"
name = "retained_in_time"
time = [0.48, 300.0]
[[measure]]
type = "compression_set"
at = [0.0, 4.0]
[[measure]]
type = "load_deflection_error"
time = [0.48, 100.0]
value = [900.0, 600.0]
[[measure]]
type = "profile_work"
stage = [1, 3]
"""


@pytest.fixture(scope="module")
def timed(tmp_path_factory):
    seal = exact_seal(tmp_path_factory.mktemp("timed"), relaxing(text(FIXED, LID, DESIGN, IN_TIME)))
    return sm.analyze(seal, keep_factors=True)


def test_forces_at_stages_and_times(timed):
    forces = timed.path.reaction("lid")[:, 1]
    np.testing.assert_allclose(timed.value("at_stages"), forces[[2, 5]], rtol=1e-14)
    found, times = timed.value("at_times"), timed.seal.terms()[0].environment.time
    part = 0.45 / 0.5 * 3.0 - 2.0
    np.testing.assert_allclose(found[1], forces[1] + part * (forces[2] - forces[1]), rtol=1e-12)
    # 1001 s is half way through the last step but one; linear in the logarithm of time in a dwell
    np.testing.assert_allclose(found[4], 0.5 * (forces[5] + forces[6]), rtol=1e-12)
    log = np.log(1.0 + times.at([4, 5]) - 0.5)
    part = (np.log(1.0 + 30.0 - 0.5) - log[0]) / (log[1] - log[0])
    np.testing.assert_allclose(found[2], forces[3] + part * (forces[4] - forces[3]), rtol=1e-12)
    assert timed.value("retained_force")[0] == pytest.approx(forces[5] / forces[2], rel=1e-14)
    assert 0.5 < timed.value("retained_in_time")[0] < 1.0
    top = [timed.displacement(step) for step in (2, -1)]
    particle = timed.measure("compression_set").point
    assert timed.value("compression_set")[0] == pytest.approx(
        top[1][particle, 1] / top[0][particle, 1], rel=1e-14
    )


@pytest.mark.parametrize(
    "name", ["time", "duration_1", "duration_2", "tau_2", "g_2", "c10", "boundary_offsets[1]"]
)
def test_derivatives_of_measures_in_time(timed, name):
    seal = timed.seal
    direct, adjoint = (
        sm.differentiate(timed, constants(seal), None, method) for method in ("direct", "adjoint")
    )
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(seal, name, STEPS.get(name, 1e-4)).items():
        one, other = (np.atleast_2d(own[measure])[:, column] for own in (direct, adjoint))
        size = np.abs(np.atleast_2d(direct[measure])).max()
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-11 * size)
        assert np.all(np.abs(one - quotient) <= bound), measure
        assert bound.max() <= 1e-4 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-2), measure


@pytest.mark.parametrize(
    ("measure", "words"),
    [
        ('type = "reaction"\nstage = 4', "stage = 4, but the motion has only 3"),
        ('type = "reaction"\nstage = 1\ntime = 2.0', "stage and time are given together"),
        (
            'type = "reaction"\ntime = 2000.0',
            "time = 2000 s is beyond the end of the analysis at 1002.5 s",
        ),
        ('type = "retained_force"\nstage = 1', "must have two"),
        (
            'type = "compression_set"\nat = [0, 4]\nstage = 3',
            "stage = 3, but the motion has only 3",
        ),
    ],
)
def test_measures_beyond_the_path_are_refused(tmp_path, measure, words):
    given = relaxing(text(FIXED, LID, f"[[measure]]\nname = 'late'\n{measure}\n"))
    with pytest.raises(sm.SealFileError, match=words):
        sm.build_seal(read(tmp_path, given))


def test_forces_later_than_a_shorter_path_are_not_numbers(timed):
    """At 900 and 1001 s of a path whose dwell was shortened to 100 s, and the ratio at 300 s."""
    result = sm.analyze(timed.seal, parameters={"duration_2": 100.0})
    found = result.value("at_times")
    np.testing.assert_array_equal(np.isnan(found), [False, False, False, True, True])
    assert np.isnan(result.value("retained_in_time")).all()
    # 30 s is in the dwell, with other load steps
    assert found[2] == pytest.approx(timed.value("at_times")[2], rel=0.02)
    told = [text for text in result.warnings if "because the path ends at 102.5 s" in text]
    assert told[0].startswith("the measure at_times has no value at 1001 s")
    assert told[1].startswith("retained_in_time: ")
    with pytest.raises(sm.LoadPathError, match="at_times, retained_in_time cannot be evaluated"):
        result.admissible_values(result.measures(None))
    assert not any("no value" in text for text in timed.warnings)


def test_a_time_needs_a_material_that_relaxes(tmp_path):
    given = text(FIXED, LID, "[[measure]]\ntype = 'reaction'\nname = 'late'\ntime = 1.0\n")
    with pytest.raises(sm.SealFileError, match="needs a viscoelastic material"):
        read(tmp_path, given)


def test_stages_are_those_of_what_moves_first(tmp_path):
    """Another profile has one stage, and a force on it at the ends of the stages of the path."""
    wall = (
        LID.replace('"lid"', '"wall"').replace('"top"', '"right"').replace("[0, 4.02]", "[4.02, 2]")
    )
    wall = wall.replace("[[-9, 0], [9, 0]]", "[[0, 9], [0, -9]]").split("[[measure]]")[0]
    wall = wall.replace(
        "{ translate = [0, -0.5], steps = 3 }", "{ translate = [-0.3, 0], steps = 8 }"
    )
    measure = (
        "[[measure]]\ntype = 'reaction'\nprofile = '{}'\ncomponent = '{}'\nname = '{}'\nstage = 2\n"
    )
    further = measure.format("wall", "x", "on_wall") + measure.format("lid", "y", "on_lid")
    lid = LID.replace('type = "reaction"', 'type = "reaction"\nprofile = "lid"')
    result = analyzed(tmp_path, relaxing(text(FIXED, lid, wall, further)))
    forces = [result.path.reaction(label)[5] for label in ("wall", "lid")]
    assert result.value("on_wall")[0] == pytest.approx(forces[0][0], rel=1e-14)
    assert result.value("on_lid")[0] == pytest.approx(forces[1][1], rel=1e-14)
    assert forces[0][0] != 0.0
