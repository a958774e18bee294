"""The same seal in another frame or in other units: results must not change."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from seal_mdao.geometry.motion import Motion
from seal_mdao.geometry.profile import ARC, Pieces, RigidProfile, rigid_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.seals.door.door_seal import DOOR, options_of
from seal_mdao.seals.seal import Seal
from seal_mdao.structure.elastic_body import elastic_body
from verification.rotation import rotation_matrix
from verification.solving import solve


class Frame(NamedTuple):
    """A way to write the same problem: x -> size (Q M x + shift), stresses times ``stress``.

    Attributes
    ----------
    angle : float
        Radians, of the rotation Q.
    mirrored : bool
        Whether M turns x into -x first.
    shift : tuple of float
    size, stress : float
        Units: 1e-3 and 1e3 write millimetres and kilopascals in metres and pascals.
    """

    angle: float = 0.0
    mirrored: bool = False
    shift: tuple[float, float] = (0.0, 0.0)
    size: float = 1.0
    stress: float = 1.0

    @property
    def matrix(self) -> np.ndarray:
        """Q M, an orthogonal matrix."""
        return rotation_matrix(self.angle) * [-1.0 if self.mirrored else 1.0, 1.0]

    def vectors(self, v: np.ndarray) -> np.ndarray:
        """Directions in this frame, without the unit of length."""
        return v @ self.matrix.T

    def places(self, x: np.ndarray) -> np.ndarray:
        return self.size * (self.vectors(x) + self.shift)


class FrameResult(NamedTuple):
    """Results brought back to the original frame and units.

    Attributes
    ----------
    reaction : ndarray, shape (n_steps, 2)
        N/m.
    displacement : ndarray, shape (n, 2)
        mm.
    gap : ndarray, shape (k,)
        mm.
    state : ndarray of int
        Contact states of all steps.
    """

    reaction: np.ndarray
    displacement: np.ndarray
    gap: np.ndarray
    state: np.ndarray


def moved_profile(profile: RigidProfile, frame: Frame) -> RigidProfile:
    """The profile in another frame; a mirrored one is walked the other way round.

    The rates with respect to the corner radius are left out.
    """
    end_angle = profile.angle + np.where(profile.kind == ARC, profile.length / profile.radius, 0.0)
    end = profile.origin + profile.length[:, None] * np.column_stack(
        [np.cos(profile.angle), np.sin(profile.angle)]
    )
    origin, angle, length = profile.origin, profile.angle, profile.length
    order = slice(None)
    if frame.mirrored:
        is_line = profile.kind == 0
        origin = np.where(is_line[:, None], end, origin)
        # a line walked back and mirrored keeps -angle; an arc starts at its mirrored end
        angle = np.where(is_line, -angle, np.pi - end_angle)
        order = slice(None, None, -1)
    kind, length, radius = profile.kind[order], frame.size * length[order], profile.radius[order]
    start = np.concatenate([[0.0], np.cumsum(length)[:-1]])
    return rigid_profile(Pieces(
        kind, frame.places(origin[order]),
        angle[order] + frame.angle, np.where(kind == ARC, frame.size, 1.0) * radius, start, length,
    ))  # fmt: skip


def analyze_in_frame(seal: Seal, frame: Frame) -> FrameResult:
    """The drawn ``seal`` written in ``frame``: particles, door, material and penalties."""
    cells = seal.body.cells[:, ::-1] if frame.mirrored else seal.body.cells
    particles = frame.places(seal.nominal_particles)
    axes = seal.body.support_axes
    body = replace(
        seal.body, cells=np.ascontiguousarray(cells), nominal=particles,
        support_radius=frame.size * seal.body.support_radius,
        support_axes=None if axes is None else axes @ frame.matrix.T / frame.size,
    )  # fmt: skip
    options = options_of(seal)
    material, law, unit = options.material, options.law, frame.stress / frame.size
    stresses = {name: frame.stress * value for name, value in material.constants.items()}
    law = law._replace(
        normal_penalty=unit * law.normal_penalty, tangent_penalty=unit * law.tangent_penalty
    )
    motion = options.motion
    places, clearance = (
        frame.size * frame.vectors(way) for way in (motion.positions, motion.clearance)
    )
    contact = replace(
        seal.terms()[1], law=law,
        shape=GivenShape(moved_profile(options.shape.profile(), frame)),
        motion=Motion(places, motion.angles, motion.steps, clearance=clearance,
                      fractions=motion.fractions),
    )  # fmt: skip
    terms = elastic_body(material.with_(**stresses)), contact
    path = solve(body, particles, terms, seal.n_steps, options=seal.newton)
    back = frame.matrix / frame.size
    return FrameResult(
        path.reaction(DOOR) @ back / frame.stress, path.displacement() @ back,
        path.at_nominal(DOOR)[-1].gap / frame.size,
        np.array([response.state for response in path.responses(DOOR)]),
    )  # fmt: skip
