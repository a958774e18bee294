"""Rings and cylinders: uniform compression, derivatives of all measures, true pressures."""

from dataclasses import replace

import numpy as np
import pytest
from quotients import quotients
from ring_files import FOAM, SPONGE, cylinder, made_of, ring
from scipy.optimize import brentq

import seal_mdao as sm
from seal_mdao.materials.sponge import graded_sponge
from seal_mdao.measures.section_shape import Volume
from seal_mdao.measures.stress import VonMises
from seal_mdao.seals.profiles import true_pressure

DESIGN = """
[[design]]
edges = ["side"]
parameters = 5
bound = 0.3
[[design]]
edges = ["bore"]
parameters = 5
bound = 0.3
[[measure]]
type = "reaction"
[[measure]]
type = "stress_norm"
[[measure]]
type = "von_mises"
[[measure]]
type = "strain_energy"
[[measure]]
type = "contact_pressure"
profile = "plate"
[[measure]]
type = "contact_width"
profile = "plate"
[[measure]]
type = "friction_work"
[[measure]]
type = "volume"
[[measure]]
type = "mass"
[[measure]]
type = "leak_rate"
rms_roughness = 20.0
roll_off_wavelength = 500.0
shortest_wavelength = 10.0
pressure = 30.0
modulus = 3000.0
"""
NAMES = ("plate_friction", "c10", "bulk_modulus", "plate_normal_penalty")


def built(folder, text):
    path = folder / "ring.toml"
    path.write_text(text.replace("\n[section]", "\ndensity = 1200.0\n[section]"))
    return replace(sm.build_seal(path), newton=sm.NewtonOptions(tolerance=1e-12))


@pytest.fixture(scope="module", params=["particles", "edges", "averages"])
def seal(request, tmp_path_factory):
    return built(tmp_path_factory.mktemp("ring"), ring(points=request.param) + DESIGN)


@pytest.fixture(scope="module")
def result(seal):
    found = sm.analyze(seal, keep_factors=True)
    found.require_converged()
    return found


def test_direct_and_adjoint_agree(seal, result):
    direct, adjoint = (
        sm.differentiate(result, NAMES, None, method) for method in ("direct", "adjoint")
    )
    for measure in seal.standard:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        assert np.abs(one).max() > 0.0
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11 * np.abs(one).max())


@pytest.mark.parametrize(
    ("name", "step"),
    [("boundary_offsets[2]", 2e-5), ("boundary_offsets[8]", 2e-5), ("plate_friction", 1e-4),
     ("c10", 1e-3)],
)  # fmt: skip
def test_derivatives_are_those_of_the_path(seal, result, name, step):
    direct = sm.differentiate(result, NAMES, None, "direct")
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(seal, name, step).items():
        one = np.atleast_2d(direct[measure])[:, column]
        assert np.all(np.abs(one - quotient) <= bound), measure
        assert bound.max() <= 1e-4 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-4), measure


def test_stress_of_free_particles_has_the_derivatives_of_the_path(seal, result):
    """Where the hoop stretch changes: in the middle of the side and of the bore."""
    points = tuple(
        int(np.median(seal.body.edge(name).particles[1:-1])) for name in ("side", "bore")
    )
    measure = VonMises(points=points)
    direct, adjoint = (
        sm.differentiate(result, NAMES, (measure,), method) for method in ("direct", "adjoint")
    )
    one, other = direct[measure.name], adjoint[measure.name]
    np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11 * np.abs(one).max())
    for name, step in (("boundary_offsets[2]", 2e-5), ("boundary_offsets[8]", 2e-5), ("c10", 1e-3)):
        found = one[:, direct.parameters.index(name)]
        quotient, bound = quotients(seal, name, step, measures=(measure,))[measure.name]
        assert np.all(np.abs(found - quotient) <= bound), name
        assert bound.max() <= 1e-4 * np.abs(found).max(), name


def compressed(material, stretch):
    """Lateral stretch and nominal stress, kPa, of a bar without stress at its side."""

    def stress(lateral):
        # tau / lambda at the side and along, from the contract in three stretches
        state = np.array([lateral, lateral, stretch])
        j = state.prod()
        kirchhoff = material.principal_stress(state) + material.bulk_modulus * (j - 1.0) * j
        return kirchhoff[1:] / state[1:]

    side = brentq(lambda lateral: stress(lateral)[0], 0.9, 1.5, xtol=1e-15)
    return side, stress(side)[1]


@pytest.mark.parametrize("material", [None, FOAM, SPONGE], ids=["rubber", "foam", "sponge"])
@pytest.mark.parametrize("spacing", [0.5, 0.31])
def test_a_smooth_cylinder_is_compressed_uniformly(spacing, material, tmp_path):
    """Also at the axis, and with a cloud that is not even: the patch test of contact."""
    text = cylinder(spacing, penalty=1e5)
    seal = built(tmp_path, made_of(material, text) if material else text)
    result = sm.analyze(seal)
    result.require_converged()
    response, term = result.response("plate"), result.term("plate")
    pressure = -response.gap * term.law.normal_penalty
    np.testing.assert_allclose(pressure, pressure.mean(), rtol=1e-10)
    stretch = 1.0 + result.displacement()[seal.body.edge("top").particles, 1].mean() / 2.0
    side, stress = compressed(result.term("structure").definition.regions[0].material, stretch)
    np.testing.assert_allclose(pressure, -stress, rtol=1e-10)
    outer = seal.body.edge("side").particles
    np.testing.assert_allclose(result.displacement()[outer, 0], 2.0 * (side - 1.0), atol=1e-11)
    force = result.path.force("plate", result.end)
    # pi R^2 P, mm^2 kPa = mN
    assert force[1] == pytest.approx(-1e-3 * np.pi * 4.0 * stress, rel=1e-10)
    assert force[0] == 0.0
    # Cauchy stress: force over the deformed area
    np.testing.assert_allclose(
        true_pressure(result, result.seal.definitions[1]), -stress / side**2, rtol=1e-10
    )


