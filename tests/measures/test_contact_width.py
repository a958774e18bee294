"""Width of contact on a closed boundary: a ring between a core and a plate."""

import numpy as np
import pytest
from quotients import quotients

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.geometry.motion import straight_motion
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.measures.contact_pressure import ContactWidth, PeakPressure
from seal_mdao.measures.gap import LargestGap
from seal_mdao.measures.reaction import Reaction
from seal_mdao.rkpm.cells import support_radii
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import edge_points

RAYS = 24
MEASURES = (
    ContactWidth("plate"), PeakPressure("plate"),
    Reaction("plate", (0.2, 0.4), direction="travel", name="against"),
)  # fmt: skip


def ring(first: int) -> sm.Seal:
    """A rubber ring on a fixed core under a plate; its outer boundary is counted from ``first`` on."""
    angles = 2.0 * np.pi * np.arange(RAYS) / RAYS
    unit = np.column_stack([np.cos(angles), np.sin(angles)])
    particles = np.concatenate([radius * unit for radius in (3.0, 4.0, 5.0)])
    inner, nxt = np.arange(RAYS), np.roll(np.arange(RAYS), -1)
    cells = np.concatenate(
        [np.column_stack([a + inner, b + inner, b + nxt, a + nxt])
         for a, b in ((0, RAYS), (RAYS, 2 * RAYS))]
    )  # fmt: skip
    fixed = np.zeros((len(particles), 2), bool)
    fixed[:RAYS] = True
    body = Body(
        cells, support_radii(cells, particles, 2.0), fixed,
        {"outer": Edge(np.roll(2 * RAYS + inner, -first), True)}, particles,
    )  # fmt: skip
    plate = RigidContact(
        "plate", body.edge_points("outer"), GivenShape(flat_profile()),
        straight_motion((0.1, 5.05), (0.3, 4.7), 6, {"depth": (0.0, -1.0)}),
        ContactLaw(1e4, 1e2, 0.2, True),
    )  # fmt: skip
    wider = np.zeros((1, *particles.shape))
    wider[0, 2 * RAYS :] = unit
    return sm.Seal(
        particles, wider, body, (elastic_body(sm.MooneyRivlin(80.0, 20.0, 2000.0)), plate), 6,
        MEASURES, newton=sm.NewtonOptions(tolerance=1e-11),
    )  # fmt: skip


@pytest.fixture(scope="module")
def seam_in_contact():
    """The boundary begins and ends at the top, in the middle of the contact."""
    return sm.analyze(ring(RAYS // 4), keep_factors=True)


def test_width_does_not_depend_on_where_the_boundary_begins(seam_in_contact):
    elsewhere = sm.analyze(ring(3 * RAYS // 4))
    widths = [float(r.value(ContactWidth("plate"))[0]) for r in (seam_in_contact, elsewhere)]
    side = 10.0 * np.sin(np.pi / RAYS)
    assert widths[0] > 2.0 * side  # the seam lies inside
    assert widths[0] == pytest.approx(widths[1], rel=1e-9)


def test_derivatives_across_the_seam(seam_in_contact):
    names = ("depth", "c10", "normal_penalty")
    direct, adjoint = (
        sm.differentiate(seam_in_contact, names, method=method) for method in ("direct", "adjoint")
    )
    for column, name in enumerate(direct.parameters):
        step = 1.0 if name == "normal_penalty" else 1e-4
        found = quotients(seam_in_contact.seal, name, step)
        for measure in MEASURES:
            one, other = (rates[measure.name][:, column] for rates in (direct, adjoint))
            quotient, bound = found[measure.name]
            assert np.abs(one - other).max() <= 1e-10 * np.abs(one).max(), (name, measure.name)
            assert (np.abs(quotient - one) <= bound).all(), (name, measure.name)
            assert bound.max() <= 1e-4 * np.abs(one).max(), (name, measure.name)


def test_the_part_that_nothing_touches_is_no_gap(seam_in_contact):
    """The boundary is closed: its longest open part lies outside of the contact, seam or not."""
    measure = LargestGap("plate").frozen(seam_in_contact)
    assert float(seam_in_contact.value(measure)[0]) == 0.0


def test_points_between_particles_are_refused(seam_in_contact):
    sides = edge_points(seam_in_contact.seal.body.edges["outer"].sides)
    with pytest.raises(ValueError, match="between particles"):
        _ = sides.at_particles
