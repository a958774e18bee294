"""Pictures of rings: the mirror image near the axis, the view in space, forces per circumference."""

import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.collections import PolyCollection
from pressed_block import pressed_block
from ring_files import cylinder, ring

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.force_table import force_lines
from seal_mdao.contact.friction import OPEN
from seal_mdao.plotting import ring_figure as view
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting import several_seals
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.several_seals import load_deflection_of
from seal_mdao.plotting.style import add_caption
from seal_mdao.report.html_tables import measures
from seal_mdao.report.page import ShownSeal, key_figures
from seal_mdao.report.picture_data import Pictures
from seal_mdao.report.write import ring_section
from seal_mdao.seals.profiles import contact_positions, contacts, true_pressure


def analyzed(folder, text):
    path = folder / "ring.toml"
    path.write_text(text)
    return sm.analyze(sm.build_seal(path))


@pytest.fixture(scope="module")
def solid(tmp_path_factory):
    return analyzed(tmp_path_factory.mktemp("solid"), cylinder())


SQUEEZED = """\
[model]
kinematics = "axisymmetric"
[material.nbr]
shore_a = 70
[section]
spacing = 0.6
outer = [{ edge = "ring", circle = { centre = [11.5, 0.0], radius = 1.5 } }]
[[profile]]
name = "groove"
friction = 0.1
line = [[10.0, -5.0], [10.0, 5.0]]
[[profile]]
name = "cylinder"
friction = 0.1
line = [[0.0, 5.0], [0.0, -5.0]]
start = [13.0, 0.0]
normal_penalty = 1e6
tangent_penalty = 1e5
stage = [{ translate = [-0.6, 0.0], steps = 12 }]
"""


@pytest.fixture(scope="module")
def squeezed(tmp_path_factory):
    """An O-ring between two walls, the contour of which begins in the contact with one of them."""
    return analyzed(tmp_path_factory.mktemp("squeezed"), SQUEEZED)


@pytest.fixture(scope="module")
def wide(tmp_path_factory):
    """Inner radius 3 mm, section 2 x 2 mm."""
    text = ring() + '[[measure]]\ntype = "reaction"\n'
    return analyzed(tmp_path_factory.mktemp("wide"), text)


def test_a_section_near_the_axis_is_shown_with_its_mirror_image(solid):
    figure = plotting.deformed_shapes(solid)
    for axes in figure.axes[:4]:
        low, high = axes.get_xlim()
        assert low == -high
        images = [own for own in axes.get_children() if own.get_label() == "_mirror"]
        lines = [own for own in images if own in axes.lines]
        assert len(images) > len(lines) > 1
        # the image of a point is where the point of the opposite radius is
        points = np.array([[1.0, 0.5], [2.0, 1.0]])
        opposite = axes.transData.transform(points * [-1.0, 1.0])
        for own in images:
            # of collections the transform is that of their paths
            np.testing.assert_allclose(own.get_transform().transform(points), opposite, atol=1e-9)
        axes.figure.canvas.draw()
        ticks = [label.get_text() for label in axes.get_xticklabels()]
        assert ticks == ticks[::-1]
    # one entry of the legend each
    (legend,) = figure.legends
    assert [own.get_text() for own in legend.get_texts()] == [
        "in contact", "open between contacts",
    ]  # fmt: skip


def test_points_in_contact_with_both_walls_are_shown_as_such(squeezed):
    """Around a closed contour the longest open part is no gap between contacts."""
    axes = plotting.deformed_shapes(squeezed).axes[3]
    lines = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert not len(lines["open between contacts"])
    x = lines["in contact"][:, 0]
    touching = [int(np.sum(squeezed.response(n).state != OPEN)) for n in ("groove", "cylinder")]
    assert min(touching) >= 2
    # walls at radii of 10 and 12.4 mm, to the penetration that the penalty permits
    near = [int(np.sum(np.abs(x - wall) < 0.01)) for wall in (10.0, 12.4)]
    assert near == touching


@pytest.mark.parametrize(("name", "number"), [("groove", 0), ("cylinder", 1)])
def test_pressure_around_the_beginning_of_a_contour_is_one_curve(squeezed, name, number):
    axes = plotting.contact_pressure(squeezed).axes[number]
    (line,) = (own for own in axes.lines if own.get_label() == "travel 0.6 mm")
    s, pressure = line.get_data()
    contact = next(own for own in contacts(squeezed.seal) if own.label == name)
    own = true_pressure(squeezed, contact)
    assert sorted(pressure) == sorted(own)
    # the points in contact follow one another
    at = np.flatnonzero(pressure)
    assert np.all(np.diff(at) == 1)
    assert 0 < at[0] <= at[-1] < len(s) - 1
    low, high = axes.get_xlim()
    assert low < s[at[0]] < s[at[-1]] < high < low + 3.0
    # the beginning of the contour, (13, 0), stays at zero
    x = contact_positions(squeezed, name)
    begin = int(np.argmin(np.abs(s)))
    # arc lengths are those of the closed polygon through the points
    chords = np.hypot(*(np.roll(x, -1, axis=0) - x).T)
    np.testing.assert_allclose(np.diff(s), np.roll(chords, begin)[:-1], rtol=1e-12)
    assert s[begin] == pytest.approx(0.0, abs=1e-12)
    assert pressure[begin] == own[0]
    assert x[0] == pytest.approx([13.0, 0.0])


