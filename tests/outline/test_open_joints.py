"""Ends of segments that are a little apart become one point, and nothing else moves by more."""

from itertools import pairwise

import numpy as np
import pytest

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.contours import Arc, Circle, Contour, Line, Outline, Spline
from seal_mdao.seals.outline.dxf import read_dxf, write_dxf

OPEN = 2.7e-4
"""mm: what drawings have where ends were snapped by hand."""
S = np.linspace(0.0, 1.0, 41)
TOP = [(5.0, 4.0), (3.0, 9.0), (0.3, 10.0), (-3.0, 8.0), (-5.0, 4.0)]


def chain(x=0.0, y=0.0):
    """Lines, arcs and a spline, each beginning ``x``, ``y`` from where the one before has ended."""
    off = x, y
    return [
        Line((-5.0, 0.0), (5.0, 0.0), "base"),
        Line(np.add(off, (5.0, 0.0)), (7.0, 1.0), "foot"),
        Arc.through(np.add(off, (7.0, 1.0)), (8.0, 2.0), (7.0, 3.0), "nose"),
        Arc.through(np.add(off, (7.0, 3.0)), (5.5, 3.2), (5.0, 4.0), "throat"),
        Spline([tuple(np.add(off, (5.0, 4.0))), *TOP[1:]], "top"),
        Line(np.add(off, (-5.0, 4.0)), (-5.0, 0.0), "side"),
    ]


def farthest(one, other):
    return max(np.abs(a.points(S) - b.points(S)).max() for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("off", [(OPEN, 0.0), (0.0, -OPEN), (1.5e-4, 2e-4)])
def test_every_joint_is_one_point(off):
    nominal = chain(*off)
    made = Contour(nominal).segments
    for one, other in pairwise([*made, made[0]]):
        assert np.abs(one.end - other.start).max() < 1e-14
    assert [segment.edge for segment in made] == [segment.edge for segment in nominal]
    assert [type(segment) for segment in made] == [type(segment) for segment in nominal]
    assert 1e-5 < farthest(made, nominal) < 3.0 * OPEN


def test_lines_keep_their_planes():
    """A base in a plane of symmetry stays in it to the last bit, whatever begins above it."""
    base, *_, side = Contour(chain(0.0, OPEN)).segments
    assert base.first[1] == base.last[1] == 0.0
    assert side.first[0] == side.last[0] == -5.0
    slanted = [Line((0.0, 0.0), (9.0, 0.0), "a"), Line((9.0, OPEN), (4.0, 7.0), "b"),
               Line((4.0, 7.0), (0.0, 0.0), "c")]  # fmt: skip
    found = Contour(slanted).segments
    assert found[0].last[1] == found[1].first[1] == 0.0
    assert np.abs(found[1].tangents([0.0]) - slanted[1].tangents([0.0])).max() < 1e-15


def test_lines_that_go_straight_on_meet_where_the_second_begins():
    halves = [Line((0.0, 0.0), (4.0, 0.0), "a"), Line((4.0 + OPEN, 0.0), (9.0, 0.0), "a"),
              Line((9.0, 0.0), (4.0, 7.0), "b"), Line((4.0, 7.0), (0.0, 0.0), "c")]  # fmt: skip
    found = Contour(halves).segments
    assert found[0].last == found[1].first == (4.0 + OPEN, 0.0)


def test_closed_joints_keep_their_bits():
    nominal = chain()
    assert all(a is b for a, b in zip(Contour(nominal).segments, nominal, strict=True))


@pytest.mark.parametrize("sweep", [0.3, 3.0, 3.3, 5.9, 6.2])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_arcs_of_any_sweep_move_little_more_than_their_ends(sweep, way):
    arc = Arc((1.0, 2.0), 5.0, 0.4, way * sweep, "a")
    start, end = np.add(arc.start, (OPEN, 0.0)), np.add(arc.end, (0.0, OPEN))
    moved = arc.between(start.tolist(), end.tolist())
    assert np.abs(moved.start - start).max() < 1e-12
    assert np.abs(moved.end - end).max() < 1e-12
    # where the ends are close to each other, their direction turns by more
    turned = max(1.0, arc.radius / np.hypot(*(arc.end - arc.start)))
    assert np.abs(moved.points(S) - arc.points(S)).max() < 3.0 * OPEN * turned


def test_one_segment_that_closes_in_itself():
    """An arc becomes a circle; a spline keeps its kink."""
    nearly = 2.0 * np.pi - OPEN / 5.0
    (whole,) = Contour([Arc((0.0, 0.0), 5.0, 0.0, -nearly, "hole")]).segments
    assert whole == Circle((0.0, 0.0), 5.0, "hole", clockwise=True)
    drop = Spline([(0.0, 0.0), (3.0, 2.0), (0.0, 5.0), (-3.0, 2.0), (0.0, OPEN)], "drop")
    (closed,) = Contour([drop]).segments
    assert closed.through[0] == closed.through[-1]
    assert np.abs(closed.tangents([0.0, 1.0]) - drop.tangents([0.0, 1.0])).max() < 1e-12
    assert np.abs(closed.points(S) - drop.points(S)).max() < 2.0 * OPEN


def test_a_drawing_of_it_is_closed(tmp_path):
    outline = Outline(Contour(chain(OPEN, OPEN)))
    again = read_dxf(write_dxf(outline, tmp_path / "a.dxf"))
    for one, other in pairwise([*again.outer.segments, again.outer.segments[0]]):
        assert np.abs(one.end - other.start).max() < 1e-12


@pytest.mark.parametrize("name", ["lip/top", "a:b", "two\nlines", "50 %?", "a\\b", "`"])
def test_names_that_no_layer_can_have_are_refused(tmp_path, name):
    outline = Outline(Contour([Circle((0.0, 0.0), 3.0, name)]))
    with pytest.raises(GeometryError, match="which is not allowed in the name of a DXF layer"):
        write_dxf(outline, tmp_path / "a.dxf")
    assert not list(tmp_path.iterdir())
