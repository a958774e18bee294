"""The measures of the door seal."""

from dataclasses import dataclass, replace

from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.gap import Gap, GapSquareIntegral, GapSquareSum
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.stress import StressNorm, VonMises

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
        return seal.before_touch

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


def curve_travels(seal) -> tuple:
    """Those of ``CURVE_TRAVELS`` that the door reaches."""
    return tuple(travel for travel in CURVE_TRAVELS if travel <= seal.depth)
