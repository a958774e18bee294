"""Samples have the distributions and the correlations that were asked for."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

import seal_mdao as sm
from seal_mdao.distributions import Normal, Triangular, Uniform
from seal_mdao.materials.hardness import hardness_factor, shore_modulus
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.profiles import contacts
from seal_mdao.tolerances.boundary_errors import (
    BoundaryTolerance,
    boundary_covariance,
    boundary_loops,
    square_root,
)
from seal_mdao.tolerances.placement import CLEARANCE, with_clearance
from seal_mdao.tolerances.tolerance_set import METHODS, Tolerances

COUNT = 4096
EXACT = {
    Uniform(2.0, 5.0): (3.5, 3.0 / np.sqrt(12.0)),
    Triangular(0.0, 1.0, 3.0): (4.0 / 3.0, np.sqrt(7.0 / 18.0)),
    # the variance of a normal distribution cut at 3: 1 - 6 phi(3) / (2 Phi(3) - 1)
    Normal(1.0, 0.5): (1.0, 0.5 * np.sqrt(1.0 - 6.0 * stats.norm.pdf(3.0) / 0.9973002039367398)),
}


@pytest.mark.parametrize("distribution", EXACT, ids=lambda d: type(d).__name__)
def test_moments_are_those_of_the_text_books(distribution):
    found = distribution.scipy.mean(), distribution.scipy.std()
    assert found == pytest.approx(EXACT[distribution], rel=1e-9)
    shares = (np.arange(COUNT) + 0.5) / COUNT
    numbers = distribution.scipy.ppf(shares)
    assert np.all(np.diff(numbers) > 0.0)
    # of midpoints: the error falls faster than their number
    assert numbers.mean() == pytest.approx(EXACT[distribution][0], rel=1e-3)
    assert numbers.std() == pytest.approx(EXACT[distribution][1], rel=1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_samples_keep_to_their_tolerances(seal, tolerances, method):
    made = tolerances.samples(seal, COUNT, method)
    means, deviations = tolerances.means, tolerances.deviations
    np.testing.assert_allclose(made.numbers.mean(axis=0), means, atol=0.02 * deviations.max())
    np.testing.assert_allclose(made.numbers.std(axis=0), deviations, rtol=0.02)
    numbers = np.corrcoef(made.numbers.T)
    assert np.abs(numbers - np.eye(3)).max() < 3.0 / np.sqrt(COUNT)
    exact = tolerances.offsets_covariance(seal)
    found = np.cov(made.offsets.T)
    # four standard errors of a covariance of two normal numbers
    allowed = 4.0 * np.sqrt(2.0 / COUNT) * exact.diagonal().max()
    assert np.abs(found - exact).max() < allowed


def test_the_same_seed_gives_the_same_samples(seal, tolerances):
    first, again, other = (tolerances.samples(seal, 20, seed=seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first.numbers, again.numbers)
    np.testing.assert_array_equal(first.offsets, again.offsets)
    assert not np.array_equal(first.numbers, other.numbers)


def test_the_boundary_has_its_error_and_its_correlation():
    """Of the moved particles: mean square, and the correlation of neighbours along the arc."""
    seal, tolerance = sm.door_seal(), BoundaryTolerance(0.1, 8.0)
    covariance = boundary_covariance(seal, tolerance)
    assert np.linalg.eigvalsh(covariance).min() > -1e-12 * np.trace(covariance)
    velocity = seal.design_velocity
    for loop in boundary_loops(seal):
        moved = velocity[:, loop]
        if np.abs(moved).max() == 0.0:
            continue
        square = np.einsum("pni,pq,qni->n", moved, covariance, moved)
        free = np.abs(moved).max(axis=(0, 2)) > 0.0
        assert square[free].mean() == pytest.approx(0.1**2, rel=1e-9)
    root = square_root(covariance)
    np.testing.assert_allclose(root @ root, covariance, atol=1e-9 * covariance.max())


def test_correlation_falls_as_a_gaussian_of_the_distance():
    """Its logarithm: four times at twice the distance, but for the chords (1 % and 3 % shorter than the
    arcs of 4 and 8 mm around 60 mm); a quarter at twice the length."""
    seal = sm.door_seal()
    logs = {}
    for length in (4.0, 8.0):
        c = boundary_covariance(seal, BoundaryTolerance(0.1, length))
        correlation = c / np.sqrt(np.outer(c.diagonal(), c.diagonal()))
        logs[length] = np.log(correlation[5, 6]), np.log(correlation[5, 7])
    assert logs[8.0][0] == pytest.approx(logs[4.0][0] / 4.0, rel=1e-9)
    assert 3.7 < logs[8.0][1] / logs[8.0][0] < 4.0


def test_correlation_of_single_particles_is_exact():
    """Offsets that move one particle each, at unequal distances around a square of side 6:
    exp(-c^2 / 2 length^2), c = 24 / pi sin(pi s / 24)."""
    sides = [[1.0, 2.0, 3.0], [2.0, 4.0], [1.0, 5.0], [3.0, 1.0, 2.0]]
    along = np.cumsum([0.0, *(piece for side in sides for piece in side)])[:-1]
    corners = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 6.0], [0.0, 6.0], [0.0, 0.0]])
    at = [np.interp(along, 6.0 * np.arange(5), column) for column in corners.T]
    particles, n = np.vstack([np.column_stack(at), [[3.0, 3.0]]]), along.size
    ring = np.column_stack([np.arange(n), np.roll(np.arange(n), -1)])
    cells = np.column_stack([ring, np.full((n, 2), n)])
    velocity = np.zeros((n, n + 1, 2))
    velocity[np.arange(n), np.arange(n)] = [0.6, 0.8]
    seal = SimpleNamespace(
        body=SimpleNamespace(cells=cells), nominal_particles=particles, design_velocity=velocity
    )
    found = boundary_covariance(seal, BoundaryTolerance(0.1, 4.0))
    chord = 24.0 / np.pi * np.sin(np.pi / 24.0 * (along[:, None] - along))
    np.testing.assert_allclose(found, 0.1**2 * np.exp(-0.5 * (chord / 4.0) ** 2), rtol=1e-12)


@pytest.mark.parametrize("probability", [0.0, 1.0])
def test_samples_at_the_ends_of_a_distribution_are_finite(
    seal, tolerances, monkeypatch, probability
):
    """A number drawn in [0, 1) may be zero, where a normal distribution is infinite."""
    monkeypatch.setattr(
        "seal_mdao.tolerances.tolerance_set._unit_samples",
        lambda dimensions, count, *_: np.full((count, dimensions), probability),
    )
    made = tolerances.samples(seal, 2)
    assert np.isfinite(made.numbers).all()
    assert np.isfinite(made.offsets).all()


def test_clearances_are_added_to_those_of_the_profiles():
    """Along the travel of the door, which is vertical."""
    seal = sm.door_seal().with_clearances({"door": (0.0, 0.25)})
    (contact,) = contacts(with_clearance(seal))
    np.testing.assert_array_equal(contact.motion.clearance, [0.0, 0.25 + CLEARANCE])


def test_inner_and_outer_boundary_are_extruded_apart():
    seal = sm.door_seal()
    covariance = boundary_covariance(seal, BoundaryTolerance(0.1, 8.0))
    outer = options_of(seal).outer_parameters
    assert np.abs(covariance[:outer, outer:]).max() == 0.0
    assert np.diagonal(covariance).min() > 0.0


def test_without_a_boundary_only_numbers_vary(seal, tolerances):
    bare = Tolerances(tolerances.scattered)
    made = bare.samples(seal, 8)
    assert made.numbers.shape == (8, 3)
    assert not made.offsets.any()
    with pytest.raises(ValueError, match=r"the set of manufacturing tolerances is empty; add a"):
        Tolerances(()).samples(seal, 8)


def test_hardness_after_gent():
    """E(50 Shore A) of Gent's formula is 2.46 MPa; five Shore are a fifth of it."""
    assert shore_modulus(50.0) == pytest.approx(2455.0, rel=2e-3)
    assert hardness_factor(50.0, 5.0) == pytest.approx(1.208, abs=1e-3)
    with pytest.raises(ValueError, match="Shore hardness"):
        shore_modulus(10.0)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Uniform(1.0, 1.0), "high"),
        (lambda: Normal(0.0, 0.0), "std"),
        (lambda: Triangular(0.0, 2.0, 1.0), "likely"),
        (lambda: BoundaryTolerance(0.1, 0.0), "length"),
    ],
)
def test_impossible_distributions_are_refused(make, match):
    with pytest.raises(ValueError, match=match):
        make()
