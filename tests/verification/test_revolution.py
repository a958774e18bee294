"""Bodies of revolution against exact solutions, axisymmetric finite elements and plane strain."""

from dataclasses import replace

import numpy as np
import pytest
from ring_files import PLANE, under_a_lid

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.terms.averaged_points import averaged_points
from seal_mdao.terms.points import boundary_particles
from verification.confined import stiffness_under_pressure
from verification.revolution import (
    BORE,
    BULK,
    C01,
    C10,
    exact_force,
    extrapolated_error,
    free_stretch,
    inflation_errors,
    large_ring_force,
    pressed_ring,
    principal_stress,
    radial_solution,
    relative_difference,
)
from verification.rings import (
    DISCS,
    EXAMPLES,
    apparent_modulus,
    gent_lindley_modulus,
    ring_errors,
    ring_result,
    stage_forces,
)
from verification.tolerances import TOLERANCES

INNER = {"cylinder": 0.0, "ring": 1.0, "large ring": 50.0}
"""Inner radii, mm: a body that touches the axis, and two that do not."""
FILE_SHEAR, FILE_BULK = 200.0, 80000.0
"""Moduli of the rubber of the seal files, kPa."""


# ---- exact solutions ----


def test_principal_stresses_are_derivatives_of_the_energy(rng):
    """dW/dl_i by complex steps, and zero in the undeformed state."""

    def energy(s):
        one, two, J = sum(s**2), s[0] ** 2 * (s[1] ** 2 + s[2] ** 2) + (s[1] * s[2]) ** 2, s.prod()
        isochoric = C10 * (one * J ** (-2 / 3) - 3) + C01 * (two * J ** (-4 / 3) - 3)
        return isochoric + BULK / 2 * (J - 1) ** 2

    stretch = rng.uniform(0.7, 1.4, 3)
    slopes = [energy(stretch + 1e-30j * axis).imag / 1e-30 for axis in np.eye(3)]
    np.testing.assert_allclose(principal_stress(*stretch), slopes, rtol=1e-12)
    assert np.abs(principal_stress(1.0, 1.0, 1.0)).max() < 1e-12


def test_free_cylinder_is_that_of_uniaxial_compression():
    """P = 2 (C10 + C01 / l) (l - l^-2) of an incompressible rubber (Rivlin)."""
    axial, bulk = 0.8, 1e8
    s = free_stretch(axial, bulk)
    exact = 2.0 * (C10 + C01 / axial) * (axial - axial**-2)
    assert principal_stress(s, s, axial, bulk)[2] == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("share", [0.0, 0.3], ids=["even", "uneven"])
@pytest.mark.parametrize("body", INNER)
def test_frictionless_compression_is_exact_with_averages(body, share, figure):
    """A uniform state, h included, from a uniform pressure."""
    errors = pressed_ring(INNER[body], share, "averages")
    figure(f"pressed {body}: force", errors.force, TOLERANCES["ring_compression"])
    figure(f"pressed {body}: pressure", errors.pressure, TOLERANCES["ring_compression"])


@pytest.mark.parametrize("inner", [0.0, 1.0])
def test_areas_of_contact_points(inner, figure):
    """int N_I 2 pi R ds of the hat functions N_I of the particles, m mm."""
    R = inner + np.array([0.0, 0.3, 0.5, 1.2, 1.4])
    place, row = np.column_stack([R, np.ones(len(R))]), np.arange(len(R))[::-1]
    points = boundary_particles(row, Edge(row, False).neighbours).around_axis()
    # five points of every edge integrate R N_I exactly
    g, w = np.polynomial.legendre.leggauss(5)
    radius = (0.5 * (R[1:] + R[:-1])[:, None] + 0.5 * np.diff(R)[:, None] * g).ravel()
    weight = (0.5 * np.diff(R)[:, None] * w).ravel() * 2e-3 * np.pi * radius
    exact = np.array([weight @ np.interp(radius, R, hat) for hat in np.eye(len(R))])
    found = points.measures(place)[::-1]
    figure("areas of contact points", np.abs(found / exact - 1.0).max(), 1e-12)
    averaged = averaged_points(row, Edge(row, False).neighbours, place, axisymmetric=True)
    total = averaged.measures(place).sum() / exact.sum()
    figure("areas of averages: sum", abs(total - 1.0), 1e-12)


@pytest.mark.parametrize("body", ["cylinder", "ring"])
def test_frictionless_compression_with_particles(body, figure):
    """The force is right to 3e-4; the pressure is not uniform, as in plane strain."""
    errors = pressed_ring(INNER[body], 0.3, "particles")
    figure(f"pressed {body}, contact at particles: force", errors.force, 5e-4)
    assert errors.pressure > 0.1


