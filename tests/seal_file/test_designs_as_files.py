"""A design written as a seal file with drawing and cloud, and read again, is the design."""

import tomllib
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from block_files import FIXED, LID, file_of, text

import seal_mdao as sm
from seal_mdao.file_optimization import on_new_cloud
from seal_mdao.measures.section_shape import cells_area
from seal_mdao.seals.file.export import on_lines, write_design
from seal_mdao.seals.outline.cloud_file import FIRST, write_cloud
from seal_mdao.seals.result import frozen_measures

for library in ("ezdxf", "meshio", "netgen", "tomli_w"):
    pytest.importorskip(library)

BULB = (Path(__file__).parent / "bulb.toml").read_text()
COARSE = {
    "spacing = 0.9": "spacing = 1.6",
    "line = [[-40.0, 0.0], [40.0, 0.0]]": (  # a hollow, under which the seal has a gap
        "spline = [[-20.0, 0.0], [-9.0, 0.1], [-4.0, 0.0], [0.0, 0.8], "
        "[4.0, 0.0], [9.0, 0.1], [20.0, 0.0]]"
    ),
    "[0.0, -6.0]": "[0.0, -4.0]",
    "steps = 60": "steps = 20",
    "[2.0, 0.0]": "[0.4, 0.0]",
    "steps = 20": "steps = 2",
    "parameters = 12": "parameters = 5",
}
PLACED = """[[measure]]
type = "gap_square_integral"
[[measure]]
type = "gap"
name = "open"
[[measure]]
type = "contact_pressure"
[[measure]]
type = "von_mises"
[[measure]]
type = "von_mises"
name = "on_the_boundary"
count = 4
[[measure]]
type = "von_mises"
name = "at_the_top"
at = [[0.0, 14.0], [0.0, 13.0]]
[[measure]]
type = "gap_square_sum"
points = "nominal"
[[measure]]
type = "displacement"
at = [0.0, 14.0]
[[measure]]
type = "reaction"
[[measure]]
type = "reaction"
name = "on_the_way"
travel = [1.5, 4.2]
direction = "travel"
length = 100.0
"""
RUBBERS = {
    "[section]\n": '[material.foot]\nlaw = "neo_hookean"\nc10 = 300.0\nbulk_modulus = 2e5\n[section]\n',
    '[[section.outer]]\nedge = "seal"\narc = { start = [4.0, 0.0]': (
        '[[section.outer]]\nedge = "right"\nline = [[4.0, 0.0], [4.0, 2.0]]\n'
        '[[section.outer]]\nedge = "seal"\narc = { start = [4.0, 2.0]'
    ),
    "end = [-4.0, 0.0] }\n": (
        'end = [-4.0, 2.0] }\n[[section.outer]]\nedge = "left"\nline = [[-4.0, 2.0], [-4.0, 0.0]]\n'
        '[[section.region]]\nmaterial = "foot"\nat = [0.0, 1.0]\nline = [[4.0, 2.0], [-4.0, 2.0]]\n'
    ),
}
RAYS = {
    "spacing = 0.9": "rays = { rays = 24, layers = 3, centre = [0.0, 7.0] }",
    "line = [[-4.0, 0.0], [4.0, 0.0]]\n[[section": (
        "line = [[-4.0414518843273806, 0.0], [4.0414518843273806, 0.0]]\n[[section"
    ),
    "[4.0, 0.0], through": "[4.0414518843273806, 0.0], through",
    "end = [-4.0,": "end = [-4.0414518843273806,",
    "circle = { centre = [0.0, 7.0], radius = 4.5 }": (
        "arc = { start = [0.0, 2.5], through = [4.5, 7.0], end = [0.0, 11.5] }\n[[section.hole]]\n"
        'edge = "cavity"\narc = { start = [0.0, 11.5], through = [-4.5, 7.0], end = [0.0, 2.5] }'
    ),
}
"""The ends of the base are at 30 degrees from below, on rays."""
PAPER_RAYS, FINE_RAYS = (
    RAYS | {"spacing = 0.9": RAYS["spacing = 0.9"].replace(" }", f', accuracy = "{name}" }}')}
    for name in ("paper", "fine")
)