def test_the_name_of_a_profile_across_the_axis_is_on_the_right(solid):
    (name,) = plotting.section_cloud(solid).axes[0].texts
    assert name.get_text() == "plate"
    # in the middle of the visible part, 0 to 2.4 mm
    assert name.get_position()[0] == pytest.approx(1.2, abs=0.2)


def test_a_section_far_from_the_axis_is_shown_alone(wide):
    axes = plotting.section_cloud(wide).axes[0]
    assert axes.get_xlim()[0] > 0.0
    assert not [own for own in axes.get_children() if own.get_label() == "_mirror"]
    # inner radius over the size of the section: 1.5, and exactly the limit
    assert not section.near_axis(wide.seal)
    nominal = wide.seal.nominal_particles - [1.0, 0.0]

    class Moved:
        body, nominal_particles = wide.seal.body, nominal

    assert section.near_axis(Moved)


def test_particles_are_fixed_in_the_legend_only_where_some_are(wide):
    def words(result):
        return [own.get_text() for own in plotting.section_cloud(result).axes[0].get_legend().texts]

    assert "fixed" in words(wide)
    free = replace(wide.seal.body, fixed=np.zeros_like(wide.seal.body.fixed))
    assert "fixed" not in words(replace(wide, seal=replace(wide.seal, body=free)))


def test_surface_that_is_seen_covers_the_silhouette():
    """Of a solid cylinder: a disc from above and a rectangle from the side."""
    # around the section on the left, from the axis
    x = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]])
    corners, colors = view._surface(x, (np.arange(4),), (0.0, 2.0 * np.pi))
    seen = view._seen(corners)
    step = np.roll(seen, -1, axis=1)
    areas = 0.5 * (seen[..., 0] * step[..., 1] - seen[..., 1] * step[..., 0]).sum(axis=1)
    exact = np.pi * 4.0 * np.sin(view.ELEVATION) + 2.0 * 2.0 * 3.0 * np.cos(view.ELEVATION)
    # a polygon in place of the circle: relative error (angle of a facet)^2 / 6, at most twice
    assert abs(areas).sum() == pytest.approx(exact, rel=view.FACET**2 / 3.0)
    assert np.all(areas < 0.0)
    assert colors.min() > 0.0
    assert colors.max() <= 1.0


def test_cuts_of_the_view_have_the_stress_of_the_section(wide):
    figure = view.ring_view(wide)
    (pieces,) = (own for own in figure.axes[0].collections if isinstance(own, PolyCollection))
    fine = view.fine_grid(wide)
    (scale,) = section.stress_scales([fine])
    mean = np.maximum(fine.von_mises()[fine.quads].mean(axis=1), 0.0)
    expected = colormaps[scale["cmap"]](scale["norm"](mean))[:, :3]

    # every piece of the section is there twice, in its colour; the surface is grey
    def counted(colors):
        return Counter(map(tuple, np.round(colors, 12).tolist()))

    shown = counted(pieces.get_facecolors()[:, :3])
    assert all(shown[color] == 2 * n for color, n in counted(expected).items())
    assert shown.total() > 2 * len(expected)
    assert figure.axes[0].get_title() == f"270° of the ring, {wide.caption(3)}"


def test_of_a_very_wide_ring_a_part_is_shown(tmp_path):
    result = analyzed(tmp_path, ring(inner=38.0))
    outer = result.deformed()[:, 0].max()
    title = view.ring_view(result).axes[0].get_title()
    # the grid between the particles may bulge a little beyond them
    degrees = np.rad2deg(view.LONGEST * 2.0 / outer)
    assert int(title.partition("°")[0]) == pytest.approx(degrees, abs=1.0)


def test_plane_strain_has_no_view_in_space(nominal):
    with pytest.raises(ValueError, match="needs a body of revolution"):
        plotting.ring_view(nominal)


