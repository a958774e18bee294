"""The measures of the door seal and where they are taken: chosen once on the drawn seal, then frozen."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.contact import Gap, GapSquareIntegral, GapSquareSum, Reaction
from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.selection import (
    boundary_peaks,
    contact_patches,
    opened_points,
    touching_stretch,
)
from seal_mdao.measures.stress import STRESS_COUNT, StressNorm, VonMises
from seal_mdao.seals.result import analyze
from seal_mdao.seals.seal import Seal
from seal_mdao.values import instance

DOOR = "door"
"""Label of the contact with the door."""
CURVE_TRAVELS = (2.0, 4.0, 6.0, 8.0, 10.0)
"""Door travels of the standard reaction curve, mm; those within the depth are taken."""


@dataclass(frozen=True)
class ReactionCurve(Reaction):
    """Force on the door at travels from the first touch of the drawn seal.

    Attributes
    ----------
    travels : tuple of float, or None
        mm; None for those of ``CURVE_TRAVELS`` that the drawn seal's door reaches. A design whose door
        does not reach them all cannot be measured.
    components : tuple of int
        0 horizontal, 1 vertical; one after the other at every travel.
    """

    profile: str = DOOR
    components: tuple = (1,)
    name: str = "reaction_curve"
    text = "Force of the seal on the door at door travels from the first touch of the drawn seal."

    def before(self, seal):
        return seal.start - seal.section.outer_radius

    @property
    def takes_places(self):
        return self.travels is None

    def frozen(self, drawn):
        travels = curve_travels(drawn.seal)
        if not travels:
            raise ValueError(
                f"measure {self.name!r} has no entries for a depth of {drawn.seal.depth} mm; leave it "
                "out"
            )
        return replace(self, travels=travels)


STANDARD = (VonMises(), Gap(DOOR), GapSquareSum(Gap(DOOR)), Reaction(DOOR))
"""The measures that an OpenMDAO component has unless others are asked for."""
FURTHER = (
    GapSquareIntegral(DOOR), StressNorm(), ContactPressure(DOOR, nominal=True, name="patch_pressure"),
    ReactionCurve(),
)  # fmt: skip
"""Optional measures."""
BY_NAME = {measure.name: measure for measure in (*STANDARD, *FURTHER)}


@dataclass(frozen=True, eq=False)
class MeasurePoints:
    """Frozen places of the measures.

    Attributes
    ----------
    stress : ndarray of int
        Particles at which the von Mises stress is a measure.
    gap : ndarray of int
        Contact points whose normal gap is a measure.
    stretch : ndarray of int
        Contact points from the first to the last one in contact.
    patches : tuple of ndarray of int
        All contact points, divided in the middle of the opened stretch.
    curve : tuple of float
        Door travels at which the reaction is a measure, mm.
    """

    stress: np.ndarray
    gap: np.ndarray
    stretch: np.ndarray
    patches: tuple
    curve: tuple


def measure_points(seal) -> MeasurePoints:
    """Places of the measures, from an analysis of the drawn seal, once for a seal.

    Raises
    ------
    LoadPathError
        When the drawn seal's path cannot be completed.
    """
    instance("seal", seal, Seal)
    return _points_of(seal.as_drawn())


@lru_cache(maxsize=64)
def _points_of(seal) -> MeasurePoints:
    return analyze(seal).points


def chosen_points(drawn) -> MeasurePoints:
    """Peaks of the stress, the opened stretch and the patches at the end of the drawn seal's path."""
    grid, state = drawn.seal.grid, drawn.contact.state
    inner = grid.particle(np.arange(grid.rays), 0)
    rows = [(grid.free_outer, False), (inner, True)]
    return MeasurePoints(
        boundary_peaks(rows, drawn.stress_field(), STRESS_COUNT), opened_points(state),
        touching_stretch(state != OPEN), contact_patches(state), curve_travels(drawn.seal),
    )  # fmt: skip


def curve_travels(seal) -> tuple:
    """Those of ``CURVE_TRAVELS`` that the door reaches."""
    return tuple(travel for travel in CURVE_TRAVELS if travel <= seal.depth)


def measures_at(points: MeasurePoints, measures) -> tuple:
    """Measures of the door seal with the places ``points``."""
    return tuple(_at(points, measure) for measure in measures)


def _at(points: MeasurePoints, measure):
    if not measure.takes_places:
        return measure
    if isinstance(measure, GapSquareSum):
        return replace(measure, base=_at(points, measure.base))
    if isinstance(measure, ReactionCurve):
        return replace(measure, travels=points.curve)
    places = {
        VonMises: ("points", points.stress), Gap: ("points", points.gap),
        GapSquareIntegral: ("nominal", points.stretch),
    }  # fmt: skip
    if isinstance(measure, ContactPressure):
        return replace(measure, patches=tuple(tuple(patch.tolist()) for patch in points.patches))
    name, values = places[type(measure)]
    return replace(measure, **{name: tuple(values.tolist())})
