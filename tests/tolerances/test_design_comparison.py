"""Fractions of samples within limits, with their confidence."""

import numpy as np
import pytest
from scipy.stats import binom

from seal_mdao.plotting import designs_compared
from seal_mdao.report.html_tables import percent
from seal_mdao.report.sample_section import samples_section
from seal_mdao.tolerances.design_comparison import SampledDesign, SampledLimit
from seal_mdao.tolerances.statistics import fraction


def floor(least, required=0.9):
    kept = lambda values: values[:, 0] >= least  # noqa: E731
    return SampledLimit("share_force_1", "force at least", "force", kept, required=required)


def design(failed=0):
    """100 samples: forces 0, 1, ..., 99, and failures."""
    values = {"force": np.arange(100.0)[:, None], "area": np.ones((100, 1))}
    return SampledDesign("robust optimum", "area", values, failed)


def test_interval_is_that_of_clopper_and_pearson():
    """Each end leaves 2.5 % of the binomial distribution beyond what was seen."""
    own = fraction(95, 100)
    assert own.value == 0.95
    assert binom.sf(94, 100, own.low) == pytest.approx(0.025, rel=1e-6)
    assert binom.cdf(95, 100, own.high) == pytest.approx(0.025, rel=1e-6)


def test_failed_samples_satisfy_no_limit():
    assert design().fraction(floor(5.0)).value == 0.95
    assert design(failed=100).fraction(floor(5.0)).value == 0.475
    summary = design(failed=100).summary((floor(5.0),))
    assert summary["share_force_1"] == 0.475
    low, high = summary["share_force_1_interval"]
    assert low < 0.475 < high


@pytest.mark.parametrize(
    ("least", "met", "words"),
    [
        (1.0, True, "99.0 % of the samples (94.6 to 100.0 % with 95 % confidence), 90 % required: met"),
        (8.0, True, "92.0 % of the samples (84.8 to 96.5 % with 95 % confidence), 90 % required: met, "
         "within the confidence of these samples"),
        (12.0, False, "88.0 % of the samples (80.0 to 93.6 % with 95 % confidence), 90 % required: NOT "
         "MET, within the confidence of these samples"),
        (50.0, False, "50.0 % of the samples (39.8 to 60.2 % with 95 % confidence), 90 % required: NOT "
         "MET"),
    ],
)  # fmt: skip
def test_limits_are_met_or_not_within_their_confidence(least, met, words):
    assert design().meets(floor(least)) is met
    assert design().in_words(floor(least)) == words


def test_limits_at_the_required_fraction_are_met():
    """Exactly nine tenths; and all of them, of which no number of samples can be certain."""
    assert design().meets(floor(10.0))
    all_of_them = design().in_words(floor(0.0, required=1.0))
    assert all_of_them.endswith("100 % required: met, within the confidence of these samples")


def test_a_band_that_is_met_is_not_too_narrow():
    """Its samples are on one side of the others, so that the middle four fifths reach beyond it."""
    values = {"force": np.append(np.linspace(0.0, 1.0, 85), np.full(15, 100.0))[:, None]}
    inside = lambda values: values[:, 0] <= 1.0  # noqa: E731
    band = SampledLimit("share_force_1", "force", "force", inside, required=0.8, band=1.0)
    assert SampledDesign("robust optimum", "force", values, 0).too_wide(band) is None


def test_the_report_has_fractions_with_intervals():
    figure = designs_compared({"robust optimum": np.arange(4.0)}, "area", "mm**2")
    page = samples_section([design()], (floor(5.0),), "area", figure)
    low, high = (percent(value) for value in design().fraction(floor(5.0))[1:])
    assert f"<td>{percent(0.95)} ({low} to {high})</td>" in page


def test_a_band_that_is_narrower_than_the_scatter():
    """Nine tenths of 0, 1, ..., 99 lie between 4.95 and 94.05."""
    inside = lambda values: np.abs(values[:, 0] - 49.5) <= 40.0  # noqa: E731
    band = SampledLimit("share_force_1", "force", "force", inside, required=0.9, band=80.0)
    assert design().too_wide(band) == pytest.approx(89.1)
    # one bound alone, or a band that is wide enough but in another place: not the scatter is at fault
    assert design().too_wide(band._replace(band=None)) is None
    assert design().too_wide(band._replace(band=95.0)) is None
    # met: nothing to say
    assert design().too_wide(band._replace(required=0.8)) is None
    # a measure of several entries, limited in all of them or in one
    values = {"force": np.column_stack([np.zeros(100), np.arange(100.0)])}
    several = SampledDesign("robust optimum", "force", values, 0)
    nowhere = band._replace(satisfied=lambda values: np.zeros(len(values), bool))
    assert several.too_wide(nowhere) is None
    assert several.too_wide(nowhere._replace(entry=1)) == pytest.approx(89.1)


@pytest.mark.parametrize(
    ("power", "scale"), [(0.1, "linear"), (6.0, "log")], ids=["area", "gap that nearly closes"]
)
def test_the_axis_of_the_cost_is_logarithmic_over_decades_only(power, scale):
    values = np.linspace(0.01, 1.0, 50) ** power
    figure = designs_compared(
        {"nominal optimum": values, "robust optimum": 0.9 * values}, "a", "mm"
    )
    assert figure.axes[0].get_xscale() == scale
