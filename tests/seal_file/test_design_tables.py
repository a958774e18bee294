"""``[[design]]`` of a seal file: derivatives, designs as files, symmetric optima, messages."""

import re

import numpy as np
import pytest
from exact_gradients import require_exact
from ring_files import cylinder

import seal_mdao as sm
from seal_mdao.cli.design_table import design_lines
from seal_mdao.cli.subcommands import main
from seal_mdao.file_optimization import design_bounds, design_warnings
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.outline.design_parameters import design_parameters
from seal_mdao.seals.result import frozen_measures

for library in ("ezdxf", "meshio", "netgen", "tomli_w"):
    pytest.importorskip(library)

SEAL = """[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 80000.0
[section]
material = "rubber"
spacing = 1.6
layers = 3
outer = [
  { edge = "base", line = [[-5.0, 0.0], [5.0, 0.0]] },
  { edge = "right", line = [[5.0, 0.0], [5.0, 5.0]] },
  { edge = "crown", arc = { start = [5.0, 5.0], through = [0.0, 10.0], end = [-5.0, 5.0] } },
  { edge = "left", line = [[-5.0, 5.0], [-5.0, 0.0]] },
]
hole = [{ edge = "hole", circle = { centre = [0.0, 5.0], radius = 3.0 } }]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.3
normal_penalty = 1e4
tangent_penalty = 1e2
contact = ["crown"]
line = [[-30.0, 0.0], [30.0, 0.0]]
start = [0.0, 10.1]
[[profile.stage]]
translate = [0.0, -1.1]
steps = 5
[[measure]]
type = "reaction"
[[measure]]
type = "stress_norm"
"""
DESIGNS = """[[design]]
edges = ["crown"]
between = [[4.0, 8.0], [-4.0, 8.0]]
parameters = 3
bound = 0.3
[[design]]
vertex = [5.0, 5.0]
mirror = "x = 0"
bound = 0.2
[[design]]
arc = [0.0, 8.0]
bound = 0.25
"""
RAYS = "# on rays\n"
WALL = 'edges = ["hole"]\nparameters = 4\nopposite = "NAME"'
HALVES = """hole = [
  { edge = "hole", arc = { start = [0.0, 2.0], through = [-3.0, 5.0], end = [0.0, 8.0] } },
  { edge = "hole", arc = { start = [0.0, 8.0], through = [3.0, 5.0], end = [0.0, 2.0] } },
]
"""
MIRRORED = """[[design]]
edges = ["hole"]
parameters = 6
mirror = "x = 0.0"
bound = 0.3
[[design]]
vertex = [-5.0, 5.0]
directions = ["x"]
mirror = "x = 0"
bound = 0.2
[optimize]
minimize = "section_area"
constraint = [{ measure = "reaction", lower = 100.0 }]
"""


