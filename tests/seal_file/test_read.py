"""What a seal file decides, and the profiles, motions and measures that follow."""

import dataclasses
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from seal_file.block_files import FIXED, LID, file_of

import seal_mdao as sm
from seal_mdao.calibration.loading_modes import MODES, nominal_stress
from seal_mdao.contact.kinematics import closest_point
from seal_mdao.geometry.motion import Stage
from seal_mdao.geometry.profile import circle_profile, polyline_profile, trace
from seal_mdao.materials.by_name import LAWS
from seal_mdao.measures.gap import GapSquareSum, OpenGapSquareSum
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.stress import LargestVonMises, VonMises
from seal_mdao.seals.file.material_table import LAW_TABLES
from seal_mdao.seals.file.measure_table import measure_of
from seal_mdao.seals.file.measure_types import KINDS
from seal_mdao.seals.file.optimize_table import Constraint
from seal_mdao.seals.file.profile_table import motion_of, rigid_profile_of
from seal_mdao.seals.outline.contours import Arc, Circle, Line

BULB = Path(__file__).parent / "bulb.toml"
PROFILE = "line = [[-40.0, 0.0], [40.0, 0.0]]\nstart = [0.0, 14.45]"


def changed(tmp_path, *changes):
    """The bulb's file with some texts replaced."""
    text = BULB.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "seal.toml"
    path.write_text(text)
    return sm.read_seal_file(path)


def test_the_tables_of_a_file_become_decisions():
    file = sm.read_seal_file(BULB)
    assert file.materials == {"rubber": sm.MooneyRivlin(80.0, 20.0, 80_000.0)}
    assert file.section.spacing == 0.9
    assert file.section.outline.edge_names == ("base", "seal", "cavity")
    assert [type(s) for s in file.section.outline.outer.segments] == [Line, Arc]
    assert isinstance(file.section.outline.holes[0].segments[0], Circle)
    assert file.fixed.edges == ("base",)
    (door,) = file.profiles
    assert (door.name, door.friction, door.contact) == ("door", 0.25, ("seal",))
    assert door.stages == (Stage(60, (0.0, -6.0)), Stage(20, (2.0, 0.0), 0.0))
    assert file.n_steps == 80
    (design,) = file.designs
    assert (design.edges, design.parameters, design.bound) == (("seal", "cavity"), 12, 0.5)
    assert [m.name for m in file.measures] == ["contact_width", "section_area", "reaction"]
    assert file.optimize.minimize == "section_area"
    assert file.optimize.constraints[0] == Constraint("reaction", 40, 60)
    with pytest.raises(dataclasses.FrozenInstanceError):
        file.section.spacing = 1.0


def test_optimize_may_name_a_type_all_of_whose_keys_have_defaults(tmp_path):
    cavity = ("[fixed]", "[[cavity]]\nhole = 1\n[fixed]")
    file = changed(tmp_path, cavity, ('minimize = "section_area"', 'minimize = "cavity_pressure"'))
    assert file.measures[1].cavity == "air"


@pytest.mark.parametrize("start", ["[0.0, 13.9]", "[1.0, 12.0]"])
def test_the_start_that_a_message_proposes_is_clear(tmp_path, start):
    with pytest.raises(sm.SealFileError, match="such as start = ") as caught:
        changed(tmp_path, ("start = [0.0, 14.45]", f"start = {start}"))
    proposed = re.search(r"such as (start = \[.*?\])", str(caught.value))[1]
    changed(tmp_path, ("start = [0.0, 14.45]", proposed))


def test_plane_of_symmetry_holds_a_section_against_one_plate(tmp_path):
    lid = LID.replace("4.02", "4")
    with pytest.raises(
        sm.SealFileError, match="the section has no support against the straight profile 'lid'"
    ):
        file_of(tmp_path, lid)
    plane = '[[symmetry]]\nedges = ["base"]\nnormal = "y"\n'
    assert file_of(tmp_path, plane, lid).symmetries


def test_section_takes_the_only_material(tmp_path):
    assert changed(tmp_path, ('material = "rubber"\n', "")) == dataclasses.replace(
        sm.read_seal_file(BULB), path=tmp_path / "seal.toml"
    )


