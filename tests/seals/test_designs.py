"""Designs of a section: parts of edges, walls, vertices, radii, planes of symmetry."""

import numpy as np
import pytest

from seal_mdao.seals.file.build import boundaries_of
from seal_mdao.seals.outline.boundary_path import MirrorPlane
from seal_mdao.seals.outline.contours import Arc, Circle, Contour, Line, Outline
from seal_mdao.seals.outline.design import boundary_velocity
from seal_mdao.seals.outline.moved import shifted_outline
from seal_mdao.seals.outline.offset_fields import OffsetDesign
from seal_mdao.seals.outline.vertices_and_arcs import RadiusDesign, VertexDesign

X0 = MirrorPlane(0, 0.0)
FIXED = {"base": (0, 1)}


def house(radius=2.0, turn=0.0):
    """A block with a fillet at its right top, a hole, and names of its own for the sides."""
    r = radius
    fillet = Arc((5.0 - r, 8.0 - r), r, 0.0, 0.5 * np.pi, "fillet")
    outer = Contour((
        Line((-5.0, 0.0), (5.0, 0.0), "base"), Line((5.0, 0.0), (5.0, 8.0 - r), "right"), fillet,
        Line((5.0 - r, 8.0), (-5.0, 8.0), "top"), Line((-5.0, 8.0), (-5.0, 0.0), "left"),
    ))  # fmt: skip
    return Outline(outer, (Contour((Circle((0.0, 4.0), 2.0, "hole"),)),))


def bulb():
    """A symmetric D-bulb with a circular hole whose first point is not in the plane of symmetry."""
    outer = Contour((
        Line((-5.0, 0.0), (5.0, 0.0), "base"), Line((5.0, 0.0), (5.0, 5.0), "right"),
        Arc((0.0, 5.0), 5.0, 0.0, np.pi, "crown"), Line((-5.0, 5.0), (-5.0, 0.0), "left"),
    ))  # fmt: skip
    return Outline(outer, (Contour((Circle((0.0, 5.0), 3.2, "hole"),)),))


def moved(outline, designs, values, supports=FIXED, spacing=0.7):
    """The outline of a design, its boundaries and their velocity."""
    boundaries, _ = boundaries_of(outline, spacing)
    velocity, _ = boundary_velocity(boundaries, designs, supports)
    ends = np.cumsum([len(own.points) for own in boundaries])[:-1]
    points = np.concatenate([own.points for own in boundaries])
    points = points + np.tensordot(values, velocity, 1)
    return shifted_outline(outline, boundaries, np.split(points, ends)), boundaries, velocity


def test_a_fillet_stays_tangent_and_round():
    """Its radius is the parameter: the section is the one drawn with that radius, exactly."""
    new, _, _ = moved(house(), [RadiusDesign((4.4, 7.4))], [0.5])
    expected = house(radius=2.5)
    assert [type(s) for s in new.outer.segments] == [type(s) for s in expected.outer.segments]
    assert new.area == pytest.approx(expected.area, rel=1e-13)
    (fillet,) = (s for s in new.outer.segments if s.edge == "fillet")
    np.testing.assert_allclose([*fillet.centre, fillet.radius], [2.5, 5.5, 2.5], rtol=1e-12)


def test_the_radius_of_a_circle_and_of_an_arc_that_is_no_fillet():
    new, _, _ = moved(bulb(), [RadiusDesign((3.2, 5.0)), RadiusDesign((0.0, 10.0))], [0.3, -0.2])
    assert new.holes[0].segments[0].radius == pytest.approx(3.5, rel=1e-12)
    (crown,) = (s for s in new.outer.segments if s.edge == "crown")
    np.testing.assert_allclose([*crown.centre, crown.radius], [0.0, 5.0, 4.8], atol=1e-12)
    # the lines beside it follow its ends, their other ends stay
    (right,) = (s for s in new.outer.segments if s.edge == "right")
    np.testing.assert_allclose([right.first, right.last], [(5.0, 0.0), (4.8, 5.0)], atol=1e-12)


def test_a_vertex_moves_and_the_lines_beside_it_stay_straight():
    new, _, _ = moved(house(), [VertexDesign((-5.0, 8.0))], [-0.4, 0.3])
    ends = {s.edge: (s.first, s.last) for s in new.outer.segments if s.edge in ("top", "left")}
    np.testing.assert_allclose(ends["top"], [(3.0, 8.0), (-5.4, 8.3)], atol=1e-12)
    np.testing.assert_allclose(ends["left"], [(-5.4, 8.3), (-5.0, 0.0)], atol=1e-12)
    # area of the quadrilateral that is added: two triangles with the moved vertex
    added = 0.5 * 8.0 * 0.4 + 0.5 * 8.0 * 0.3
    assert new.area == pytest.approx(house().area + added, rel=1e-12)