def seal_file(folder, *changes, measures=PLACED):
    text = BULB[: BULB.index("[optimize]")] + measures
    for old, new in {**COARSE, **{k: v for change in changes for k, v in change.items()}}.items():
        if old in text:  # a change may replace what another one would
            text = text.replace(old, new)
    path = folder / "seal.toml"
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


def test_short_lists_of_a_design_are_on_one_line():
    """Those of numbers and names, and of such lists; what is written stays the same."""
    given = {
        "table": [[-30, 1.9], [0, 1.2]],
        "edges": ["two  blanks", 'a "quote"'],
        "steps": [i / 7 for i in range(12)],
        "measure": [{"type": "gap", "contact": ["lip"]}, {"type": "area"}],
    }
    shown = on_lines(import_module("tomli_w").dumps(given))
    assert tomllib.loads(shown) == given
    assert "table = [[-30, 1.9], [0, 1.2]]\n" in shown
    assert 'contact = ["lip"]' in shown
    assert "    0.14285714285714285,\n" in shown


def offsets_of(seal):
    return np.random.default_rng(4).uniform(-0.3, 0.3, seal.n_offsets)


@pytest.fixture(scope="module")
def bulb(tmp_path_factory):
    """File, seal, offsets, measures with their places, and the design as a file."""
    return written(tmp_path_factory.mktemp("bulb"))


def written(folder, *changes):
    file = seal_file(folder, *changes)
    seal = sm.build_seal(file)
    measures, offsets = frozen_measures(seal), offsets_of(seal)
    paths = write_design(file, seal, offsets, measures, folder, "best")
    return file, seal, offsets, measures, paths[0]


@pytest.mark.parametrize(
    "changes",
    [{}, RUBBERS, RAYS, PAPER_RAYS, FINE_RAYS],
    ids=["one rubber", "two", "rays", "paper's rays", "fine rays"],
)
def test_its_analysis_is_that_of_the_design(changes, tmp_path):
    """The particles come back bit for bit; on rays the start of the door is off by rounding."""
    _, seal, offsets, measures, path = written(tmp_path, changes)
    result = sm.analyze(seal, offsets)
    again = sm.build_seal(sm.read_seal_file(path))
    assert np.array_equal(again.nominal_particles, seal.particles(offsets))
    assert np.array_equal(again.body.support_radius, seal.body.support_radius)
    assert np.array_equal(again.body.support_axes, seal.body.support_axes)
    assert again.body.basis_order == seal.body.basis_order
    assert np.all(np.equal(again.body.n_gauss, seal.body.n_gauss))
    assert again.body.column == seal.body.column
    assert np.array_equal(again.body.hidden_pairs, seal.body.hidden_pairs)
    assert again.scalars == seal.scalars
    found = sm.analyze(again)
    assert result.converged
    assert found.converged
    for old, new in zip(measures, frozen_measures(again), strict=True):
        assert (old.name, old.size(seal)) == (new.name, new.size(again))
        size = np.abs(result.value(old)).max(initial=0.0)
        assert np.abs(found.value(new) - result.value(old)).max(initial=0.0) <= 1e-6 * size
    assert measures[2].size(seal) > 0, "no gap is open"


def test_the_point_of_a_compression_set_moves_with_the_design(tmp_path):
    """At its nominal place there is another particle in a design that is 1.2 mm higher."""
    stages = "stage = [{ translate = [0, -0.5], steps = 3 }, { translate = [0, 0.2], steps = 1 }]"
    lid = LID.replace("stage = [{ translate = [0, -0.5], steps = 3 }]", stages)
    design = '[[design]]\nedges = ["top"]\nparameters = 4\nbound = 1.5\n'
    measure = '[[measure]]\ntype = "compression_set"\nat = [0, 4]\n'
    file = file_of(tmp_path, FIXED, lid, design, measure)
    seal = sm.build_seal(file)
    measures, offsets = frozen_measures(seal), np.full(seal.n_offsets, 1.2)
    path = write_design(file, seal, offsets, measures, tmp_path, "best")[0]
    again = sm.build_seal(path)
    assert again.measures()[1] == measures[1]


