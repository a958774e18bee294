"""The first-order changes that the page draws are the derivatives of what it draws."""

import base64

import numpy as np
import pytest
from studio.small_seal import TEXT, nothing, write

import seal_mdao as sm
from seal_mdao.studio.workbench import Workbench
from seal_mdao.tolerances.tolerance_study import ToleranceStudy

STEP = 1e-4
"""Over the range of a number."""
NOISE = 1e-8
"""Error of a converged state over its size, ten times the residual at which Newton stops."""


def numbers(text):
    return np.frombuffer(base64.b64decode(text), "<f4").astype(float)


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Workbench(write(tmp_path_factory.mktemp("bulb")), nothing, nothing)


def drawn(bench, design, step):
    """What the page draws, in double precision: of the pictures the numbers before they are packed."""
    from seal_mdao.seals.profiles import contacts, true_pressure

    state = bench.analyze(design, step)
    (contact,) = contacts(bench.result.seal)
    poses = np.array(state["frame"]["poses"]).ravel()
    (curve,) = state["curves"]
    return {
        "points": np.column_stack([bench.fine.deformed(step), bench.fine.von_mises(step)]).ravel(),
        "pressure": true_pressure(bench.result, contact, step),
        "poses": poses, "along": np.array(curve["along"]),
        "force": np.array(curve["force"]).ravel(),
        "measures": np.concatenate(list(state["measures"].values())),
        "states": bench.result.path.at_nominal("plate")[step].state,
    }  # fmt: skip


@pytest.mark.parametrize("step", [5, 3])
def test_rates_are_derivatives_of_what_is_drawn(bench, step):
    start = bench.start()
    start[1] = 0.11
    base = drawn(bench, start, step)
    found, count = bench.first_order(step), len(start)
    rates = {name: numbers(found[name]).reshape(-1, count) for name in ("points",)}
    for name in ("pressure", "poses", "along", "force"):
        rates[name] = numbers(found[name][0]).reshape(-1, count)
    rates["measures"] = np.concatenate(
        [numbers(own).reshape(-1, count) for own in found["measures"].values()]
    )
    compared = 0
    for p, own in enumerate(bench.numbers):
        h = STEP * (own.high - own.low)
        near = {}
        for k in (-2, -1, 1, 2):
            design = list(start)
            design[p] += k * h
            near[k] = drawn(bench, design, step)
        if any(not np.array_equal(other["states"], base["states"]) for other in near.values()):
            continue
        compared += 1
        for name, own_rates in rates.items():
            one = (near[1][name] - near[-1][name]) / (2.0 * h)
            two = (near[2][name] - near[-2][name]) / (4.0 * h)
            # f'(x) = (4 D(h) - D(2h)) / 3 + O(h^4); D(2h) - D(h) = h^2 f'''/2
            best = (4.0 * one - two) / 3.0
            size = np.abs(base[name]).max()
            bound = np.abs(two - one) + NOISE * size / h
            # packed in 32 bits
            bound = bound + 2.0**-23 * np.abs(best)
            wrong = np.abs(own_rates[:, p] - best) > bound
            assert not wrong.any(), (name, bench.numbers[p].name, np.flatnonzero(wrong)[:5])
    assert compared > 0.7 * count


def test_changes_of_undeformed_points_are_exact(bench):
    scene = bench.scene()
    design = bench.start()
    design[:4] = [0.1, -0.2, 0.05, 0.3]
    bench.analyze(design)
    velocity = numbers(scene["velocity"]).reshape(4, -1)
    moved = numbers(scene["undeformed"]) + np.array(design[:4]) @ velocity
    # coordinates and offsets are packed in 32 bits
    assert np.abs(moved - bench.fine.undeformed().ravel()).max() < 4 * 2.0**-24 * 10.0


def test_preview_of_a_drag_of_a_tenth_of_a_millimetre_is_within_two_percent(bench):
    start = bench.start()
    base = bench.analyze(start)
    rates = numbers(bench.first_order()["force"][0]).reshape(-1, 2, len(start))
    for p in range(4):
        design = list(start)
        design[p] = 0.1
        exact = np.array(bench.analyze(design)["curves"][0]["force"])[-1, 1]
        preview = base["curves"][0]["force"][-1][1] + 0.1 * rates[-1, 1, p]
        assert preview == pytest.approx(exact, rel=0.02)