def written(folder, text):
    path = folder / "seal.toml"
    path.write_text(SEAL + text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def designed(tmp_path_factory):
    """File, seal, offsets and the analysed design."""
    folder = tmp_path_factory.mktemp("designed")
    file = sm.read_seal_file(written(folder, DESIGNS))
    seal = sm.build_seal(file)
    offsets = np.array([0.05, -0.08, 0.06, 0.04, -0.03, 0.07])
    return file, seal, offsets, sm.analyze(seal, offsets, keep_factors=True)


def test_every_design_has_its_bound(designed):
    file, seal, _, _ = designed
    assert seal.design_sizes == (3, 2, 1)
    np.testing.assert_array_equal(design_bounds(file, seal), [0.3, 0.3, 0.3, 0.2, 0.2, 0.25])


def test_table_of_the_parameters_has_the_effect_of_every_kind(designed):
    """The sign of an arc of a hole is another one than that of an edge."""
    _, seal, _, _ = designed
    found = design_parameters(seal)
    out, along, into = "out of the rubber", "along the edge", "into the rubber"
    assert [own.direction for own in found] == [out, out, out, out, along, into]
    assert [own.table for own in found] == [1, 1, 1, 2, 2, 3]
    assert [own.edge for own in found if own.direction != along] == ["crown"] * 4 + ["hole"]
    boundary = np.concatenate(seal.loops)
    for way, own in zip(np.eye(seal.n_offsets), found, strict=True):
        assert own.index == way.argmax()
        moved = (seal.particles(way) - seal.nominal_particles)[boundary]
        away = np.hypot(*(seal.nominal_particles[boundary] - own.place).T)
        assert away.min() < 1e-8
        assert own.velocity == pytest.approx(moved[away.argmin()], abs=1e-8)
        assert own.largest == pytest.approx(np.hypot(*moved.T).max(), rel=1e-8)
        assert own.largest == pytest.approx(np.hypot(*own.velocity), rel=1e-8)
        plus, minus = (seal.area(s * 0.01 * way)[0] for s in (1, -1))
        assert own.area == pytest.approx((plus - minus) / 0.02, rel=1e-9)
        assert own.area * {out: 1, into: -1}.get(own.direction, np.sign(own.area)) > 0.0


ANNULAR_WALL = """[[design]]
edges = ["crown"]
parameters = 4
bound = {}
[[design]]
edges = ["hole"]
parameters = 6
bound = {}
"""
BOTH_FACES = """[[design]]
edges = ["crown"]
between = [[4.8, 6.4], [-4.8, 6.4]]
parameters = 5
opposite = "hole"
"""
"""Below the crown the wall is 2 mm thick, at the sides too."""


@pytest.mark.parametrize(
    ("designs", "expected"),
    [
        (ANNULAR_WALL.format(0.9, 1.05), ""),
        (ANNULAR_WALL.format(0.9, 1.15), "[[design]] 1 and [[design]] 2 the two faces"),
        (ANNULAR_WALL.format(0.1, 2.05), "[[design]] 1 and [[design]] 2 the two faces"),
        (f"{BOTH_FACES}bound = 0.95\n", ""),
        (f"{BOTH_FACES}bound = 1.05\n", "[[design]] 1 the two"),
        ('[[design]]\nedges = ["hole"]\nparameters = 6\nbound = 1.95\n', ""),
        ('[[design]]\nedges = ["hole"]\nparameters = 6\nbound = 2.05\n', "[[design]] 1 the two"),
    ],
)
def test_limits_that_invert_a_wall_are_reported(tmp_path, designs, expected):
    file = sm.read_seal_file(written(tmp_path, designs))
    found = design_warnings(file, unchosen_seal(file))
    assert len(found) == bool(expected)
    for text in found:
        assert text.startswith(f"within the limits (bound) of {expected}")
        thickness = float(re.search(r"only ([\d.]+) mm thick", text)[1])
        assert thickness == pytest.approx(2.0, rel=0.03)
        x, y = map(float, re.search(r"at x = ([-\d.]+), y = ([-\d.]+) can", text).groups())
        # on one of the two faces of the wall
        radius = np.hypot(x, y - 5.0)
        assert min(abs(radius - 3.0), abs(radius - 5.0), abs(abs(x) - 5.0)) < 0.01


def test_check_and_optimize_warn_of_limits_that_invert_a_wall(tmp_path, monkeypatch, capsys):
    class BegunError(Exception):
        """Of the optimisation, which is not run."""

    def begun(*arguments):
        raise BegunError

    path = written(
        tmp_path, ANNULAR_WALL.format(1.2, 1.2) + MIRRORED[MIRRORED.index("[optimize]") :]
    )
    text = "WARNING: within the limits (bound) of [[design]] 1 and [[design]] 2"
    assert main(["check", str(path), "--out", str(tmp_path / "out")]) == 0
    assert text in capsys.readouterr().out
    monkeypatch.setattr("seal_mdao.cli.optimize.run_optimization", begun)
    with pytest.raises(BegunError):
        main(["optimize", str(path), "--out", str(tmp_path / "out")])
    assert text in capsys.readouterr().out


TWICE = """[[design]]
vertex = [5.0, 5.0]
directions = [{}]
bound = 0.2
"""
CIRCLE = """[[design]]
arc = [3.0, 5.0]
bound = 0.2
[[design]]
edges = ["hole"]
parameters = 6
bound = 0.3
"""


@pytest.mark.parametrize(
    ("designs", "expected"),
    [
        (TWICE.format('"x", "y"') + TWICE.format('"x"'), "0, 2 (boundary_offsets) of [[design]] 1 and"),
        (TWICE.format('"x"') + TWICE.format('"y"'), ""),
        (TWICE.format('"x"') + DESIGNS, ""),
        (TWICE.format('"x"') + DESIGNS + TWICE.format('"x"'),
         "0, 7 (boundary_offsets) of [[design]] 1 and [[design]] 5 do"),
        # a radius is the sum of all offsets of the circle
        (CIRCLE, "0, 1, 2, 3, 4, 5, 6 (boundary_offsets) of [[design]] 1 and [[design]] 2 do"),
        (MIRRORED[: MIRRORED.index("[optimize]")], ""),
    ],
)  # fmt: skip
def test_parameters_that_do_not_move_the_boundary_independently_are_reported(
    tmp_path, designs, expected
):
    file = sm.read_seal_file(written(tmp_path, designs))
    found = [own for own in design_warnings(file, unchosen_seal(file)) if "independently" in own]
    assert len(found) == bool(expected)
    assert all(expected in own for own in found)


def test_equal_designs_add_up(tmp_path):
    file = sm.read_seal_file(written(tmp_path, 2 * TWICE.format('"x"')))
    seal = unchosen_seal(file)
    both, one = seal.particles(np.array([0.1, 0.05])), seal.particles(np.array([0.15, 0.0]))
    np.testing.assert_allclose(both, one, rtol=0.0, atol=1e-14)


def test_parameters_at_a_joint_have_the_edge_that_moves(tmp_path):
    """The axis does not move, and of both sides of a corner the one whose normal is the direction."""
    path = tmp_path / "cylinder.toml"
    tables = '[[design]]\nedges = ["top"]\nparameters = 3\nbound = 0.1\n'
    path.write_text(f"{cylinder()}{tables}[[design]]\nvertex = [2.0, 2.0]\nbound = 0.1\n")
    found = design_parameters(unchosen_seal(sm.read_seal_file(path)))
    assert found[2].place == (0.0, 2.0)
    assert [own.edge for own in found] == ["top", "top", "top", "side", "top"]
    assert {own.direction for own in found} == {"out of the rubber"}


def test_printed_table_of_the_parameters(designed, monkeypatch):
    found = design_parameters(designed[1])
    heading, columns, *rows = design_lines(found)
    assert heading.startswith(
        "6 design parameters (boundary_offsets); effect of an increase by 1 mm"
    )
    assert len(rows) == 6
    # columns are aligned below their names
    at = columns.index("direction")
    assert [row[at:].split("  ")[0] for row in rows] == [own.direction for own in found]
    assert rows[5].endswith(f"{found[5].area:+.4g}")
    monkeypatch.setattr("seal_mdao.cli.design_table.MOST_ROWS", 4)
    assert design_lines(found)[-1] == "and 2 more, in summary.json"
    assert design_lines([]) == []


@pytest.mark.parametrize(
    ("closed", "parameters", "left"),
    [(False, 3, 2), (False, 4, 2), (False, 5, 3), (True, 4, 3), (True, 5, 3), (True, 6, 4)],
)
def test_number_of_parameters_with_a_mirror(tmp_path, closed, parameters, left):
    name = "hole" if closed else "crown"
    table = f'[[design]]\nedges = ["{name}"]\nparameters = {parameters}\nmirror = "x = 0"\nbound = 0.1\n'
    seal = unchosen_seal(sm.read_seal_file(written(tmp_path, table)))
    assert seal.design_sizes == (left,)


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        (
            "arc = [0.0, 10.0]",
            "the design parameter would move the edge 'right', which is fixed; in place of arc",
        ),
        (
            "vertex = [5.0, 5.0]",
            "the design parameter would move the edge 'right', which is fixed; choose a vertex",
        ),
        (
            'edges = ["crown"]\nparameters = 1',
            "the edge 'crown' needs at least 2 design parameters",
        ),
    ],
)
def test_messages_name_the_table_and_the_remedy(tmp_path, kind, text):
    first = '[[design]]\nedges = ["hole"]\nparameters = 4\nbound = 0.1\n'
    path = written(tmp_path, first + f"[[design]]\n{kind}\nbound = 0.1\n")
    content = path.read_text(encoding="utf-8")
    path.write_text(
        content.replace('edges = ["base"]', 'edges = ["base", "right"]'), encoding="utf-8"
    )
    with pytest.raises(sm.SealFileError, match=rf"\[\[design\]\] 2: {text}"):
        unchosen_seal(sm.read_seal_file(path))