def test_free_neighbours_of_the_nearest_edge_touch_unless_contact_is_given(tmp_path):
    assert changed(tmp_path, ('contact = ["seal"]\n', "")).profiles[0].contact == ("seal",)
    # a block between its glued or fixed left edge and its plane of symmetry on the right
    right = """[fixed]
edges = ["left"]
[[symmetry]]
edges = ["right"]
normal = "x"
"""
    for y, travel, contact in ((4.1, -1.0, ("top",)), (-0.1, 1.0, ("base",))):
        plate = "[[9, 0], [-9, 0]]" if y < 0.0 else "[[-9, 0], [9, 0]]"
        table = f"""[[profile]]
name = "plate"
friction = 0.1
line = {plate}
start = [0, {y}]
stage = [{{ translate = [0, {travel}] }}]
"""
        (own,) = file_of(tmp_path, right, table).profiles
        assert own.contact == contact
        # all but the fixed one, as they follow one another behind it
        if y > 0.0:
            for fixed, free in (
                ("base", ("right", "top", "left")),
                ("right", ("top", "left", "base")),
            ):
                (own,) = file_of(tmp_path, FIXED.replace("base", fixed), table).profiles
                assert own.contact == free


def test_a_file_of_the_needed_tables_alone(tmp_path):
    text = BULB.read_text()
    path = tmp_path / "seal.toml"
    path.write_text(text[: text.index("[[design]]")])
    file = sm.read_seal_file(path)
    assert (file.designs, file.measures, file.optimize) == ((), (), None)


def test_lines_of_several_points_splines_and_several_holes(tmp_path):
    file = changed(
        tmp_path,
        ("line = [[-4.0, 0.0], [4.0, 0.0]]", "line = [[-4.0, 0.0], [0.0, -1.0], [4.0, 0.0]]"),
        ("arc = { start = [4.0, 0.0], through = [0.0, 14.0], end = [-4.0, 0.0] }",
         "spline = [[4.0, 0.0], [7.0, 7.0], [0.0, 14.0], [-7.0, 7.0], [-4.0, 0.0]]"),
        ("radius = 4.5 }", "radius = 1.5 }\n[[section.hole]]\nedge = 'flat'\nhole = 2\n"
         "line = [[-2.0, 2.0], [2.0, 2.0]]\n[[section.hole]]\nedge = 'round'\nhole = 2\n"
         "arc = { start = [2.0, 2.0], through = [0.0, 4.0], end = [-2.0, 2.0] }"),
    )  # fmt: skip
    outline = file.section.outline
    assert outline.edge_names == ("base", "seal", "cavity", "round", "flat")
    assert len(outline.edge("base")) == 2
    assert outline.holes[1].area == pytest.approx(-2.0 * np.pi)


def test_a_section_from_a_drawing_beside_the_file(tmp_path):
    here = sm.read_seal_file(BULB).section.outline
    sm.write_dxf(here, tmp_path / "bulb.dxf")
    text = BULB.read_text()
    rows = text[text.index("[[section.outer]]") : text.index("[fixed]")]
    there = changed(tmp_path, (rows, 'dxf = "bulb.dxf"\n')).section.outline
    assert there.edge_names == here.edge_names
    assert there.area == pytest.approx(here.area, rel=1e-13)


@pytest.mark.parametrize("name", LAWS)
def test_laws_by_the_names_of_their_constants(name):
    few = {"ogden": 2, "hyperfoam": 1}.get(name)
    fields = dataclasses.fields(LAWS[name])
    constants = {own.name: 6000.0 if own.name == "bulk_modulus" else 60.0 for own in fields}
    if few:
        ones = {"mu": [60.0, 1.0][:few], "alpha": [3.0, -2.0][:few], "nu": [0.3]}
        constants |= {key: ones[key] for key in constants if key in ones}
    law = LAW_TABLES[name](law=name, **constants).made("[material.x]", Path())
    assert isinstance(law, LAWS[name])
    for key, value in constants.items():
        assert getattr(law, key) == (tuple(value) if few and key in ones else value)


