"""Contact pressure of seal files that leave everything open, against independent finite elements."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import seal_mdao as sm
from verification.contact_profiles import (
    REFERENCES,
    SECTIONS,
    PressureErrors,
    Reference,
    point_intervals,
    pressure_errors,
    stored,
    uncertainty,
)

RMS, PEAK, WIDTH = 0.01, 0.01, 0.01
"""Bounds of the errors of the pressure over its peak, of the peak and of the width in contact."""

HOLD = [
    ("half_disc", "peak", 0),
    ("half_disc", "peak", 1),
    ("half_disc", "width", 0),
    ("o_ring", "rms", 0),
    ("o_ring", "peak", 2),
    ("o_ring", "width", 1),
    ("o_ring", "width", 2),
    ("bonded_gasket", "width", 0),
    ("bonded_gasket", "width", 1),
    ("bonded_gasket", "width", 2),
    ("half_ring", "peak", 1),
    ("half_ring", "width", 1),
    ("half_ring", "width", 2),
    ("rounded_punch", "width", 1),
    ("rounded_punch", "width", 2),
]
"""Section, quantity and stage (from 0) whose bound holds."""


@cache
def errors(name):
    """Of the ends of the stages, with the spacing, the load steps and the penalties of the file."""
    result = sm.analyze(sm.build_seal(REFERENCES / f"{name}.toml"))
    result.require_converged()
    return pressure_errors(result, stored(name))


def straight(pressure, length=2.0):
    """A reference along the x axis with the ``pressure`` (n,) at equal distances."""
    s = np.linspace(0.0, length, len(pressure))
    peak, width = np.array([max(pressure)]), np.array([2.0])
    return Reference("straight", np.column_stack([s, 0 * s]), s, np.array([pressure]), peak, width)


def test_means_are_exact_for_linear_pressures():
    """One side, the other side, both, and beyond the contact."""
    found = straight([2.0, 1.0, 0.0, 0.0, 0.0]).means(
        0, np.array([[0.0, 0.5], [-0.5, 0.0], [-0.5, 0.5], [1.0, 2.0], [0.75, 1.25]])
    )
    assert found == pytest.approx([1.5, 1.5, 1.5, 0.0, 0.125], abs=2e-3)


def test_arc_length_of_places_off_the_edge():
    """Points of the chords of an arc, on both sides of the middle, and points beyond the edge."""
    angle = np.linspace(0.0, 1.0, 101)
    place = 5.0 * np.column_stack([np.sin(angle), np.cos(angle)])
    arc = Reference("arc", place, 5.0 * angle, np.zeros((1, 101)), None, None)
    points = 4.98 * np.array([[np.sin(a), np.cos(a)] for a in (0.3, -0.7, 2.5)])
    assert arc.along(points) == pytest.approx([1.5, -3.5, 5.0], abs=1e-3)


def test_parts_of_the_boundary_of_points():
    """They lie end to end; on a closed boundary the last one meets the first."""
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    opened, closed = point_intervals(square, False), point_intervals(square, True)
    for parts in (opened, closed):
        assert np.array_equal(parts[1:, 0], parts[:-1, 1])
    assert np.array_equal(opened[[0, -1], [0, 1]], square[[0, -1]])
    assert np.array_equal(closed[[0, -1], [0, 1]], [[0.0, 1.0], [0.0, 1.0]])


QUANTITIES = PressureErrors._fields
BOUNDS = dict(zip(QUANTITIES, (RMS, PEAK, WIDTH), strict=True))


@pytest.mark.parametrize("name", SECTIONS)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_references_are_converged(name, quantity, figure):
    """In the first three stages; the bonded corner of the gasket is too uncertain in the fourth."""
    worst = max(getattr(stage, quantity) for stage in uncertainty(name)[:3])
    figure(f"{name}: {quantity} of the reference", worst, BOUNDS[quantity])


@pytest.mark.parametrize(("name", "quantity", "stage"), HOLD)
def test_pressure_at_defaults(name, quantity, stage, figure):
    error = abs(getattr(errors(name)[stage], quantity))
    figure(f"{name}, stage {stage + 1}: {quantity} of the pressure", error, BOUNDS[quantity])


def test_errors_follow_the_reference():
    """Twice the pressure and half the width: the result has half the peak and twice the width."""
    result = sm.analyze(sm.build_seal(REFERENCES / "o_ring.toml"))
    known = stored("o_ring")
    other = replace(
        known, pressure=2.0 * known.pressure, peak=2.0 * known.peak, width=0.5 * known.width
    )
    for own, its in zip(
        pressure_errors(result, known), pressure_errors(result, other), strict=True
    ):
        assert 2.0 * (1.0 + its.peak) == pytest.approx(1.0 + own.peak)
        assert 0.5 * (1.0 + its.width) == pytest.approx(1.0 + own.width)
        # the pressure of Hertz has the root mean square sqrt(2/3) of its peak
        assert its.rms == pytest.approx(0.5 * np.sqrt(2.0 / 3.0), rel=0.1)