def test_the_radius_of_a_bonded_circle_has_no_remedy_but_another_edge(tmp_path):
    """Its edge cannot move along its normals either."""
    path = written(tmp_path, "[[design]]\narc = [3.0, 5.0]\nbound = 0.1\n")
    bonded = path.read_text().replace('edges = ["base"]', 'edges = ["base", "hole"]')
    path.write_text(bonded)
    with pytest.raises(sm.SealFileError, match=r"'hole', which is fixed; choose another edge$"):
        unchosen_seal(sm.read_seal_file(path))


WHOLE = next(line for line in SEAL.splitlines(True) if line.startswith("hole"))


def of_two_halves(folder, design):
    """The hole's particles, and their velocities by the only parameter of a design, (k, 2) each."""
    path = written(folder, design)
    path.write_text(path.read_text().replace(WHOLE, HALVES))
    seal = unchosen_seal(sm.read_seal_file(path))
    assert seal.n_offsets == 1
    hole = seal.loops[1]
    return seal.nominal_particles[hole], seal.design_velocity[0, hole]


def test_the_radius_of_half_a_circle_moves_the_other_half_at_both_ends(tmp_path):
    points, velocity = of_two_halves(tmp_path, "[[design]]\narc = [-3.0, 5.0]\nbound = 0.2\n")
    own = points[:, 0] < 1e-9
    np.testing.assert_allclose(velocity[own], (points[own] - (0.0, 5.0)) / 3.0, atol=1e-9)
    # along the chords of the other half from (0, -1) at its lower end to (0, 1) at its upper end
    order = np.argsort(points[~own, 1])
    rest = points[~own][order]
    ends = np.vstack([[0.0, 2.0], rest, [0.0, 8.0]])
    along = np.cumsum(np.hypot(*np.diff(ends, axis=0).T))
    expected = 2.0 * along[:-1] / along[-1] - 1.0
    np.testing.assert_allclose(velocity[~own][order, 0], 0.0, atol=1e-9)
    np.testing.assert_allclose(velocity[~own][order, 1], expected, atol=1e-9)