def test_constants_fitted_to_tests_beside_the_file(tmp_path):
    """Tests of a known rubber give its constants back; the bulk modulus is not in them."""
    known, stretch = sm.Yeoh(60.0, -3.0, 0.4, 5e4), np.linspace(0.6, 1.8, 13)
    rows = ["mode,stretch,stress_kPa"]
    for mode in MODES.values():
        pairs = zip(stretch, nominal_stress(known, mode, stretch), strict=True)
        rows += [f"{mode.name},{float(x)!r},{float(y)!r}" for x, y in pairs]
    (tmp_path / "tests.csv").write_text("\n".join(rows))
    table = '[material.rubber]\nlaw = "yeoh"\ndata = "tests.csv"\nbulk_modulus = 5e4\n'
    text = BULB.read_text()
    file = changed(tmp_path, (text[: text.index("[section]")], table))
    assert file.materials["rubber"].constants == pytest.approx(known.constants, rel=1e-7)
    wide = table + "stable = [0.1, 12.0]\n"
    file = changed(tmp_path, (text[: text.index("[section]")], wide))
    (tmp_path / "tests.csv").write_text("mode,stretch,stress_kPa\nuniaxial,1.2,-50\n")
    with pytest.raises(
        sm.SealFileError, match=r"tests\.csv, line 2, column stretch: 1\.2 has a stress"
    ):
        changed(tmp_path, (text[: text.index("[section]")], table))


def test_constants_must_be_stable_over_the_range_that_is_stated(tmp_path):
    """This rubber softens: d tau : d ln lambda of the planar test becomes negative."""
    weak = (
        '[material.rubber]\nlaw = "yeoh"\nc10 = 60.0\nc20 = -3.0\nc30 = 0.0\nbulk_modulus = 8e4\n'
    )
    text = BULB.read_text()
    old = text[: text.index("[section]")]
    assert changed(tmp_path, (old, weak)).materials["rubber"] == sm.Yeoh(60.0, -3.0, 0.0, 8e4)
    with pytest.raises(
        sm.SealFileError,
        match=r"yeoh describes a material that is not stable: .* instability begins",
    ) as found:
        changed(tmp_path, (old, weak + "stable = [0.5, 3.0]\n"))
    begins = float(
        re.search(r"planar: .*begins at a stretch of [\d.]+ and ([\d.]+)", str(found.value))[1]
    )
    changed(tmp_path, (old, weak + f"stable = [1.0, {0.9 * begins:.3f}]\n"))


def test_a_polyline_becomes_the_profile_of_its_vertices(tmp_path):
    corner = "line = [[-40.0, 0.0], [0.0, 0.0], [3.0, 2.0], [3.0, 40.0]]\nstart = [0.0, 14.45]"
    (door,) = changed(tmp_path, (PROFILE, corner)).profiles
    made = rigid_profile_of(door)
    known = polyline_profile(np.array([(-40.0, 0.0), (0.0, 0.0), (3.0, 2.0), (3.0, 40.0)]))
    for field in ("kind", "origin", "angle", "start", "length"):
        assert np.abs(getattr(made, field) - getattr(known, field)).max() < 1e-14
    assert made.period == 0.0


def test_a_circle_is_walked_around_its_body(tmp_path):
    circle = "circle = { centre = [0.0, 3.0], radius = 3.0 }\nstart = [0.0, 14.45]"
    (door,) = changed(tmp_path, (PROFILE, circle)).profiles
    made, known = rigid_profile_of(door), circle_profile((0.0, 3.0), 3.0)
    assert made.period == pytest.approx(known.period)
    for x, y, gap in ((0.0, -2.0, 2.0), (0.0, 1.0, -1.0), (5.0, 3.0, 2.0)):
        assert closest_point(made, x, y)[2] == pytest.approx(gap, abs=1e-14)