@pytest.mark.parametrize("place", ["end = [-4.0, 2.0]", "arc = { start = [4.0, 2.0]"])
def test_a_joint_that_is_open_comes_back(place, tmp_path):
    """Where the line between two rubbers ends, the boundary is drawn 0.27 micrometres open."""
    moved = place.replace("4.0, 2.0", "4.00027, 2.0")
    changes = {old: new.replace(place, moved) for old, new in RUBBERS.items()}
    assert changes != RUBBERS
    _, seal, offsets, _, path = written(tmp_path, changes)
    again = sm.build_seal(sm.read_seal_file(path))
    assert np.array_equal(again.nominal_particles, seal.particles(offsets))
    assert np.array_equal(again.parts, seal.parts)


def test_the_drawn_seal_comes_back_with_its_design(tmp_path):
    """Arc lengths and normals found at the particles are those of the drawing."""
    file = seal_file(tmp_path)
    seal = sm.build_seal(file)
    path = write_design(
        file, seal, np.zeros(seal.n_offsets), frozen_measures(seal), tmp_path, "drawn"
    )[0]
    again = sm.build_seal(sm.read_seal_file(path))
    assert np.abs(again.design_velocity - seal.design_velocity).max() < 1e-9
    for name, edge in seal.body.edges.items():
        assert np.array_equal(again.body.edges[name].particles, edge.particles)


def test_a_mesh_from_elsewhere_makes_a_seal(tmp_path):
    """Triangles alone, clockwise, numbered anyhow, with a point that no cell has."""
    import meshio

    from seal_mdao.seals.outline.mesher import triangulate

    file = seal_file(tmp_path, measures="")
    seal = sm.build_seal(file)
    loops = [seal.nominal_particles[loop] for loop in seal.loops]
    points, triangles, _ = triangulate(loops, 1.6)
    order = np.random.default_rng(3).permutation(len(points))
    shuffled = np.vstack([points[order], [[50.0, 50.0]]])
    place = np.argsort(order)
    cells = [("line", np.array([[0, 1]])), ("triangle", place[triangles[:, ::-1]])]
    meshio.Mesh(np.column_stack([shuffled, np.zeros(len(shuffled))]), cells).write(
        tmp_path / "mesh.vtu"
    )
    text = file.path.read_text().replace("spacing = 1.6", 'cloud = "mesh.vtu"')
    (tmp_path / "other.toml").write_text(text)
    other = sm.build_seal(sm.read_seal_file(tmp_path / "other.toml"))
    assert len(other.nominal_particles) == len(points)
    assert other.area(np.zeros(other.n_offsets))[0] == pytest.approx(
        seal.area(np.zeros(seal.n_offsets))[0], rel=1e-12
    )
    assert sm.analyze(other).converged


def _quads(mesh):
    return next(own.data for own in mesh.cells if own.type == "quad")


