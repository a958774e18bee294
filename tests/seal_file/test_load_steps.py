"""Load steps and penalties that a seal file leaves open: chosen once, then part of the seal."""

import re
from dataclasses import replace

import numpy as np
import pytest
from test_build import COARSE, read

import seal_mdao as sm
from seal_mdao.analysis.path_result import ConvergedStep, Status
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.seals.checks import Finding
from seal_mdao.seals.file.chosen import chosen_ends, chosen_for
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.penalty_error import penalty_errors
from seal_mdao.seals.refined_steps import difference, divided
from seal_mdao.seals.result import analyze_particles, frozen_measures
from seal_mdao.seals.steps_and_penalties import COARSE as COARSE_STEPS

OPEN = re.sub(r"steps = \d\n", "", COARSE)
LISTED = COARSE.replace("steps = 6", "steps = [0.2, 0.3, 1]").replace("steps = 2", "steps = 1")
TIGHT = sm.NewtonOptions(tolerance=1e-12)
LIMITED = OPEN.replace(
    'law = "mooney_rivlin"\nc10 = 80.0\nc01 = 20.0',
    'law = "gent"\nshear_modulus = 200.0\nlimit = 0.05\nstable = [0.99, 1.01]',
).replace("[0.0, -1.1]", "[0.0, -6.0]")
"""Of a rubber that hardly stretches."""
UNEQUAL = (0.3, 0.45, 0.5, 0.7, 0.8, 1.0, 1.1, 1.6, 2.0)
WALL = """[[profile]]
name = "wall"
friction = 0.1
contact = ["seal"]
line = [[-30.0, -40.0], [-30.0, 40.0]]
stage = [{ }, { translate = [0.5, 0.0] }]
[[profile]]
name = "post"
friction = 0.1
contact = ["seal"]
line = [[30.0, 40.0], [30.0, -40.0]]
[[fluid]]
edge = "seal"
from = "end"
pressure = 4.0
"""
BESIDE = OPEN[: OPEN.index("[optimize]")].replace("[[design]]", f"{WALL}[[design]]")


class Begun:
    """A callback with the load steps of the paths that begin."""

    def __init__(self, paths: list):
        self.paths = paths

    def begin_analysis(self, number, of, steps):
        self.paths.append(steps)

    def __call__(self, step):
        pass


@pytest.fixture(scope="module")
def bulb(tmp_path_factory):
    """File, seal, and how many load steps its choice took."""
    file, seen = read(tmp_path_factory.mktemp("bulb"), OPEN), []
    return file, sm.build_seal(file, seen.append), len(seen)


def lengths(seal):
    return np.diff(chosen_ends(seal), prepend=0.0)


def test_what_a_file_gives_and_what_it_leaves_open(tmp_path):
    stages = {}
    for name, text in {
        "given": COARSE, "open": OPEN, "listed": LISTED,
        "auto": COARSE.replace("steps = 6", 'steps = "auto"').replace("steps = 2\n", ""),
        "tolerance": f"{OPEN}[steps]\ntolerance = 0.03\n",
    }.items():  # fmt: skip
        file = read(tmp_path, text)
        stages[name] = file.step_tolerance, [s.steps for s in file.profiles[0].stages], file.n_steps
    assert stages == {
        "given": (None, [6, 2], 8), "listed": (None, [(0.2, 0.3, 1.0), 1], 4),
        "open": (0.005, [1, 1], 2), "auto": (0.005, [1, 1], 2), "tolerance": (0.03, [1, 1], 2),
    }  # fmt: skip


def test_measures_and_forces_are_within_the_tolerance_of_four_times_as_many(bulb):
    file, seal, _ = bulb
    before = chosen_for(file, seal)
    finer = sm.build_seal(
        file, step_ends=divided(np.array(before["step_ends"]), 4), penalties=before["penalties"]
    )
    assert finer.n_steps == 4 * seal.n_steps
    found = difference(sm.analyze(seal), sm.analyze(finer), np.arange(3, finer.n_steps, 4))
    assert 0.0 < found <= file.step_tolerance
    assert 1.0 in chosen_ends(seal)


def test_a_smaller_tolerance_takes_more_steps_where_they_are_needed(bulb, tmp_path):
    tight = sm.build_seal(read(tmp_path, f"{OPEN}[steps]\ntolerance = 1e-5\n"))
    assert tight.n_steps > bulb[1].n_steps
    assert lengths(tight).max() >= 2.0 * lengths(tight).min()