def test_lines_arcs_and_splines_in_one_chain(tmp_path):
    chain = """start = [0.0, 14.45]
[[profile.segment]]
line = [[-40.0, 0.0], [0.0, 0.0]]
[[profile.segment]]
arc = { start = [0.0, 0.0], through = [2.8284271247461903, 1.1715728752538097], end = [4.0, 4.0] }
[[profile.segment]]
spline = [[4.0, 4.0], [4.2, 6.0], [4.1, 9.0], [5.0, 12.0]]"""
    (door,) = changed(tmp_path, (PROFILE, chain)).profiles
    made = rigid_profile_of(door)
    assert np.array_equal(made.kind, [0, 1, 2, 2, 2])
    fine = trace(made, 0.05, 30.0)
    for segment in door.segments[1:]:
        for point in segment.points(np.linspace(0.05, 0.95, 7)):
            assert abs(closest_point(made, *point)[2]) < 1e-12
    assert np.hypot(*np.diff(fine, axis=0).T)[2:-2].max() < 1.0
    # the body lies on the left: above the flat
    assert closest_point(made, -10.0, -1.0)[2] == pytest.approx(1.0)
    assert closest_point(made, -10.0, 1.0)[2] == pytest.approx(-1.0)


def test_a_closed_spline_is_a_closed_profile(tmp_path):
    oval = "spline = [[0.0, 0.0], [4.0, 2.0], [0.0, 4.0], [-4.0, 2.0], [0.0, 0.0]]"
    (door,) = changed(tmp_path, (PROFILE, oval + "\nstart = [0.0, 14.45]")).profiles
    assert door.closed
    made = rigid_profile_of(door)
    assert made.period == pytest.approx(made.length.sum())
    assert closest_point(made, 0.0, 2.0)[2] < 0.0 < closest_point(made, 0.0, -3.0)[2]


def test_stages_become_a_motion(tmp_path):
    pivot = PROFILE + "\npivot = [1.0, 2.0]\nangle = 10.0\nnormal_penalty = 5e3"
    file = changed(tmp_path, (PROFILE, pivot), ("rotate = 0.0", "rotate = -20.0"))
    (door,) = file.profiles
    motion = motion_of(door, file.n_steps)
    assert motion.n_steps == 80
    assert np.allclose(motion.positions, [(0.0, 14.45), (0.0, 8.45), (2.0, 8.45)], atol=1e-14)
    assert np.allclose(np.degrees(motion.angles), [10.0, 10.0, -10.0])
    assert np.array_equal(motion.pivot, [1.0, 2.0])
    assert (door.normal_penalty, door.tangent_penalty) == (5e3, None)
    assert file.open_penalties == ("door_tangent_penalty",)


def test_a_profile_without_stages_stands_still(tmp_path):
    wall = """[[profile]]
name = "wall"
friction = 0.1
contact = ["seal"]
line = [[9.0, 0.0], [9.0, 30.0]]
[[design]]"""
    other = ('measure = "reaction"', 'measure = "contact_width"')
    with pytest.raises(sm.SealFileError, match="inside the rigid body"):
        changed(tmp_path, ("[[design]]", wall), other)
    # walked upwards its body is on the side of the seal, downwards beyond the wall
    wall = wall.replace("[[9.0, 0.0], [9.0, 30.0]]", "[[9.0, 30.0], [9.0, 0.0]]")
    file = changed(tmp_path, ("[[design]]", wall), other)
    motion = motion_of(file.profiles[1], file.n_steps)
    assert motion.n_steps == 80
    assert not motion.coordinates(77.5).any()


# one needs a seal that relaxes, and has a test of its own
@pytest.mark.parametrize("name", [name for name in KINDS if name != "time_to_force_fraction"])
def test_every_type_becomes_a_measure_with_its_name(tmp_path, name):
    further = {
        "cavity_area": 'edge = "cavity"', "displacement": "at = [0.0, 13.9]",
        "cavity_pressure": '[[cavity]]\nhole = 1',
        "load_deflection_error": "travel = [2.0, 4.0]\nvalue = [20.0, 60.0]",
        "retained_force": "stage = [1, 2]", "compression_set": "at = [0.0, 13.9]",
        "pressure_integral": "exponent = 1.5\nreference_pressure = 100.0",
        "leak_rate": "rms_roughness = 6.0\nroll_off_wavelength = 500.0\nshortest_wavelength = 1.0\n"
                     "pressure = 10.0",
        "blow_off_pressure": '[[fluid]]\nedge = "seal"\nfrom = "end"\npressure = 9.0\nsteps = 20',
    }.get(name, "")  # fmt: skip
    file = changed(tmp_path, ('type = "contact_width"\nprofile = "door"',
                              f'type = "{name}"\nname = "mine"\n{further}'))  # fmt: skip
    particles = np.array([(0.0, 0.0), (0.0, 14.0), (1.0, 13.0)])
    measure = measure_of(file.measures[0], particles)
    assert isinstance(measure, Measure)
    assert measure.name == "mine"
    assert getattr(measure, "profile", "door") == "door"
    assert getattr(measure, "point", 1) == 1
    assert not file.measures[0].single or measure.size(None) == 1


