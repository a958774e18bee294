"""Derivatives at a kink of contact are reported where they jump, and nowhere else."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.cli.analyze import differentiated, measured
from seal_mdao.contact.friction import OPEN, STICK, ContactLaw
from seal_mdao.contact.kinks import LIMIT, SMOOTH, TOUCHING, find_kinks, rounding_of
from seal_mdao.dsa import contact_kinks
from seal_mdao.dsa.contact_kinks import contact_states, warn_of_kinks
from seal_mdao.errors import KinkWarning

BULB = (Path(__file__).parents[1] / "seal_file" / "bulb.toml").read_text()
START = "start = [0.0, 14.45]"


def bulb(folder, start=None, friction=0.25, changed=lambda text: text):
    """The bulb with coarse particles and a short path; without another start its door is at the highest
    contact point, which is the mean of the sides beside it, after five steps of 0.1 mm, and slides
    later."""
    text = BULB.replace("spacing = 0.9", "spacing = 1.6")
    text = text.replace("[0.0, -6.0]\nsteps = 60", "[0.0, -1.2]\nsteps = 12")
    text = text.replace("[2.0, 0.0]\nrotate = 0.0\nsteps = 20", "[0.2, 0.0]\nsteps = 2")
    text = text.replace(
        "friction = 0.25", f"friction = {friction}\nnormal_penalty = 1e4\ntangent_penalty = 1e2"
    )
    path = folder / "bulb.toml"

    def made(start):
        path.write_text(changed(text.replace(START, start)))
        return sm.build_seal(sm.read_seal_file(path))

    if start is not None:
        return made(start)
    seal = made(START)
    (door,) = (own for own in seal.definitions if own.label == "door")
    top = door.where.moving.at(seal.nominal_particles)[:, 1].max()
    return made(f"start = [0.0, {float(top) + 0.5!r}]")


@pytest.fixture(scope="module")
def kinked(tmp_path_factory):
    return bulb(tmp_path_factory.mktemp("kinked"))


def one_sided(seal, direction, side, h=1e-6):
    """Difference of second order of the reaction on one side of the nominal design."""
    at = [reaction(sm.analyze(seal, side * n * h * direction)) for n in range(3)]
    return side * (4.0 * at[1] - at[2] - 3.0 * at[0]) / (2.0 * h)


def reaction(result):
    (measure,) = (m for m in result.measures() if m.name == "reaction")
    return result.value(measure)


def test_a_jump_of_the_derivative_is_reported_with_contact_step_and_points(kinked):
    """The two sides differ by much more than differences err; the derivative is that of one."""
    result = sm.analyze(kinked)
    with pytest.warns(KinkWarning) as found:
        rates = sm.differentiate(result)
    (message,) = (str(item.message) for item in found)
    assert "'door' at load step 5: zero gap at point" in message
    assert "(x = 0, y = 14)" in message
    direction = np.zeros(kinked.n_offsets)
    direction[: kinked.n_offsets // 2] = 1.0
    sides = [one_sided(kinked, direction, side) for side in (-1.0, 1.0)]
    exact = np.atleast_2d(rates.reaction)[:, : direction.size] @ direction
    jump = np.abs(sides[1] - sides[0]).max()
    assert jump > 1e-3 * np.abs(exact).max()
    assert min(np.abs(side - exact).max() for side in sides) < 1e-2 * jump


def test_a_summary_without_design_parameters_has_no_warning(kinked, tmp_path):
    """Derivatives in material constants are written, too; who changes no design needs no advice."""
    with pytest.warns(KinkWarning):
        differentiated(sm.analyze(kinked))
    fixed = bulb(tmp_path, changed=_without_design)
    result = sm.analyze(fixed)
    with pytest.warns(KinkWarning):
        sm.differentiate(result)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = measured(differentiated(result))["measures"]
    assert found
    assert all(own["value"] is not None for own in found.values())


def _without_design(text):
    """The text without its tables of design parameters and of the optimisation."""
    tables = re.split(r"^(?=\[)", text, flags=re.MULTILINE)
    return "".join(
        own for own in tables if not own.startswith(("[[design", "[optimize", "[[optimize"))
    )


def test_off_the_kink_nothing_is_reported(tmp_path):
    seal = bulb(tmp_path, START)
    sm.differentiate(sm.analyze(seal))


def test_without_friction_only_measured_steps_count(tmp_path):
    seal = bulb(tmp_path, friction=0.0)
    result = sm.analyze(seal)
    sm.differentiate(result)
    with pytest.warns(KinkWarning, match="load step 5: zero gap"):
        warn_of_kinks(result.path, [4])


def test_a_symmetric_touch_that_passes_nothing_on_is_not_reported(nominal):
    """The door seal's top has zero gap after five steps, at which nothing is measured."""
    gap = nominal.path.steps[4].responses[nominal.path.index_of("door")].gap
    assert np.abs(gap).min() < 1e-14
    sm.differentiate(nominal)
    with pytest.warns(KinkWarning, match=r"'door' at load step 5: zero gap at point 25 \(x = 0"):
        warn_of_kinks(nominal.path, [4])


