"""Observed orders of the shape functions and of the whole analysis on irregular clouds."""

import numpy as np
import pytest

from verification.approximation import interpolation_convergence
from verification.manufactured import manufactured_convergence
from verification.manufactured_ring import ring_convergence
from verification.tolerances import TOLERANCES

SLOPE = TOLERANCES["slope"]


def check_slopes(figure, name, slopes, order):
    figure(f"{name}: slope - {order}", np.abs(slopes - order).max(), SLOPE)


@pytest.mark.parametrize(
    ("basis_order", "cells"), [(2, (8, 32)), pytest.param(1, (32, 64), marks=pytest.mark.long)]
)
def test_interpolation_has_the_order_of_the_basis(figure, basis_order, cells):
    study = interpolation_convergence(basis_order, cells)
    name = f"interpolation, basis {basis_order}, "
    check_slopes(figure, name + "L2", study.l2_slopes, basis_order + 1)
    check_slopes(figure, name + "H1", study.h1_slopes, basis_order)


@pytest.mark.parametrize("cells", [(8, 16), pytest.param((8, 16, 32), marks=pytest.mark.long)])
def test_linear_basis_converges_with_slopes_two_and_one(figure, cells):
    study = manufactured_convergence(basis_order=1, cells=cells)
    check_slopes(figure, "manufactured solution, linear basis, L2", study.l2_slopes, 2)
    check_slopes(figure, "manufactured solution, linear basis, H1", study.h1_slopes, 1)


@pytest.mark.long
def test_quadratic_basis_gains_one_order_with_consistent_integration(figure):
    study = manufactured_convergence(basis_order=2, consistent=2, cells=(16, 32), seeds=(1, 2))
    check_slopes(figure, "manufactured solution, quadratic basis, L2", study.l2_slopes, 3)
    check_slopes(figure, "manufactured solution, quadratic basis, H1", study.h1_slopes, 2)


# ---- bodies of revolution ----


def overall(study) -> np.ndarray:
    """Orders of the L2 and the H1 error from the coarsest to the finest cloud."""
    spans = np.log(study.spacing[-1] / study.spacing[0])
    return np.array([np.log(e[-1] / e[0]) / spans for e in (study.l2, study.h1)])


@pytest.mark.parametrize(
    ("basis_order", "cells"), [(1, (8, 32)), pytest.param(2, (8, 32), marks=pytest.mark.long)]
)
def test_ring_converges_with_the_order_of_the_basis(figure, basis_order, cells):
    """The quadratic basis with quadratically consistent integration; coarse clouds converge faster."""
    orders = overall(ring_convergence(basis_order, basis_order, cells))
    for name, order, known in zip(
        ("L2", "H1"), orders, (basis_order + 1, basis_order), strict=True
    ):
        figure(f"ring, basis {basis_order}, {name}: order, if less", known - order, SLOPE)
