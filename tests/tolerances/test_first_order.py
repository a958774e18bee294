"""The estimate from the gradient against samples of small tolerances."""

from dataclasses import replace

import numpy as np
import pytest

from seal_mdao.distributions import Normal
from seal_mdao.tolerances.boundary_errors import BoundaryTolerance
from seal_mdao.tolerances.statistics import described, rank_correlations
from seal_mdao.tolerances.tolerance_set import Tolerances
from seal_mdao.tolerances.tolerance_study import ToleranceStudy


def tolerances_of(tolerances, size):
    """The same with normal distributions of a share of the width."""
    scattered = tuple(
        replace(t, distribution=Normal(mean, size * std))
        for t, mean, std in zip(
            tolerances.scattered, tolerances.means, tolerances.deviations, strict=True
        )
    )
    return Tolerances(scattered, BoundaryTolerance(size * 0.02, 8.0))


def test_the_error_of_the_estimate_falls_with_the_square(seal, tolerances, tmp_path):
    """Four samples in each size: what is left is second order, so a quarter of the tolerances leaves a
    sixteenth; contact states that change make it less, so an eighth is asked for."""
    errors = []
    for size in (0.2, 0.05):
        study = ToleranceStudy(seal, tolerances_of(tolerances, size), ("reaction", "stress_norm"))
        sampled = study.run(tmp_path / f"{size}.sqlite", 4)
        estimate = study.first_order()
        linear = estimate.at(sampled.scenarios)
        away = np.abs(sampled.values - estimate.values).max(axis=0)
        errors.append(np.abs(linear - sampled.values).max(axis=0))
        assert np.all(errors[-1] < 0.2 * away)
    assert np.all(errors[1] < errors[0] / 8.0)


def test_the_deviation_is_that_of_the_linear_function(seal, tolerances):
    """Variances by the formula, and of many samples of the linear function itself."""
    study = ToleranceStudy(seal, tolerances, ("reaction", "stress_norm"))
    estimate = study.first_order()
    linear = estimate.at(tolerances.samples(seal, 4096))
    np.testing.assert_allclose(linear.std(axis=0), estimate.std, rtol=0.03)
    away = np.abs(linear.mean(axis=0) - estimate.values)
    assert np.all(away < 3.0 / np.sqrt(4096) * estimate.std)
    assert estimate.variances.shape == (3, 4)
    assert np.all(estimate.variances[1, 1:] > 0.0)  # all sticks: friction does nothing


def test_rank_correlations_are_those_of_scipy(rng):
    from scipy.stats import spearmanr

    x, y = rng.normal(size=(50, 3)), rng.normal(size=(50, 2))
    y[:, 0] += x[:, 1] ** 3
    found = rank_correlations(x, y)
    both = spearmanr(np.hstack([x, y])).statistic
    np.testing.assert_allclose(found, both[3:, :3], atol=1e-12)
    assert rank_correlations(np.ones((5, 1)), x[:5, :1])[0, 0] == 0.0


def test_described_values(rng):
    values = rng.normal(size=101)
    found = described(values)
    assert found["q50"] == np.median(values)
    assert found["std"] == pytest.approx(values.std(ddof=1))
    assert list(found)[:4] == ["mean", "std", "lowest", "highest"]
    assert described(values[:1])["std"] == 0.0
