"""A saved design is a seal file whose analysis repeats the numbers of the page."""

import tomllib

import numpy as np
import pytest
from studio.small_seal import TEXT, nothing, write

import seal_mdao as sm
from seal_mdao.studio.saved import save_design
from seal_mdao.studio.workbench import Workbench

AGREEMENT = 1e-8
"""Newton stops at residuals of 1e-9 of the forces, in either analysis."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Workbench(write(tmp_path_factory.mktemp("bulb")), nothing, nothing)


def changed(bench, **values):
    """The design of the file with other numbers, by their names."""
    design = dict(zip([own.name for own in bench.numbers], bench.start(), strict=True))
    assert values.keys() <= design.keys()
    return list((design | values).values())


def test_saved_design_repeats_the_numbers(bench, tmp_path):
    design = changed(bench, plate_friction=0.45, c10=300.0, plate_stage_1_y=-1.9, plate_y=10.3)
    design[:4] = [0.2, -0.1, 0.3, 0.05]
    state = bench.analyze(design)
    paths = save_design(bench, design, tmp_path, "mine")
    assert [path.name for path in paths] == ["mine.toml", "mine.dxf", "mine.vtu"]
    result = sm.analyze(sm.build_seal(paths[0]))
    for name, values in state["measures"].items():
        again = result.value(name)
        assert np.abs(again - values).max() <= AGREEMENT * np.abs(values).max(), name
    force = np.array(state["curves"][0]["force"])
    assert np.abs(result.reaction - force).max() <= AGREEMENT * np.abs(force).max()
    # numbers are written as the page has them
    tables = tomllib.loads(paths[0].read_text())
    assert tables["profile"][0]["friction"] == 0.45
    assert tables["material"]["rubber"]["c10"] == 300.0
    assert tables["profile"][0]["stage"][0]["translate"] == pytest.approx([0.0, -1.9], abs=1e-12)


def test_what_the_page_may_change_is_in_the_file(bench):
    names = [own.name for own in bench.numbers[4:]]
    assert names == [
        "plate_friction", "plate_stage_1_x", "plate_stage_1_y", "plate_x", "plate_y", "plate_angle",
        "c10", "c01",
    ]  # fmt: skip
    assert [own.value for own in bench.numbers[4:]] == [0.3, 0.0, -1.7, 0.0, 10.2, 0.0, 240.0, 60.0]
    tables = tomllib.loads(TEXT)
    for own in bench.numbers[4:]:
        own.write(tables, own.value + 0.5)
    profile = tables["profile"][0]
    assert (profile["start"], profile["angle"]) == ([0.5, 10.7], 0.5)
    assert profile["stage"][0]["translate"] == [0.5, -1.2]
    assert (profile["friction"], tables["material"]["rubber"]["c10"]) == (0.8, 240.5)


@pytest.mark.parametrize(
    ("old", "new", "name", "value"),
    [
        ('law = "mooney_rivlin"\nc10 = 240.0\nc01 = 60.0\nbulk_modulus = 24000.0', "shore_a = 50",
         "shore_a", 50.0),
        ("24000.0\n", "24000.0\nexpansion = 2e-4\n[model]\ntemperature = 60.0\n", "temperature",
         60.0),
        ("steps = 6", "steps = 6\nrotate = 2.0", "plate_stage_1_angle", 2.0),
    ],
)  # fmt: skip
def test_numbers_of_other_files(tmp_path, old, new, name, value):
    assert old in TEXT
    bench = Workbench(write(tmp_path, text=TEXT.replace(old, new)), nothing, nothing)
    (own,) = [own for own in bench.numbers if own.name == name]
    assert own.value == value
    design = changed(bench, **{name: value + 1.0})
    state = bench.analyze(design)
    paths = save_design(bench, design, tmp_path, "mine")
    result = sm.analyze(sm.build_seal(paths[0]))
    force = np.array(state["curves"][0]["force"])
    assert np.abs(result.reaction - force).max() <= AGREEMENT * np.abs(force).max()


def test_designs_out_of_range_are_refused(bench):
    with pytest.raises(ValueError, match="must have 12 numbers"):
        bench.split([0.0])
    with pytest.raises(ValueError, match=r"friction on plate = 9 is outside its range 0 to 1"):
        bench.split(changed(bench, plate_friction=9.0))
