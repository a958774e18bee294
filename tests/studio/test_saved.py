"""A saved design is a seal file whose analysis repeats the numbers of the page."""

import tomllib

import numpy as np
import pytest
from studio.small_seal import TEXT, nothing, write

import seal_mdao as sm
from seal_mdao.studio.problem_form import offered, write_problem
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


def test_a_file_with_moved_edges_that_have_no_name(tmp_path):
    """Their name is that of their first edge."""
    first, last = TEXT.index("[[profile]]"), TEXT.index("[[measure]]")
    bonded = '[[moved]]\nedges = ["top"]\nstage = [{ translate = [0.0, -0.5], steps = 3 }]\n'
    text = (TEXT[:first] + bonded + TEXT[last:]).replace("contact_width", "strain_energy")
    side = 'edge = "bulb", line = [[5.0, 5.0], [5.0, 10.0]]'
    text = text.replace(
        'edge = "bulb", arc = { start = [5.0, 5.0], through = [0.0, 10.0], end = [-5.0, 5.0] }',
        f'{side} }},\n  {{ edge = "top", line = [[5.0, 10.0], [-5.0, 10.0]] }},\n  '
        '{ edge = "left", line = [[-5.0, 10.0], [-5.0, 5.0]]',
    ).replace('edge = "bulb", line = [[-5.0, 5.0]', 'edge = "left", line = [[-5.0, 5.0]')
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    names = [own.name for own in bench.numbers if not own.name.startswith("boundary")]
    assert names == ["top_stage_1_x", "top_stage_1_y", "c10", "c01"]
    design = changed(bench, top_stage_1_y=-0.6, c10=250.0)
    state = bench.analyze(design)
    result = sm.analyze(sm.build_seal(save_design(bench, design, tmp_path, "mine")[0]))
    energy = state["measures"]["strain_energy"]
    assert result.strain_energy == pytest.approx(energy, rel=AGREEMENT)


def test_a_profile_moved_into_the_section_is_saved_with_its_interference(bench, tmp_path):
    design = changed(bench, plate_y=9.9, plate_angle=1.0)
    design[:4] = [0.05, -0.1, 0.1, 0.05]
    state = bench.analyze(design)
    path, *_ = save_design(bench, design, tmp_path, "mine")
    (profile,) = sm.read_seal_file(path).profiles
    assert 0.1 < profile.interference < 0.3
    result = sm.analyze(sm.build_seal(path))
    assert len(result.path.steps) > len(result.path.nominal_steps)
    force = np.array(state["curves"][0]["force"])
    assert np.abs(result.reaction - force).max() <= AGREEMENT * np.abs(force).max()


def test_a_problem_with_a_profile_moved_into_the_section_is_a_seal_file(bench, tmp_path):
    path = tmp_path / "other.toml"
    problem = {
        "fixed": ["foot"], "pressed": ["bulb"], "moving": ["inside"], "parameters": 4, "bound": 0.4,
        "minimize": None, "limits": [],
    }  # fmt: skip
    write_problem(bench, changed(bench, plate_y=9.9), problem, path)
    (profile,) = sm.read_seal_file(path).profiles
    assert (profile.start, profile.interference) == ((0.0, 9.9), pytest.approx(0.1, rel=0.02))


def test_a_problem_keeps_what_the_form_does_not_show(tmp_path):
    text = TEXT.replace("bound = 0.4", 'bound = 0.4\nmirror = "x = 0"').replace(
        "[[measure]]",
        '[[measure]]\ntype = "reaction"\nname = "forces"\ntravel = [1.0, 1.6]\n[[measure]]', 1,
    )  # fmt: skip
    limit = '{ measure = "forces", lower = [100.0, 250.0] }'
    text = text.replace("lower = 300.0 }", f"lower = 300.0 }}, {limit}")
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    shown = offered(bench)
    assert shown["unseen"] == ["forces"]
    assert "von_mises" in shown["measures"]
    problem = {
        key: shown[key] for key in ("fixed", "pressed", "moving", "parameters", "bound", "minimize")
    } | {"limits": [{"measure": "reaction", "lower": 310.0, "upper": None}]}  # fmt: skip
    path = tmp_path / "other.toml"
    write_problem(bench, bench.start(), problem, path)
    before, after = tomllib.loads(text), tomllib.loads(path.read_text())
    assert after["design"] == before["design"]
    assert after["optimize"]["constraint"] == [
        {"measure": "reaction", "lower": 310.0}, {"measure": "forces", "lower": [100.0, 250.0]},
    ]  # fmt: skip
    # other bounds are those of the form alone
    write_problem(bench, bench.start(), problem | {"bound": 0.3}, path)
    assert tomllib.loads(path.read_text())["design"] == [
        {"edges": ["inside"], "parameters": 4, "bound": 0.3}
    ]