def test_a_part_of_an_edge_begins_and_ends_smoothly():
    """Value and slope of the offset are zero at both points, and nothing moves beyond them."""
    between = (
        (5.0 * np.cos(0.5), 5.0 + 5.0 * np.sin(0.5)),
        (5.0 * np.cos(2.0), 5.0 + 5.0 * np.sin(2.0)),
    )
    design = OffsetDesign(("crown",), 3, between)
    boundaries, _ = boundaries_of(bulb(), 0.1)
    velocity, sizes = boundary_velocity(boundaries, [design], FIXED)
    assert sizes == (3,)
    points = boundaries[0].points
    angle = np.arctan2(points[:, 1] - 5.0, points[:, 0])
    on = (boundaries[0].edge == "crown") & (angle > 0.5) & (angle < 2.0)
    size = np.hypot(*np.moveaxis(velocity, -1, 0))[:, : len(points)]
    assert not size[:, ~on].any()
    assert size[:, on].max() > 0.4
    # near an end the offset grows with the square of the distance
    near = on & (angle < 0.53)
    assert size[:, near].max() < 0.01
    with pytest.raises(ValueError, match="give the two points of the key between in this order"):
        boundary_velocity(boundaries, [OffsetDesign(("crown",), 3, between[::-1])], FIXED)


def test_a_part_of_a_loop_may_pass_its_first_point():
    between = (
        (3.2 * np.cos(-0.5), 5.0 - 3.2 * np.sin(0.5)),
        (3.2 * np.cos(0.7), 5.0 + 3.2 * np.sin(0.7)),
    )
    boundaries, _ = boundaries_of(bulb(), 0.2)
    # holes are walked clockwise: from the upper point to the lower one
    velocity, _ = boundary_velocity(boundaries, [OffsetDesign(("hole",), 2, between[::-1])], FIXED)
    hole = boundaries[1].points
    angle = np.arctan2(hole[:, 1] - 5.0, hole[:, 0])
    still = (angle < -0.5) | (angle > 0.7)
    size = np.hypot(*np.moveaxis(velocity, -1, 0))[:, len(boundaries[0].points) :].max(axis=0)
    assert not size[still].any()
    assert size[~still].min(initial=1.0, where=np.abs(angle[~still]) < 0.3) > 0.05


def test_a_wall_gets_thicker_on_both_sides():
    """Offsets of a circular wall by one number: both radii change by it, in opposite directions."""
    outer = Contour((Circle((0.0, 0.0), 5.0, "out"),))
    ring = Outline(outer, (Contour((Circle((0.0, 0.0), 4.0, "in"),)),))
    design = OffsetDesign(("out",), 6, opposite="in")
    new, _, _ = moved(ring, [design], np.full(6, 0.2), supports={}, spacing=0.5)
    assert new.outer.segments[0].radius == pytest.approx(5.2, rel=1e-12)
    assert new.holes[0].segments[0].radius == pytest.approx(3.8, rel=1e-12)


@pytest.mark.parametrize(
    ("designs", "count"),
    [
        ([OffsetDesign(("crown",), 7, mirror=X0)], 4),
        ([OffsetDesign(("crown",), 6, mirror=X0)], 3),
        ([OffsetDesign(("hole",), 8, mirror=X0)], 5),
        ([OffsetDesign(("hole",), 7, mirror=X0)], 4),
        ([OffsetDesign(("left", "crown", "right"), 5, mirror=X0)], 8),
        ([OffsetDesign(("right",), 5, mirror=X0)], 5),
        ([OffsetDesign(("crown",), 5, opposite="hole", mirror=X0)], 3),
        ([OffsetDesign(("crown",), 5, ((4.0, 8.0), (-4.0, 8.0)), mirror=X0)], 3),
        ([OffsetDesign(("crown",), 4, ((4.0, 8.0), (3.0, 9.0)), mirror=X0)], 4),
        ([VertexDesign((5.0, 5.0), mirror=X0)], 2),
        ([RadiusDesign((0.0, 10.0), mirror=X0)], 1),
        ([OffsetDesign(("hole",), 8, mirror=MirrorPlane(1, 5.0))], 5),
    ],
)  # fmt: skip
def test_symmetric_designs_have_symmetric_velocities(designs, count):
    """The velocity at the mirror image of a point is the mirror image of its velocity."""
    boundaries, _ = boundaries_of(bulb(), 0.5)
    velocity, sizes = boundary_velocity(boundaries, designs, FIXED)
    assert sizes == (count,)
    # independent, and each of them moves something
    assert np.linalg.matrix_rank(velocity.reshape(count, -1)) == count
    plane = designs[0].mirror
    points = np.concatenate([own.points for own in boundaries])
    moves = np.abs(velocity).max(axis=(0, 2)) > 0.0
    images = plane.image(points[moves])
    away = np.hypot(*np.moveaxis(images[:, None] - points, -1, 0))
    nearest = away.argmin(axis=1)
    assert away.min(axis=1).max() < 1e-9
    expected = velocity[:, moves].copy()
    expected[..., plane.axis] *= -1.0
    np.testing.assert_allclose(velocity[:, nearest], expected, atol=1e-8)


