"""The nominal section, the particle ring on it, and its exact area."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.rkpm.cells import support_radii
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.door.section import RingGrid, Section
from seal_mdao.seals.wall_grid import ray_directions

SECTION = Section()
D0 = SECTION.base_angle


def outer_point(angle):
    return SECTION.outer(angle)[..., None] * ray_directions(angle)


def test_base_is_flat_and_as_wide_as_drawn():
    angle = np.linspace(-D0, D0, 21)
    points = outer_point(angle)
    np.testing.assert_allclose(points[:, 1], -9.5, rtol=1e-14)
    np.testing.assert_allclose(np.abs(points[[0, -1], 0]), 3.2009, atol=5e-5)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_flanks_are_straight_and_tangent_to_the_circle(side):
    angle = side * np.linspace(D0, 2 * D0, 15)
    points = outer_point(angle)
    along = np.diff(points, axis=0)
    cross = along[:-1, 0] * along[1:, 1] - along[:-1, 1] * along[1:, 0]
    np.testing.assert_allclose(cross, 0.0, atol=1e-14)
    # perpendicular to the radius where the circle begins
    end = ray_directions(np.array(2 * side * D0))
    direction = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
    assert direction @ end == pytest.approx(0.0, abs=1e-14)
    assert np.linalg.norm(points[-1]) == pytest.approx(9.5, rel=1e-14)


@pytest.mark.parametrize("angle", [D0, 2 * D0, 2 * np.pi - D0, 2 * np.pi - 2 * D0])
def test_outer_radius_is_continuous(angle):
    below, above = SECTION.outer(np.array([angle - 1e-10, angle + 1e-10]))
    assert below == pytest.approx(above, abs=1e-8)


def test_outer_radius_has_no_kink_where_the_circle_begins():
    h = 1e-6
    slope = (SECTION.outer(2 * D0) - SECTION.outer(2 * D0 - h)) / h
    assert slope == pytest.approx(0.0, abs=1e-5)
    assert SECTION.outer(np.array([2.5, np.pi, 4.0])) == pytest.approx(9.5, rel=1e-15)


def test_radii_are_even_and_periodic_in_the_angle(rng):
    angle = rng.uniform(0, 2 * np.pi, 50)
    np.testing.assert_allclose(SECTION.outer(-angle), SECTION.outer(angle), rtol=1e-13)
    np.testing.assert_allclose(SECTION.outer(angle + 2 * np.pi), SECTION.outer(angle), rtol=1e-13)
    np.testing.assert_array_equal(SECTION.inner(angle), 7.5)


def test_area_of_the_drawn_section():
    """R^2 (2 tan D0 + pi - 2 D0) - pi r^2 by integration by hand; 108.971 mm^2 in the example."""
    model = sm.door_seal()
    area, _ = options_of(model).splines.area(np.zeros(25))
    exact = 9.5**2 * (2 * np.tan(D0) + np.pi - 2 * D0) - np.pi * 7.5**2
    assert area == pytest.approx(exact, rel=1e-13)
    assert area == pytest.approx(108.971, abs=5e-4)


def test_area_of_a_design_is_that_of_a_fine_polygon(rng):
    model = sm.door_seal()
    offsets = rng.uniform(-0.5, 0.5, 25)
    angle = np.linspace(0.0, 2 * np.pi, 40001)
    outer = SECTION.outer(angle) + options_of(model).splines.outer_basis(angle) @ offsets[:14]
    inner = SECTION.inner(angle) + options_of(model).splines.inner_basis(angle) @ offsets[14:]
    areas = []
    for radius in (outer, inner):
        x, y = (radius[:, None] * ray_directions(angle)).T
        areas.append(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    found, _ = options_of(model).splines.area(offsets)
    assert found == pytest.approx(areas[0] - areas[1], rel=1e-7)


def test_area_gradient_is_exact(rng):
    """The area is quadratic in the offsets: central differences have no truncation error."""
    splines = options_of(sm.door_seal()).splines
    offsets = rng.uniform(-0.3, 0.3, 25)
    gradient = splines.area(offsets)[1]
    differences = [
        splines.area(offsets + e)[0] - splines.area(offsets - e)[0] for e in 0.05 * np.eye(25)
    ]
    np.testing.assert_allclose(gradient, np.array(differences) / 0.1, rtol=1e-10)


def test_uniform_inner_offset_moves_a_circle():
    splines = options_of(sm.door_seal()).splines
    offsets = np.concatenate([np.zeros(14), np.full(11, 0.3)])
    change = splines.area(offsets)[0] - splines.area(np.zeros(25))[0]
    assert change == pytest.approx(-np.pi * (7.8**2 - 7.5**2), rel=1e-12)


@pytest.mark.parametrize(("rays", "layers"), [(58, 3), (116, 5)])
def test_particle_ring(rays, layers):
    """Base corners, straight down, tangent points are particles; walls are divided evenly."""
    model = sm.door_seal(rays=rays, layers=layers)
    grid, x = options_of(model).grid, model.nominal_particles
    assert x.shape == (rays * layers, 2)
    base = x[grid.base]
    np.testing.assert_allclose(base[:, 1], -9.5, rtol=1e-14)
    np.testing.assert_allclose(base[[0, -1], 0], [-9.5 * np.tan(D0), 9.5 * np.tan(D0)], rtol=1e-13)
    assert len(grid.base) == 6 * rays // 58 + 1
    np.testing.assert_allclose(x[grid.particle(0, layers - 1)], [0.0, -9.5], atol=1e-14)
    np.testing.assert_allclose(x[grid.particle(rays // 2, layers - 1)], [0.0, 9.5], atol=1e-14)
    wall = np.linalg.norm(np.diff(x.reshape(rays, layers, 2), axis=1), axis=2)
    np.testing.assert_allclose(wall, wall[:, :1] + 0 * wall, rtol=1e-13)
    assert not np.isin(grid.free_outer, grid.base).any()
    assert len(grid.free_outer) + len(grid.base) == rays


def test_cells_tile_the_ring_counter_clockwise():
    model = sm.door_seal()
    cells, x = options_of(model).grid.cells, model.nominal_particles
    assert len(cells) == 58 * 2
    assert np.array_equal(np.unique(cells), np.arange(174))
    corners = x[cells]
    after = np.roll(corners, -1, axis=1)
    area = 0.5 * np.sum(corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0], axis=1)
    assert np.all(area > 0.0)


def test_particle_numbers_are_periodic_in_the_ray():
    grid = RingGrid(58, 3, 3)
    np.testing.assert_array_equal(grid.particle(-1, 2), grid.particle(57, 2))
    np.testing.assert_array_equal(grid.particle(58, 0), 0)


@pytest.mark.parametrize("rays", [58, 116])
@pytest.mark.parametrize("refinement", [2, 3])
def test_refined_ring_divides_the_intervals_of_its_upper_part(rays, refinement):
    even = options_of(sm.door_seal(rays=rays)).grid
    grid = options_of(sm.door_seal(rays=rays, refinement=refinement)).grid
    assert grid.angles.shape == (grid.rays,)
    for angle in even.angles:
        assert np.abs(grid.angles - angle).min() < 1e-14
    step = 2 * np.pi / rays
    intervals = np.diff(grid.angles, append=2 * np.pi)
    upper = np.abs(grid.angles + 0.5 * intervals - np.pi) < 10 / 29 * np.pi
    np.testing.assert_allclose(intervals[upper], step / refinement, rtol=1e-12)
    np.testing.assert_allclose(intervals[~upper], step, rtol=1e-12)


def test_refined_ring_has_the_base_of_the_even_one():
    even, refined = sm.door_seal(), sm.door_seal(refinement=3)
    np.testing.assert_allclose(
        *(seal.nominal_particles[options_of(seal).grid.base] for seal in (refined, even)),
        atol=1e-14,
    )


def test_support_is_measured_by_the_longest_edge_at_each_particle():
    model = sm.door_seal()
    radius = support_radii(options_of(model).grid.cells, model.nominal_particles, 2.0)
    x, longest = model.nominal_particles, np.zeros(174)
    for cell in options_of(model).grid.cells:
        for a, b in zip(cell, np.roll(cell, -1), strict=True):
            edge = np.linalg.norm(x[a] - x[b])
            longest[a], longest[b] = max(longest[a], edge), max(longest[b], edge)
    np.testing.assert_allclose(radius, 2.0 * longest, rtol=1e-14)


@pytest.mark.parametrize(
    "wrong",
    [{"inner_radius": 9.6}, {"inner_radius": 0.0}, {"base_angle": 0.0}, {"base_angle": 0.8},
     {"outer_radius": np.nan}],
)  # fmt: skip
def test_impossible_sections_are_refused(wrong):
    with pytest.raises(ValueError, match=r"radi|base_angle"):
        Section(**wrong)


@pytest.mark.parametrize("columns", [2, 3, 4, 7])
def test_fixed_particles_are_those_on_the_flat_base(columns):
    for rays in (58, 116):
        section = Section(base_angle=columns * 2 * np.pi / 58)
        seal = sm.door_seal(section=section, rays=rays)
        outer = seal.nominal_particles.reshape(rays, 3, 2)[:, -1]
        on_base = np.abs(outer[:, 1] + 9.5) < 1e-9
        assert on_base.sum() == 2 * columns * rays // 58 + 1
        np.testing.assert_array_equal(
            seal.body.fixed.reshape(rays, 3, 2)[:, -1].all(axis=1), on_base
        )


@pytest.mark.parametrize("angle", [0.2, 0.6, 0.05])
def test_base_that_ends_between_two_rays_is_refused(angle):
    with pytest.raises(
        ValueError, match=r"base_angle = .* multiple of the angle 2 pi / 58 between"
    ):
        sm.door_seal(section=Section(base_angle=angle))