SOFT = f"{COARSE}[penalties]\ntolerance = 0.9\n"


@pytest.mark.parametrize(
    "text", [OPEN, COARSE, SOFT], ids=["steps and penalties", "penalties", "the first penalties"]
)
def test_the_last_path_of_the_choice_is_the_analysis_of_the_nominal_seal(text, tmp_path):
    """Bit for bit, so it is not made again; and the choice takes at most three paths."""
    file, begun, steps = read(tmp_path, text), [], []

    def callback(step):
        steps.append(step)

    callback.begin_analysis = lambda *numbers: begun.append(numbers)
    seal = sm.build_seal(file, callback)
    assert len(begun) <= 3
    last, shown = steps[-seal.n_steps :], []
    one = sm.analyze(seal, keep_factors=True, callback=shown.append)
    assert all(a is b is c for a, b, c in zip(one.path.nominal_steps, last, shown, strict=True))
    other = sm.analyze(sm.build_seal(file, **chosen_for(file, seal)), keep_factors=True)
    for a, b in zip(one.path.steps, other.path.steps, strict=True):
        np.testing.assert_array_equal(a.d, b.d)
        assert a.residuals == b.residuals
    measures = one.measures()
    rates = [sm.differentiate(r, ("c10",), measures, "adjoint").rows for r in (one, other)]
    for measure in measures:
        np.testing.assert_array_equal(*(found[measure.name] for found in rates))


def test_a_choice_discretises_the_body_once(tmp_path, monkeypatch):
    """And evaluates the errors by the penalties of a path once."""
    calls, paths = {"discretize": 0, "errors": 0}, []

    def discretized(*given):
        calls["discretize"] += 1
        return discretize(*given)

    def errors(result, *given):
        calls["errors"] += not given
        return penalty_errors(result, *given)

    monkeypatch.setattr("seal_mdao.seals.result.discretize", discretized)
    monkeypatch.setattr("seal_mdao.seals.penalty_error.penalty_errors", errors)
    sm.build_seal(read(tmp_path, OPEN), Begun(paths))
    assert len(paths) > 1
    assert calls == {"discretize": 1, "errors": len(paths)}


def test_they_are_the_seal_s_own_whatever_its_design(bulb, tmp_path):
    _, seal, seen = bulb
    assert seen >= COARSE_STEPS + seal.n_steps
    other = seal.with_parameters({"door_friction": 0.4, "c10": 60.0})
    result = sm.analyze(other, np.full(seal.n_offsets, 0.05))
    assert chosen_ends(result.seal) == chosen_ends(seal)
    assert len(result.path.nominal_steps) == seal.n_steps
    again = sm.build_seal(read(tmp_path, OPEN))
    assert chosen_ends(again) == chosen_ends(seal)


def test_chosen_before_they_are_not_chosen_again(bulb, tmp_path):
    file, seal, _ = bulb
    seen = []
    again = sm.build_seal(file, seen.append, **chosen_for(file, seal))
    assert not seen
    one, other = (sm.analyze(own) for own in (seal, again))
    for a, b in zip(one.path.nominal_steps, other.path.nominal_steps, strict=True):
        np.testing.assert_array_equal(a.d, b.d)
    for wrong in ([0.5, 2.0], [0.5, 1.0], [0.0, 1.0, 2.0]):
        with pytest.raises(
            sm.SealFileError, match="the fractions of a motion at which load steps end"
        ):
            sm.build_seal(file, step_ends=wrong)
    with pytest.raises(sm.SealFileError, match=r"the argument step_ends cannot be combined with"):
        sm.build_seal(read(tmp_path, COARSE), step_ends=[1.0, 2.0])


def test_a_design_as_a_file_has_them(bulb, tmp_path):
    file, seal, _ = bulb
    offsets = np.random.default_rng(2).uniform(-0.1, 0.1, seal.n_offsets)
    path = write_design(file, seal, offsets, frozen_measures(seal), tmp_path, "best")[0]
    design = sm.read_seal_file(path)
    assert design.step_tolerance is None
    again = sm.build_seal(design)
    one, other = (
        next(term.motion for term in own.terms() if term.label == "door") for own in (seal, again)
    )
    np.testing.assert_array_equal(one.ends, other.ends)
    for fraction in np.linspace(0.0, seal.n_steps, 40):
        np.testing.assert_array_equal(one.coordinates(fraction), other.coordinates(fraction))


