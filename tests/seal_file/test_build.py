"""From a seal file to a seal that is analysed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.cli.examples import examples_folder
from seal_mdao.file_seal import build_seal, file_and_seal
from seal_mdao.rkpm.cells import cell_map, quadrature_weights
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.clearance import cleared, nearest_at_start
from seal_mdao.seals.outline.section_cloud import LONGEST, longest_side
from seal_mdao.seals.profiles import path_stages

BULB = (Path(__file__).parent / "bulb.toml").read_text()
COARSE = BULB
for old, new in (
    ("spacing = 0.9", "spacing = 1.6"), ("[0.0, -6.0]", "[0.0, -1.1]"), ("steps = 60", "steps = 6"),
    ("[2.0, 0.0]", "[0.3, 0.0]"), ("steps = 20", "steps = 2"), ("parameters = 12", "parameters = 5"),
):  # fmt: skip
    assert old in COARSE
    COARSE = COARSE.replace(old, new)


def read(folder, text):
    path = folder / "seal.toml"
    path.write_text(text)
    return sm.read_seal_file(path)


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    given = COARSE.replace(
        'name = "door"', 'name = "door"\nnormal_penalty = 1e6\ntangent_penalty = 1e4'
    )
    seal = build_seal(read(tmp_path_factory.mktemp("build"), given))
    return seal, sm.analyze(seal, keep_factors=True)


def test_a_path_makes_the_same_seal_as_the_file_that_is_read(tmp_path):
    file = read(tmp_path, COARSE)
    seal = build_seal(file)
    for path in (file.path, str(file.path)):
        assert np.array_equal(build_seal(path).nominal_particles, seal.nominal_particles)
        own, other = file_and_seal(path)
        assert own.path == file.path
        assert np.array_equal(other.nominal_particles, seal.nominal_particles)
    with pytest.raises(sm.SealFileError, match="there is no such file"):
        build_seal(tmp_path / "none.toml")


def test_everything_that_the_file_says_is_in_the_seal(pressed):
    seal, result = pressed
    assert result.converged
    assert seal.n_steps == 8
    assert seal.n_offsets == 10
    assert [measure.name for measure in seal.standard] == [
        "contact_width", "section_area", "reaction",
    ]  # fmt: skip
    scalars = {name: scalar.value for name, scalar in seal.scalars.items()}
    assert scalars == {
        "c10": 80.0, "c01": 20.0, "bulk_modulus": 80_000.0, "door_friction": 0.25,
        "door_normal_penalty": 1e6, "door_tangent_penalty": 1e4,
    }  # fmt: skip
    assert set(seal.body.edges) == {"base", "seal", "cavity"}
    base = seal.body.edge("base").particles
    assert np.array_equal(np.flatnonzero(seal.body.fixed.all(axis=1)), np.sort(base))
    assert np.abs(seal.nominal_particles[base, 1]).max() < 1e-14


@pytest.mark.parametrize(("end", "first"), [("start", (4.0, 0.0)), ("end", (-4.0, 0.0))])
def test_a_fluid_comes_from_its_end_of_the_edge(tmp_path, end, first):
    fluid = f'[[fluid]]\nedge = "seal"\nfrom = "{end}"\npressure = 50.0\nsteps = 4\nname = "oil"\n'
    seal = build_seal(read(tmp_path, COARSE.replace("[[design]]", f"{fluid}[[design]]")))
    term = next(term for term in seal.terms() if term.label == "oil")
    places = seal.nominal_particles[term.particles]
    assert places[0] == pytest.approx(first)
    assert places[-1] == pytest.approx((-first[0], 0.0))
    assert np.hypot(*np.diff(places, axis=0).T).max() < 1.61
    assert term.ramp.tolist() == [0.0] * 5 + [0.25, 0.5, 0.75, 1.0]
    assert seal.scalars["oil_pressure"].value == 50.0
    moved = seal.with_parameters({"oil_pressure": 20.0, "door_normal_penalty": 2e4}).terms()[-1]
    assert (moved.pressure, moved.contacts[0].law.normal_penalty) == (20.0, 2e4)


def test_the_door_presses_from_above_and_drags_to_the_right(pressed):
    seal, result = pressed
    horizontal, vertical = result.response("door").total
    assert vertical > 0.0 > horizontal
    (reaction,) = (measure for measure in seal.standard if measure.name == "reaction")
    assert result.value(reaction) == pytest.approx([vertical])
    # 1.1 mm of travel from 0.5 mm above the top
    top = result.displacement()[:, 1].min()
    assert -0.75 < top < -0.55


def test_walls_with_fewer_than_five_layers_are_reported(tmp_path):
    """1.4 mm thick, with a spacing of 0.9 mm; ``layers`` gives more."""
    thin = BULB.replace("radius = 4.5", "radius = 5.6").replace("[0.0, -6.0]", "[0.0, -0.6]")
    thin = thin.replace("steps = 60", "steps = 2").replace("steps = 20", "steps = 1")
    few = build_seal(read(tmp_path, thin))
    enough = build_seal(read(tmp_path, thin.replace("spacing = 0.9", "spacing = 0.9\nlayers = 5")))
    assert len(enough.nominal_particles) > 1.5 * len(few.nominal_particles)
    assert enough.warnings == ()
    of_layers = [
        [text for text in sm.analyze(seal).warnings if "layers" in text] for seal in (enough, few)
    ]
    assert of_layers[0] == []
    (text,) = of_layers[1]
    assert "mm thick and has about 3 layers of particles across, fewer than 5" in text
    assert "layers = 5 in [section]" in text
    assert "stresses too small by 20 % or more" in text
    assert "layers = 9" in text


PAD = """
[material.rubber]
law = "mooney_rivlin"
c10 = 200.0
c01 = 50.0
bulk_modulus = 250000.0
[section]
material = "rubber"
spacing = 2.9
layers = 3
outer = [
  { edge = "base", line = [[-10.0, 0.0], [10.0, 0.0]] },
  { edge = "right", line = [[10.0, 0.0], [10.0, 4.0]] },
  { edge = "seal", arc = { start = [10.0, 4.0], through = [0.0, 6.0], end = [-10.0, 4.0] } },
  { edge = "left", line = [[-10.0, 4.0], [-10.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.2
contact = ["seal"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 6.0]
stage = [{ translate = [0.0, -1.2], steps = 20 }]
"""


def test_stress_in_a_pad_by_its_layers(tmp_path):
    """The figures of the page on accuracy: largest stress in the middle of a pad of 20 x 6 mm."""
    force, stress = {}, {}
    for layers in (3, 5, 9):
        text = PAD.replace("layers = 3", f"layers = {layers}")
        result = sm.analyze(build_seal(read(tmp_path, text)))
        places, values = result.section_stress()
        nearest = np.hypot(*(places - [0.0, 3.0]).T).argmin()
        force[layers], stress[layers] = result.reaction[-1, 1], values[nearest]
        assert bool(result.seal.warnings) == (layers == 3)
    assert force[3] == pytest.approx(force[9], rel=0.01)
    assert stress[3] / stress[9] - 1.0 == pytest.approx(-0.23, abs=0.01)
    assert stress[5] == pytest.approx(stress[9], rel=0.05)


def rectangle(width, height, layers, squeeze=0.2):
    """A pad with its base fixed, pressed by a plate over its full width."""
    start = PAD.index("outer = ["), PAD.index("[fixed]")
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    sides = zip(("base", "right", "seal", "left"), corners, [*corners[1:], corners[0]], strict=True)
    lines = ",\n".join(
        f'{{ edge = "{name}", line = [{list(a)}, {list(b)}] }}' for name, a, b in sides
    )
    text = f"{PAD[: start[0]]}outer = [\n{lines}]\n{PAD[start[1] :]}"
    text = text.replace("spacing = 2.9", f"spacing = {0.49 * height}")
    text = text.replace("layers = 3", f"layers = {layers}").replace("-1.2", f"{-squeeze * height}")
    wide = 5.0 * width
    text = text.replace("[[-40.0, 0.0], [40.0, 0.0]]", f"[[{-wide}, 0.0], [{wide}, 0.0]]")
    return text.replace("[0.0, 6.0]\nstage", f"[0.0, {height}]\nstage")


@pytest.mark.parametrize("width", [11.0, 12.0, 10.0])
def test_short_pads_with_three_layers_are_reported_where_their_force_errs(tmp_path, width):
    """From 11 x 6 mm on by 13 to 14 %; up to 10 x 6 mm by 3 %, without a warning."""
    coarse, fine = (
        sm.analyze(build_seal(read(tmp_path, rectangle(width, 6.0, layers)))) for layers in (3, 13)
    )
    error = coarse.reaction[-1, 1] / fine.reaction[-1, 1] - 1.0
    assert error == pytest.approx({10.0: 0.028, 11.0: 0.135, 12.0: 0.131}[width], abs=0.003)
    assert [("fewer than 5" in text) for text in coarse.seal.warnings] == [True] * (width > 10.0)
    assert fine.seal.warnings == ()


def test_a_quarter_of_a_block_is_held_by_its_planes(tmp_path):
    """The contact patch test through a file: no other edge is fixed, nothing touches at the start."""
    planes = 'symmetry = [{ edges = ["left"], normal = "x" }, { edges = ["base"], normal = "y" }]\n'
    text = rectangle(12.0, 6.0, 4).replace('[fixed]\nedges = ["base"]\n', "")
    text = text.replace("start = [0.0, 6.0]", "start = [0.0, 6.5]")
    text = planes + text.replace("friction = 0.2", "friction = 0.0")
    result = sm.analyze(build_seal(read(tmp_path, text)))
    gap = result.response("plate").gap
    assert np.abs(gap / gap.mean() - 1.0).max() < 1e-10
    # one plane alone lets it slide
    with pytest.raises(sm.SealFileError, match="profiles must support the section"):
        read(tmp_path, text.replace(', { edges = ["base"], normal = "y" }', ""))


def test_contact_points_of_a_body_between_plates(tmp_path):
    """Averages for a plate that touches a whole side at the start, the particles for one that touches a
    corner alone, and for both where one has a gap."""
    plane = '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'
    text = rectangle(12.0, 6.0, 4).replace('[fixed]\nedges = ["base"]\n', plane)
    text = text.replace("friction = 0.2", "friction = 0.0")
    lower = '[[profile]]\nname = "bottom"\nfriction = 0.0\ncontact = ["base"]\n'
    lower += "line = [[60.0, 0.0], [-60.0, 0.0]]\nstart = [0.0, 0.0]\n"
    result = sm.analyze(build_seal(read(tmp_path, text + lower)))
    for name in ("plate", "bottom"):
        gap = result.response(name).gap
        assert np.abs(gap / gap.mean() - 1.0).max() < 1e-10
    for start, changed, upper in (
        (6.1, lower, "particles"), (6.0, lower + "angle = -5.0\n", "averages"),
    ):  # fmt: skip
        moved = text.replace("start = [0.0, 6.0]", f"start = [0.0, {start}]")
        file = read(tmp_path, moved + changed)
        assert [own.contact_points for own in file.profiles] == [upper, "particles"]


def test_pressure_under_a_flat_base_does_not_oscillate(tmp_path):
    """A dome pressed on a flat groove that it is not fixed to: contact at averages below, at particles
    above. The pressure below does not alternate beside the corners."""
    (tmp_path / "dome.toml").write_text(DOME)
    file = sm.read_seal_file(tmp_path / "dome.toml")
    assert [own.contact_points for own in file.profiles] == ["particles", "averages"]
    result = sm.analyze(build_seal(file))
    assert result.converged
    groove = result.term("groove")
    below = groove.reference[:, 1] == 0.0
    x = groove.reference[below, 0]
    pressure = -result.response("groove").gap[below]
    # second differences without the points at the corners; 0.33 of the peak at particles
    waves = np.abs(np.diff(pressure[np.argsort(x)][1:-1], 2)).max()
    assert waves < 0.2 * pressure.max()


DOME = """
[material.rubber]
shore_a = 70
[section]
spacing = 0.4
outer = [
  { edge = "flat", line = [[-4, 0], [4, 0]] },
  { edge = "dome", line = [[4, 0], [4, 2]] },
  { edge = "dome", arc = { start = [4, 2], through = [0, 5], end = [-4, 2] } },
  { edge = "dome", line = [[-4, 2], [-4, 0]] },
]
[[profile]]
name = "lid"
friction = 0.4
line = [[-30, 0], [30, 0]]
start = [0, 5]
stage = [{ translate = [0, -0.7] }]
[[profile]]
name = "groove"
friction = 0.4
contact = ["flat"]
line = [[30, 0], [-30, 0]]
"""


def test_a_second_body_that_no_profile_may_touch_is_refused(tmp_path):
    other = '  { body = 2, edge = "other", line = [[9, 0], [12, 0], [12, 2], [9, 2], [9, 0]] },\n'
    two = DOME.replace("]\n[[profile]]", f"{other}]\n[[profile]]", 1)
    with pytest.raises(sm.SealFileError, match=r"body 2 .edge 'other'.* no profile may touch it"):
        read(tmp_path, two.replace('name = "lid"', 'name = "lid"\ncontact = ["dome"]'))


@pytest.mark.parametrize("off", [3e-6, -3e-6])
def test_coordinates_with_six_digits_touch(tmp_path, off):
    """A block that only two plates hold, of which one starts 3e-6 mm away or inside: it is moved."""
    plane = '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'
    text = rectangle(12.0, 6.0, 4).replace('[fixed]\nedges = ["base"]\n', plane)
    lower = '[[profile]]\nname = "bottom"\nfriction = 0.2\ncontact = ["base"]\n'
    lower += f"line = [[60.0, 0.0], [-60.0, 0.0]]\nstart = [0.0, {-off}]\n"
    file = read(tmp_path, text + lower)
    assert [own.contact_points for own in file.profiles] == ["averages"] * 2
    # moved to where it touches, twice the rounding of 1e-9 away
    outline = file.section.outline
    gap = nearest_at_start(cleared(file.profiles[1], outline), outline).gap
    assert gap == pytest.approx(2e-9 * outline.size, rel=1e-3)
    assert sm.analyze(build_seal(file)).converged
    with pytest.raises(
        sm.SealFileError, match=r"none touches it at the start: the nearest one is 0\.02"
    ):
        read(tmp_path, _apart(0.02, text, lower, off))
    # a little receded
    nearly = read(tmp_path, _apart(0.01, text, lower, off))
    assert [own.contact_points for own in nearly.profiles] == ["averages"] * 2
    touching, receded = (
        sm.analyze(build_seal(own)).path.reaction("plate") for own in (file, nearly)
    )
    # the travel is shorter by both gaps
    assert 0.95 < receded[-1, 1] / touching[-1, 1] < 1.0


def _apart(gap, text, lower, off):
    """The file with plates at a distance from the block."""
    above = text.replace("start = [0.0, 6.0]", f"start = [0.0, {6.0 + gap}]")
    return above + lower.replace(f"[0.0, {-off}]", f"[0.0, {-gap}]")


@pytest.mark.parametrize(("scale", "word"), [(0.01, "smaller"), (1.0, None), (25.4, "larger")])
def test_sections_in_a_wrong_unit_of_length_are_reported(tmp_path, scale, word):
    seal = build_seal(read(tmp_path, rectangle(20.0 * scale, 6.0 * scale, 5)))
    if word is None:
        assert seal.warnings == ()
    else:
        (text,) = seal.warnings
        assert f"the section is {20.0 * scale:.4g} mm wide and {6.0 * scale:.4g} mm high" in text
        assert f"{word} than usual seals" in text
        assert "needs units in [section]" in text


@pytest.mark.parametrize(("travel", "reported"), [(390.0, False), (1200.0, True)])
def test_displacements_in_a_wrong_unit_of_length_are_reported(tmp_path, travel, reported):
    """More than twenty times the width of 20 mm, in the second stage."""
    text = rectangle(20.0, 6.0, 5)
    moved = text.replace(
        "steps = 20 }", f"steps = 20 }}, {{ translate = [{travel}, 0.0], steps = 9 }}"
    )
    assert moved != text
    found = [own for own in unchosen_seal(read(tmp_path, moved)).warnings if "displaced by" in own]
    assert len(found) == reported
    if reported:
        assert "'plate' is displaced by 1200 mm in stage 2, 60 times the size" in found[0]


def test_gradients_against_central_differences(pressed):
    """The same points touch and slip at both ends. The step's square is 1e-8 of the value's, and
    Newton's tolerance over the step less."""
    seal, result = pressed
    rates = sm.differentiate(result, ("c10",))
    step = 1e-4 * 80.0
    ends = [sm.analyze(seal, None, {"c10": 80.0 + way * step}) for way in (1.0, -1.0)]
    for measure in seal.standard:
        values = [end.value(measure) for end in ends]
        quotient = (values[0] - values[1]) / (2.0 * step)
        exact = getattr(rates, measure.name)[:, -1]
        size = np.abs(getattr(rates, measure.name)).max()
        assert np.abs(quotient - exact).max() < 1e-5 * size


def test_a_drawing_gives_the_same_seal(tmp_path, pressed):
    """Ends of segments differ by rounding, so particles do by little more."""
    seal, _ = pressed
    file = read(tmp_path, COARSE)
    sm.write_dxf(file.section.outline, tmp_path / "bulb.dxf")
    rows = COARSE[COARSE.index("[[section.outer]]") : COARSE.index("[fixed]")]
    again = build_seal(read(tmp_path, COARSE.replace(rows, 'dxf = "bulb.dxf"\n')))
    assert np.array_equal(again.body.cells, seal.body.cells)
    assert np.abs(again.nominal_particles - seal.nominal_particles).max() < 1e-9


def test_two_profiles_and_contact_over_several_edges(tmp_path):
    text = COARSE[: COARSE.index("[[design]]")].replace(
        "arc = { start = [4.0, 0.0], through = [0.0, 14.0], end = [-4.0, 0.0] }",
        'spline = [[4.0, 0.0], [8.0, 7.0], [0.0, 14.0]]\n[[section.outer]]\nedge = "left"\n'
        "spline = [[0.0, 14.0], [-8.0, 7.0], [-4.0, 0.0]]",
    ).replace('contact = ["seal"]', 'contact = ["left", "seal"]')  # fmt: skip
    wall = """[[profile]]
name = "wall"
friction = 0.1
contact = ["seal"]
line = [[9.0, 30.0], [9.0, 0.0]]
"""
    seal = build_seal(read(tmp_path, text + wall))
    _, door, side = seal.terms()
    assert (door.label, side.label) == ("door", "wall")
    body = seal.body
    both = {*body.edge("seal").particles, *body.edge("left").particles}
    movable = [p for p in both if not body.fixed[p].all()]
    assert sorted(door.where.points.anchors[:, 0]) == sorted(movable)
    # from the right end of the base over the top to the left one
    x = seal.nominal_particles[door.where.points.anchors[:, 0], 0]
    assert x[0] > 4.0
    assert x[-1] < -4.0
    assert side.motion.n_steps == 8
    assert not side.motion.coordinates(5.0).any()


RING = """[material.rubber]
law = "neo_hookean"
c10 = 500.0
bulk_modulus = 400000.0
[section]
material = "rubber"
spacing = 0.5
[[section.outer]]
edge = "right"
arc = { start = [0.3, 0.015037688680139993], through = [3.0, 3.0], end = [-0.3, 5.98496231131986] }
[[section.outer]]
edge = "left"
arc = { start = [-0.3, 5.98496231131986], through = [-3.0, 3.0], end = [0.3, 0.015037688680139993] }
[[profile]]
name = "lid"
friction = 0.2
contact = ["right", "left"]
line = [[-9.0, 0.0], [9.0, 0.0]]
start = [0.0, 6.0]
stage = [{ translate = [0.0, -0.3], steps = 8 }]
[[profile]]
name = "bottom"
friction = 0.2
contact = ["right", "left"]
line = [[9.0, 0.0], [-9.0, 0.0]]
[[design]]
edges = ["right"]
parameters = 4
bound = 0.2
[[measure]]
type = "reaction"
profile = "lid"
[[measure]]
type = "strain_energy"
"""


def test_a_ring_that_nothing_holds_but_two_planes(tmp_path):
    """They touch it within segments, not at ends of them; gradients with no particle held."""
    seal = build_seal(read(tmp_path, RING))
    assert not seal.body.fixed.any()
    result = sm.analyze(seal)
    assert result.converged
    direct, adjoint = (sm.differentiate(result, (), None, way) for way in ("direct", "adjoint"))
    for name in ("reaction", "strain_energy"):
        size = np.abs(direct[name]).max()
        assert size > 0.0
        np.testing.assert_allclose(direct[name], adjoint[name], rtol=0.0, atol=1e-9 * size)


def test_the_largest_stress_lies_inside_and_is_seen(tmp_path):
    """That of a squeezed ring lies below the contact, far above all along its boundary."""
    stress = '[[measure]]\ntype = "von_mises"\n'
    seal = build_seal(read(tmp_path, f'{RING}{stress}{stress}name = "boundary"\ncount = 7\n'))
    result = sm.analyze(seal, keep_factors=True)
    everywhere, boundary = (
        result.value(measure) for measure in result.measures() if measure.units == "kPa"
    )
    largest = result.section_stress()[1].max()
    assert largest <= everywhere[0] <= 1.05 * largest
    assert result.stress_field().argmax() not in np.concatenate(seal.loops)
    assert boundary.max() < 0.7 * largest
    rates = [sm.differentiate(result, ("c10",), None, way) for way in ("direct", "adjoint")]
    one, other = (np.atleast_2d(found["von_mises"]) for found in rates)
    assert np.abs(one - other).max() <= 1e-10 * np.abs(one).max()


@pytest.mark.parametrize(("start", "clear"), [(6.0, True), (6.0 - 2e-5, False), (6.1, True)])
def test_the_least_gap_is_found_between_the_points_that_are_looked_at(tmp_path, start, clear):
    text = RING.replace("start = [0.0, 6.0]", f"start = [0.0, {start!r}]")
    if clear:
        assert read(tmp_path, text).profiles[0].start == (0.0, start)
    else:
        with pytest.raises(
            sm.SealFileError, match=r"'(right|left)' 2e-05 mm inside the rigid body"
        ):
            read(tmp_path, text)


@pytest.mark.parametrize(("old", "new", "words"), [
    ("parameters = 5", "parameters = 1", "needs at least"),
    ("radius = 4.5", "radius = 6.9999", "seal.toml: "),
])  # fmt: skip
def test_what_only_shows_when_it_is_built(tmp_path, old, new, words):
    with pytest.raises(sm.SealFileError, match=words) as caught:
        build_seal(read(tmp_path, COARSE.replace(old, new)))
    assert "\n" not in str(caught.value)


VENTS = "[[cavity]]\nhole = 1\nvent_diameter = 3.0\nvent_spacing = 100.0\nclosing_speed = 500.0\n"


def test_a_cavity_with_vents_takes_its_time_from_the_profile_that_travels(tmp_path):
    file = read(tmp_path, COARSE.replace("[fixed]", f"{VENTS}[fixed]"))
    seal = build_seal(file)
    air = next(own for own in seal.terms() if own.label == "air")
    np.testing.assert_allclose(air.travel, [*np.linspace(0.0, 1.1, 7), 1.25, 1.4], rtol=1e-12)
    given = {name: scalar.value for name, scalar in seal.scalars.items() if "air" in name}
    assert given == {
        "air_pressure": 101.325, "air_gamma": 1.4, "air_vent_diameter": 3.0,
        "air_vent_spacing": 100.0, "air_discharge_coefficient": 0.61, "air_closing_speed": 500.0,
    }  # fmt: skip


def test_a_vented_cavity_bleeds_down_in_a_dwell(tmp_path):
    """In rubber too stiff for the air to deform it, sqrt(p) falls linearly in the time of the dwell."""
    rest = "translate = [2.0, 0.0]\nrotate = 0.0\nsteps = 20"
    assert rest in BULB
    text = BULB.replace(rest, "steps = 100\nduration = 4e-4").replace("[0.0, -6.0]", "[0.0, -1.4]")
    text = text.replace("spacing = 0.9", "spacing = 1.8").replace("steps = 60", "steps = 6")
    for old, new in (
        ("c10 = 80.0", "c10 = 8e5"), ("c01 = 20.0", "c01 = 2e5"), ("modulus = 80000.0", "modulus = 8e8"),
    ):  # fmt: skip
        text = text.replace(old, new)
    fast = VENTS.replace("500.0", "1e6")
    result = sm.analyze(build_seal(read(tmp_path, text.replace("[fixed]", f"{fast}[fixed]"))))
    air, responses = result.term("air"), result.path.at_nominal("air")
    pressure = np.array([response.outputs[0, 0] for response in responses])[5:]
    area = responses[-1].outputs[0, 1]
    # d sqrt(p) / dt = -gamma c C_d a sqrt(p_a) / (2 A) for p much smaller than p_a
    fall = 0.5 * air.gamma * air.conductance / area * 4e-4 * np.sqrt(air.outside)
    assert 0.2 < fall / np.sqrt(pressure[0]) < 0.8
    assert np.sqrt(pressure[0]) - np.sqrt(pressure[-1]) == pytest.approx(fall, rel=0.02)


def test_the_times_of_a_vented_cavity_whose_stages_have_durations(tmp_path):
    """Without closing_speed, and of a rubber that does not relax."""
    text = COARSE.replace("[fixed]", f"{VENTS}[fixed]").replace("closing_speed = 500.0\n", "")
    text = text.replace("steps = 6", "steps = 6\nduration = 0.5").replace(
        "steps = 2\n", "steps = 2\nduration = 10.0\n"
    )
    seal = build_seal(read(tmp_path, text))
    np.testing.assert_allclose(path_stages(seal).times, [0.0, 0.5, 10.5], rtol=1e-12)


def test_chosen_load_steps_see_the_error_in_time(tmp_path):
    """With little air lost in a step, steps follow the seal; with much of it, there are more of them."""
    counts = []
    for diameter in ("1e-6", "3.0"):
        text = COARSE.replace("steps = 6\n", "").replace("steps = 2\n", "")
        text = text.replace("[fixed]", f"[steps]\ntolerance = 0.02\n{VENTS}[fixed]")
        text = text.replace("vent_diameter = 3.0", f"vent_diameter = {diameter}")
        text = text.replace('type = "contact_width"', 'type = "cavity_pressure"').replace(
            'profile = "door"\n[optimize]', "[optimize]"
        )
        seal = build_seal(read(tmp_path, text))
        counts.append(seal.n_steps)
    assert counts[1] > counts[0]


@pytest.mark.parametrize(("spacing", "layers"), [(0.8, 3), (1.1, 5), (1.25, 5)])
def test_a_slot_with_round_ends_is_filled_at_any_spacing(spacing, layers):
    """With these spacings cells are folded at the ends; with a fraction of them they are not."""
    pytest.importorskip("netgen")
    file = sm.read_seal_file(examples_folder() / "two_holes.toml")
    file = replace(file, section=replace(file.section, spacing=spacing, layers=layers))
    seal = unchosen_seal(file)
    assert longest_side(seal.body.cells, seal.nominal_particles) <= LONGEST * spacing
    assert (quadrature_weights(cell_map(seal.body.cells), seal.nominal_particles) > 0.0).all()
