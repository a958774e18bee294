"""Statistics of samples of which some are infinite, such as leak rates without contact."""

import numpy as np
import pytest

from seal_mdao.cli.study import statistics_text
from seal_mdao.tolerances.statistics import described, quantiles

pytestmark = pytest.mark.filterwarnings("error")


def test_quantiles_are_infinite_above_the_last_finite_sample():
    values = np.array([3.0, np.inf, 1.0, 2.0, np.inf])
    found = quantiles(values, (0.0, 0.25, 0.375, 0.5, 0.51, 1.0))
    np.testing.assert_array_equal(found, [1.0, 2.0, 2.5, 3.0, np.inf, np.inf])


def test_quantiles_of_finite_samples_are_those_of_numpy(rng):
    values, levels = rng.normal(size=17), np.linspace(0.0, 1.0, 9)
    np.testing.assert_array_equal(quantiles(values, levels), np.quantile(values, levels))


def test_deviation_is_that_of_a_sample():
    """The squares of -1.5, -0.5, 0.5 and 1.5, over 3 degrees of freedom."""
    found = described(np.array([1.0, 2.0, 3.0, 4.0]))
    assert (found["mean"], found["std"]) == (2.5, pytest.approx(np.sqrt(5.0 / 3.0), rel=1e-15))
    assert described(np.array([2.0]))["std"] == 0.0


def test_no_statistic_of_infinite_samples_is_undefined():
    found = described(np.array([1.0, 2.0, 3.0, np.inf]))
    assert not np.isnan([*found.values()]).any()
    assert found["mean"] == found["std"] == found["q95"] == np.inf
    assert (found["lowest"], found["q25"]) == (1.0, 1.75)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (
            [1.0, 2.0, np.inf],
            "infinite in 1 samples (no contact): mean inf, std inf, 5 to 95 % 1.1 to",
        ),
        ([np.inf, np.inf], "infinite in all samples (no contact)"),
        ([4.0, 4.0], "4 kPa in all samples"),
    ],
)
def test_the_command_names_infinite_samples(values, words):
    values = np.array(values)
    line = described(np.zeros(len(values)))
    found = {"unit": "kPa", "sampled": described(values), "first_order": line}
    found["infinite_samples"] = int(np.isinf(values).sum())
    assert statistics_text(found).startswith(words)