def test_halves_of_a_circle_that_are_mirror_images_stay_a_circle(tmp_path):
    design = '[[design]]\narc = [-3.0, 5.0]\nmirror = "x = 0"\nbound = 0.2\n'
    points, velocity = of_two_halves(tmp_path, design)
    np.testing.assert_allclose(velocity, (points - (0.0, 5.0)) / 3.0, atol=1e-9)


def test_arcs_that_meet_their_mirror_image_at_an_angle_are_refused(tmp_path):
    path = written(tmp_path, '[[design]]\narc = [3.5, 8.2]\nmirror = "x = 0"\nbound = 0.2\n')
    crown = next(line for line in SEAL.splitlines(True) if '"crown"' in line)
    pointed = """{ edge = "crown", arc = { start = [5, 5], through = [3.5, 8.2], end = [0, 10] } },
{ edge = "crown", arc = { start = [0, 10], through = [-3.5, 8.2], end = [-5, 5] } },
"""
    path.write_text(path.read_text().replace(crown, pointed))
    with pytest.raises(
        sm.SealFileError, match=r"1: the arc at \(3.5, 8.2\) and its mirror image meet"
    ):
        unchosen_seal(sm.read_seal_file(path))


def test_the_derivative_of_the_area_is_exact(designed):
    """The area is quadratic in the offsets: central differences have no truncation error."""
    _, seal, offsets, _ = designed
    _, gradient = seal.area(offsets)
    for i, way in enumerate(np.eye(seal.n_offsets)):
        plus, minus = (seal.area(offsets + s * 0.01 * way)[0] for s in (1, -1))
        assert gradient[i] == pytest.approx((plus - minus) / 0.02, rel=1e-9)
    # that of the hole's radius is its circumference, up to the chords of the particles
    radius = 3.0 + offsets[5]
    assert gradient[5] == pytest.approx(-2.0 * np.pi * radius, rel=0.05)


