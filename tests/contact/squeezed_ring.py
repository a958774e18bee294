"""A thin ring squeezed between two plates until its inner walls touch: whole, with contact of the hole
with itself or of each half with a line on the mid-plane; and its upper half on that line."""

import numpy as np

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.contact.self_contact import SelfContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.measures.reaction import Reaction
from seal_mdao.structure.elastic_body import elastic_body

LAYERS, INNER, OUTER = 4, 9.5, 10.5
PENALTY = 4e3
"""Of a wall on the line; of a wall on a wall it is half of that, for the gap is twice as wide."""


def _grid(rays, half):
    """Numbers (layers, rays) from the inside, counter-clockwise from the mid-plane, and places."""
    count = rays // 2 + 1 if half else rays
    angle = 2.0 * np.pi * np.arange(count) / rays
    radius = np.linspace(INNER, OUTER, LAYERS)
    places = radius[:, None, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.arange(places[..., 0].size).reshape(LAYERS, count), places.reshape(-1, 2)


def ring_body(rays, half=False):
    """Held by its symmetry: across the mid-plane on it, sideways at its top and bottom."""
    at, places = _grid(rays, half)
    ends = at[:, :-1] if half else at
    following = at[:, 1:] if half else np.roll(at, -1, axis=1)
    corners = ends[:-1], ends[1:], following[1:], following[:-1]
    fixed = np.zeros((at.size, 2), bool)
    fixed[at[:, [0, rays // 2]], 1] = True
    fixed[at[:, rays // 4 :: rays // 2], 0] = True
    quarter = np.arange(rays // 8, rays // 2 - rays // 8 + 1)
    edges = {"top": Edge(at[-1, quarter], False), "upper": Edge(at[0, quarter[::-1]], False)}
    if not half:
        edges |= {
            "bottom": Edge(at[-1, quarter + rays // 2], False),
            "lower": Edge(at[0, (quarter + rays // 2)[::-1]], False),
            "hole": Edge(at[0, ::-1], True),
        }
    cells = np.column_stack([c.ravel() for c in corners])
    radius = np.full(at.size, 2.2 * max(2.0 * np.pi * OUTER / rays, (OUTER - INNER) / (LAYERS - 1)))
    return Body(cells, radius, fixed, edges, nominal=places)


def _flat(label, body, edge, places, up, penalty=PENALTY):
    """A line that faces up or down and goes through the heights ``places`` of its stages."""
    stages = [Stage(n, (0.0, dy), rates={} if dy == 0.0 else {"depth": (0.0, np.sign(dy), 0.0)})
              for n, dy in places[1:]]  # fmt: skip
    motion = staged_motion(stages, start=(0.0, places[0]), angle=180.0 if up else 0.0)
    law = ContactLaw(penalty, 0.1 * penalty, 0.0, True)
    where = body.edge_points(edge)
    return RigidContact(label, where, GivenShape(flat_profile()), motion, law, f"{label}_")


def ring(
    kind, rays=64, depth=9.2, steps=46, friction=0.0, turned=False, tolerance=1e-9, bulk=8_000.0,
):  # fmt: skip
    """``kind``: "half", "lines" or "itself". Design: wall from the inside, its top and bottom alone."""
    half = kind == "half"
    body = ring_body(rays, half)
    places = body.nominal
    radius = np.hypot(*places.T)[:, None]
    share, y = (OUTER - radius) / (OUTER - INNER), places[:, 1] / OUTER
    velocity = np.stack([-share * places / radius, -share * places / radius * (y**4)[:, None]])
    start = OUTER + 0.01
    terms = [_flat("plate", body, "top", (start, (steps, -depth)), False)]
    if not half:
        terms.append(_flat("under", body, "bottom", (-start, (steps, depth)), True))
    if kind != "itself":
        terms.append(_flat("line", body, "upper", (0.0, (steps, 0.0)), True))
    if kind == "lines":
        terms.append(_flat("mirror", body, "lower", (0.0, (steps, 0.0)), False))
    if kind == "itself":
        terms.append(itself(body, friction, turned))
    return sm.Seal(
        places, velocity, body, (elastic_body(sm.MooneyRivlin(80.0, 20.0, bulk)), *terms), steps,
        standard=(Reaction("plate"),), newton=sm.NewtonOptions(tolerance=tolerance),
    )  # fmt: skip


def itself(body, friction, turned=False):
    """Contact of the hole with itself; ``turned`` numbers its particles from elsewhere."""
    hole = body.edge("hole").particles
    hole = np.roll(hole, len(hole) // 2 + 3) if turned else hole
    touching = np.isin(hole, np.concatenate([body.edge(n).particles for n in ("upper", "lower")]))
    law = ContactLaw(0.5 * PENALTY, 0.05 * PENALTY, friction, True)
    return SelfContact("hole", (hole,), touching, body.nominal, law)
