"""Clouds: cells that tile the section, walls with three particles across, the same bits again."""

import sys

import numpy as np
import pytest
from boundaries import circle, paper_ring, polygon

from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.measures.section_shape import cells_area
from seal_mdao.rkpm.cells import cell_map, quadrature_weights
from seal_mdao.seals.outline.contours import Arc, Contour, Line, Outline, sampled
from seal_mdao.seals.outline.design import harmonic_extension
from seal_mdao.seals.outline.layers import thin_wall
from seal_mdao.seals.outline.quadrilaterals import corner_angles, paired
from seal_mdao.seals.outline.sampling import doubled
from seal_mdao.seals.outline.section_cloud import (
    cloud,
    graded,
    longest_side,
    wall_spacing,
    wall_thickness,
)

pytest.importorskip("netgen")

BLOCK = [[0.0, 0.0], [8.0, 0.0], [8.0, 5.0], [0.0, 5.0]]


def loops(boundaries):
    return [boundary.points for boundary in boundaries]


def sections(spacing):
    return {
        "ring": paper_ring(spacing),
        "solid": [circle("rim", (0.0, 0.0), 4.0, spacing)],
        "two holes": [
            polygon(BLOCK, spacing), circle("left", (2.0, 2.5), 1.2, min(spacing, 0.5), hole=True),
            circle("right", (5.5, 2.0), 1.4, min(spacing, 0.5), hole=True),
        ],
        "corner": [polygon([[0, 0], [9, 0], [9, 2], [2, 2], [2, 7], [0, 7]], spacing)],
    }  # fmt: skip


@pytest.mark.parametrize("spacing", [0.9, 0.4])
@pytest.mark.parametrize("name", ["ring", "solid", "two holes", "corner"])
def test_cells_tile_the_section(name, spacing):
    given = loops(sections(spacing)[name])
    filled = cloud(given, spacing)
    rim = np.concatenate(given)
    assert np.array_equal(filled.particles[: len(rim)], rim)
    assert np.array_equal(np.concatenate(filled.loops), np.arange(filled.n_boundary))
    assert np.array_equal(np.unique(filled.cells), np.arange(len(filled.particles)))
    assert (quadrature_weights(cell_map(filled.cells), filled.particles) > 0.0).all()
    exact = sum(polygon_area(loop)[0] for loop in given)
    area, _ = cells_area(filled.cells, filled.particles)
    assert area == pytest.approx(exact, rel=1e-12)
    sides = np.stack([filled.cells, np.roll(filled.cells, -1, axis=1)], axis=2).reshape(-1, 2)
    length = np.hypot(*np.diff(filled.particles[sides], axis=1)[:, 0].T)
    assert length.max() < 1.5 * spacing
    angles = corner_angles(filled.particles[filled.cells])
    assert angles.min() > 25.0
    assert angles.max() < 165.0


def test_the_same_input_gives_the_same_bits():
    given = loops(sections(0.5)["two holes"])
    one, other = cloud(given, 0.5), cloud(given, 0.5)
    assert np.array_equal(one.particles, other.particles)
    assert np.array_equal(one.cells, other.cells)


@pytest.mark.parametrize("thickness", [2.0, 0.5, 0.2])
def test_no_wall_has_fewer_than_three_particles_across(thickness):
    """Every way through a wall has a particle inside: no side of a cell joins its two faces."""

    def boundaries(at):
        inner = circle("in", (0.0, 0.0), 5.0 - thickness, at, hole=True)
        return [circle("out", (0.0, 0.0), 5.0, at), inner]

    fine = loops(boundaries(0.1))
    spacing = float(wall_spacing(fine, 0.9, 3)(fine[0]).min())
    assert spacing == pytest.approx(min(0.9, max(0.5 * thickness, 0.15)), rel=0.02)
    filled = cloud(loops(boundaries(spacing)), 0.9)
    outside = np.isin(np.arange(len(filled.particles)), filled.loops[0])
    inside = np.isin(np.arange(len(filled.particles)), filled.loops[1])
    sides = np.stack([filled.cells, np.roll(filled.cells, -1, axis=1)], axis=2).reshape(-1, 2)
    assert not (outside[sides].any(axis=1) & inside[sides].any(axis=1)).any()


def test_spacing_grows_away_from_a_thin_wall():
    """A lip 0.6 thick on a block: fine at the lip, as wanted far from it, no faster than a quarter."""
    corners = [[0, 0], [8, 0], [8, 2.2], [12, 2.2], [12, 2.8], [8, 2.8], [8, 5], [0, 5]]
    fine = loops([polygon(np.array(corners, float), 0.1)])
    at = wall_spacing(fine, 0.9, 3)
    # in the middle of the lip, a quarter of the way from its faces
    assert at([[11.0, 2.2]])[0] == pytest.approx(0.3, rel=0.05)
    assert at([[0.0, 2.5]])[0] == 0.9
    along = np.column_stack([np.linspace(0.0, 12.0, 200), np.full(200, 2.5)])
    assert np.abs(np.diff(at(along))).max() <= 0.25 * 12.0 / 199 * 1.001


