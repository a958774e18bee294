"""The same seal in another frame or in other units: results must not change."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.loading import LoadProgram
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.geometry.profile import ARC, RigidProfile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.model import SealModel
from seal_mdao.verification.rotation import rotation_matrix
from seal_mdao.verification.solving import completed


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
    none = np.zeros(len(kind))
    return RigidProfile.of(
        kind.copy(), np.ascontiguousarray(frame.places(origin[order])),
        angle[order] + frame.angle, np.where(kind == ARC, frame.size, 1.0) * radius, start, length,
        np.zeros((len(kind), 2)), none, none, none,
    )  # fmt: skip


def analyze_in_frame(model: SealModel, frame: Frame) -> FrameResult:
    """The drawn seal of ``model`` written in ``frame``: particles, door, material and penalties."""
    cells = model.body.cells[:, ::-1] if frame.mirrored else model.body.cells
    body = replace(
        model.body, cells=np.ascontiguousarray(cells),
        support_radius=frame.size * model.body.support_radius,
    )  # fmt: skip
    m, law, unit = model.material, model.law, frame.stress / frame.size
    material = MooneyRivlin(*(frame.stress * c for c in (m.c10, m.c01, m.bulk_modulus)))
    law = ContactLaw(
        unit * law.normal_penalty, unit * law.tangent_penalty, law.friction, law.accumulated
    )
    profile = moved_profile(model.profile(model.drawn_door_radius), frame)
    program = LoadProgram(frame.size * frame.vectors(model.positions))
    disc = discretize(body, frame.places(model.particles()))
    path = completed(solve_path(disc, material, profile, law, program, model.newton))
    back = frame.matrix / frame.size
    return FrameResult(
        path.reaction @ back / frame.stress, path.displacement() @ back,
        path.steps[-1].gap / frame.size, path.contact_state,
    )  # fmt: skip
