"""Observed orders of the shape functions and of the whole analysis on irregular clouds."""

import pytest

from seal_mdao.verification.approximation import interpolation_convergence
from seal_mdao.verification.manufactured import manufactured_convergence


@pytest.mark.parametrize("basis_order", [1, 2])
def test_interpolation_has_the_order_of_the_basis(figure, basis_order):
    study = interpolation_convergence(basis_order, cells=(16, 32, 64))
    name = f"interpolation, basis {basis_order}: "
    figure(name + "L2 slope", abs(study.l2_slopes[-1] - basis_order - 1), 0.15)
    figure(name + "H1 slope", abs(study.h1_slopes[-1] - basis_order), 0.15)


def test_linear_basis_converges_with_slopes_two_and_one(figure):
    study = manufactured_convergence(basis_order=1, cells=(8, 16, 32))
    figure(
        "manufactured solution, linear basis: L2 slope - 2", abs(study.l2_slopes - 2).max(), 0.15
    )
    figure(
        "manufactured solution, linear basis: H1 slope - 1", abs(study.h1_slopes - 1).max(), 0.15
    )


def test_quadratic_basis_gains_one_order_with_consistent_integration(figure):
    study = manufactured_convergence(basis_order=2, consistent=2, cells=(16, 32), seeds=(1, 2))
    figure(
        "manufactured solution, quadratic basis: L2 slope - 3", abs(study.l2_slopes - 3).max(), 0.15
    )
    figure(
        "manufactured solution, quadratic basis: H1 slope - 2", abs(study.h1_slopes - 2).max(), 0.15
    )