def test_a_touch_before_the_measured_steps_is_reported_for_either_reason(nominal, monkeypatch):
    """Its force moves what the next step uses, or the point slips in the next step."""
    path, door = nominal.path, nominal.term("door")
    last, kinks = [len(path.steps) - 1], door.kinks

    def slipping(*given):
        found = kinks(*given)
        return found._replace(slips=np.ones(len(found.touching), bool))

    warn_of_kinks(path, last)
    with monkeypatch.context() as patched:
        patched.setattr(door, "kinks", slipping)
        with pytest.warns(KinkWarning, match="load step 5: zero gap at point 25"):
            warn_of_kinks(path, last)
    monkeypatch.setattr(contact_kinks, "_passes_on", lambda path, term, kinks, *steps: ~kinks.slips)
    with pytest.warns(KinkWarning, match="load step 5: zero gap at point 25"):
        warn_of_kinks(path, last)


TOUCHED = """\
[material.rubber]
shore_a = 60
[section]
spacing = 1.5
outer = [
  { edge = "base", line = [[-4.0, 0.0], [4.0, 0.0]] },
  { edge = "right", line = [[4.0, 0.0], [4.0, 4.0]] },
  { edge = "top", line = [[4.0, 4.0], [0.0, 5.0], [-4.0, 4.0]] },
  { edge = "left", line = [[-4.0, 4.0], [-4.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.0
normal_penalty = 1e5
tangent_penalty = 1e4
contact = ["top"]
contact_points = "particles"
line = [[-20.0, 0.0], [20.0, 0.0]]
start = [0.0, 5.0]
stage = [{ translate = [0.1, -0.3], steps = 4 }]
[[measure]]
type = "reaction"
[[measure]]
type = "profile_work"
profile = "plate"
[[design]]
edges = ["top"]
parameters = 3
bound = 0.2
"""
"""A ridge whose tip a plate touches at the start of the path."""


def touched(folder, *changes):
    text = TOUCHED
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "touched.toml").write_text(text)
    return sm.build_seal(sm.read_seal_file(folder / "touched.toml"))


FRICTION = ("friction = 0.0", "friction = 0.3")
AT_THE_START = r"'plate' at the start: zero gap at point \d+ \(x = 0, y = 5\)"


