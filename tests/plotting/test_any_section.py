"""Pictures of seals other than the door seal: several materials, a closed profile, triangles."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from matplotlib.animation import PillowWriter
from matplotlib.contour import ContourSet
from pressed_block import pressed_block

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.measures.reaction import Reaction
from seal_mdao.plotting import field
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.animation import save_animation
from seal_mdao.plotting.several_seals import against_travel, force_against_travel
from seal_mdao.seals.profiles import contacts, profile_histories
from seal_mdao.seals.result import unloaded
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.region import Region


@pytest.fixture(scope="module")
def pressed():
    """A block of two laws under an ellipse that comes, and then slides and turns."""
    block = pressed_block()
    soft, hard = np.arange(12), np.arange(12, 24)
    body = ElasticBody(
        (
            Region(sm.NeoHookean(120.0, 20_000.0), soft, "low_"),
            Region(sm.NeoHookean(240.0, 20_000.0), hard, "high_"),
        )
    )
    return sm.analyze(replace(block, definitions=(body, *block.definitions[1:])))


def test_points_between_materials_lie_twice(pressed):
    fine = field.fine_grid(pressed, 3)
    places = fine.undeformed()
    twice = np.unique(np.round(places, 9), axis=0)
    # between the first 12 cells and the others lie 8 sides above and one across: 28 points
    assert len(places) - len(twice) == 9 * 3 + 1
    assert set(fine.region) == {0, 1}
    stress = fine.von_mises()
    both = [np.flatnonzero(np.hypot(*(places - p).T) < 1e-9) for p in places[fine.region == 0]]
    jumps = [abs(np.ptp(stress[at])) for at in both if at.size == 2]
    assert jumps
    # F is continuous: of neo-Hookean laws the stiffer one has twice the stress
    ratios = [stress[at].max() / stress[at].min() for at in both if at.size == 2]
    assert ratios == pytest.approx([2.0] * len(ratios), rel=1e-9)


def test_closed_profile_is_filled_where_it_is(pressed):
    (roll,) = contacts(pressed.seal)
    body = section.profile_body(pressed, roll, 8.0)
    place = roll.motion.pose(8.0).position
    assert shapely.contains_xy(body, *place)
    assert body.area == pytest.approx(np.pi * 1.5 * 1.0, rel=2e-3)
    # points of the contact are as far from what is drawn as their gaps say, but for its chords:
    # of 0.024 mm, on radii of 0.67 mm and more
    answer, face = pressed.response("roll"), body.exterior
    away = [face.distance(shapely.Point(x)) for x in answer.x]
    signs = np.where(shapely.contains_xy(body, answer.x), -1.0, 1.0)
    assert signs * away == pytest.approx(answer.gap, abs=0.024**2 / 8 / 0.67 + 1e-12)


def test_what_is_held_is_found_without_a_name(pressed):
    (line,) = section.fixed_lines(pressed)
    assert "base" not in pressed.seal.body.edges
    assert line[[0, -1]].tolist() == [[-3.0, 0.0], [3.0, 0.0]]


def test_every_figure(pressed, tmp_path):
    steps = pressed.key_steps()
    assert steps == [1, 4, 5, 7]
    shapes = plotting.deformed_shapes(pressed)
    titles = [axes.get_title() for axes in shapes.axes if axes.get_title()]
    assert titles == [pressed.caption(step) for step in steps]
    assert titles[-1] == "stage 2, travel 0.4 mm, turn 10°"
    nominal = [c for axes in shapes.axes for c in axes.get_children() if isinstance(c, ContourSet)]
    assert len(nominal) == 4 * 2  # a scale per material
    curve = plotting.load_deflection(pressed)
    first, second = (axes for axes in curve.axes if axes.get_title())
    force = pressed.path.reaction("roll")
    lines = [line.get_ydata() for line in first.get_lines()]
    assert any(np.array_equal(line, [0.0, *force[:5, 1]]) for line in lines)
    assert any(np.array_equal(line.get_ydata(), force[4:, 0]) for line in second.get_lines())
    for name in ("section_cloud", "contact_pressure", "contact_width"):
        assert (
            plotting.save(getattr(plotting, name)(pressed), tmp_path / "x.png", dpi=40)
            .stat()
            .st_size
        )


def test_colour_bars_of_two_materials_do_not_narrow_the_panels(pressed):
    """Otherwise white space lies between the rows of panels, whose aspect ratio is fixed."""
    figure = plotting.deformed_shapes(pressed)
    figure.canvas.draw()
    upper, _, lower, _ = (axes.get_position() for axes in figure.axes[:4])
    # between rows a title of one line and tick marks, less than 0.6 inches
    assert (upper.y0 - lower.y1) * figure.get_figheight() < 0.6


def test_forces_of_several_seals_are_those_against_the_travel(pressed):
    """As the measure with direction "travel": along y in stage 1, along x in stage 2."""
    axes = plotting.load_deflection_of({"block": pressed}).axes[0]
    assert axes.get_ylabel() == "force on roll against its travel (N/m)"
    force = pressed.path.reaction("roll")
    assert np.abs(force[4:, 0]).min() > 1.0
    # the curve jumps at the end of stage 1, 0.6 mm
    travel, drawn = axes.lines[1].get_data()
    assert travel == pytest.approx(
        [0.0, *0.12 * np.arange(1, 6), 0.6, *0.6 + 0.4 / 3 * np.arange(1, 4)]
    )
    np.testing.assert_allclose(drawn, [0.0, *force[:5, 1], *-force[4:, 0]], rtol=1e-12)
    _, measured = Reaction("roll", direction="travel").curve(pressed)
    _, drawn, ends, _ = force_against_travel(pressed)
    np.testing.assert_allclose(drawn[ends], measured, rtol=1e-12)


def test_force_against_an_inclined_travel(pressed):
    """-F . u with the direction u of each stage; a profile that turns has none."""
    history, units = profile_histories(pressed)[0], pressed.seal.units
    steps = [Stage(2, rotate=5.0), Stage(4, (-0.3, -0.4)), Stage(2, (1.0, 0.0))]
    against, words = against_travel(staged_motion(steps, start=(0.0, 4.0)), history, units)
    assert against == pytest.approx(np.array([[0.6, 0.8]] * 6 + [[-1.0, 0.0]] * 2))
    assert words == "force on roll against its travel"
    against, words = against_travel(staged_motion(steps[:1], start=(0.0, 4.0)), history, units)
    assert against.tolist() == [[0.0, 1.0]] * 8
    assert words == "vertical force on roll"


def test_force_of_loading_and_unloading_is_against_the_first_travel(pressed):
    """One curve without a change of sign, also after a dwell; its label says so."""
    history, units = profile_histories(pressed)[0], pressed.seal.units
    steps = [Stage(4, (0.0, -0.6)), Stage(1), Stage(3, (0.0, 0.6))]
    against, words = against_travel(staged_motion(steps, start=(0.0, 4.0)), history, units)
    assert against.tolist() == [[0.0, 1.0]] * 8
    assert words == "vertical force on roll against its first travel"
    # loading alone
    against, words = against_travel(staged_motion(steps[:2], start=(0.0, 4.0)), history, units)
    assert words == "vertical force on roll against its travel"
    # a stage along another line: the direction of each stage
    steps.append(Stage(2, (0.5, 0.0)))
    longer = replace(history, force=np.ones((10, 2)))
    against, words = against_travel(staged_motion(steps, start=(0.0, 4.0)), longer, units)
    assert against.tolist() == [[0.0, 1.0]] * 5 + [[0.0, -1.0]] * 3 + [[-1.0, 0.0]] * 2
    assert words == "force on roll against its travel"


def test_the_mark_of_an_animation_is_on_its_curve(pressed, tmp_path, monkeypatch):
    """At the end of each load step, the jump between the stages included."""
    marks = []

    def drawn(self):
        curve, marker = self.fig.axes[1].lines[1:3]
        marks.append(np.ravel(marker.get_data()))
        assert marks[-1].tolist() in np.transpose(curve.get_data()).tolist()
        grab(self)

    grab = PillowWriter.grab_frame
    monkeypatch.setattr(PillowWriter, "grab_frame", drawn)
    save_animation(pressed, tmp_path / "roll.gif")
    # the last frame is repeated
    assert all(np.array_equal(mark, marks[7]) for mark in marks[8:])
    del marks[8:]
    expected = Reaction("roll", direction="travel").curve(pressed)
    np.testing.assert_allclose(np.transpose(marks), np.array(expected)[:, 1:], rtol=1e-12)


def test_edges_of_a_section_look_different():
    """By colour, or by dashes where there are more edges than colours."""
    block = pressed_block()
    body = block.body
    top = body.edges["top"].particles
    parts = {f"top_{i}": Edge(top[i : i + 2], closed=False) for i in range(len(top) - 1)}
    body = replace(body, edges={**body.edges, **parts})
    axes = plotting.section_cloud(unloaded(replace(block, body=body))).axes[0]
    names = [*body.edges]
    looks = {own.get_label(): (own.get_color(), own.get_linestyle()) for own in axes.lines}
    assert len({looks[name] for name in names}) == len(names) == 11


@pytest.mark.parametrize("cut", [True, False])
def test_a_scale_that_is_cut_says_so(pressed, monkeypatch, cut):
    monkeypatch.setattr(section, "PEAK", 0.5 if cut else 1e3)
    figure = plotting.deformed_shapes(pressed)
    labels = [axes.get_ylabel() for axes in figure.axes if "stress" in axes.get_ylabel()]
    assert len(labels) == 2
    assert all(own.endswith("\n(arrow: higher at single points)") == cut for own in labels)


def test_single_points_do_not_set_the_scale():
    usual = np.linspace(0.0, 100.0, 1000)
    scale = section.stress_scale([usual, np.append(usual, 5000.0)])
    assert scale["extend"] == "max"
    assert 115.0 < scale["levels"][-1] < 140.0
    plain = section.stress_scale([usual])
    assert plain["extend"] == "neither"
    assert plain["levels"][-1] >= 100.0


def test_every_material_has_its_colour_scale(pressed):
    """It covers the stress of the own points, in other colours; the bars have the names."""
    fine = field.fine_grid(pressed, 3)
    scales = section.stress_scales([fine])
    for number, scale in enumerate(scales):
        own = fine.von_mises()[fine.region == number]
        assert np.array_equal(scale["levels"], section.stress_scale([own])["levels"])
    assert scales[0]["cmap"] != scales[1]["cmap"]
    figure = plotting.deformed_shapes(pressed)
    bars = [axes.get_ylabel() for axes in figure.axes if "stress" in axes.get_ylabel()]
    assert bars == ["low: von Mises stress (kPa)", "high: von Mises stress (kPa)"]
    # every scale colours triangles of its material alone
    shown = [c for c in figure.axes[0].get_children() if isinstance(c, ContourSet)]
    x = fine.deformed(pressed.key_steps()[0])
    for number, contours in enumerate(shown):
        own = x[fine.region == number]
        box = contours.get_datalim(figure.axes[0].transData)
        assert (box.x0, box.y0, box.x1, box.y1) == pytest.approx(
            (*own.min(0), *own.max(0)), abs=0.2
        )


def test_triangles_and_holes_make_loops():
    # a square with a square hole, one corner cut: quadrilaterals and triangles
    x, y = (a.ravel() for a in np.meshgrid(np.arange(4.0), np.arange(4.0)))
    cells = [[i + 4 * j, i + 1 + 4 * j, i + 5 + 4 * j, i + 4 + 4 * j] for j in range(3) for i in range(3)
             if (i, j) not in ((1, 1), (2, 2))]  # fmt: skip
    cells = np.array([*cells, [10, 11, 14, 14]])
    points, of_cell, _ = field._refined(cells, np.zeros(len(cells), int), 2)
    places = points.at(np.column_stack([x, y]))
    loops = field.boundary_loops(cells, of_cell)
    areas = sorted(polygon_area(places[loop])[0] for loop in loops)
    assert areas == pytest.approx([-1.0, 8.5])
    triangles = places[field._triangles(field._quads(of_cell))]
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(7.5)
