"""The four extensions in one seal: a block on springs, pressed and sheared by an ellipse."""

import numpy as np
from arruda_boyce import ArrudaBoyce
from elastic_foundation import ElasticFoundation
from ellipse import Ellipse
from highest_point import HighestPoint

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.measures.reaction import Reaction
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import edge_points


def pressed_block():
    """6 mm by 2 mm, its base fixed, springs at the sides; design: height and slant of the top."""
    x, y = np.meshgrid(np.linspace(-3.0, 3.0, 9), np.linspace(0.0, 2.0, 4))
    particles = np.column_stack([x.ravel(), y.ravel()])
    at = np.arange(36).reshape(4, 9)
    corners = (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1])
    fixed = np.zeros((36, 2), bool)
    fixed[at[0]] = True
    # every edge is walked with the body on the left
    edges = {
        "top": Edge(at[-1, ::-1], closed=False),
        "left": Edge(at[::-1, 0], closed=False),
        "right": Edge(at[:, -1], closed=False),
    }
    body = Body(np.column_stack([c.ravel() for c in corners]), np.full(36, 1.3), fixed, edges)
    velocity = np.zeros((2, 36, 2))
    velocity[:, :, 1] = particles[:, 1] / 2 * np.array([np.ones(36), particles[:, 0] / 3])

    sides = edge_points(np.concatenate([edges["left"].sides, edges["right"].sides]))
    motion = staged_motion(
        [Stage(5, (0.0, -0.6), rates={"depth": (0.0, -1.0, 0.0)}), Stage(3, (0.4, 0.0), 10.0)],
        start=(0.1, 3.05),
    )
    terms = (
        elastic_body(ArrudaBoyce(modulus=200.0, links=8.0, bulk_modulus=20_000.0)),
        ElasticFoundation("springs", sides, 300.0),
        RigidContact(
            "roll", body.edge_points("top"), Ellipse(1.5, 1.0), motion,
            ContactLaw(1e4, 1e3, 0.3, True), prefix="roll_",
        ),
    )  # fmt: skip
    return sm.Seal(
        particles,
        velocity,
        body,
        terms,
        n_steps=8,
        standard=(HighestPoint(), Reaction("roll")),
        newton=sm.NewtonOptions(tolerance=1e-11),
    )