@pytest.mark.parametrize(
    ("changes", "name"), [((), "profile_work"), ((FRICTION,), "reaction")], ids=["work", "friction"]
)
def test_a_touch_at_the_start_is_reported_where_the_derivative_jumps(tmp_path, changes, name):
    """A design that overlaps the plate has a force at the start, which counts in the work and from which
    points stick or slip."""
    seal = touched(tmp_path, *changes)
    result, direction, h = sm.analyze(seal), np.ones(seal.n_offsets), 1e-6
    with pytest.warns(KinkWarning, match=AT_THE_START):
        exact = np.atleast_2d(sm.differentiate(result, (), [name])[name])[-1] @ direction

    def at(n):
        return np.atleast_1d(sm.analyze(seal, n * h * direction).value(name))[-1]

    # (4 f(h) - f(2 h) - 3 f(0)) / (2 h) on either side
    below, above = (
        side * (4.0 * at(side) - at(2 * side) - 3.0 * at(0)) / (2.0 * h) for side in (-1, 1)
    )
    assert exact == pytest.approx(below, rel=1e-5)
    assert abs(above - below) > 1e-4 * abs(below)


@pytest.mark.parametrize(
    "changes",
    [
        [],
        [FRICTION, ("start = [0.0, 5.0]", "start = [0.0, 5.001]")],
        [FRICTION, ('edges = ["top"]', 'edges = ["right"]')],
    ],
    ids=["no friction", "clear", "other edge"],
)
def test_a_touch_at_the_start_without_effect_is_not_reported(tmp_path, changes):
    result = sm.analyze(touched(tmp_path, *changes))
    sm.differentiate(result, (), ["reaction"])


def test_steps_after_the_last_measured_one_do_not_count(kinked):
    path = sm.analyze(kinked).path
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_kinks(path, [3])
        warn_of_kinks(path, [])


def test_zero_gap_and_zero_slip_margin_within_rounding():
    """w_n = 1000, w_t = 100, mu = 0.2: at a gap of -1e-3 the limit is a slip of 2e-3."""
    law = ContactLaw(1000.0, 100.0, 0.2, True)
    rounding = rounding_of(10.0)
    assert 1e-15 < rounding < 1e-12
    near, far = 0.9 * rounding, 1e3 * rounding
    cases = [
        # gap, slip, found
        (0.0, 0.0, TOUCHING), (near, 0.0, TOUCHING), (-near, 0.0, TOUCHING), (far, 0.0, SMOOTH),
        (-1e-3, 2e-3, LIMIT), (-1e-3, 2e-3 + near, LIMIT), (-1e-3, -2e-3 - near, LIMIT),
        (-1e-3, 2e-3 + far, SMOOTH), (-1e-3, 2e-3 - far, SMOOTH), (-1e-3, 0.0, SMOOTH),
    ]  # fmt: skip
    gap, slip = (np.array(column) for column in list(zip(*cases, strict=True))[:2])
    states = np.where(gap < 0.0, STICK, OPEN)
    found = np.empty(len(cases), np.int64)
    none = np.zeros(len(cases))
    variables = np.column_stack([none, none + 1.0, none])
    count = find_kinks(0.0, law, gap, slip, states, variables, rounding, found)
    assert [int(kind) for kind in found] == [case[2] for case in cases]
    assert count == 6
    # round a closed profile the shorter way
    find_kinks(7.0, law, gap, slip + 7.0, states, variables, 1e-12, found)
    assert list(found[4:7]) == [LIMIT] * 3
    # without friction there is no limit
    find_kinks(0.0, law._replace(friction=0.0), gap, slip, states, variables, rounding, found)
    assert list(found[4:]) == [SMOOTH] * 6


def test_states_have_names():
    result = sm.analyze(sm.door_seal(n_steps=5, depth=2.0))
    states, door = contact_states(result.path), result.term("door")
    assert len(states) == 5 * len(door.where)
    assert set(states.values()) > {"open"}
    for step in result.path.nominal_steps:
        branch = step.responses[door.index].branch
        for point, (x, y) in enumerate(door.reference.round(6) + 0.0):
            name = (
                f"point {point} (x = {x:.4g}, y = {y:.4g}) of 'door' at load step {step.fraction:g}"
            )
            assert states[name] == ("open", "stick", "slip")[branch[point]]
