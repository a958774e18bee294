"""Edges of a section by their names: order along the boundary, particles, contact points."""

from types import SimpleNamespace

import numpy as np
import pytest

from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.seals.outline.section_body import SectionBody


@pytest.fixture
def section():
    """A loop of six particles in three edges, the first of which begins at particle 0."""
    particles = {"foot": [0, 1, 2], "right": [2, 3, 4], "left": [4, 5, 0]}
    edges = {name: Edge(np.array(own), False) for name, own in particles.items()}
    fixed = np.zeros((6, 2), bool)
    fixed[1] = True
    body = SimpleNamespace(
        edges=edges, edge=edges.__getitem__, fixed=fixed, n_particles=6, axisymmetric=False
    )
    return SectionBody(body, (np.arange(6),), 1)


@pytest.mark.parametrize(
    ("names", "order"),
    [
        (("foot", "left"), ["left", "foot"]),
        (("left", "right"), ["right", "left"]),
        (("left", "foot", "right"), ["foot", "right", "left"]),
        (("right",), ["right"]),
    ],
)
def test_neighbouring_edges_follow_one_another(section, names, order):
    """Across the beginning of the loop, too; all round from the first edge of the loop."""
    assert section.in_order(names) == order


def test_particles_are_those_of_the_edges_once_and_in_order(section):
    assert section.particles(("left", "foot")).tolist() == [4, 5, 0, 1, 2]


def test_contact_points_do_not_depend_on_the_order_of_the_names(section):
    """Free particles from one end of the stretch to the other; or the middles of its sides."""
    one, other = (section.contact_points(names) for names in (("foot", "left"), ("left", "foot")))
    assert one.at_particles.tolist() == other.at_particles.tolist() == [4, 5, 0, 2]
    x = np.column_stack([np.arange(6.0), np.zeros(6)])
    middles = section.contact_points(("foot", "left"), "edges").points.at(x)
    np.testing.assert_allclose(middles[:, 0], [4.5, 2.5, 0.5, 1.5], atol=1e-15)