ONE_OF_ITS_KIND = {
    "cavity_pressure": ("cavity", '[[cavity]]\nname = "{}"\nhole = 1'),
    "blow_off_pressure": ("fluid",
        '[[fluid]]\nname = "{}"\nedge = "seal"\nfrom = "end"\npressure = 9.0\nsteps = 20'),
}  # fmt: skip
"""Key of the table that a type of measure names, and such a table."""


@pytest.mark.parametrize("name", ONE_OF_ITS_KIND)
def test_the_only_cavity_or_fluid_needs_no_name(tmp_path, name):
    key, text = ONE_OF_ITS_KIND[name]
    old = 'type = "contact_width"\nprofile = "door"'
    file = changed(tmp_path, (old, f'type = "{name}"\n{text.format("bulb")}'))
    assert getattr(file.measures[0], key) == "bulb"
    # also where the problem alone names the type
    width, implied = "[[measure]]\n" + old, f'minimize = "{name}"'
    file = changed(tmp_path, (width, text.format("bulb")), ('minimize = "section_area"', implied))
    assert [getattr(own, key) for own in file.measures if own.type == name] == ["bulb"]
    # another name is still an error
    wrong = f'type = "{name}"\n{key} = "foot"\n{text.format("bulb")}'
    with pytest.raises(sm.SealFileError, match=f"{key} = 'foot', but there is no such"):
        changed(tmp_path, (old, wrong))


def test_the_reaction_is_taken_along_the_first_travel(tmp_path):
    for travel, axis in (("[0.0, -6.0]", "y"), ("[-6.0, 1.0]", "x"), ("[1.0, 1.0]", "y")):
        file = changed(tmp_path, ("[0.0, -6.0]", travel))
        given = {k: v for k, v in file.measures[-1].arguments.items() if v is not None}
        assert given == {"profile": "door", "component": axis}
    declared = 'type = "reaction"\ncomponent = "x"'
    file = changed(tmp_path, ('type = "contact_width"\nprofile = "door"', declared))
    assert [m.name for m in file.measures] == ["reaction", "section_area"]
    assert measure_of(file.measures[0], np.zeros((1, 2))).components == (0,)


def test_the_reaction_on_a_fixed_profile_is_taken_along_the_travel_of_the_moving_one(tmp_path):
    wall = (
        '[[profile]]\nname = "wall"\nline = [[-9, -50], [-9, 50]]\nfriction = 0.1\n'
        '[[measure]]\ntype = "reaction"\nprofile = "wall"\nname = "on_wall"\n'
    )
    for travel, axis in (("[-6.0, 1.0]", 0), ("[0.0, -6.0]", 1)):
        file = changed(tmp_path, ("[0.0, -6.0]", travel), ("[[design]]", wall + "[[design]]"),
                       ('measure = "reaction"', 'measure = "on_wall"'))  # fmt: skip
        measure = next(own for own in file.measures if own.name == "on_wall")
        assert measure_of(measure, np.zeros((1, 2))).components == (axis,)


@pytest.mark.parametrize(("keys", "size", "fields"), [
    ("travel = 3.0", 1, {"travels": (3.0,), "components": (1,), "direction": None, "units": "N/m"}),
    ("travel = [1, 3.5]", 2, {"travels": (1.0, 3.5)}),
    ("direction = [0.0, -2.0]\nlength = 100.0", 1, {"direction": (0.0, -1.0), "units": "N"}),
    ('direction = "travel"\ntravel = 8.0', 1, {"direction": "travel", "travels": (8.0,)}),
])  # fmt: skip
def test_reactions_at_any_travel_in_any_direction(tmp_path, keys, size, fields):
    file = changed(tmp_path, ('type = "contact_width"\nprofile = "door"',
                              f'type = "reaction"\nname = "mine"\n{keys}'))  # fmt: skip
    measure = measure_of(file.measures[0], np.zeros((1, 2)))
    assert measure.size(None) == size
    assert file.measures[0].single == (size == 1)
    assert {name: getattr(measure, name) for name in fields} == fields


