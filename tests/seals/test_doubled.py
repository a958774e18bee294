"""Points in the middle of the sides of a boundary, on the curve itself."""

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from seal_mdao.seals.outline.sampling import doubled


class Sampled(NamedTuple):
    points: np.ndarray
    edge: np.ndarray
    segment: np.ndarray
    corner: np.ndarray
    arc_length: np.ndarray
    length: float
    tangent: np.ndarray


class Diameter:
    """From (1, 0) to (-1, 0)."""

    length, edge = 2.0, "line"

    def points(self, s):
        return np.column_stack([1.0 - 2.0 * np.asarray(s), np.zeros(len(s))])

    def tangents(self, s):
        return np.tile([-1.0, 0.0], (len(s), 1))


class HalfCircle:
    """From (-1, 0) below the origin to (1, 0)."""

    length, edge = np.pi, "arc"

    def points(self, s):
        angle = np.pi * (1.0 + np.asarray(s))
        return np.column_stack([np.cos(angle), np.sin(angle)])

    def tangents(self, s):
        return self.points(s)[:, ::-1] * [-1.0, 1.0]


def test_half_disc():
    """The line in two sides, the arc in three."""
    line, arc = Diameter(), HalfCircle()
    arcs = np.concatenate([[0.0, 1.0], 2.0 + np.pi * np.arange(3) / 3])
    points = np.vstack([line.points([0.0, 0.5]), arc.points(np.arange(3) / 3)])
    after = np.vstack([line.tangents([0.0, 0.5]), arc.tangents(np.arange(3) / 3)])
    before = after.copy()
    before[0], before[2] = arc.tangents([1.0]), line.tangents([1.0])
    given = Sampled(
        points, np.array(["line"] * 2 + ["arc"] * 3), np.array([0, 0, 1, 1, 1]),
        np.array([True, False, True, False, False]), arcs, 2.0 + np.pi,
        np.stack([before, after], axis=1),
    )  # fmt: skip
    outline = SimpleNamespace(contours=(SimpleNamespace(segments=(line, arc)),))
    (found,) = doubled(outline, [given])
    assert np.array_equal(found.points[::2], points)
    assert np.array_equal(found.tangent[::2], given.tangent)
    assert found.edge.tolist() == ["line"] * 4 + ["arc"] * 6
    assert np.flatnonzero(found.corner).tolist() == [0, 4]
    np.testing.assert_allclose(found.points[1:4:2], line.points([0.25, 0.75]), atol=1e-15)
    np.testing.assert_allclose(found.points[5::2], arc.points(np.array([1, 3, 5]) / 6), atol=1e-15)
    np.testing.assert_allclose(found.tangent[5], np.tile(arc.tangents([1 / 6]), (2, 1)), atol=1e-15)
    np.testing.assert_allclose(np.diff(found.arc_length)[4:], np.pi / 6, rtol=1e-13)