def test_sponges_of_two_grades_around_each_other_have_the_force_of_both(tmp_path):
    """Without lateral strain both are compressed uniformly, under a plate to which they are bonded."""
    text = made_of('sponge = "2A2"\n', cylinder()).partition("[[profile]]")[0]
    # the line between both ends at corners
    text = text.replace("[2.0, 0.0]]", "[1.2, 0.0], [2.0, 0.0]]")
    text = text.replace("[0.0, 2.0]]", "[1.2, 2.0], [0.0, 2.0]]")
    text += """
[material.cover]
sponge = "2A5"
[[section.region]]
material = "cover"
at = [1.5, 1.0]
line = [[1.2, 0.0], [1.2, 2.0]]
[[moved]]
name = "plate"
edges = ["top"]
stage = [{ translate = [0.0, -0.4], steps = 3 }]
"""
    result = sm.analyze(built(tmp_path, text))
    np.testing.assert_allclose(result.displacement()[:, 0], 0.0, atol=1e-12)
    # P = mu (lambda - 1 / lambda) over the areas of both, kPa mm^2 = mN
    (inner,), (outer,) = (graded_sponge(name).mu for name in ("2A2", "2A5"))
    exact = np.pi * (inner * 1.2**2 + outer * (2.0**2 - 1.2**2)) * (0.8 - 1.0 / 0.8)
    assert result.path.reaction("plate")[-1, 1] == pytest.approx(-1e-3 * exact, rel=1e-10)


def test_contact_at_particles_has_an_error_that_falls(tmp_path):
    errors = []
    for spacing in (0.5, 0.25):
        result = sm.analyze(built(tmp_path, cylinder(spacing, "particles")))
        stretch = (
            1.0 + result.displacement()[result.seal.body.edge("top").particles, 1].mean() / 2.0
        )
        _, stress = compressed(result.term("structure").definition.regions[0].material, stretch)
        errors.append(
            result.path.force("plate", result.end)[1] / (-1e-3 * np.pi * 4.0 * stress) - 1
        )
    assert abs(errors[1]) < abs(errors[0]) < 1e-3


def test_mass_of_a_ring_is_in_grams(seal, result):
    # 1200 kg/m^3 = 1.2e-3 g/mm^3, 2 pi R A with R = 4 mm, A = 4 mm^2
    assert result.value("mass")[0] == pytest.approx(1.2e-3 * 32.0 * np.pi, rel=1e-12)
    assert seal.units.of(result.measure("mass").units) == "g"


def test_volume_is_that_of_pappus(seal, result):
    # 2 pi R A with R = 4 mm, A = 4 mm^2
    assert result.value(Volume())[0] == pytest.approx(2.0 * np.pi * 4.0 * 4.0, rel=1e-12)
    assert result.path.discretization.cells.cell_weights.sum() == pytest.approx(
        2e-3 * np.pi * 16.0, rel=1e-12
    )


FOAM_STEPS = {
    "boundary_offsets[2]": 1e-4, "boundary_offsets[8]": 1e-4, "plate_friction": 1e-4, "mu_1": 1e-2,
    "alpha_2": 1e-3, "nu_1": 1e-4,
}  # fmt: skip


def test_a_foam_ring_has_the_derivatives_of_its_path(tmp_path):
    """By shape and by constants: of all measures, and of the stress where the hoop stretch changes."""
    seal = built(tmp_path, made_of(FOAM, ring(points="averages", friction=0.1)) + DESIGN)
    result = sm.analyze(seal, keep_factors=True)
    result.require_converged()
    points = tuple(
        int(np.median(seal.body.edge(name).particles[1:-1])) for name in ("side", "bore")
    )
    others = (own for own in seal.standard if own.name != "von_mises")
    measures = (*others, VonMises(points=points))
    names = tuple(name for name in FOAM_STEPS if name in seal.scalars)
    direct, adjoint = (
        sm.differentiate(result, names, measures, method) for method in ("direct", "adjoint")
    )
    for measure in measures:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11 * np.abs(one).max())
    for name, step in FOAM_STEPS.items():
        column = direct.parameters.index(name)
        for measure, (quotient, bound) in quotients(seal, name, step, measures=measures).items():
            found = np.atleast_2d(direct[measure])[:, column]
            assert np.all(np.abs(found - quotient) <= bound), (name, measure)
            # 0.02 mJ is the work of friction; the volume does not depend on constants
            # leak rates depend on the pressure with a high power: truncation of the same step is larger
            share = 1e-5 if measure == "leak_rate" else 1e-6
            assert bound.max() <= share * max(np.abs(found).max(), 0.02), (name, measure)
