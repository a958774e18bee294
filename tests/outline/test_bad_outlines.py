"""Segments, contours and sections that are refused: one line that says what and where."""

import re
from dataclasses import replace

import numpy as np
import pytest
from sample_sections import bulb, circle, lines

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.contours import Arc, Circle, Contour, Line, Outline, Spline

SQUARE = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
BASE, BACK = Line((0.0, 0.0), (4.0, 0.0), "base"), Line((4.0, 0.0), (2.0, 3.0), "seal")


def two_lobes():
    """A slit of no width: the boundary touches itself at (5, 4)."""
    return [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 4.0), (1.0, 9.0), (1.0, 4.0), (5.0, 4.0),
            (0.0, 2.0)]  # fmt: skip


BAD = {
    "no length": (lambda: Line((1, 1), (1, 1)), "a line of the boundary has zero length, because"),
    "not a pair": (lambda: Line((1, 1), (1, 1, 2)), "last must be a point [x, y], got (1, 1, 2)"),
    "text": (lambda: Line((1, 1), "ab"), "last must be a point [x, y], got 'ab'"),
    "number": (lambda: Line(3.0, (1, 1)), "first must be a point [x, y], got 3.0"),
    "NaN": (lambda: Line((1, np.nan), (1, 1)), "first = (1, nan) is not finite"),
    "infinite": (lambda: Arc.through((0, 0), (1, np.inf), (2, 0)), "through = (1, inf) is not"),
    "too large": (lambda: Line((1, 1e300), (1, 1)), "first = (1, 1e+300) is beyond 1e+09 mm"),
    "collinear": (lambda: Arc.through((0, 0), (1, 1), (2, 2)), "(2, 2) of an arc are collinear"),
    "nearly collinear": (lambda: Arc.through((0, 0), (1, 1e-7), (2, 0)), "are collinear; use a"),
    "arc twice a point": (lambda: Arc.through((0, 0), (0, 0), (2, 0)), "start and through of an"),
    "arc to its start": (lambda: Arc.through((0, 0), (1, 1), (0, 0)), "start and end of an arc"),
    "no radius": (lambda: Circle((0, 0), 0.0), "radius of a circle must be positive, got 0"),
    "negative radius": (lambda: Arc((0, 0), -1.0, 0.0, 1.0), "radius of an arc must be positive"),
    "text radius": (lambda: Circle((0, 0), "big"), "radius must be a number, got 'big'"),
    "NaN radius": (lambda: Circle((0, 0), np.nan), "radius = nan is not finite"),
    "whole turn": (lambda: Arc((0, 0), 1.0, 0.0, 7.0), "between 0 and 360 degrees, got 401"),
    "no sweep": (lambda: Arc((0, 0), 1.0, 0.0, 0.0), "between 0 and 360 degrees, got 0"),
    "one point": (lambda: Spline([(0, 0)]), "needs at least 2 points, got 1"),
    "closed, two points": (lambda: Spline([(0, 0), (1, 1), (0, 0)]), "at least 4 points when it is"),
    "no list": (lambda: Spline(4.0), "a spline needs a list of points [[x, y], ...], got 4.0"),
    "same points": (lambda: Spline([(0, 0), (1, 1), (1, 1), (2, 0)]), "points 2 and 3 of a spline"),
    "bad point": (lambda: Spline([(0, 0), (1, "b")]), "point 2 of a spline must be a point"),
    "parameter": (lambda: Spline([(0, 0), (1, 1)], "a", (1.0, 0.0)), "must be 2 increasing numbers"),
    "cusp": (
        lambda: Spline([(-1, 0), (1, 0)], "a", (-1.0, 1.0), ((-1.0, 0.0), (-1.0, 0.0))),
        "a spline has a cusp",
    ),
    "no segment": (lambda: Contour([]), "needs at least one segment, got []"),
    "no list of segments": (lambda: Contour(BASE), "needs at least one segment, got Line"),
    "no segment at all": (lambda: Contour([BASE, "arc"]), "segment 2 of the boundary must be a line"),
    "no name": (lambda: Contour([Circle((0, 0), 1.0)]), "segment 1 of the boundary needs the name"),
    "open": (
        lambda: Contour([BASE, BACK]),
        "the contour is open: segment 2 (edge 'seal') ends at (2, 3), but the next segment 1 "
        "(edge 'base') begins at (0, 0), 3.61 mm away",
    ),
    "open, of one edge": (
        lambda: Contour([Line((0, 0), (4, 0), "a"), Line((4, 0), (2, 3), "a")]),
        "(edge 'a') begins at (0, 0), 3.61 mm away; a line or spline that is a complete contour "
        "repeats its first point at its end",
    ),
    "gap": (
        lambda: Contour([BASE, Line((4.1, 0), (0, 3), "seal"), Line((0, 3), (0, 0), "seal")]),
        "segment 1 (edge 'base') ends at (4, 0), but the next segment 2 (edge 'seal') begins at (4.1,",
    ),
    "there and back": (
        lambda: Contour([BASE, Line((4, 0), (0, 0), "seal")]),
        "segment 1 (edge 'base') and segment 2 (edge 'seal') overlap or form a cusp at (4, 0)",
    ),
    "speck": (
        lambda: lines([(0.0, 0.0), (10.0, 0.0), (10.0, 1e-4), (0.0, 10.0)]),
        "segment 2 (edge 'seal') at (10, 0) is only 0.0001 mm long",
    ),
    "circle in a chain": (
        lambda: Contour([BASE, Circle((3.0, 0.0), 1.0, "seal"), Line((4, 0), (0, 0), "x")]),
        "segment 2 (edge 'seal') is a circle, which must be the only segment",
    ),
    "clockwise": (lambda: Outline(lines(SQUARE[::-1])), "(edges seal) runs clockwise; reverse"),
    "no contour": (lambda: Outline(BASE), "a section must consist of contours (Contour), got Line"),
    "no contour in holes": (lambda: bulb(3.0), "a section must consist of contours (Contour), got 3.0"),
    "bow tie": (
        lambda: Outline(lines([(0.0, 0.0), (10.0, 0.0), (3.0, 9.0), (9.0, 9.0)])),
        "the outer contour, edge 'seal', crosses itself (edge 'seal') at (5.625, 5.625)",
    ),
    "touches itself": (lambda: Outline(lines(two_lobes())), "touches itself (edge 'seal') at (5, 4)"),
    "hole crosses": (
        lambda: bulb(circle((0.0, 2.0), 4.0)),
        "the outer contour, edge 'base', crosses hole 1, edge 'cavity', at (-3.46",
    ),
    "hole touches": (
        lambda: bulb(circle((0.0, 2.0), 2.0)),
        "the outer contour, edge 'base', touches hole 1, edge 'cavity', at",
    ),
    "hole outside": (
        lambda: bulb(circle((20.0, 2.0), 2.0)),
        "hole 1 (edge 'cavity', at (22, 2)) lies outside of the outer contour",
    ),
    "hole around": (
        lambda: bulb(circle((0.0, 7.0), 30.0)),
        "hole 1 (edge 'cavity', at (30, 7)) lies outside of the outer contour",
    ),
    "overlapping holes": (
        lambda: bulb(circle((0.0, 7.0), 2.0), circle((1.0, 7.0), 2.0, "other")),
        "hole 1, edge 'cavity', crosses hole 2, edge 'other', at (0.5",
    ),
    "hole in a hole": (
        lambda: bulb(circle((0.0, 7.0), 2.0), circle((0.0, 7.0), 1.0, "other")),
        "hole 2 (edge 'other', at (1, 7)) lies inside of hole 1",
    ),
    "the same hole twice": (
        lambda: bulb(circle((0.0, 7.0), 2.0), circle((0.0, 7.0), 2.0, "other")),
        "hole 1, edge 'cavity', touches hole 2, edge 'other', at",
    ),
    "an edge on two contours": (
        lambda: bulb(circle((0.0, 7.0), 2.0, "seal")),
        "the edge 'seal' is on the outer contour and on hole 1",
    ),
    "an edge in two places": (
        lambda: Outline(Contour([
            replace(s, edge=name)
            for s, name in zip(lines(SQUARE).segments, ["a", "b", "a", "c"], strict=True)
        ])),
        "the edge 'a' is in two parts on the outer contour; an edge must be one connected part",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_a_section_is_refused_in_one_line(name):
    make, words = BAD[name]
    with pytest.raises(GeometryError, match=re.escape(words)) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_thin_but_sound_sections_are_taken():
    """A slit of 0.1, and a fillet much smaller than the section."""
    slit = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (2.0, 5.0), (2.0, 5.1), (10.0, 5.1), (10.0, 9.0),
            (0.0, 9.0)]  # fmt: skip
    assert Outline(lines(slit)).area == pytest.approx(90.0 - 0.8)
    small = Arc((9.99, 0.01), 0.01, -0.5 * np.pi, 0.5 * np.pi, "a")
    sides = [
        Line((0.0, 0.0), (9.99, 0.0), "a"), small, Line((10.0, 0.01), (10.0, 9.0), "a"),
        Line((10.0, 9.0), (0.0, 0.0), "a"),
    ]  # fmt: skip
    assert Outline(Contour(sides)).area == pytest.approx(45.0 - 0.01**2 * (1.0 - np.pi / 4))
