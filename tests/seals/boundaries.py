"""Boundaries of sections for clouds, written down without the drawing's own geometry."""

from typing import NamedTuple

import numpy as np


class Boundary(NamedTuple):
    """Points of a loop, the edge of the side after each, arc length and tangents before and after."""

    points: np.ndarray
    edge: np.ndarray
    arc_length: np.ndarray
    length: float
    tangent: np.ndarray


def line(edge, start, end):
    start, along = np.array(start, float), np.subtract(end, start)
    size = np.hypot(*along)
    return edge, size, lambda t: (start + t[:, None] * along, np.tile(along / size, (t.size, 1)))


def arc(edge, centre, radius, first, last):
    def at(t):
        angle = first + t * (last - first)
        outward = np.column_stack([np.cos(angle), np.sin(angle)])
        turned = np.column_stack([-outward[:, 1], outward[:, 0]]) * np.sign(last - first)
        return np.array(centre) + radius * outward, turned

    return edge, radius * abs(last - first), at


def boundary(pieces, spacing):
    """Points at ``spacing`` at the most, an even number of sides on every piece."""
    points, edges, arcs, before, after, start = [], [], [], [], [], 0.0
    last = pieces[-1][2](np.array([1.0]))[1][0]
    for edge, length, at in pieces:
        count = 2 * int(np.ceil(length / (2 * spacing) - 1e-9))
        t = np.arange(count) / count
        x, tangent = at(t)
        points.append(x)
        edges += [edge] * count
        arcs.append(start + t * length)
        after.append(tangent)
        before.append(np.vstack([last, tangent[1:]]))
        last, start = at(np.array([1.0]))[1][0], start + length
    tangents = np.stack([np.concatenate(before), np.concatenate(after)], axis=1)
    return Boundary(np.concatenate(points), np.array(edges), np.concatenate(arcs), start, tangents)


def paper_ring(spacing):
    """The ring of the paper's seal: a flat base with straight flanks, a round hole."""
    d0 = 3 * 2 * np.pi / 58
    right = 9.5 * np.array([np.tan(d0), -1.0])
    touch = 9.5 * np.array([np.sin(2 * d0), -np.cos(2 * d0)])
    mirror = np.array([-1.0, 1.0])
    first = np.arctan2(touch[1], touch[0])
    outer = [
        line("base", right * mirror, right),
        line("outer", right, touch),
        arc("outer", (0.0, 0.0), 9.5, first, np.pi - first),
        line("outer", touch * mirror, right * mirror),
    ]
    hole = [arc("cavity", (0.0, 0.0), 7.5, 1.5 * np.pi, -0.5 * np.pi)]
    return [boundary(outer, spacing), boundary(hole, spacing)]


def polygon(corners, spacing, names=None):
    """A loop of straight edges, called after their numbers unless named."""
    names = names or [str(k) for k in range(len(corners))]
    ends = zip(names, corners, np.roll(corners, -1, axis=0), strict=True)
    return boundary([line(*piece) for piece in ends], spacing)


def circle(edge, centre, radius, spacing, hole=False):
    turn = -2 * np.pi if hole else 2 * np.pi
    return boundary([arc(edge, centre, radius, 0.0, turn)], spacing)
