"""Walls of a section between named edges."""

import numpy as np
import shapely

MEETING = 1e-9
"""Distance of edges that meet, over the size of the section."""


def fault_of_wall(outline, edges, opposite) -> str:
    """Describe why two groups of edges do not enclose a wall; empty if they do.

    The straight line where they are nearest to each other has to lie in the material.
    """
    lines = [_lines(outline, names) for names in (edges, opposite)]
    shortest = shapely.shortest_line(*lines)
    if shapely.length(shortest) <= MEETING * outline.size:
        return "share a point, where the thickness is zero; name edges that do not meet"
    # even number of contours around a point: outside, or in a hole; one on a contour is within it, where
    # the edge between two parallel ones is itself the nearest line
    middle = shapely.line_interpolate_point(shortest, 0.5, normalized=True)
    polygons = np.array([shapely.polygons(own) for own in outline.polyline()])
    around = shapely.dwithin(polygons, middle, MEETING * outline.size)
    if around.sum() % 2 == 0:
        return "face each other across a gap instead of across rubber; name the two sides of a wall"
    return ""


def _lines(outline, names):
    """Straight sides along edges, within the tolerance of the section's polygons."""
    # points of a contour's sides, and the index of the segment of each
    parts = []
    for points, segments, labels in outline.labelled(outline.size * 1e-5):
        ends = np.stack([points, np.roll(points, -1, axis=0)], axis=1)
        parts += list(ends[np.isin(np.array(labels)[segments], names)])
    return shapely.multilinestrings(shapely.linestrings(np.array(parts)))
