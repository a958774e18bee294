"""Types of measures of the force on a profile: the force at travels, its difference from a target."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.geometry.motion import ROUNDING
from seal_mdao.measures.load_deflection import LoadDeflectionError
from seal_mdao.measures.reaction import TRAVEL, Reaction
from seal_mdao.seals.file.forms import Form, Names, Point, Text, many, number, one_of, whole
from seal_mdao.seals.file.measure_table import KINDS, MeasureTable, OfProfile, kind
from seal_mdao.seals.file.model_table import AXIAL, axis_edges
from seal_mdao.seals.file.schema import key, known
from seal_mdao.seals.file.target_curve import read_target
from seal_mdao.seals.file.viscoelastic_table import relaxes

__all__ = ["KINDS", "LoadDeflectionErrorTable", "ReactionTable", "reaction_of"]

_AXES = {"x": 0, "y": 1}
Travels = Annotated[
    number(least=0.0) | many(number(least=0.0), "a list of travels"),
    Form("a travel along the path, a number of at least 0, or a list of them (mm)"),
]
Stages = Annotated[
    whole(1, 1000) | many(whole(1, 1000), "a list of stages"),
    Form("the number of a stage, from 1 on, or a list of them"),
]
Times = Annotated[
    number(above=0.0) | many(number(above=0.0), "a list of times"),
    Form("a time from the beginning of the path on, a number above 0, or a list of them (s)"),
]
Forces = many(number(), "a list of numbers")
Weights = many(number(least=0.0), "a list of numbers of at least 0")


def _some_direction(given):
    if given == (0.0, 0.0):
        raise ValueError
    return given


Direction = Annotated[
    Literal[TRAVEL] | Annotated[Point, AfterValidator(_some_direction)],
    Form(f'a direction [x, y] that is not [0, 0], or "{TRAVEL}"'),
]


def reaction_of(profile="", component=None, travel=None, stage=None, time=None, **own):
    # both axes for a direction, which the measure projects on
    axes = (0, 1) if component is None else (_AXES[component],)
    travels, stages, times = (
        given if given is None or isinstance(given, tuple) else (given,)
        for given in (travel, stage, time)
    )
    return Reaction(profile, travels, axes, stages=stages, times=times, **own)


@kind("reaction", reaction_of)
class ReactionTable(OfProfile):
    """Force of the seal on a profile, or on fixed or moved edges."""

    edges: Names | None = key(
        "instead of a profile or [[moved]]: fixed or moved edges on which the force acts", None
    )

    component: one_of(*_AXES) | None = key(
        "axis of the force; default without direction: the axis of the first translation, of a "
        "profile that does not move that of the first moving profile",
        None,
    )
    direction: Direction | None = key(
        'direction of the force, a vector of any length; or "travel": against the motion of the'
        " profile, positive if the seal resists it",
        None,
    )
    travel: Travels | None = key(
        "distance of the profile along its path, or a list of distances; for a profile that does not "
        "move, along the path of the first moving profile; default: the end",
        None,
    )
    stage: Stages | None = key(
        "instead of travel: ends of stages, which are those of the first profile or moved edges that "
        "move or have several stages, also for the force on another profile",
        None,
    )
    time: Times | None = key("instead of travel: times, for a seal whose material relaxes", None)
    length: number("mm", above=0.0) | None = key(
        "length of the seal for a force in N; default: force per length in N/m", None
    )

    @staticmethod
    def takes(moving) -> bool:
        return True

    @model_validator(mode="after")
    def _one_direction(self):
        if self.edges is not None and self.profile is not None:
            raise ValueError("the keys edges and profile are given together; use only one of them")
        # an axis, or a vector
        if self.component is not None and self.direction is not None:
            raise ValueError(
                "the keys component and direction are given together; use only one of them"
            )
        # one kind of places on the path
        if len(self._places) > 1:
            raise ValueError(
                f"the keys {' and '.join(self._places)} are given together; use only one of them"
            )
        return self

    @property
    def _places(self) -> dict:
        """What is given of travel, stage and time."""
        given = {name: getattr(self, name) for name in ("travel", "stage", "time")}
        return {name: own for name, own in given.items() if own is not None}

    @property
    def single(self) -> bool:
        """Unless there is a list of travels, stages or times."""
        return not any(isinstance(own, tuple) for own in self._places.values())

    @property
    def count(self):
        given = next(iter(self._places.values()), None)
        return len(given) if isinstance(given, tuple) else 1

    def settled(self, where, profiles):
        if self.edges is not None:
            # along the axis of the first travel of what moves
            done = MeasureTable.settled(self, where, profiles)
            own = next((p for p in profiles if p.travel > 0.0), profiles[0])
        else:
            done = super().settled(where, profiles)
            own = next(p for p in profiles if p.name == done.profile)
        # the first travel, of a profile that stands still that of the first one that travels, gives
        # the axis where there is no component or direction
        moving = next((p for p in (own, *profiles) if p.travel > 0.0), own)
        if done.component is None and done.direction is None:
            done = replace(done, component=_main_axis(moving))
        if done.direction == TRAVEL and not own.travel > 0.0:
            raise SealFileError(
                f"{where}: direction = {TRAVEL!r}, but the profile {own.name!r} does not move; "
                "give the direction as [x, y]"
            )
        # travels are those of the same profile; up to rounding, they end with the path
        if done.travel is not None and np.max(done.travel) > moving.travel * (1.0 + ROUNDING):
            raise SealFileError(
                f"{where}: travel = {np.max(done.travel):g}, but the total travel of the profile "
                f"{moving.name!r} is only {moving.travel:.6g} mm"
            )
        return done

    def check(self, where, file):
        stages = len(file.stages)
        if self.stage is not None and np.max(self.stage) > stages:
            raise SealFileError(
                f"{where}: stage = {np.max(self.stage)}, but the motion has only {stages} "
                f"stage{'s' if stages > 1 else ''}"
            )
        if self.time is not None and not relaxes(file):
            raise SealFileError(
                f"{where}: time needs a viscoelastic material ([material.NAME.viscoelastic]), "
                "without which stages take no time; use travel or stage instead"
            )
        # a force on an edge needs a prescribed component; the axis of revolution is no support
        axis = axis_edges(file.section.outline) if file.axisymmetric else ()
        supports = [n for n, own in file.supports.items() if n not in axis or AXIAL in own]
        for name in self.edges or ():
            known(where, "edges", name, file.section.outline.edge_names, "edge")
            if name not in supports:
                raise SealFileError(
                    f"{where}: the list edges contains {name!r}, which is neither fixed nor moved; "
                    f"the fixed and moved edges are {', '.join(supports) or 'none'}"
                )


def _main_axis(profile) -> str:
    """Find the axis along which the first translation of a profile moves most; y without one."""
    # the larger component of the first stage that is not at rest
    for stage in profile.stages:
        if any(stage.translate):
            return "x" if abs(stage.translate[0]) > abs(stage.translate[1]) else "y"
    return "y"


def _load_deflection_error(value, data=None, weight=None, **own):
    # forces as the measure "reaction" gives them; the file of targets has been read
    return LoadDeflectionError(reaction_of(**own), value, weight)


@kind("load_deflection_error", _load_deflection_error)
class LoadDeflectionErrorTable(ReactionTable):
    """Sum of the squared relative differences between the force and a target curve."""

    value: Forces | None = key(
        "target force at every travel, stage or time, in the units of the force", None
    )
    weight: Weights | None = key("weight of each force in the sum; default: 1", None)
    data: Text | None = key(
        "instead of travel and value: CSV file with the columns travel_mm and force, relative "
        "to this file",
        None,
    )

    single = True
    count = 1

    def read(self, where, folder):
        if self.data is None:
            return self
        if self._places or self.value is not None:
            raise SealFileError(
                f"{where}: the target curve is given twice, by data and by travel with value; use "
                "only one of them"
            )
        try:
            travel, value = read_target(folder / self.data)
        except SealFileError as error:
            raise SealFileError(f"{where}: data: {error}") from None
        return replace(self, travel=travel, value=value)

    def settled(self, where, profiles):
        if not self._places or self.value is None:
            raise SealFileError(
                f"{where}: the target curve is missing; give travel and value, or data"
            )
        # one number is a curve of one point
        (place, given), *_ = self._places.items()
        places = given if isinstance(given, tuple) else (given,)
        for name, own in (("value", self.value), ("weight", self.weight)):
            if own is not None and len(own) != len(places):
                raise SealFileError(
                    f"{where}: the list {name} has {len(own)} numbers, but {place} has "
                    f"{len(places)}; both lists must have the same length"
                )
        if not all(self.value):
            raise SealFileError(
                f"{where}: value contains a target force of 0, but differences are relative to the "
                f"targets; leave out the {place} with this target"
            )
        if self.weight is not None and not any(self.weight):
            raise SealFileError(
                f"{where}: all weights of the target forces are zero; at least one weight must be "
                "above 0"
            )
        return replace(super().settled(where, profiles), **{place: places})
