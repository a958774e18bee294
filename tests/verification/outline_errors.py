"""Error of the door seal when its section is filled as that of any seal file, by spacing."""

import numpy as np

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import straight_motion
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.door.section import Section
from seal_mdao.seals.door.shapes import FlatDoor
from seal_mdao.seals.file.build import boundaries_of
from seal_mdao.seals.outline.arcs import Arc, Circle
from seal_mdao.seals.outline.contours import Contour, Outline
from seal_mdao.seals.outline.outline_seal import BodyModel, OutlineSeal, outline_seal
from seal_mdao.seals.outline.section_cloud import Kernels
from seal_mdao.seals.outline.segments import Line
from seal_mdao.seals.result import analyze
from seal_mdao.seals.wall_grid import ray_directions
from verification.error_sources import STEPS
from verification.flat_door_reference import reaction_errors

START, DEPTH = 10.0, 10.0
"""The door's flat at the start; its final depth below the top of the nominal seal, mm."""


def door_outline() -> Outline:
    """The nominal door seal as contours."""
    section = Section()
    top, base = section.outer_radius, section.base_angle
    foot = (top * np.tan(base), -top)
    touch = tuple((top * ray_directions(np.array(2.0 * base))).tolist())
    mirrored = [(-x, y) for x, y in (foot, touch)]
    first = np.arctan2(touch[1], touch[0])
    outer = (
        Line(mirrored[0], foot, "base"),
        Line(foot, touch, "seal"),
        Arc((0.0, 0.0), top, first, np.pi - 2.0 * first, "seal"),
        Line(mirrored[1], mirrored[0], "seal"),
    )
    return Outline(
        Contour(outer), (Contour((Circle((0.0, 0.0), section.inner_radius, "cavity"),)),)
    )


def flat_door_seal(
    spacing: float, kernels: Kernels | None = None, contact_points: str = "particles"
) -> OutlineSeal:
    """The door seal under the flat door with the cloud that a seal file with this spacing gets, and its
    kernels and contact points, or others."""
    end = Section().outer_radius - DEPTH
    motion = straight_motion((0.0, START), (0.0, end), STEPS)

    def door(section):
        where = section.contact_points(("seal",), contact_points)
        return RigidContact("door", where, FlatDoor(), motion, DoorOptions().law)

    return outline_seal(
        *boundaries_of(door_outline(), spacing), MooneyRivlin(), n_steps=STEPS,
        supports={"base": (0, 1)}, contributions=(door,), model=BodyModel(kernels=kernels),
    )  # fmt: skip


def reaction_error(seal: OutlineSeal) -> float:
    """Worst relative error of the reaction at 2, 4, 6, 8 and 10 mm."""
    result = analyze(seal)
    result.require_converged()
    top = Section().outer_radius
    door = np.linspace(START, top - DEPTH, STEPS + 1)[1:]
    errors = reaction_errors(top - door, result.path.reaction("door")[:, 1])
    return float(np.abs(errors).max())