BAD = {
    "a particle beside the drawing": (
        lambda mesh: mesh.points.__setitem__((mesh.points[:, 1].argmax(), 1), 14.0 + 2e-6),
        ("away from the edge 'seal'", "on which it must lie"),
    ),
    "moved to the side along the edge": (
        lambda mesh: mesh.points.__setitem__(
            slice(0, 3), mesh.points[[0, 0, 2]] + [[1e-3, 0, 0], [2e-3, 0, 0], [0, 0, 0]]
        ),
        ("no particle is at (-4, 0)", "'base'"),
    ),
    "no cells": (
        lambda mesh: mesh.cells.__setitem__(0, type(mesh.cells[0])("line", np.array([[0, 1]]))),
        ("neither quadrilaterals nor triangles",),
    ),
    "tetrahedra": (
        lambda mesh: mesh.cells.append(type(mesh.cells[0])("tetra", np.array([[0, 1, 2, 3]]))),
        ("cells of the type 'tetra'",),
    ),
    "a cell twice": (
        lambda mesh: mesh.cells.append(type(mesh.cells[0])("quad", _quads(mesh)[3:4])),
        ("cells of the mesh overlap or occur twice beside (",),
    ),
    "all cells twice, the other way round": (
        lambda mesh: mesh.cells.append(type(mesh.cells[0])("quad", _quads(mesh)[:, ::-1])),
        ("cells of the mesh overlap or occur twice beside (",),
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_clouds_that_do_not_fit(name, bulb, tmp_path):
    import meshio

    file, seal, *_ = bulb
    mesh = meshio.read(write_cloud(seal, np.zeros(seal.n_offsets), tmp_path / "cloud.vtu"))
    change, words = BAD[name]
    change(mesh)
    meshio.Mesh(mesh.points, mesh.cells).write(tmp_path / "cloud.vtu")
    (tmp_path / "seal.toml").write_text(
        file.path.read_text().replace("spacing = 1.6", 'cloud = "cloud.vtu"')
    )
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file(tmp_path / "seal.toml")
    text = str(caught.value)
    assert "\n" not in text
    assert "[section]: cloud: " in text
    for word in words:
        assert word in text


def test_the_cloud_of_another_drawing_is_refused(bulb):
    *_, path = bulb
    text = path.read_text()
    other = path.with_name("other.toml")
    other.write_text(text.replace("best.dxf", "drawn.dxf"))
    sm.write_dxf(bulb[0].section.outline, path.with_name("drawn.dxf"))
    with pytest.raises(sm.SealFileError, match=r"best.vtu: the particle at .* is .* mm away from"):
        sm.read_seal_file(other)


def test_the_cloud_of_a_section_with_a_hole_does_not_fill_one_without(bulb, tmp_path):
    file, seal, *_ = bulb
    write_cloud(seal, np.zeros(seal.n_offsets), tmp_path / "cloud.vtu")
    text = file.path.read_text()
    hole = text[text.index("[[section.hole]]") : text.index("[fixed]")]
    text = text.replace(hole, "").replace("spacing = 1.6", 'cloud = "cloud.vtu"')
    (tmp_path / "seal.toml").write_text(text)
    with pytest.raises(
        sm.SealFileError, match="the mesh has 2 closed boundaries, but the section has 1"
    ):
        sm.read_seal_file(tmp_path / "seal.toml")


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ('"best.vtu"', '"none.vtu"', "none.vtu: there is no such file"),
        ('"best.vtu"', '"best.dxf"', "the mesh file (cloud) cannot be read"),
        ('cloud = "best.vtu"', 'cloud = "best.vtu"\nspacing = 1.0', "but has spacing and cloud"),
        (
            'cloud = "best.vtu"',
            "spacing = 1.6",
            "the key places contains indices of particles, which",
        ),
        ("places = [", "places = [700, ", "places contains the index 700, but there are only"),
        ("places = [", "places = [-1, ", "a list of indices, from 0"),
    ],
)
def test_wrong_files_take_one_line(old, new, word, bulb):
    *_, path = bulb
    text = path.read_text()
    assert old in text
    other = path.with_name("wrong.toml")
    other.write_text(text.replace(old, new, 1))
    with pytest.raises(sm.SealFileError) as caught:
        sm.build_seal(sm.read_seal_file(other))
    assert word in str(caught.value)
    assert "\n" not in str(caught.value)


def test_clouds_keep_where_kernels_were_chosen(bulb):
    import meshio

    _, seal, _, _, path = bulb
    mesh = meshio.read(path.with_suffix(".vtu"))
    assert np.array_equal(mesh.point_data[FIRST][:, :2], seal.nominal_particles)


TOP = '[[design]]\nedges = ["top"]\nparameters = 3\nbound = 0.5\n'
MODELS = {
    "strip": ("", "", ""), "heated": ("[model]\ntemperature = 60.0\n", "expansion = 2e-4\n", ""),
    "relaxing": ("", "viscoelastic = { g = [0.3], tau = [1.0] }\n", ", duration = 2.0"),
}  # fmt: skip


