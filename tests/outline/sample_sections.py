"""Sections that the tests of this folder and of the seal file share."""

from seal_mdao.seals.outline.contours import Arc, Circle, Contour, Line, Outline, Spline


def lines(points, edge="seal"):
    """A closed polygon of one edge."""
    following = [*points[1:], points[0]]
    return Contour([Line(a, b, edge) for a, b in zip(points, following, strict=True)])


def circle(centre, radius, edge="cavity", **way):
    return Contour([Circle(centre, radius, edge, **way)])


def bulb(*holes):
    """A flat base under an arc."""
    arc = Arc.through((4.0, 0.0), (0.0, 14.0), (-4.0, 0.0), "seal")
    return Outline(Contour([Line((-4.0, 0.0), (4.0, 0.0), "base"), arc]), holes)


def mixed():
    """Every kind of segment: lines, an arc, splines open and closed, a circle."""
    outer = [
        Line((-5.0, 0.0), (5.0, 0.0), "base"),
        Arc.through((5.0, 0.0), (7.0, 2.0), (5.0, 4.0), "side"),
        Spline([(5.0, 4.0), (3.0, 9.0), (0.3, 10.0), (-3.0, 8.0), (-5.0, 4.0)], "top"),
        Line((-5.0, 4.0), (-5.0, 0.0), "side 2"),
    ]
    oval = [(-2.5, 5.0), (-1.5, 6.5), (0.0, 7.0), (1.0, 6.0), (-1.0, 4.5), (-2.5, 5.0)]
    return Outline(Contour(outer), [circle((3.0, 3.0), 1.5), Contour([Spline(oval, "oval")])])