def test_direct_and_adjoint_agree_and_are_the_quotients(designed):
    *_, result = designed
    for step in (1e-4, 5e-5):
        require_exact(result, ("reaction", "stress_norm"), step)


def test_a_design_as_a_file_is_the_design_and_has_its_parameters(designed, tmp_path):
    """Points that name a vertex, an arc or a part move along; derivatives are those of the design."""
    file, seal, offsets, result = designed
    paths = write_design(file, seal, offsets, frozen_measures(seal), tmp_path, "best")
    best = sm.read_seal_file(paths[0])
    again = sm.build_seal(best)
    assert again.design_sizes == seal.design_sizes
    new = sm.analyze(again)
    for name in ("reaction", "stress_norm"):
        expected = result.value(result.measure(name))
        np.testing.assert_allclose(new.value(new.measure(name)), expected, rtol=1e-9)
    np.testing.assert_allclose(best.designs[1].vertex, (5.04, 4.97), atol=1e-9)
    # the hole is still a circle, of the new radius
    (hole,) = best.section.outline.holes[0].segments
    assert hole.radius == pytest.approx(3.07, rel=1e-9)
    # displacement of the vertex, radius of the hole: the same velocity of the boundary
    n = sum(len(loop) for loop in seal.loops)
    np.testing.assert_allclose(again.design_velocity[5][:n], seal.design_velocity[5][:n], atol=1e-8)


SYMMETRIC_WALL = """[[design]]
edges = ["crown"]
opposite = "hole"
parameters = 6
mirror = "x = 0"
bound = 0.2
[tolerance.boundary]
std = 0.02
length = 2.0
"""
"""Particles of the circle are not mirror images of each other, nor is a spline through them."""
DEFORMED_CIRCLE = """[[design]]
vertex = [5.0, 5.0]
mirror = "x = 0"
bound = 0.2
[[design]]
arc = [0.0, 8.0]
bound = 0.1
[[design]]
edges = ["hole"]
parameters = 5
bound = 0.2
"""


def test_a_design_as_a_file_is_that_of_the_file_as_it_was_read(tmp_path):
    """An edit of the file meanwhile does not mix with the design; the tables in memory stay."""
    path = written(tmp_path, DESIGNS)
    text = path.read_text()
    file = sm.read_seal_file(path)
    seal = sm.build_seal(file)
    offsets, measures = np.zeros(seal.n_offsets), frozen_measures(seal)
    best = write_design(file, seal, offsets, measures, tmp_path, "best")[0].read_text()
    path.write_text(text.replace("friction = ", "friction = 0.0  # "))
    again = write_design(file, seal, offsets, measures, tmp_path, "best")[0].read_text()
    assert again == best


