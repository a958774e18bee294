"""Names of the edges of a boundary without named edges: every part between two corners is an
edge."""

from dataclasses import replace
from math import radians

import numpy as np

from seal_mdao.seals.outline.contours import Contour, Outline

CORNER = np.cos(radians(20.0))
"""Cosine of the least angle of a corner."""
FLAT = 1e-6
"""Largest difference of heights of a level edge, over the size of the section."""


def named_by_corners(outline: Outline) -> Outline:
    """Name the edges of a section from corner to corner.

    The lowest edge of the outer contour is ``base``; the others are ``edge_1``, ``edge_2``, ...
    counter-clockwise from there. Every hole is one edge, ``hole_1``, ...; further bodies have
    ``body_2_edge_1``, ...

    Parameters
    ----------
    outline : Outline
        Its names need not be those of connected parts.

    Returns
    -------
    Outline
    """
    outer = _between_corners(outline.outer, "edge", base=True)
    holes = tuple(
        _renamed(hole.segments, [f"hole_{number}"] * len(hole.segments))
        for number, hole in enumerate(outline.holes, 1)
    )
    bodies = tuple(
        _between_corners(body, f"body_{number}_edge", base=False)
        for number, body in enumerate(outline.others, 2)
    )
    return Outline(outer, holes, bodies)


def _between_corners(contour: Contour, name: str, base: bool) -> Contour:
    """Name the segments of a contour by the part between corners that they belong to."""
    segments = contour.segments
    # t_end . t_start < cos of the least angle at the beginning of a segment
    ends = [segments[i - 1].tangents([1.0])[0] for i in range(len(segments))]
    starts = [segment.tangents([0.0])[0] for segment in segments]
    corners = [i for i, (a, b) in enumerate(zip(ends, starts, strict=True)) if a @ b < CORNER]
    first = corners[0] if corners else 0
    order = [(first + i) % len(segments) for i in range(len(segments))]
    part = np.cumsum([i in corners and i != first for i in order])
    segments = [segments[i] for i in order]
    lowest = _lowest(segments, part) if base else None
    # counted from the lowest part on
    count, begin = part[-1] + 1, 0 if lowest is None else lowest + 1
    names = ["base" if p == lowest else f"{name}_{(p - begin) % count + 1}" for p in part.tolist()]
    # the contour begins with the lowest part
    shift = 0 if lowest is None else int(np.argmax(part == lowest))
    return _renamed(segments[shift:] + segments[:shift], names[shift:] + names[:shift])


def _lowest(segments, part) -> int:
    """Find the part whose highest point is lowest; of several the longest."""
    heights, lengths = np.full(part[-1] + 1, -np.inf), np.zeros(part[-1] + 1)
    for segment, own in zip(segments, part, strict=True):
        highest = segment.points(np.linspace(0.0, 1.0, 17))[:, 1].max()
        heights[own] = max(heights[own], highest)
        lengths[own] += segment.length
    level = heights <= heights.min() + FLAT * lengths.sum()
    return int(np.argmax(np.where(level, lengths, -1.0)))


def _renamed(segments, names) -> Contour:
    return Contour(tuple(replace(s, edge=n) for s, n in zip(segments, names, strict=True)))
