"""Boundary points for clouds: an even number of sides between corners."""

import numpy as np


def doubled(outline, boundaries) -> list:
    """Insert a point on the curve in the middle (arc length) of every side of the boundary.

    Parameters
    ----------
    outline : Outline
    boundaries : sequence of Boundary
        As ``sampled(outline, 2 * spacing)`` gives them; for ``cloud.graded``

            def sample(at):
                return doubled(outline, sampled(outline, lambda x: 2.0 * at(x)))
    """
    return [
        _doubled(contour.segments, boundary)
        for contour, boundary in zip(outline.contours, boundaries, strict=True)
    ]


def _doubled(segments, boundary):
    starts = np.concatenate([[0.0], np.cumsum([segment.length for segment in segments])])
    # middle of each side in arc length; the last side ends where the contour begins
    arc = boundary.arc_length
    middle = 0.5 * (arc + np.append(arc[1:], boundary.length))
    points, tangents = np.empty((arc.size, 2)), np.empty((arc.size, 2))
    for number, segment in enumerate(segments):
        here = boundary.segment == number
        s = (middle[here] - starts[number]) / segment.length
        points[here], tangents[here] = segment.points(s), segment.tangents(s)
    return boundary._replace(
        points=_between(boundary.points, points),
        edge=np.repeat(boundary.edge, 2),
        segment=np.repeat(boundary.segment, 2),
        corner=_between(boundary.corner, np.zeros(arc.size, bool)),
        arc_length=_between(arc, middle),
        tangent=_between(boundary.tangent, np.stack([tangents, tangents], axis=1)),
    )


def _between(values, others):
    # interleave: values at even indices, others at odd ones
    return np.stack([values, others], axis=1).reshape(2 * len(values), *values.shape[1:])