def test_forces_of_figures_and_report_are_per_circumference_too(wide):
    radius = wide.seal.units.radius
    force = wide.path.reaction("plate")[-1, 1]
    for figure in (plotting.load_deflection(wide), load_deflection_of({"a": wide})):
        (right,) = figure.axes[0].child_axes
        assert right.get_ylabel() == (
            f"N per mm of circumference\nat the mean radius {radius:.4g} mm"
        )
        figure.canvas.draw()
        low, high = figure.axes[0].get_ylim()
        expected = np.array([low, high]) / (2.0 * np.pi * radius)
        assert right.get_ylim() == pytest.approx(expected, rel=1e-12)
    found = measures(wide)
    along = f"per mm of circumference at the mean radius {radius:.4g} mm"
    for name in ("reaction", "axial force on the profile"):
        assert found[name] == ("N", pytest.approx(force, rel=1e-12))
        unit, value = found[f"{name}, {along}"]
        assert unit == "N/mm"
        assert value == pytest.approx(force / (2.0 * np.pi * radius), rel=1e-12)


def test_a_ring_squeezed_radially_is_reported_with_its_radial_force(squeezed):
    """On the cards of the report, in its captions and charts, and on the console by its name."""

    class Recorded:
        name, scenarios = "ring", ()

    class History:
        kind, objective_name, objective = "optimisation", "reaction", np.array([1.0])
        major, iterations, evaluations, max_violation = True, 0, 1, np.array([0.0])

    force = squeezed.path.reaction("cylinder")[-1]
    assert abs(force[0]) > 100.0 * abs(force[1])
    cards = {name: value for name, value, _ in
             key_figures(History, [ShownSeal(Recorded, [squeezed, squeezed])])}  # fmt: skip
    assert cards["radial force, cylinder"] == f"{force[0]:.3g} N".replace("-", "−")
    assert not any("vertical" in name or "axial" in name for name in cards)
    data = Pictures(squeezed, squeezed, []).as_data()
    assert data["force"]["directions"] == ("radial", "axial")
    for curve in data["paths"][0]["curves"]:
        assert curve["component"] == 0
        assert abs(curve["reaction"][-1][0]) > abs(curve["reaction"][-1][1])
    assert "radial and axial force (N)" in force_lines(squeezed)[0]
    lines = {own.get_label(): own for own in plotting.load_deflection(squeezed).axes[1].lines}
    assert lines["radial"].get_ydata()[-1] == force[0]


def test_report_has_the_view_of_rings_alone(wide, nominal):
    class Recorded:
        name = "bump"

    assert 'alt="Deformed ring: bump"' in ring_section(0, ShownSeal(Recorded, [wide, wide]))
    assert ring_section(0, ShownSeal(Recorded, [nominal])) == ""


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """The picture of a strip of 6 x 2 mm and a ring, with its caption; drawn."""
    strip = sm.analyze(pressed_block())
    text = ring(inner=20.0, translate=(0.0, -0.5))
    results = {"strip": strip, "ring": analyzed(tmp_path_factory.mktemp("large"), text)}
    with captioned({"strip": "rubber", "ring": "rubber"}):
        figure = plotting.seals_compared(results)
        add_caption(figure)
    figure.canvas.draw()
    return figure


def test_forces_per_length_and_of_rings_are_compared_in_two_panels(compared):
    strip, ring, pressure, *_ = compared.axes
    assert strip.get_ylabel() == "force on roll against its travel (N/m)"
    # a longer label has two lines
    assert ring.get_ylabel() == "axial force on plate\nagainst its travel (N)"
    assert [len(axes.lines) for axes in (strip, ring, pressure)] == [2, 2, 2]
    colors = [axes.lines[-1].get_color() for axes in (strip, ring)]
    assert colors == [line.get_color() for line in pressure.lines]
    assert colors[0] != colors[1]


def test_labels_of_a_comparison_are_complete_and_clear_of_each_other(compared):
    texts = [axes.yaxis.label for axes in compared.axes] + compared.texts
    boxes = [own.get_window_extent() for own in texts if own.get_text()]
    inside = compared.bbox.padded(1.0)
    assert all(inside.fully_contains(*box.min) and inside.contains(*box.max) for box in boxes)
    pairs = itertools.combinations(boxes, 2)
    assert not any(one.overlaps(other) for one, other in pairs)


def test_compared_sections_have_windows_of_one_size_around_each(compared):
    *_, strip, ring, _ = compared.axes
    (left, right), (low, high) = strip.get_xlim(), ring.get_xlim()
    assert [strip.get_title(), ring.get_title()] == ["strip", "ring"]
    assert right - left == pytest.approx(high - low)
    # the ring lies between radii of 20 and 22 mm
    assert low > 15.0
    assert high < 27.0


def test_compared_sections_of_very_different_sizes_have_their_own_scales():
    small, large = np.array([[0.0, 0.0], [3.0, 2.0]]), np.array([[-50.0, 0.0], [50.0, 30.0]])
    found = several_seals._windows([small, large])
    np.testing.assert_array_equal(found, [small, large])
