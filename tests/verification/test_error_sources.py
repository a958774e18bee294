"""Accuracy of the door seal by name, refinement in one direction, and the gap along the boundary."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import ACCURACIES
from seal_mdao.verification.error_sources import (
    boundary_gaps,
    drawn,
    flat_errors,
    largest_opened_gap,
    worst_error,
)
from seal_mdao.verification.flexure import bend_block

PRODUCT = ACCURACIES["engineering"]["support"]
# what the reference itself may be off (4 x 116 against 8 x 232 elements: 0.1 %)
REFERENCE = 1e-3


def test_paper_accuracy_is_the_default():
    assert sm.door_seal() == sm.door_seal(accuracy="paper")
    assert sm.door_seal().body.support_axes is None


def test_engineering_accuracy_is_within_half_a_percent(figure):
    steps = ACCURACIES["engineering"]["n_steps"]
    error = np.abs(flat_errors(accuracy="engineering", n_steps=steps)).max()
    figure("flat door, engineering accuracy: reaction at 2 ... 10 mm", error, 5e-3)


@pytest.mark.long
def test_gap_accuracy_is_within_two_percent(figure):
    """Of a ring with some four times as many particles, evaluated between particles too."""
    error = np.abs(flat_errors(accuracy="gaps", n_steps=35)).max()
    figure("flat door, accuracy for gaps: reaction at 2 ... 10 mm", error, 5e-3)
    limit = largest_opened_gap(drawn(accuracy="gaps", rays=174, layers=7, refinement=2))
    found = largest_opened_gap(drawn(accuracy="gaps"))
    figure("corner door, accuracy for gaps: largest gap", abs(found / limit - 1.0), 2e-2)


def test_rays_alone_do_not_make_it_worse_with_product_kernels():
    """116 x 3 with round kernels is 4 % worse than 58 x 3."""
    errors = [worst_error(rays=rays, layers=3, support=PRODUCT) for rays in (58, 116)]
    assert errors[1] < errors[0] + REFERENCE


@pytest.mark.long
@pytest.mark.parametrize("rays", [58, 116])
@pytest.mark.parametrize("order", [1, 2])
def test_layers_make_it_better(rays, order):
    errors = [
        worst_error(rays=rays, layers=n, support=PRODUCT, basis_order=order) for n in (3, 4, 5, 6)
    ]
    assert np.all(np.diff(errors) < REFERENCE)
    assert errors[-1] < 5e-3


def test_error_falls_both_ways_with_the_pressure_through_the_wall():
    """With one value a cell 116 x 4 is worse than 58 x 4."""
    errors = np.array(
        [
            [worst_error(rays=rays, layers=n, support=PRODUCT, pressure="wall") for n in (4, 5)]
            for rays in (58, 116)
        ]
    )
    assert np.all(errors[1] < 0.55 * errors[0])
    assert np.all(errors[:, 1] < 0.85 * errors[:, 0])
    assert errors[1, 1] < 5e-3


def test_bending_with_product_kernels_is_no_worse(figure):
    """Four cells across."""
    errors = [
        abs(bend_block(180.0, (30, 4), n_steps=9, support=s).error[-1]) for s in (2.0, PRODUCT)
    ]
    figure("block bent to a half circle, product kernels: moment", errors[1], errors[0])


def test_gaps_along_the_boundary_meet_those_of_the_particles():
    """A point that comes ever nearer to a particle has its gap."""
    result = drawn(depth=2.0, start=10.03, n_steps=10)
    gaps = boundary_gaps(result, 40).reshape(-1, 40)
    at_particles = result.contact.gap
    # the first Gauss point of a side lies 1e-3 of the side from its particle
    slope = np.abs(np.diff(gaps, axis=1)).max()
    np.testing.assert_allclose(gaps[:, 0], at_particles[:-1], rtol=0.0, atol=slope)