@pytest.mark.parametrize("thickness", [0.5, 2.0, 2.5, 3.2])
def test_spacing_is_the_largest_distance(thickness):
    """Walls that two cells fill only if they are long get more of them."""

    def sample(at):
        out, inner = (circle("rim", (0.0, 0.0), r, 0.1).points for r in (8.0, 8.0 - thickness))
        return [
            circle("out", (0.0, 0.0), 8.0, float(at(out).min())),
            circle("in", (0.0, 0.0), 8.0 - thickness, float(at(inner).min()), hole=True),
        ]

    boundaries, spacing = graded(sample, 0.9)
    filled = cloud(loops(boundaries), spacing)
    assert longest_side(filled.cells, filled.particles) <= 1.25 * 0.9
    assert spacing >= 0.6 * 0.9


@pytest.mark.parametrize("spacing", [0.5, 0.9, 1.3])
@pytest.mark.parametrize("radius", [0.1, 0.5])
def test_sides_grow_slowly_from_fillets(radius, spacing):
    """A quarter of a circle has two cells at least, however small: those beside it follow."""
    outline = Outline(Contour([
        Line([0.0, 0.0], [10.0, 0.0], "base"), Line([10.0, 0.0], [10.0, 4.0 - radius], "side"),
        Arc([10.0 - radius, 4.0 - radius], radius, 0.0, 0.5 * np.pi, "top"),
        Line([10.0 - radius, 4.0], [0.0, 4.0], "top"), Line([0.0, 4.0], [0.0, 0.0], "left"),
    ]))  # fmt: skip

    def sample(at):
        return doubled(outline, sampled(outline, lambda places: 2.0 * at(places)))

    (boundary,), chosen = graded(sample, spacing)
    filled = cloud([boundary.points], chosen)
    assert longest_side(filled.cells, filled.particles) <= 1.25 * spacing
    length = np.hypot(*(np.roll(boundary.points, -1, axis=0) - boundary.points).T)
    assert length.min() < 0.6 * radius
    # the side of a cell beside one with a growth of a quarter of the distance between their middles
    following = np.roll(length[::2], -1)
    assert (np.maximum(length[::2] / following, following / length[::2]) < 1.8).all()


def ring_sample(thickness):
    """Boundaries of a ring by the spacing at them."""

    def sample(at):
        out, inner = (circle("rim", (0.0, 0.0), r, 0.1).points for r in (8.0, 8.0 - thickness))
        return [
            circle("out", (0.0, 0.0), 8.0, float(at(out).min())),
            circle("in", (0.0, 0.0), 8.0 - thickness, float(at(inner).min()), hole=True),
        ]

    return sample


@pytest.mark.parametrize("layers", [3, 5, 7])
@pytest.mark.parametrize("thickness", [1.0, 1.4])
def test_walls_have_as_many_layers_as_are_wanted(layers, thickness):
    """Particles counted in a narrow sector, and as the warning counts them."""
    boundaries, spacing = graded(ring_sample(thickness), 0.9, layers=layers)
    filled = cloud(loops(boundaries), spacing)
    radius = np.hypot(*filled.particles.T)
    # between both rims a circle in every layer is crossed by sides of cells
    inside = 8.0 - thickness + np.arange(1, layers - 1) * thickness / (layers - 1)
    step = 0.55 * thickness / (layers - 1)
    assert all((np.abs(radius - r) < step).any() for r in inside)
    assert thin_wall(filled.loops, filled.particles, filled.cells, layers) is None
    few = thin_wall(filled.loops, filled.particles, filled.cells, 2 * layers)
    assert layers - 1 <= few.layers < 2 * layers
    assert few.thickness == pytest.approx(thickness, rel=0.02)


def test_a_wall_of_two_cells_is_too_thin():
    """1.7 mm thick, with a spacing of 0.9 mm: the force is nine percent too large."""
    boundaries, spacing = graded(ring_sample(1.7), 0.9, layers=3)
    filled = cloud(loops(boundaries), spacing)
    assert thin_wall(filled.loops, filled.particles, filled.cells).layers == 3
    boundaries, spacing = graded(ring_sample(1.7), 0.9, layers=5)
    filled = cloud(loops(boundaries), spacing)
    assert thin_wall(filled.loops, filled.particles, filled.cells) is None


