"""Particles on arcs that are small beside the spacing."""

import numpy as np
import pytest

from seal_mdao.seals.file.build import boundaries_of
from seal_mdao.seals.outline.contours import Arc, Contour, Line, Outline
from seal_mdao.seals.outline.section_cloud import SLOPE


@pytest.mark.parametrize("radius", [1.0, 0.3])
def test_a_corner_of_the_size_of_the_spacing_has_particles_of_its_own(radius):
    """Spacing 1 mm: four sides of 22.5 degrees on a quarter; sides beside it grow from theirs."""
    spacing, corner = 1.0, Arc((5.0 - radius, 6.0 - radius), radius, 0.0, 0.5 * np.pi, "corner")
    points = [(-5.0, 0.0), (5.0, 0.0), tuple(corner.start), tuple(corner.end), (-5.0, 6.0)]
    lines = [Line(a, b, n) for a, b, n in (
        (points[0], points[1], "base"), (points[1], points[2], "right"),
        (points[3], points[4], "top"), (points[4], points[0], "left"),
    )]  # fmt: skip
    outline = Outline(Contour((*lines[:2], corner, *lines[2:])))
    pytest.importorskip("netgen")
    (boundary,), _ = boundaries_of(outline, spacing)
    sides = np.hypot(*(np.roll(boundary.points, -1, axis=0) - boundary.points).T)
    own = boundary.edge == "corner"
    assert own.sum() == 4
    np.testing.assert_allclose(sides[own], 2.0 * radius * np.sin(np.pi / 16.0), rtol=1e-9)
    # the size of neighbouring sides changes by the slope of the spacing at most, in pairs
    ratio = np.maximum(sides / np.roll(sides, 1), np.roll(sides, 1) / sides)
    assert ratio.max() < 1.0 + 2.0 * 2.0 * SLOPE
    assert sides.max() <= spacing * (1.0 + 1e-9)
