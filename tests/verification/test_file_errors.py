"""Errors of seals from files against half their spacing: what the page on accuracy says of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.result import analyze
from verification.file_errors import (
    LINEAR,
    QUADRATIC,
    fine_forces,
    force_error,
    forces,
    refined,
    stress_error,
    touched_at,
    with_kernels,
)

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
REFERENCES = Path(__file__).parent / "references"


def example(name):
    file = touched_at(read_seal_file(EXAMPLES / f"{name}.toml"), "particles")
    return file, build_seal(file)


def test_kernels_of_files_are_those_called_linear():
    _, seal = example("sealed_bulb")
    same = with_kernels(seal, LINEAR)
    assert np.array_equal(same.body.support_radius, seal.body.support_radius)
    assert same.body.basis_order == seal.body.basis_order


def test_half_the_spacing_has_more_than_three_times_the_particles():
    file, seal = example("sealed_bulb")
    assert len(refined(file).nominal_particles) > 3 * len(seal.nominal_particles)


def test_contact_at_edges_is_halfway_between_particles():
    file, seal = example("lip")
    (here,) = (t for t in seal.definitions if isinstance(t, RigidContact))
    other = build_seal(touched_at(file, "edges"))
    (moved,) = (t for t in other.definitions if isinstance(t, RigidContact))
    x = seal.nominal_particles
    own, middle = here.where.points.at(x), moved.where.points.at(x)
    nearest = np.sort(np.hypot(*(middle[:, None] - own).T), axis=0)[:2]
    # both ends of an edge are contact points but for held ones
    inner = nearest[1] < 1.5 * nearest[0]
    assert inner.sum() > 0.8 * len(middle)
    np.testing.assert_allclose(nearest[0, inner], nearest[1, inner], rtol=1e-12)


@pytest.mark.release
def test_both_bases_converge_and_the_quadratic_one_is_no_better():
    file, seal = example("sealed_bulb")
    exact = fine_forces(file)
    linear, quadratic = (
        force_error(forces(with_kernels(seal, kernels)), exact) for kernels in (LINEAR, QUADRATIC)
    )
    fine = force_error(forces(with_kernels(refined(file), LINEAR)), exact)
    assert fine < 0.5 * linear
    assert linear < quadratic < 0.015


@pytest.mark.release
def test_contact_at_edges_misses_the_tip_of_a_lip():
    file, seal = example("slipping_lip")
    exact = fine_forces(file)
    assert force_error(forces(build_seal(touched_at(file, "edges"))), exact) > 1.5 * force_error(
        forces(seal), exact
    )


@pytest.mark.long
def test_quadratic_basis_has_no_smaller_error_of_stress_in_a_solid_section():
    """A half disc with half as many particles as the page shows, away from the ends of its foot."""
    file = read_seal_file(REFERENCES / "half_disc.toml")
    file = replace(file, section=replace(file.section, spacing=0.57))
    fine, seal = analyze(refined(file)), build_seal(file)
    linear, quadratic = (
        stress_error(analyze(with_kernels(seal, kernels)), fine, 1.2)
        for kernels in (LINEAR, QUADRATIC)
    )
    assert 0.04 < linear < 0.06
    assert quadratic > linear


def test_error_of_stress_is_that_of_a_scaled_stress():
    """Of a cloud against itself with the stress 10 % larger."""
    _, seal = example("sealed_bulb")
    result = analyze(seal)
    places, stress = result.section_stress()

    class Larger:
        def section_stress(self):
            return places, 1.1 * stress

    assert stress_error(result, result, 1.0) < 1e-12
    assert stress_error(result, Larger(), 1.0) == pytest.approx(0.1, rel=1e-9)
