"""Contact pressure along an edge against that of finite elements, ``pressure`` in ``references/*.json``.

Those of seal files are by ``references/felupe_pressure.py``, that of the door seal by ``door_pressure``.

Pressures are nominal: force over undeformed length, p = w_n |g_n| at a contact point. A contact point
stands for the boundary up to the middle between it and its neighbours. Its pressure is compared with the
mean of the reference over that part of the boundary, which matters at the ends of the contact.
Peak and width are compared with those of the reference itself, as a user reads them from the result.

The reference has the arc length of the undeformed edge, a result the chords between its points: up to
0.1 % of a width is that difference.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seal_mdao.measures.boundary_line import ordered_points
from seal_mdao.seals.profiles import contacts, nominal_pressure, profile_histories

REFERENCES = Path(__file__).parent / "references"
DOOR = "flat_door"
SECTIONS = ("half_disc", "o_ring", "bonded_gasket", "half_ring", "rounded_punch")


class PressureErrors(NamedTuple):
    """Errors of the contact pressure at the end of a stage.

    Attributes
    ----------
    rms : float
        Root of the mean square difference of pressures over the union of both contacts, over the
        reference's peak.
    peak, width : float
        Relative errors of the highest nominal pressure and of the undeformed width in contact.
    """

    rms: float
    peak: float
    width: float


@dataclass(frozen=True, eq=False)
class Reference:
    """Stored pressures along one half of an edge; the other half, x < 0, mirrors it.

    Attributes
    ----------
    name : str
    place : ndarray, shape (n, 2)
        Undeformed nodes from the middle of the contact, x = 0, in the coordinates of the seal file.
    length : ndarray, shape (n,)
        Their arc length from the middle, mm.
    pressure : ndarray, shape (k, n)
        At the ends of the stages, kPa; beyond the last node it is zero.
    peak, width : ndarray, shape (k,)
        Highest pressure, kPa, and undeformed width in contact, mm.
    """

    name: str
    place: np.ndarray
    length: np.ndarray
    pressure: np.ndarray
    peak: np.ndarray
    width: np.ndarray

    def along(self, place: np.ndarray) -> np.ndarray:
        """Signed arc length (k,) of the nearest points of the edge to ``place`` (k, 2)."""
        start, side = self.place[:-1], np.diff(self.place, axis=0)
        size = (side**2).sum(axis=1)
        right = np.abs(place) * [1.0, 0.0] + place * [0.0, 1.0]
        # t = (X - X_a) . (X_b - X_a) / |X_b - X_a|^2 of all sides, within them
        t = np.einsum("kmi,mi->km", right[:, None] - start, side) / size
        t = np.clip(t, 0.0, 1.0)
        away = np.linalg.norm(start + t[..., None] * side - right[:, None], axis=2)
        nearest, row = away.argmin(axis=1), np.arange(len(place))
        s = self.length[nearest] + t[row, nearest] * np.diff(self.length)[nearest]
        return np.copysign(s, place[:, 0])

    def means(self, stage: int, ends: np.ndarray) -> np.ndarray:
        """Means of the pressure of a stage between the signed arc lengths ``ends`` (k, 2)."""
        p, s = self.pressure[stage], self.length
        fine = np.linspace(0.0, s[-1], 4000)
        value = np.interp(fine, s, p)
        # P(s) = int_0^s p ds, odd in s
        total = np.append(0.0, np.cumsum(0.5 * np.diff(fine) * (value[1:] + value[:-1])))
        integral = np.copysign(np.interp(np.abs(ends), fine, total), ends)
        width = np.diff(ends)[:, 0]
        empty = np.abs(width) < 1e-12
        return np.where(empty, 0.0, np.diff(integral)[:, 0] / np.where(empty, 1.0, width))


def stored(name: str) -> Reference:
    """Read the pressures of a section."""
    known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))["pressure"]
    stages = known["stages"]
    return Reference(
        name, np.array(known["place_mm"]), np.array(known["arc_length_mm"]),
        *(np.array([s[key] for s in stages]) for key in ("pressure_kPa", "peak_kPa", "width_mm")),
    )  # fmt: skip


def uncertainty(name: str) -> list[PressureErrors]:
    """Of the stages of a reference: the change by mesh or by load steps, whichever is larger."""
    known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))["pressure"]
    changes = known["change_on_coarse_mesh"], known["change_with_half_the_load_steps"]
    return [
        PressureErrors(
            *(max(abs(own[key]) for own in both) for key in ("rms_over_peak", "peak", "width"))
        )
        for both in zip(*changes, strict=True)
    ]


def point_intervals(place: np.ndarray, closed: bool) -> np.ndarray:
    """Ends (k, 2, 2) of the parts of the boundary that its contact points ``place`` (k, 2) stand for."""
    middle = 0.5 * (place[1:] + place[:-1])
    joint = 0.5 * (place[:1] + place[-1:])
    # the end points of an open edge have half of a part
    first, last = (joint, joint) if closed else (place[:1], place[-1:])
    return np.stack([np.vstack([first, middle]), np.vstack([middle, last])], axis=1)


def pressure_errors(result, reference: Reference, label: str | None = None) -> list[PressureErrors]:
    """Compare the pressure of a result with a reference at the ends of the stages.

    Parameters
    ----------
    result : SealResult
        Of a path that has reached its end.
    reference : Reference
    label : str, optional
        Of the profile; the first one unless given.
    """
    histories = {own.label: own for own in profile_histories(result)}
    label = next(iter(histories)) if label is None else label
    history, contact = histories[label], next(c for c in contacts(result.seal) if c.label == label)
    place = result.term(label).reference
    closed = len(ordered_points(result.term(label).where)) > len(place)
    ends = reference.along(point_intervals(place, closed).reshape(-1, 2)).reshape(-1, 2)
    # the reference touches nowhere beyond the stored part of the edge
    near = np.abs(reference.along(place)) < reference.length[-1]
    length, found = np.where(near, np.abs(np.diff(ends)[:, 0]), 0.0), []
    for stage, (peak, width) in enumerate(zip(reference.peak, reference.width, strict=True)):
        step = np.flatnonzero(history.stage == stage + 1)[-1]
        pressure = nominal_pressure(contact, result.path.at_nominal(label)[step])
        exact = reference.means(stage, ends)
        # the part of a point's length that is in contact: all of it, or that of the reference
        covered = np.abs(np.diff(np.clip(ends, -0.5 * width, 0.5 * width))[:, 0])
        union = np.where(pressure > 0.0, length, np.minimum(covered, length))
        # rms over the union of both contacts
        square = np.average((pressure - exact) ** 2, weights=union)
        errors = np.sqrt(square), history.nominal_peak[step], history.nominal_width[step]
        found.append(PressureErrors(errors[0] / peak, errors[1] / peak - 1, errors[2] / width - 1))
    return found
