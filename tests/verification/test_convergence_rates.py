"""Observed orders of the shape functions and of the whole analysis on irregular clouds."""

import pytest

from seal_mdao.verification.approximation import interpolation_convergence
from seal_mdao.verification.manufactured import manufactured_convergence
from seal_mdao.verification.tolerances import TOLERANCES

SLOPE = TOLERANCES["slope"]


@pytest.mark.parametrize("basis_order", [1, 2])
def test_interpolation_has_the_order_of_the_basis(figure, basis_order):
    study = interpolation_convergence(basis_order, cells=(16, 32, 64))
    name = f"interpolation, basis {basis_order}: "
    figure(name + "L2 slope", abs(study.l2_slopes[-1] - basis_order - 1), SLOPE)
    figure(name + "H1 slope", abs(study.h1_slopes[-1] - basis_order), SLOPE)


def check_slopes(figure, name, study, l2, h1):
    for norm, slopes, order in (("L2", study.l2_slopes, l2), ("H1", study.h1_slopes, h1)):
        away = abs(slopes - order).max()
        figure(f"manufactured solution, {name} basis: {norm} slope - {order}", away, SLOPE)


def test_linear_basis_converges_with_slopes_two_and_one(figure):
    study = manufactured_convergence(basis_order=1, cells=(8, 16, 32))
    check_slopes(figure, "linear", study, 2, 1)


def test_quadratic_basis_gains_one_order_with_consistent_integration(figure):
    study = manufactured_convergence(basis_order=2, consistent=2, cells=(16, 32), seeds=(1, 2))
    check_slopes(figure, "quadratic", study, 3, 2)