def test_solid_sections_and_corners_have_no_thin_walls():
    for spacing in (0.9, 0.5):
        filled = cloud([circle("rim", (0.0, 0.0), 4.0, spacing).points], spacing)
        assert thin_wall(filled.loops, filled.particles, filled.cells) is None
        filled = cloud([polygon(np.array(BLOCK), spacing).points], spacing)
        assert thin_wall(filled.loops, filled.particles, filled.cells) is None


def test_thickness_of_a_ring():
    (outer, inner) = wall_thickness(loops([
        circle("out", (0.0, 0.0), 5.0, 0.1), circle("in", (0.0, 0.0), 3.0, 0.1, hole=True)
    ]))  # fmt: skip
    np.testing.assert_allclose(outer, 2.0, atol=0.01)
    np.testing.assert_allclose(inner, 2.0, atol=0.01)


def test_what_cannot_be_filled_is_refused():
    square = polygon(np.array(BLOCK), 0.5).points
    with pytest.raises(ValueError, match=r"\(loop\) 0 must have shape \(2 k, 2\)"):
        cloud([square[:-1]], 0.5)
    with pytest.raises(ValueError, match="spacing must be a positive number"):
        cloud([square], -1.0)
    with pytest.raises(ValueError, match=r"\(loop\) 0 has the wrong direction"):
        cloud([square[::-1]], 0.5)
    with pytest.raises(ValueError, match=r"\(loop\) 1 has the wrong direction"):
        cloud([square, 0.2 * square + 1.0], 0.5)


def test_pairs_are_convex_and_nothing_is_lost():
    points = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [3, 0.5]], float)
    triangles = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 6, 5]])
    cells, _ = paired(points, triangles, np.zeros(len(triangles), int))
    assert sorted(len(set(cell)) for cell in cells.tolist()) == [3, 4, 4]
    assert cells_area(cells, points)[0] == pytest.approx(2.5)


def test_linear_fields_extend_to_themselves():
    filled = cloud(loops(sections(0.9)["two holes"]), 0.9)
    slope, x = np.array([[0.3, -0.2], [0.5, 0.1]]), filled.particles
    boundary = np.arange(filled.n_boundary)
    found = harmonic_extension(filled.cells, x, boundary, (x[boundary] @ slope)[None] + 0.7)
    np.testing.assert_allclose(found[0], x @ slope + 0.7, atol=1e-12)


def test_extension_converges_to_the_harmonic_field():
    """Re z^3 in a disc from its values at the rim: second order."""
    errors = []
    for spacing in (0.4, 0.2):
        filled = cloud(loops([circle("rim", (0.0, 0.0), 2.0, spacing)]), spacing)
        z = filled.particles @ np.array([1.0, 1.0j])
        exact = np.column_stack([(z**3).real, (z**3).imag])
        boundary = np.arange(filled.n_boundary)
        found = harmonic_extension(filled.cells, filled.particles, boundary, exact[None, boundary])
        errors.append(np.sqrt(np.mean((found[0] - exact) ** 2)))
    assert np.log2(errors[0] / errors[1]) > 1.6


def test_a_missing_mesher_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "netgen.geom2d", None)
    with pytest.raises(ImportError, match=r"pip install seal_mdao\[mesh\]"):
        cloud(loops(sections(0.9)["solid"]), 0.9)


@pytest.mark.parametrize("side", [0.3, 0.5, 1.0])
def test_spacing_is_smaller_beside_a_line_of_short_sides(side):
    """As that between two materials of an optimum, whose vertices are particles."""
    outline = Outline(Contour([
        Line([0.0, 0.0], [8.0, 0.0], "base"), Line([8.0, 0.0], [8.0, 2.0], "right"),
        Line([8.0, 2.0], [8.0, 5.0], "right"), Line([8.0, 5.0], [0.0, 5.0], "top"),
        Line([0.0, 5.0], [0.0, 2.0], "left"), Line([0.0, 2.0], [0.0, 0.0], "left"),
    ]))  # fmt: skip

    def sample(at):
        return doubled(outline, sampled(outline, lambda places: 2.0 * at(places)))

    x = np.linspace(8.0, 0.0, round(8.0 / side) + 1)
    cut = np.column_stack([x, 2.0 + 1e-4 * x * (8.0 - x)])
    boundaries, spacing = graded(sample, 0.9, [cut])
    filled = cloud(loops(boundaries), spacing, [cut])
    assert cells_area(filled.cells, filled.particles)[0] == pytest.approx(40.0)
    # the vertices of the line are particles
    away = np.hypot(*np.moveaxis(cut[:, None] - filled.particles, 2, 0)).min(axis=1)
    assert away.max() < 1e-9