def test_a_problem_without_fixed_edges_has_none(bench, tmp_path):
    path = tmp_path / "other.toml"
    problem = {
        "fixed": [], "pressed": ["bulb"], "moving": ["inside"], "parameters": 4, "bound": 0.4,
        "minimize": None, "limits": [],
    }  # fmt: skip
    # the foot was the only support
    with pytest.raises(sm.SealFileError, match=r"\[fixed\] is missing, so profiles must"):
        write_problem(bench, bench.start(), problem, path)
    assert not path.exists()


FLUID = """\
[[fluid]]
edge = ["bulb"]
from = "end"
pressure = 3.0
steps = 2
[fixed]"""


def test_a_seal_file_may_have_every_pressure_of_the_page(tmp_path):
    text = TEXT.replace("[fixed]", FLUID)
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    (own,) = [own for own in bench.numbers if own.name == "fluid_pressure"]
    assert (own.low, own.value, own.high) == pytest.approx((1.0, 3.0, 9.0))
    for pressure in (own.low, own.high):
        design = changed(bench, fluid_pressure=pressure)
        state = bench.analyze(design)
        path, *_ = save_design(bench, design, tmp_path, f"mine_{pressure:g}")
        result = sm.analyze(sm.build_seal(path))
        force = np.array(state["curves"][0]["force"])
        assert np.abs(result.reaction - force).max() <= AGREEMENT * np.abs(force).max()


GLUED = """\
[material.rubber]
law = "mooney_rivlin"
c10 = 240.0
c01 = 60.0
bulk_modulus = 24000.0
[section]
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
glued = ["top"]
contact = ["right"]
normal_penalty = 60000.0
tangent_penalty = 6000.0
line = [[-20.0, 0.0], [20.0, 0.0]]
start = [0.0, 4.0]
stage = [{ translate = [0.1, -0.8], rotate = 1.0, steps = 5 }]
"""


def test_the_start_of_a_profile_with_glued_edges_is_not_changed(tmp_path):
    """A file with another start has the edge bonded there; a placement would displace the edge."""
    bench = Workbench(write(tmp_path, text=GLUED), nothing, nothing)
    assert [own.name for own in bench.numbers] == [
        "lid_friction", "lid_stage_1_x", "lid_stage_1_y", "lid_stage_1_angle", "c10", "c01",
    ]  # fmt: skip
    design = changed(bench, lid_stage_1_x=0.2, lid_stage_1_y=-0.7, lid_stage_1_angle=1.2)
    state = bench.analyze(design)
    path, *_ = save_design(bench, design, tmp_path, "mine")
    result = sm.analyze(sm.build_seal(path))
    force = np.array(state["curves"][0]["force"])
    assert np.abs(result.reaction - force).max() <= AGREEMENT * np.abs(force).max()


def test_designs_out_of_range_are_refused(bench):
    with pytest.raises(ValueError, match="must have 12 numbers"):
        bench.split([0.0])
    with pytest.raises(ValueError, match=r"friction on plate = 9 is outside its range 0 to 1"):
        bench.split(changed(bench, plate_friction=9.0))


def test_a_design_of_a_file_without_measures_is_a_seal_file(tmp_path):
    text = TEXT.split("[[measure]]")[0]
    bench = Workbench(write(tmp_path, text=text), nothing, nothing)
    path, *_ = save_design(bench, changed(bench, c10=250.0), tmp_path, "mine")
    assert sm.read_seal_file(path).measures == ()