@pytest.mark.parametrize(
    ("designs", "size", "left", "reason"),
    [
        # moved so far that the spline and its mirror image differ by more than the tolerance
        (
            SYMMETRIC_WALL,
            0.3,
            (),
            "[[design]] 1 of seal.toml is left out, .* no edge is the mirror image .*, a closed edge "
            "such as a circle as two arcs that meet in the plane, or leave out mirror",
        ),
        (DEFORMED_CIRCLE, 0.1, (2, 5), "[[design]] 2 of seal.toml is left out, .* is not an arc"),
    ],
)
def test_a_design_as_a_file_has_no_design_that_its_section_does_not_permit(
    tmp_path, designs, size, left, reason
):
    file = sm.read_seal_file(written(tmp_path, designs))
    seal = sm.build_seal(file)
    offsets = np.random.default_rng(2).uniform(-size, size, seal.n_offsets)
    path = write_design(file, seal, offsets, frozen_measures(seal), tmp_path, "best")[0]
    again = sm.build_seal(sm.read_seal_file(path))
    assert again.design_sizes == left
    expected, found = sm.analyze(seal, offsets), sm.analyze(again)
    np.testing.assert_allclose(found.reaction, expected.reaction, rtol=1e-9)
    lines = [own.removeprefix("# ") for own in path.read_text().splitlines() if own.startswith("#")]
    assert re.search(reason.replace("[", r"\["), " ".join(lines))


@pytest.mark.parametrize(
    "table", [SYMMETRIC_WALL, MIRRORED[: MIRRORED.index("[optimize]")].replace("= 6", "= 12")]
)
def test_a_symmetric_design_as_a_file_keeps_its_parameters(tmp_path, table):
    """Although the spline through particles of a circle, which are not symmetric, is not quite so."""
    file = sm.read_seal_file(written(tmp_path, table))
    seal = unchosen_seal(file)
    offsets = np.random.default_rng(2).uniform(-0.1, 0.1, seal.n_offsets)
    path = write_design(file, seal, offsets, (), tmp_path, "best")[0]
    again = unchosen_seal(sm.read_seal_file(path))
    assert again.design_sizes == seal.design_sizes
    # every parameter moves the hole symmetrically: its centre stays in the plane
    hole = again.loops[1]
    for velocity in again.design_velocity:
        weights = again.boundaries[1].arc_length
        sides = np.diff(np.append(weights, again.boundaries[1].length))
        mean = 0.5 * (sides + np.roll(sides, 1)) @ velocity[hole, 0]
        assert abs(mean) <= 0.02 * sides.sum() * np.abs(velocity).max()


def test_optimize_reports_designs_that_the_optimum_lacks(tmp_path, capsys):
    problem = MIRRORED[MIRRORED.index("[optimize]") :]
    path, out = written(tmp_path, DEFORMED_CIRCLE + problem), tmp_path / "out"
    main(["optimize", str(path), "--max-iterations", "2", "--out", str(out)])
    text = "(optimum.toml lacks 1 of 3 [[design]]; its first lines give the reason)"
    assert text in capsys.readouterr().out


def test_a_symmetric_seal_has_a_symmetric_optimum(tmp_path):
    # a hole of two halves has particles that are mirror images of each other
    path, out = written(tmp_path, MIRRORED), tmp_path / "out"
    path.write_text(path.read_text().replace(WHOLE, HALVES), encoding="utf-8")
    main(["optimize", str(path), "--max-iterations", "4", "--out", str(out), "--quiet"])
    outline = sm.read_seal_file(out / "optimum.toml").section.outline
    moved = {s.edge: s for contour in outline.contours for s in contour.segments}
    assert len(outline.holes[0].segments) == 1
    np.testing.assert_allclose(
        np.array(moved["left"].first) * (-1.0, 1.0), moved["right"].last, atol=1e-9
    )
    assert abs(moved["right"].last[0] - 5.0) > 1e-3
    # points of the hole: the image of each is on the hole
    hole = moved["hole"]
    points = hole.points(np.linspace(0.0, 1.0, 400, endpoint=False))
    assert np.abs(np.hypot(*(points - (0.0, 5.0)).T) - 3.0).max() > 1e-3
    images = hole.points(np.linspace(0.0, 1.0, 40_001)) * (-1.0, 1.0)
    away = np.hypot(*np.moveaxis(points[:, None] - images, -1, 0)).min(axis=1)
    assert away.max() < 1e-3


