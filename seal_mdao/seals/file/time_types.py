"""Types of measures of a seal that relaxes: retained force, time to a force, compression set."""

from pydantic import model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.measures.retention import CompressionSet, RetainedForce, TimeToForceFraction
from seal_mdao.seals.file.force_types import (
    KINDS,
    ReactionTable,
    reaction_of,
)
from seal_mdao.seals.file.forms import Point, number, one_of, whole
from seal_mdao.seals.file.measure_table import MeasureTable, kind, nearest
from seal_mdao.seals.file.schema import key
from seal_mdao.seals.file.viscoelastic_table import dwells, relaxes

__all__ = ["KINDS", "CompressionSetTable", "RetainedForceTable", "TimeToForceFractionTable"]


@kind("retained_force", lambda **own: RetainedForce(reaction_of(**own)))
class RetainedForceTable(ReactionTable):
    """Force at the second of two stages or times divided by that at the first, F(t) / F(0)."""

    single = True
    count = 1

    @model_validator(mode="after")
    def _two(self):
        given = self.stage if self.time is None else self.time
        if not isinstance(given, tuple) or len(given) != 2:
            raise ValueError(
                "the key stage or time must have two numbers, such as stage = [1, 2] for the force "
                "at the end of stage 2 relative to that at the end of stage 1"
            )
        return self


def _time_to_force_fraction(fraction, stage=1, **own):
    return TimeToForceFraction(reaction_of(**own), fraction, stage)


@kind("time_to_force_fraction", _time_to_force_fraction)
class TimeToForceFractionTable(ReactionTable):
    """Time from the end of a stage until the force has fallen to a fraction of its value there."""

    fraction: number(above=0.0, most=0.99) = key("fraction of the force at the end of the stage")
    stage: whole(1, 1000) = key("stage at whose end the time begins; a dwell must follow", 1)

    single = True
    count = 1

    def check(self, where, file):
        if not relaxes(file):
            raise SealFileError(
                f"{where}: {self.type} needs a viscoelastic material; add "
                "[material.NAME.viscoelastic], or leave out this measure"
            )
        super().check(where, file)
        if self.stage == len(file.stages) or not dwells(file, self.stage):
            raise SealFileError(
                f"{where}: stage = {self.stage}, but the next stage is not a dwell (a stage in "
                "which neither profiles nor temperature, swelling or fluid pressure change); give "
                "the number of the stage before a dwell"
            )


@kind("compression_set", CompressionSet)
class CompressionSetTable(MeasureTable):
    """Fraction of the compression that remains at the end, (h_0 - h) / (h_0 - h_closed)."""

    at: Point = key("a point of the surface that is compressed; the nearest particle is taken")
    component: one_of("x", "y") = key("axis of the compression", "y")
    stage: whole(1, 1000) = key("stage at whose end the seal is closed", 1)

    def measure(self, particles):
        point = nearest(self.at, particles)
        return self.makes(point, "xy".index(self.component), self.stage)

    def check(self, where, file):
        stages = len(file.stages)
        if self.stage >= stages:
            raise SealFileError(
                f"{where}: stage = {self.stage}, but the motion has only {stages} "
                f"stage{'s' if stages > 1 else ''}, and compression set is measured after a later "
                "stage"
            )