def test_profiles_go_on_side_by_side_and_a_fluid_comes_in_the_last_stage(tmp_path):
    file = read(tmp_path, BESIDE)
    ends = [0.25, 1.0, 1.5, 2.0]
    seal = sm.build_seal(file, step_ends=ends)
    motions = {t.label: t.motion for t in seal.terms() if hasattr(t, "motion")}
    assert [motion.n_steps for motion in motions.values()] == [4, 4, 4]
    np.testing.assert_allclose(motions["door"].coordinates(1.0)[1], 14.45 - 1.1 / 4, atol=1e-14)
    np.testing.assert_allclose(motions["wall"].coordinates(3.0)[0], 0.25, atol=1e-14)
    assert np.ptp([motions["post"].coordinates(k) for k in range(5)], axis=0).tolist() == [0, 0, 0]
    fluid = next(term for term in seal.terms() if term.label == "fluid")
    assert fluid.ramp.tolist() == [0.0, 0.0, 0.0, 0.5, 1.0]
    np.testing.assert_array_equal(fluid.contacts[0].motion.ends, ends)
    path = write_design(file, seal, np.zeros(seal.n_offsets), (), tmp_path, "again")[0]
    again = next(t for t in sm.build_seal(sm.read_seal_file(path)).terms() if t.label == "fluid")
    np.testing.assert_array_equal(again.ramp, fluid.ramp)


def test_stages_at_rest_count(tmp_path):
    """Nothing moves but the pressure of the fluid, in the second of two stages."""
    text = BESIDE.replace("[0.0, -1.1]", "[0.0, 0.0]").replace("[0.3, 0.0]", "[0.0, 0.0]")
    text = text.replace("{ translate = [0.5, 0.0] }", "{ }")
    post = text[text.index('[[profile]]\nname = "post"') : text.index("[[fluid]]")]
    first = text.replace(post, "").replace("[[profile]]", f"{post}[[profile]]", 1)
    assert first.index('"post"') < first.index('"door"')
    file, ends = read(tmp_path, first), [0.5, 1.0, 1.25, 2.0]
    assert chosen_ends(sm.build_seal(file, step_ends=ends)) == ends


def test_derivatives_are_exact_with_them(bulb, rng):
    file, *_ = bulb
    seal = replace(sm.build_seal(file, step_ends=UNEQUAL), newton=TIGHT)
    offsets = 0.05 * rng.uniform(-1.0, 1.0, seal.n_offsets)
    result = sm.analyze(seal, offsets, keep_factors=True)
    names = ("door_friction", "c10")
    direct, adjoint = (
        sm.differentiate(result, names, method=method) for method in ("direct", "adjoint")
    )
    way = rng.uniform(-1.0, 1.0, seal.n_offsets)
    sides = [sm.analyze(seal, offsets + s * 1e-5 * way) for s in (1.0, -1.0)]
    for measure in seal.standard:
        a, b = direct[measure.name], adjoint[measure.name]
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-9 * np.abs(a).max())
        plus, minus = (side.value(measure)[0] for side in sides)
        assert all(map(ConvergedStep.same_branches, *(side.path.nominal_steps for side in sides)))
        exact = a[0, : seal.n_offsets] @ way
        # the step squared, and rounding of relative 1e-12 over the step
        assert abs((plus - minus) / 2e-5 - exact) <= 1e-5 * np.abs(a[0, : seal.n_offsets]).sum()


def test_a_path_that_ends_early_is_told_with_what_was_computed(tmp_path, monkeypatch):
    """The rubber comes to its limit: no load step is small enough."""
    monkeypatch.setattr("seal_mdao.seals.steps_and_penalties.MOST", 1)
    with pytest.raises(sm.LoadPathError, match="could not be completed") as caught:
        sm.build_seal(read(tmp_path, LIMITED.replace("[0.0, -6.0]", "[0.0, -9.0]")))
    result = caught.value.result
    assert 0 < len(result.path.nominal_steps) < 12 == result.seal.n_steps


def test_where_a_path_fails_more_load_steps_are_tried(tmp_path, monkeypatch):
    tried = []

    def failing(seal, *design, **options):
        tried.append(seal.n_steps)
        result = analyze_particles(seal, *design, **options)
        return cut_short(result) if len(tried) < 3 else result

    monkeypatch.setattr("seal_mdao.seals.steps_and_penalties.analyze_particles", failing)
    assert sm.build_seal(read(tmp_path, OPEN)).n_steps == 96
    # twice cut short; then the penalties are raised and the steps are halved
    assert tried == [12, 24, 48, 96]