@pytest.mark.parametrize(
    ("model", "steps"),
    [("strip", ""), ("strip", ", steps = [0.2, 0.5, 1.0]"), ("heated", ""), ("relaxing", "")],
)
def test_a_design_that_has_grown_into_a_profile_has_an_interference_in_its_file(
    tmp_path, model, steps
):
    """The lid stays where it is and begins farther back, as in the analysis of the design; also where
    the path has a temperature or a time, and a measure at a travel."""
    of_model, rubber, more = MODELS[model]
    lid = LID.replace(", steps = 3", f"{steps or ', steps = 3'}{more}")
    travel = '[[measure]]\ntype = "reaction"\nname = "half"\ncomponent = "y"\ntravel = 0.25\n'
    path = tmp_path / "block.toml"
    given = text(FIXED, lid, TOP).replace("[section]", f"{rubber}[section]")
    path.write_text(f"{of_model}{given}\n{travel}", encoding="utf-8")
    file = sm.read_seal_file(path)
    seal = sm.build_seal(file)
    grown = np.full(seal.n_offsets, 0.1)
    found, measures = sm.analyze(seal, grown), frozen_measures(seal)
    written = write_design(file, seal, grown, measures, tmp_path, "grown")[0]
    (profile,) = sm.read_seal_file(written).profiles
    assert (profile.start, profile.stages) == (file.profiles[0].start, file.profiles[0].stages)
    assert 0.1 - 0.02 < profile.interference < 0.13
    again = sm.analyze(sm.build_seal(sm.read_seal_file(written)))
    for own in found.measures():
        value = found.value(own)
        np.testing.assert_allclose(again.value(own), value, rtol=1e-9, atol=1e-6)
    # one that is clear has none
    still = write_design(file, seal, 0.0 * grown, measures, tmp_path, "still")[0]
    assert sm.read_seal_file(still).profiles[0].interference == 0.0


def test_a_lid_with_an_interference(tmp_path):
    """As one that comes from afar, without friction; without the key it is refused."""
    lid = LID.replace("friction = 0.3", "friction = 0.0")
    pressed = lid.replace("[0, 4.02]", "[0, 3.7]").replace("[0, -0.5]", "[0, -0.1]")
    path = tmp_path / "block.toml"
    path.write_text(text(FIXED, pressed), encoding="utf-8")
    with pytest.raises(sm.SealFileError, match=r"0.3 mm inside .* give its interference"):
        sm.read_seal_file(path)
    pressed = pressed.replace("start", "interference = 0.31\nstart")
    path.write_text(text(FIXED, pressed), encoding="utf-8")
    own = sm.analyze(sm.build_seal(path))
    path.write_text(text(FIXED, lid.replace("[0, -0.5]", "[0, -0.42]")), encoding="utf-8")
    far = sm.analyze(sm.build_seal(path))
    assert own.reaction[-1] == pytest.approx(far.reaction[-1], rel=1e-6)


AREA = '[[measure]]\ntype = "section_area"\n'


def design_of(file, folder, name, shift):
    """All offsets of the nominal seal of a file moved, and written and read again."""
    seal = sm.build_seal(file)
    offsets = np.full(seal.n_offsets, shift)
    path = write_design(file, seal, offsets, (), folder, name)[0]
    return sm.read_seal_file(path), seal.particles(offsets)


@pytest.mark.parametrize(
    "changes", [{}, {"[section]\n": "[section]\nedge_spacing = { cavity = 0.5 }\n"}]
)
def test_new_particles_of_a_design_of_a_design_are_those_of_its_section(tmp_path, changes):
    """Where the file names a cloud, its particles are those of another section."""
    first, _ = design_of(seal_file(tmp_path, changes, measures=AREA), tmp_path, "first", 0.1)
    second, particles = design_of(first, tmp_path, "second", -0.2)
    here, there = (sm.build_seal(file) for file in (second, first))
    area, before = (cells_area(own.body.cells, own.nominal_particles)[0] for own in (here, there))
    assert abs(area / before - 1.0) > 0.02
    _, found = on_new_cloud(second, first)
    assert found.value("section_area")[0] == pytest.approx(area, rel=0.005)
    # about as many particles, and as small ones along the edges
    assert 0.6 < len(found.particles) / len(particles) < 1.6
    sides = [
        np.diff(own.nominal_particles[own.body.edge("cavity").particles], axis=0)
        for own in (found.seal, here)
    ]
    lengths = [np.hypot(*own.T).max() for own in sides]
    assert lengths[0] < 1.25 * lengths[1]


def test_kernels_of_rays_have_no_new_particles(tmp_path):
    file = seal_file(tmp_path, FINE_RAYS, measures=AREA)
    first, _ = design_of(file, tmp_path, "first", 0.05)
    with pytest.raises(sm.SealFileError, match="other shape functions"):
        on_new_cloud(first, first)