def test_a_design_whose_measure_has_no_value_is_shown_without_it(tmp_path):
    measure = '[[measure]]\ntype = "retained_force"\ncomponent = "y"\nstage = [1, 2]\n'
    dwell = "[[profile.stage]]\ntranslate = [0.0, -0.1]\nsteps = 2\n"
    text = TEXT.replace("[[measure]]", f"{dwell}{measure}[[measure]]", 1)
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    assert bench.analyze(bench.start())["measures"]["retained_force"] != [None]
    (number,) = [p for p, own in enumerate(bench.numbers) if own.name == "plate_y"]
    design = bench.start()
    design[number] = 11.7
    # the plate is not in contact after the first stage
    (travel,) = [p for p, own in enumerate(bench.numbers) if own.name == "plate_stage_1_y"]
    design[travel] = bench.numbers[travel].high
    found = bench.analyze(design)
    assert found["measures"]["retained_force"] == [None]
    assert all(
        None not in own for name, own in found["measures"].items() if name != "retained_force"
    )
    assert bench.first_order() is not None


def test_a_travel_that_is_not_reached_leaves_the_pictures_of_the_last_design(tmp_path):
    text = TEXT.replace(
        "[[measure]]", '[[measure]]\ntype = "reaction"\ntravel = 1.6\n[[measure]]', 1
    )
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    before, design = bench.analyze(bench.start()), bench.start()
    (travel,) = [p for p, own in enumerate(bench.numbers) if own.name == "plate_stage_1_y"]
    design[travel] = -1.5
    with pytest.raises(sm.LoadPathError, match=r"needs the force at 1\.6 mm of travel"):
        bench.analyze(design)
    assert bench.view(5) == before["frame"]
    assert bench.first_order() is not None


VENTED = """\
[[cavity]]
hole = 1
vent_diameter = 3.0
vent_spacing = 100.0
closing_speed = 1000.0
[fixed]"""


def test_the_time_of_vented_air_changes_with_the_travel(tmp_path):
    """Time, pressure and force are those of a file with this travel at its closing speed."""
    text = TEXT.replace("[fixed]", VENTED)
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    start = bench.start()
    (travel,) = [p for p, own in enumerate(bench.numbers) if own.name == "plate_stage_1_y"]

    def forces(value):
        design = list(start)
        design[travel] = value
        return np.array(bench.analyze(design)["curves"][0]["force"])

    written = text.replace("[0.0, -1.7]", "[0.0, -1.5]")
    result = sm.analyze(sm.build_seal(write(tmp_path, "written.toml", written)))
    assert result.reaction == pytest.approx(forces(-1.5), rel=1e-9, abs=1e-9 * 300.0)
    forces(-1.7)
    (rates,) = bench.first_order()["force"]
    rate, h = numbers(rates).reshape(-1, 2, len(start))[-1, 1, travel], 1e-3
    assert (forces(-1.7 + h) - forces(-1.7 - h))[-1, 1] / (2.0 * h) == pytest.approx(rate, rel=1e-5)


SCATTERED = """\
[tolerance.vary.plate_y]
distribution = "normal"
kind = "shift"
mean = 0.0
std = 0.1
[tolerance.vary.stiffness]
distribution = "uniform"
kind = "factor"
low = 0.9
high = 1.1
parameters = ["c10", "c01"]
[tolerance.boundary]
std = 0.05
length = 4.0
"""


def test_scatter_of_the_curve_ends_with_that_of_a_tolerance_study(tmp_path):
    bench = Workbench(write(tmp_path, text=TEXT + SCATTERED), nothing, nothing)
    bench.analyze(bench.start())
    # (load steps, components) of the only profile
    (band,) = np.array(bench.first_order()["scatter"])
    # at the middle of all tolerances, which is the seal of the file, by the adjoint method
    (expected,) = ToleranceStudy(bench.seal, bench.tolerances, ("reaction",)).first_order().std
    assert band[-1, 1] == pytest.approx(expected, rel=1e-9)
