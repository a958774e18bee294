"""A bulb on rays, touched at its particles or between them: forces against those of a finer one."""

import numpy as np

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.door.shapes import FlatDoor
from seal_mdao.seals.file.build import boundaries_of
from seal_mdao.seals.outline.arcs import Arc, Circle
from seal_mdao.seals.outline.contours import Contour, Outline
from seal_mdao.seals.outline.outline_seal import OutlineSeal, outline_seal
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.segments import Line
from verification.file_errors import force_error, forces

COMPARED = ("particles", "edges")
"""Contact points whose errors are compared."""

CENTRE, TOP, HOLE = (0.0, 7.0), 14.0, 4.5
"""Of the rays and of the hole; the top of the bulb and the radius of the hole, mm."""
FOOT = CENTRE[1] * np.tan(np.pi / 6.0)
"""Half the width of the base, whose ends are seen from the centre at 30 degrees from below, mm."""
CLEAR, DOWN, ACROSS, STEPS = 0.5, 6.0, 2.0, (40, 10)
"""Way of a flat door: where it starts above the top, how far it goes down, then across, mm; steps."""


def ray_bulb(rays: int, layers: int, accuracy: str, contact_points: str) -> OutlineSeal:
    """A bulb on a base, pressed by a flat door that then goes across; ``rays`` a multiple of 12."""
    outer = (
        Line((-FOOT, 0.0), (FOOT, 0.0), "base"),
        Arc.through((FOOT, 0.0), (0.0, TOP), (-FOOT, 0.0), "seal"),
    )
    outline = Outline(Contour(outer), (Contour((Circle(CENTRE, HOLE, "cavity"),)),))
    stages = Stage(STEPS[0], (0.0, -DOWN)), Stage(STEPS[1], (ACROSS, 0.0))
    motion = staged_motion(stages, (0.0, TOP + CLEAR))

    def door(section):
        where = section.contact_points(("seal",), contact_points)
        return RigidContact("door", where, FlatDoor(), motion, DoorOptions().law)

    return outline_seal(
        *boundaries_of(outline, Rays(rays, layers, CENTRE, accuracy)), MooneyRivlin(),
        n_steps=sum(STEPS), supports={"base": (0, 1)}, contributions=(door,),
    )  # fmt: skip


def limit(rays: int = 144, layers: int = 6) -> tuple[list, float]:
    """Mean of both contacts on a fine wall, and by how much they differ."""
    one, other = (forces(ray_bulb(rays, layers, "fine", points)) for points in COMPARED)
    mean = [0.5 * (a + b) for a, b in zip(one, other, strict=True)]
    return mean, force_error(one, other)
