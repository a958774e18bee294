"""Seals from boundaries: the ring of the paper on an unstructured cloud, gradients, reseeding."""

from dataclasses import replace

import numpy as np
import pytest
from boundaries import paper_ring
from verification.flat_door_reference import REACTION

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import straight_motion
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.section_shape import CavityArea, SectionArea
from seal_mdao.measures.work import StrainEnergy
from seal_mdao.seals.door.shapes import FlatDoor
from seal_mdao.seals.outline.offset_fields import OffsetDesign
from seal_mdao.seals.outline.outline_seal import outline_seal, reseed

pytest.importorskip("netgen")

DESIGNS = (OffsetDesign(("outer",), 14), OffsetDesign(("cavity",), 11))


MEASURES = (Reaction("door"), StrainEnergy(), CavityArea("cavity"), SectionArea())


def ring(spacing, n_steps=105, depth=10.0, **options):
    """The ring under a flat door that ends ``depth`` below its top."""
    motion = straight_motion((0.0, 10.0), (0.0, 9.5 - depth), n_steps)
    law = ContactLaw(1e4, 1e2, 0.25, True)

    def door(section):
        return RigidContact("door", section.contact_points(("outer",)), FlatDoor(), motion, law)

    seal = outline_seal(
        paper_ring(spacing), spacing, sm.MooneyRivlin(80.0, 20.0, 80_000.0), n_steps=n_steps,
        supports={"base": (0, 1)}, contributions=(door,), designs=DESIGNS,
    )  # fmt: skip
    return replace(seal, standard=MEASURES, **options)


def reaction_errors(spacing):
    """Relative errors of the vertical reaction at 2, 4, 6, 8 and 10 mm."""
    result = sm.analyze(ring(spacing))
    result.require_converged()
    reaction = result.path.reaction("door")[:, 1]
    travel = 0.1 * np.arange(1, 106) - 0.5
    at = np.abs(travel - REACTION[:, :1]).argmin(axis=1)
    return reaction[at] / REACTION[:, 1] - 1.0


def test_reaction_of_the_ring():
    assert np.abs(reaction_errors(0.9)).max() < 0.03


@pytest.mark.release
def test_reaction_converges():
    errors = [np.abs(reaction_errors(spacing)).max() for spacing in (0.9, 0.45, 0.3)]
    assert errors[0] < 0.03
    assert errors[1] < 0.01
    # the reference itself is good to 0.5 %
    assert errors[2] < max(errors[1], 0.005)


@pytest.fixture(scope="module")
def pressed():
    newton = sm.NewtonOptions(tolerance=1e-11)
    seal = ring(0.9, n_steps=18, depth=4.0, newton=newton)
    offsets = np.random.default_rng(4).uniform(-0.1, 0.1, seal.n_offsets)
    return seal, offsets, sm.analyze(seal, offsets)


def states(result):
    return np.array([response.branch for response in result.path.responses("door")])


def test_gradients_against_differences(pressed):
    """Fourth-order quotients along a random direction through the same contact sequence."""
    seal, offsets, result = pressed
    way = np.random.default_rng(5).uniform(-1.0, 1.0, seal.n_offsets)
    sensitivities = sm.differentiate(result, method="adjoint")
    step, weights = 2e-5, np.array([1.0, -8.0, 8.0, -1.0]) / 12.0
    sides = [sm.analyze(seal, offsets + k * step * way) for k in (-2, -1, 1, 2)]
    assert all(np.array_equal(states(side), states(result)) for side in sides)
    assert len(np.unique(states(result))) == 3
    for measure in seal.standard:
        values = np.array([np.atleast_1d(side.value(measure)) for side in sides])
        quotient, exact = weights @ values / step, sensitivities[measure.name] @ way
        assert np.abs(quotient - exact).max() <= 1e-5 * np.abs(exact).max(), measure.name


def test_direct_and_adjoint_agree(pressed):
    _, _, result = pressed
    direct, adjoint = (sm.differentiate(result, method=m) for m in ("direct", "adjoint"))
    for name in ("reaction", "strain_energy", "cavity_area", "section_area"):
        size = np.abs(direct[name]).max()
        np.testing.assert_allclose(direct[name], adjoint[name], rtol=0.0, atol=1e-9 * size)


def test_offsets_move_the_boundary_along_its_normals(pressed):
    """All control values of the cavity equal: its radius shrinks by as much, for the B-splines sum
    to one and its normals point inward. The base stays."""
    seal, _, _ = pressed
    offsets = np.concatenate([np.zeros(14), np.full(11, 0.2)])
    moved = seal.particles(offsets)
    np.testing.assert_allclose(np.hypot(*moved[seal.loops[1]].T), 7.3, rtol=1e-12)
    base = seal.body.edge("base").particles
    assert not seal.design_velocity[:, base].any()
    assert np.abs(seal.design_velocity[:14, seal.loops[0]]).max() > 0.6


def test_area_and_its_gradient(pressed):
    seal, offsets, _ = pressed
    area, gradient = seal.area(offsets)
    way = np.random.default_rng(6).uniform(-1.0, 1.0, seal.n_offsets)
    # quadratic in the offsets: central differences have no truncation error
    plus, minus = (seal.area(offsets + s * 0.01 * way)[0] for s in (1, -1))
    assert gradient @ way == pytest.approx((plus - minus) / 0.02, rel=1e-10)
    assert 90.0 < area < 120.0


def test_reseeded_seal_has_the_same_boundary_and_nearly_the_same_answer(pressed):
    seal, offsets, result = pressed
    new = reseed(seal, offsets)
    n = sum(len(loop) for loop in seal.loops)
    np.testing.assert_allclose(new.particles(offsets)[:n], seal.particles(offsets)[:n], atol=1e-13)
    assert np.array_equal(new.design_velocity[:, :n], seal.design_velocity[:, :n])
    again = sm.analyze(new, offsets)
    before, after = (r.value(seal.standard[0])[1] for r in (result, again))
    # two discretisations, each within its 3 %
    assert after == pytest.approx(before, rel=0.06)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"supports": {"foot": (0, 1)}},
            "supports: the section has no edge 'foot'; its edges are base, outer",
        ),
        (
            {"designs": [OffsetDesign(("foot",), 5)]},
            r"\[\[design\]\] 1: the section has no edge 'foot'; its edges are base, outer, cavity",
        ),
        ({"designs": [OffsetDesign(("base",), 5)]}, r"\[\[design\]\] 1: the edge 'base' is fixed"),
        ({"designs": [OffsetDesign(("outer",), 1)]}, "'outer' needs at least 2 design parameters"),
        (
            {"contributions": (lambda section: section.contact_points(("foot",)),)},
            "no edge 'foot'; its edges are: base, outer, cavity",
        ),
    ],
)
def test_names_that_cannot_be_meant_are_refused(change, message):
    given = {"supports": {"base": (0, 1)}, "n_steps": 1} | change
    with pytest.raises(ValueError, match=message):
        outline_seal(paper_ring(0.9), 0.9, sm.MooneyRivlin(), **given)