@pytest.mark.parametrize(("kind", "cells"), [("tube", 32), ("sphere", 8)])
def test_inflation_converges_in_second_order(kind, cells, figure):
    """A linear basis: the displacement falls with the square of the spacing."""
    coarse, fine = (inflation_errors(kind, n) for n in (cells, 2 * cells))
    slope = np.log2(coarse.displacement / fine.displacement)
    figure(f"inflated {kind}: order from 2", abs(slope - 2.0), 0.2)
    # the error of the next finer grid of the sphere is three times smaller again
    bounds = {"tube": (1e-5, 1e-6), "sphere": (5e-4, 1e-3)}[kind]
    for name, bound in zip(fine._fields, bounds, strict=True):
        figure(f"inflated {kind}, {2 * cells} cells: {name}", getattr(fine, name), bound)


def test_displacement_of_a_sphere_tends_to_the_exact_one(figure):
    """The part in h^2 of 24 and 48 cells through the wall taken off."""
    figure("inflated sphere, extrapolated: displacement", extrapolated_error(24), 1e-5)


def test_tube_of_a_seal_file(figure):
    """Its bore is a moved edge, between planes of symmetry: displacement and force."""
    radius, stress = radial_solution("tube")
    # 0.5 mm high
    force = -stress * 2e-3 * np.pi * BORE * 0.5
    errors = []
    for spacing in (0.05, 0.025):
        result = ring_result("ring_tube", spacing)
        R, u = result.seal.nominal_particles[:, 0], result.path.displacement()
        errors.append(relative_difference(u, np.column_stack([radius(R) - R, 0.0 * R])))
    figure("tube of a seal file: order from 2, if less", 2.0 - np.log2(errors[0] / errors[1]), 0.1)
    figure("tube of a seal file: displacement", errors[1], 1e-5)
    error = abs(-result.path.reaction("mandrel")[-1, 0] / force - 1.0)
    figure("tube of a seal file: force on the bore", error, 1e-5)


@pytest.mark.parametrize("kind", ["tube", "sphere"])
def test_radial_solution_keeps_the_volume(kind):
    """Nearly: r^(n+1) - R^(n+1) is constant for a bulk modulus a thousand times as large."""
    power = {"tube": 2, "sphere": 3}[kind]
    R = np.linspace(1.0, 2.0, 9)
    shell = radial_solution(kind, 2e6)[0](R) ** power - R**power
    assert np.ptp(shell) < 1e-3 * shell.mean()


# a ring between smooth plates, with a design: the true pressure is uniform
TRUE = (
    PLANE
    + under_a_lid((1.0, 3.0), 1.0, 1.0, -0.2, 4, bulk=2000.0, spacing=0.3)
    + """\
[[design]]
edges = ["side"]
parameters = 4
bound = 0.2
[[measure]]
type = "peak_pressure"
"""
)


def test_true_pressure_is_force_over_deformed_area(tmp_path, figure):
    """P_z / s^2 with the radial stretch s, along the ring and around it, as a measure and in the
    history; and its derivatives against central differences."""
    path = tmp_path / "ring.toml"
    path.write_text(TRUE, encoding="utf-8")
    seal = sm.build_seal(path)
    result = sm.analyze(seal, keep_factors=True)
    area = np.pi * (3.0**2 - 1.0**2) * 1e-3
    nominal = exact_force(1.0, 0.2) / area
    # the plate is penetrated by |P_z| / w_n
    s = free_stretch(0.8 + nominal / 1e5)
    true = nominal / s**2
    figure("true pressure: measure", abs(result.value("peak_pressure")[0] / true - 1.0), 1e-7)
    history = profile_histories(result)[0]
    figure("true pressure: history", abs(history.peak[-1] / true - 1.0), 1e-7)
    found = np.ravel(sm.differentiate(result, ())["peak_pressure"])
    for p, own in enumerate(found[:2]):
        b = 1e-4 * np.eye(len(found))[p]
        ends = [sm.analyze(seal, sign * b).value("peak_pressure")[0] for sign in (1.0, -1.0)]
        slope = (ends[0] - ends[1]) / 2e-4
        figure("true pressure: derivative", abs(own - slope) / abs(found).max(), 1e-4)


# ---- high pressure ----


@pytest.mark.parametrize("axisymmetric", [False, True], ids=["plane", "ring"])
def test_confined_rubber_stays_stiff_under_pressure(axisymmetric, figure):
    """Its smallest stiffness does not depend on the pressure, for int det(grad v) dA = 0 of a field v
    without values at the boundary.

    Exactly so in plane strain, but for the moduli of the law at this volume, where p / K is 2 %; in a
    body of revolution up to the ratio of the spacing to the radius. Quadrature of the volume lost 60 %.
    """
    changed = stiffness_under_pressure(2, 20.0, axisymmetric) - 1.0
    figure("stiffness that a pressure of 20 shear moduli changes", abs(changed), 0.04)


# ---- plane strain ----


def test_large_rings_tend_to_plane_strain(figure):
    """Force per mm of the mean circumference: the difference falls with the radius, slope one."""
    plane = large_ring_force(None)
    radii = 40.0 * 10.0 ** np.arange(4)
    apart = np.array([abs(large_ring_force(r) / plane - 1.0) for r in radii])
    slopes = np.log10(apart[:-1] / apart[1:])
    figure("large rings: slope of the difference from one", np.abs(slopes - 1.0).max(), 0.02)
    figure("ring of 10^4 times the section: force from plane strain", apart[-1], 1e-5)