def test_an_optimisation_is_continued_with_its_own_designs_only(tmp_path):
    path, out = written(tmp_path, MIRRORED), tmp_path / "out"
    cases = out / "cases.sql"
    main(["optimize", str(path), "--quiet", "--max-iterations", "1", "--out", str(out)])
    before = read_optimization(cases).design["boundary_offsets"]
    assert before.shape[1] == 4 + 1
    assert (
        main(["optimize", str(path), "--quiet", "--max-iterations", "2", "--restart", str(cases)])
        < 2
    )
    after = read_optimization(cases).design["boundary_offsets"]
    assert len(after) > len(before)
    np.testing.assert_array_equal(after[: len(before)], before)
    # without the plane of symmetry the parameters are others
    written(tmp_path, MIRRORED.replace('mirror = "x = 0.0"\n', ""))
    with pytest.raises(SystemExit) as ended:
        main(["optimize", str(path), "--quiet", "--restart", str(cases)])
    assert ended.value.code == 2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('edges = ["crown"]', 'edges = ["crown"]\nvertex = [5.0, 5.0]', "has edges and vertex"),
        ("vertex = [5.0, 5.0]\n", "", "vertex and arc, but this one has none of them"),
        ("parameters = 3\n", "", "the key 'parameters' is missing"),
        ("arc = [0.0, 8.0]", "arc = [0.0, 8.0]\nparameters = 3", "combined with edges, not with arc"),
        ('edges = ["crown"]', 'edges = ["crown", "left"]', "combined with several edges"),
        ('"x = 0"', '"z = 0"', 'it must be a plane of symmetry, such as "x = 0"'),
        ('"x = 0"', '"x = 0.3"', r"the boundary has no vertex at \(-4.4, 5\)"),
        ("arc = [0.0, 8.0]", WALL.replace("NAME", "base"), "opposite names 'base', which .fixed."),
        ("arc = [0.0, 8.0]", WALL.replace("NAME", "hole"), "3: opposite = 'hole' is also in the list"),
        ('mirror = "x = 0"', 'directions = ["x", "x"]', "directions contains 'x' twice; remove one"),
        ("parameters = 3", "parameters = 90", r"1: \d+ of the 90 design parameters of"),
        ("[[4.0, 8.0], [-4.0, 8.0]]", "[[4.0, 8.0], [3.9, 8.1]]", "3 of the 3 design parameters of"),
        ("arc = [0.0, 8.0]", WALL.replace("NAME", "bse"), "did you mean 'base'"),
        ("[[design]]", RAYS + "[[design]]", "1: between cannot be combined with rays"),
        ("[5.0, 5.0]", "[5.0, 4.0]", r"no vertex at \(5, 4\); the nearest vertex is at \(5, 5\)"),
    ],
)  # fmt: skip
def test_wrong_designs_are_refused(tmp_path, old, new, message):
    assert old in DESIGNS
    path = written(tmp_path, DESIGNS.replace(old, new, 1))
    if RAYS in new:
        filled = path.read_text().replace(
            "spacing = 1.6\nlayers = 3", "rays = { rays = 24, layers = 4 }"
        )
        path.write_text(filled, encoding="utf-8")
    with pytest.raises(sm.SealFileError, match=message):
        sm.build_seal(sm.read_seal_file(path))