def test_given_load_steps_bound_those_in_which_penalties_are_chosen(tmp_path, monkeypatch):
    tried, told = [], []

    def failing(seal, *design, **options):
        tried.append(seal.n_steps)
        result = analyze_particles(seal, *design, **options)
        return cut_short(result) if len(tried) < 2 else result

    monkeypatch.setattr("seal_mdao.seals.steps_and_penalties.analyze_particles", failing)
    monkeypatch.setattr(
        "seal_mdao.seals.steps_and_penalties.findings", lambda path: [Finding("a fault", True)]
    )

    def callback(step):
        """Take load steps."""

    callback.faults = told.append
    given = re.sub(r"(translate = .*\n)", r"\1steps = 15\n", OPEN)
    seal = sm.build_seal(read(tmp_path, given), callback)
    # about twelve of the given ones, which fail, then all that are given
    assert tried[0] < seal.n_steps
    assert set(tried[1:]) == {seal.n_steps}
    # impossible states are reported after every completed path
    assert told == [["a fault"]] * (len(tried) - 1)


def cut_short(result):
    path = replace(result.path, steps=result.path.steps[:-1], status=Status.NOT_CONVERGED)
    return replace(result, path=path)


def test_a_tolerance_that_is_not_reached_is_told_with_the_results(tmp_path, monkeypatch):
    monkeypatch.setattr("seal_mdao.seals.refined_steps.ROUNDS", 1)
    seal = sm.build_seal(read(tmp_path, f"{OPEN}[steps]\ntolerance = 1e-9\n"))
    result = sm.analyze(seal)
    assert any("24 load steps cause an estimated" in text for text in result.warnings)


def test_pictures_show_even_parts_of_uneven_stages(bulb):
    result = sm.analyze(sm.build_seal(bulb[0], step_ends=UNEQUAL))
    assert result.key_steps() == [2, 5, 7, 8]
    assert result.caption(2) == "stage 1, travel 0.55 mm"


WIPER = """[material.rubber]
shore_a = 60
[section]
spacing = 0.6
outer = [
  { edge = "under", line = [[-0.433, -0.25], [3.317, -6.745]] },
  { edge = "tip", arc = { start = [3.317, -6.745], through = [4.0, -6.928], end = [4.183, -6.245] } },
  { edge = "back", line = [[4.183, -6.245], [0.433, 0.25]] },
  { edge = "root", line = [[0.433, 0.25], [-0.433, -0.25]] },
]
[fixed]
edges = ["root"]
[[profile]]
name = "plane"
friction = 0.3
line = [[40, 0], [-40, 0]]
start = [0, -7.1]
stage = [{ translate = [0, 1.605] }, { translate = [5, 0] }, { translate = [-5, 0] }]
[[measure]]
type = "reaction"
component = "x"
travel = [1.705, 6.705]
"""
"""A lip that slides in both directions; friction turns round within a small part of a stage."""


def test_steps_are_small_where_a_measure_at_a_travel_needs_it(tmp_path):
    """In steady sliding displacements do not change with the steps, between which forces are linear."""
    file = read(tmp_path, WIPER)
    seal = sm.build_seal(file)
    result = sm.analyze(seal)
    chosen = chosen_for(file, seal)
    ends = divided(np.array(chosen["step_ends"]), 8)
    exact = sm.analyze(sm.build_seal(file, step_ends=ends, penalties=chosen["penalties"]))
    largest = np.hypot(*exact.path.reaction("plane").T).max()
    values = [own.value("reaction") for own in (result, exact)]
    assert np.abs(np.subtract(*values)).max() / largest <= file.step_tolerance
    # sliding in both directions
    assert values[1][0] < -0.1 * largest < 0.1 * largest < values[1][1]


def test_an_error_between_steps_that_stays_too_large_is_told(tmp_path, monkeypatch):
    """After three divisions the forces at the ends of the steps are right, those between are not."""
    monkeypatch.setattr("seal_mdao.seals.refined_steps.ROUNDS", 3)
    file = read(tmp_path, WIPER)
    seal = sm.build_seal(file)
    assert seal.step_error > 10.0 * file.step_tolerance
    assert seal.step_warnings[0].startswith(
        f"{seal.n_steps} load steps cause an estimated error of"
    )