@pytest.mark.parametrize(
    ("design", "message"),
    [
        (OffsetDesign(("right",), 5, mirror=MirrorPlane(0, 0.1)), "mirror image of 'right'"),
        (OffsetDesign(("base",), 5), "the edge 'base' is fixed"),
        (OffsetDesign(("crown",), 5, opposite="base"), "the edge 'base' is fixed"),
        (OffsetDesign(("crown",), 5, ((9.0, 9.0), (0.0, 10.0))), "must lie on the edge 'crown'"),
        (VertexDesign((1.0, 9.0)), r"no vertex at \(1, 9\); the nearest vertex is at \(5, 5\)"),
        (VertexDesign((3.2, 5.0)), r"the boundary has no vertex at \(3.2, 5\)"),
        (VertexDesign((5.0, 0.0)), "would move the edge 'base', which is fixed"),
        (RadiusDesign((5.0, 2.0)), "is not an arc, so it has no radius to change; give"),
        (RadiusDesign((0.0, 3.5)), "must lie on the boundary"),
    ],
)  # fmt: skip
def test_designs_that_cannot_be_are_refused(design, message):
    boundaries, _ = boundaries_of(bulb(), 0.5)
    with pytest.raises(ValueError, match=message):
        boundary_velocity(boundaries, [design], FIXED)


def half():
    """The right half of the bulb, cut in the plane x = 0."""
    return Outline(Contour((
        Line((0.0, 0.0), (5.0, 0.0), "base"), Line((5.0, 0.0), (5.0, 5.0), "right"),
        Arc((0.0, 5.0), 5.0, 0.0, 0.5 * np.pi, "crown"), Line((0.0, 10.0), (0.0, 0.0), "plane"),
    )))  # fmt: skip


def test_planes_of_symmetry_stay_planes():
    supports = {"base": (1,), "plane": (0,)}
    new, _, velocity = moved(
        half(), [RadiusDesign((5.0 * np.cos(1.0), 5.0 + 5.0 * np.sin(1.0)))], [0.2], supports
    )
    (plane,) = (s for s in new.outer.segments if s.edge == "plane")
    np.testing.assert_allclose([plane.first, plane.last], [(0.0, 10.2), (0.0, 0.0)], atol=1e-12)
    new, _, velocity = moved(half(), [VertexDesign((0.0, 10.0))], [0.3], supports)
    assert velocity.shape[0] == 1
    (plane,) = (s for s in new.outer.segments if s.edge == "plane")
    np.testing.assert_allclose(plane.first, (0.0, 10.3), atol=1e-12)
    with pytest.raises(
        ValueError,
        match=r"the vertex \(0, 10\) lies in a plane of symmetry and cannot move out of it in x",
    ):
        moved(half(), [VertexDesign((0.0, 10.0), (0, 1))], [0.3, 0.1], supports)


def test_an_edge_that_is_fixed_along_itself_is_no_plane():
    """Designs leave a horizontal base that is fixed along x as they leave a fixed one; its end moves
    with a vertex alone."""
    design = OffsetDesign(("left",), 4)
    velocities = [moved(house(), [design], np.ones(4), {"base": own})[2] for own in [(0,), (0, 1)]]
    np.testing.assert_array_equal(*velocities)
    corner = VertexDesign((-5.0, 0.0))
    new, _, _ = moved(house(), [corner], [-0.4, -0.3], {"base": (0,)})
    (base,) = (s for s in new.outer.segments if s.edge == "base")
    np.testing.assert_allclose([base.first, base.last], [(-5.4, -0.3), (5.0, 0.0)], atol=1e-12)


def test_a_smooth_joint_within_an_edge_is_no_vertex():
    outer = Contour((
        Line((-5.0, 0.0), (5.0, 0.0), "base"), Line((5.0, 0.0), (5.0, 5.0), "side"),
        Arc((0.0, 5.0), 5.0, 0.0, np.pi, "side"), Line((-5.0, 5.0), (-5.0, 0.0), "side"),
    ))  # fmt: skip
    boundaries, _ = boundaries_of(Outline(outer), 0.7)
    with pytest.raises(ValueError, match=r"the edge 'side' is smooth at \(5, 5\)"):
        boundary_velocity(boundaries, [VertexDesign((5.0, 5.0))], FIXED)
