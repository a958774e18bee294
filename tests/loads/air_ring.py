"""A ring held at its foot, pressed and sheared by a plate that may go back; its hole sealed, vented or
open."""

import numpy as np

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.loads.trapped_air import TrappedAir
from seal_mdao.loads.vented_air import VentedAir
from seal_mdao.measures.fluid import CavityPressure
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.section_shape import CavityArea
from seal_mdao.structure.elastic_body import elastic_body

RAYS, LAYERS, INNER, OUTER = 24, 3, 4.0, 6.0
WEIGHTS = np.array([1, -8, 8, -1]) / 12.0
"""Of a central difference of fourth order at -2, -1, 1 and 2 steps."""


def ring_particles(axis=None):
    """Layer by layer from the inside, rays counter-clockwise from straight down, shape (n, 2); around a
    point at the distance ``axis`` from the axis of a body of revolution."""
    angle = np.linspace(0.0, 2.0 * np.pi, RAYS, endpoint=False) - 0.5 * np.pi
    radius = np.linspace(INNER, OUTER, LAYERS)
    own = radius[:, None, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return own.reshape(-1, 2) + np.array([axis or 0.0, 0.0])


def ring_body(axis=None):
    at = np.arange(RAYS * LAYERS).reshape(LAYERS, RAYS)
    following = np.roll(at, -1, axis=1)
    corners = at[:-1], at[1:], following[1:], following[:-1]
    fixed = np.zeros((at.size, 2), bool)
    fixed[at[-1, [-2, -1, 0, 1, 2]]] = True
    edges = {"outer": Edge(at[-1, 3:-2], False), "cavity": Edge(at[0, ::-1], True)}
    cells = np.column_stack([c.ravel() for c in corners])
    nominal = ring_particles(axis)
    return Body(
        cells, np.full(at.size, 2.4), fixed, edges, nominal=nominal,
        axisymmetric=axis is not None,
    )  # fmt: skip


def change_of_residual(result, rng) -> tuple:
    """The factor of the last tangent, displacements (n,), and the change of the residual along them.

    The step is 1e-3 of the penetration of points in contact, so that all stay as they are.
    """
    step, path = result.path.steps[-1], result.path
    problem = PathProblem(path.discretization, result.seal.terms())
    factor, layout = problem.factorize_at(step), path.discretization.layout
    along = rng.standard_normal(layout.n_equations)
    h, spread = 1e-6, layout.gather(along)

    def residual(share):
        d = step.d + share * h * spread
        return problem.evaluate(d, step.fraction, step.before, tangent=False).residual

    return factor, along, WEIGHTS @ [residual(s) for s in (-2, -1, 1, 2)] / h


def air_ring(
    sealed=True, friction=0.3, back=False, depth=1.2, finer=1, shear=0.4, rest=None,
    axis=None, **air,
):  # fmt: skip
    """Design: thickness of the wall, an egg-shaped hole, one side of the hole. ``rest``: seconds of a
    dwell between the two stages; ``axis``: distance of the middle from the axis of a body of
    revolution."""
    particles, body = ring_particles(), ring_body(axis)
    radius = np.hypot(*particles.T)[:, None]
    away, (x, y) = particles / radius, particles.T
    share = (OUTER - radius) / (OUTER - INNER)
    velocity = np.stack(
        [share * away, share * away * (y**2 / 16)[:, None], share * away * x[:, None]]
    )
    stages = [
        Stage(4 * finer, (0.0, -depth), rates={"depth": (0.0, -1.0, 0.0)}),
        Stage(3 * finer, (shear, -0.2)),
    ]
    if rest is not None:
        stages.insert(1, Stage(2 * finer, duration=rest))
    if back:
        stages += [Stage(3 * finer, (-shear, 0.2)), Stage(4 * finer, (0.0, depth))]
    plate = RigidContact(
        "plate", body.edge_points("outer"), GivenShape(flat_profile()),
        staged_motion(stages, start=(0.0, OUTER + 0.013)), ContactLaw(1e4, 1e3, friction, True),
    )  # fmt: skip
    ring = body.edge("cavity").particles
    if "vent_diameter" in air:
        # time is counted by the travel of the nominal plate
        travel, time = plate.motion.timing
        trapped = (VentedAir("air", ring, travel=travel, time=time, **air),)
    else:
        trapped = (TrappedAir("air", ring, **air),) if sealed else ()
    return sm.Seal(
        body.nominal, velocity, body,
        (elastic_body(sm.MooneyRivlin(80.0, 20.0, 20_000.0)), plate, *trapped),
        sum(stage.steps for stage in stages),
        standard=(
            *((CavityPressure("air"),) if sealed else ()), CavityArea("cavity"), Reaction("plate"),
        ),
        newton=sm.NewtonOptions(tolerance=1e-12),
    )  # fmt: skip
