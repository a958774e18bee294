"""A block under two profiles at once that come, slide, turn and go: a plate from above, a roll from
the side."""

from dataclasses import dataclass

import numpy as np
from pressed_block import pressed_block

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.geometry.profile import circle_profile, flat_profile
from seal_mdao.measures.work import ProfileWork, StrainEnergy
from seal_mdao.structure.elastic_body import elastic_body


@dataclass(frozen=True)
class Plate:
    names = ()

    def profile(self):
        return flat_profile()


@dataclass(frozen=True)
class Roll:
    radius: float
    names = ("radius",)

    def profile(self):
        return circle_profile((0.0, 0.0), self.radius)


# travel and turn of the stages
PLATE = [((0.0, -0.33), 0.0), ((0.25, -0.02), 3.0), ((0.0, 0.4), 0.0), ((-0.25, -0.05), -3.0)]
ROLL = [((-0.3, 0.0), 0.0), ((-0.02, 0.15), 25.0), ((0.37, 0.0), 0.0), ((-0.05, -0.15), -25.0)]


def two_profiles(friction, steps=6, way="loop"):
    """The seal. The profiles come and stay ("in"), go back the way they came ("back"), or go on to
    where they were ("loop"); the parameters ``press`` and ``twist`` leave this one closed."""
    block, motions = pressed_block(), []
    for stages, start, pivot, name, rate in (
        (PLATE, (0.0, 2.073), (0.4, -0.2), "press", (0.0, -1.0, 0.0)),
        (ROLL, (4.06, 1.1), (0.2, 0.3), "twist", (0.0, 0.0, 1.0)),
    ):
        first, last = (0, 2) if name == "press" else (1, 3)
        back = {name: tuple(-r for r in rate)}
        parts = [
            Stage(steps, *stage, {first: {name: rate}, last: back}.get(i, {}))
            for i, stage in enumerate(stages)
        ]
        if way != "loop":
            turns = [Stage(steps, (-x, -y), -turn) for (x, y), turn in stages[1::-1]]
            parts = [Stage(steps, *stage) for stage in stages[:2]] + turns * (way == "back")
        motions.append(staged_motion(parts, start, pivot=pivot))
    law = ContactLaw(1e4, 1e3, friction, True)
    rubber = elastic_body(sm.MooneyRivlin(80.0, 20.0, 20_000.0))
    plate = RigidContact("plate", block.body.edge_points("top"), Plate(), motions[0], law, "plate_")
    roll = RigidContact(
        "roll", block.body.edge_points("right"), Roll(1.0), motions[1], law, "roll_"
    )
    n_steps = motions[0].n_steps
    return sm.Seal(
        block.nominal_particles, block.design_velocity, block.body, (rubber, plate, roll), n_steps,
        (ProfileWork("plate", "plate_work"), ProfileWork("roll", "roll_work"), StrainEnergy()),
        newton=block.newton,
    )  # fmt: skip


def stored_energy(result):
    """Elastic energy and that of the normal penalties after every nominal step."""
    found = []
    for step in result.path.nominal_steps:
        energy = result.term("structure").energy(step.d, step.fraction)
        for label in ("plate", "roll"):
            term, gap = result.term(label), np.minimum(result.response(label, step).gap, 0.0)
            energy += 0.5 * term.law.normal_penalty * term.length @ gap**2
        found.append(energy)
    return np.array(found)