# ---- finite elements ----

STAGES = {
    "ring_disc_2": (0, 1),
    "ring_disc_5": (0, 1),
    "ring_squeezed": (0, 1),
    "ring_sleeve": (0, 1),
    "ring_foam": (0, 1),
    "shaft_lip": (0,),
}
"""Stages of which the finite elements are certain to 0.3 %."""


@pytest.mark.parametrize("name", STAGES)
def test_forces_of_seal_files(name, figure):
    errors = ring_errors(name)
    own = [*STAGES[name]]
    assert errors.uncertainty[own].max() <= 4e-3
    figure(f"{name}: force", np.abs(errors.force[own]).max(), TOLERANCES[name.rstrip("_25")])


@pytest.mark.parametrize(
    ("name", "spacing"),
    [
        ("ring_squeezed", 0.15),
        ("ring_foam", 0.3),
        pytest.param("ring_sleeve", 0.2, marks=pytest.mark.long),
        pytest.param("ring_disc_5", 0.3, marks=pytest.mark.long),
    ],
)
def test_forces_converge(name, spacing, figure):
    """Smaller particles give a smaller largest error, up to that of the elements."""
    coarse, fine, own = ring_errors(name), ring_errors(name, spacing), [*STAGES[name]]
    errors = np.abs(fine.force[own]) - fine.uncertainty[own]
    assert errors.max() < np.abs(coarse.force[own]).max()
    figure(f"{name}, {spacing} mm: force", np.abs(fine.force[own]).max(), 6e-3)


@pytest.mark.parametrize("spacing", [None, 0.15])
def test_peak_pressure_of_an_o_ring(spacing, figure):
    """At 10 and 20 % squeeze, from six edges in contact on: less than 2 % and, as the finite elements'
    peaks change by 0.4 % with their last refinement, what is left of it after twice that."""
    peak = np.abs(ring_errors("ring_squeezed", spacing).peak).max()
    figure(f"ring_squeezed, {spacing or 'own'} spacing: peak pressure", peak, 1e-2)


@pytest.mark.parametrize(
    "spacing", [None, *(pytest.param(own, marks=pytest.mark.long) for own in (0.375, 0.25))]
)
def test_lip_on_a_shaft(spacing, figure):
    """Force and peak pressure of the example, from six sides along the contact on."""
    errors = ring_errors("shaft_lip", spacing)
    # the finite elements' peak changes by 0.1 % with their last refinement
    name, (force,), (peak,) = f"shaft_lip, {spacing or 'own'} spacing", errors.force, errors.peak
    figure(f"{name}: force", abs(force), TOLERANCES["shaft_lip"])
    figure(f"{name}: peak pressure", abs(peak), TOLERANCES["shaft_lip_peak"])


def test_a_peak_between_few_points_is_reported():
    """Without the spacing of its edge the lip has two points in contact: the force is right, the peak
    is not, and a warning says so."""
    fine = ring_result("shaft_lip")
    assert fine.warnings == ()
    file = read_seal_file(EXAMPLES / "shaft_lip.toml")
    plain = replace(file, section=replace(file.section, edge_spacing={}))
    coarse = sm.analyze(sm.build_seal(plain))
    assert abs(stage_forces(coarse)[0] / stage_forces(fine)[0] - 1.0) < TOLERANCES["shaft_lip"]
    assert coarse.value("peak_pressure")[0] < 0.9 * fine.value("peak_pressure")[0]
    (warning,) = coarse.warnings
    assert "peak pressure on 'shaft' is not resolved: at the peak only 2 adj" in warning


@pytest.mark.parametrize("name", DISCS)
def test_apparent_modulus_of_bonded_discs(name, figure):
    """That of Gent and Lindley, for shape factors of 1 and 2.5 and 0.1 % of compression."""
    found = apparent_modulus(name, stage_forces(ring_result(name))[0])
    exact = gent_lindley_modulus(DISCS[name], FILE_SHEAR, FILE_BULK)
    figure(f"{name}: apparent modulus", abs(found / exact - 1.0), TOLERANCES["gent_lindley"])


def test_displacements_in_a_thin_disc_are_smooth(figure):
    """Compressed by 20 %, the pressure is more than ten times the shear modulus: the radial displacement
    of the middle plane, up to 6 mm, against a polynomial of degree 7 (over the compression of the half
    disc). By quadrature of the volume they oscillated by 0.9."""
    result = ring_result("ring_disc_2")
    X = result.seal.nominal_particles
    at = np.flatnonzero((X[:, 1] < 1e-9) & (X[:, 0] < 6.0))
    u = result.path.displacement()[at, 0]
    smooth = np.polynomial.Polynomial.fit(X[at, 0], u, 7)
    figure("thin disc: oscillation", np.abs(smooth(X[at, 0]) - u).max() / 0.2, 1e-2)