@pytest.mark.parametrize(("keys", "kind", "single"), [
    ("", LargestVonMises, True), ("excess = 0.1", LargestVonMises, True),
    ("count = 3", VonMises, False), ("at = [[0.0, 13.9], [0.1, 0.0]]", VonMises, False),
])  # fmt: skip
def test_stress_is_that_of_the_complete_section_unless_points_are_chosen(
    tmp_path, keys, kind, single
):
    file = changed(tmp_path, ('type = "contact_width"\nprofile = "door"',
                              f'type = "von_mises"\n{keys}'))  # fmt: skip
    measure = measure_of(file.measures[0], np.array([(0.0, 0.0), (5.0, 5.0), (0.0, 14.0)]))
    assert type(measure) is kind
    assert file.measures[0].single == single
    assert not measure.selects_points or keys.startswith("count")
    if "at" in keys:
        assert measure.points == (2, 0)


@pytest.mark.parametrize(("keys", "kind"), [
    ("", OpenGapSquareSum), ('points = "design"', OpenGapSquareSum),
    ('points = "nominal"', GapSquareSum),
])  # fmt: skip
def test_gaps_are_those_of_the_design_unless_the_nominal_ones_are_meant(tmp_path, keys, kind):
    file = changed(tmp_path, ('type = "contact_width"\nprofile = "door"',
                              f'type = "gap_square_sum"\n{keys}'))  # fmt: skip
    measure = measure_of(file.measures[0], np.zeros((1, 2)))
    assert type(measure) is kind
    assert measure.selects_points


def test_the_form_in_the_tests_is_toml_of_sixty_lines():
    assert len(BULB.read_text().splitlines()) <= 60
    assert set(tomllib.loads(BULB.read_text())) == {
        "material", "section", "fixed", "profile", "design", "measure", "optimize",
    }  # fmt: skip


def test_a_wall_between_the_sides_of_a_bar(tmp_path):
    """The nearest line between parallel sides may be the end of the bar."""
    corners = {"base": (-4, 0), "right": (4, 0), "seal": (4, 14), "left": (-4, 14)}
    names, places = list(corners), list(corners.values())
    bar = "".join(
        f'[[section.outer]]\nedge = "{name}"\nline = [{[*map(float, a)]}, {[*map(float, b)]}]\n'
        for name, a, b in zip(names, places, places[1:] + places[:1], strict=True)
    )
    text = BULB.read_text()
    outer, hole = (text.index(f"[[section.{kind}]]") for kind in ("outer", "hole"))
    wall = 'type = "wall_thickness"\nedges = ["left"]\nopposite = ["right"]'
    file = changed(
        tmp_path, (text[outer:hole], bar), (text[hole : text.index("[fixed]")], ""),
        ('["seal", "cavity"]', '["seal"]'), ('type = "contact_width"\nprofile = "door"', wall),
    )  # fmt: skip
    assert file.measures[0].edges == ("left",)


def test_particles_of_a_file_without_spacing(tmp_path):
    """The bulb is 15.1 mm wide and 14 mm high."""
    none = "spacing = 0.9\n"
    section = changed(tmp_path, (none, "")).section
    assert section.default_spacing
    assert section.spacing == pytest.approx(14.0 / 12.0, rel=5e-3)
    assert section.layers == 5
    # given layers, and the start of a choice for an accuracy
    layered = changed(tmp_path, (none, "layers = 4\n")).section
    assert (layered.spacing, layered.layers) == (section.spacing, 4)
    chosen = changed(tmp_path, (none, 'accuracy = "1 %"\n')).section
    assert (chosen.spacing, chosen.layers, chosen.default_spacing) == (section.spacing, 3, False)
    assert not sm.read_seal_file(BULB).section.default_spacing
