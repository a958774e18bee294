"""Keys ``steps`` and ``penalties`` of a seal file: given, or chosen (``seals.steps_and_penalties``)."""

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import AfterValidator

from seal_mdao.errors import SealFileError
from seal_mdao.geometry.motion import increases_to_one
from seal_mdao.seals.file.forms import Form, many, number, whole
from seal_mdao.seals.file.schema import Table, key, table
from seal_mdao.seals.steps_and_penalties import PENALTY_TOLERANCE, STEP_TOLERANCE

MOST_STEPS = 100_000
CHOSEN = "auto"
_Count = whole(1, MOST_STEPS)


def _increasing(fractions: tuple) -> tuple:
    # 0 < s_1 < ... < s_n = 1
    if not increases_to_one(fractions):
        raise ValueError
    return fractions


# "auto" leaves the steps open, as no key does
Steps = Annotated[
    Literal[CHOSEN]
    | _Count
    | Annotated[many(number(above=0.0, most=1.0), "a list"), AfterValidator(_increasing)],
    AfterValidator(lambda given: None if given == CHOSEN else given),
    Form(
        f"a whole number from 1 to {MOST_STEPS}, a list of fractions of the stage that increase to 1.0, "
        f'or "{CHOSEN}"'
    ),
]
"""How many equal ones, or the fractions of the stage at their ends; None to be chosen."""


@table
class StepsTable(Table):
    """Allowed error for the choice of load steps that the stages do not give."""

    tolerance: number(above=0.0, most=1.0) = key(
        "largest admissible relative change of a measure or of the force on a profile by a "
        "further halving of the load steps (allowed error)",
        STEP_TOLERANCE,
    )


@table
class PenaltiesTable(Table):
    """Allowed error for the choice of penalties that the contacts do not give."""

    tolerance: number(above=0.0, most=1.0) = key(
        "largest admissible relative error that the penalties cause in a measure or a force, and "
        "largest relative penetration and elastic slip (allowed error)",
        PENALTY_TOLERANCE,
    )


def with_steps(profiles: tuple, moved: tuple, steps: StepsTable | None) -> tuple:
    """Return profiles and moved edges with load steps, and the tolerance within which these are to be
    chosen, or None.

    Stages whose steps are to be chosen have None; they get one.

    Raises
    ------
    SealFileError
        When only some of the stages have steps, or all of them and there is a tolerance.
    """
    # all stages have steps, or none has
    named = [
        (f"[[{kind}]] {i} ({own.name!r}): [[{kind}.stage]] {k}", stage.steps)
        for kind, tables in (("profile", profiles), ("moved", moved))
        for i, own in enumerate(tables, 1)
        for k, stage in enumerate(own.stages, 1)
    ]
    # the first stage without steps is named in messages
    without = [where for where, own in named if own is None]
    if not without:
        if steps is not None:
            raise SealFileError(
                "[steps]: tolerance has no effect, because all stages have steps; leave out "
                "tolerance, or the steps of all stages"
            )
        return profiles, moved, None
    # some stages have steps and others none: one choice for all
    for where, own in named:
        if own is not None:
            raise SealFileError(
                f"{where} has a number of load steps (steps), but {without[0]} has none; give "
                "steps in all stages, or in no stage for an automatic choice"
            )
    tolerance = (StepsTable() if steps is None else steps).tolerance
    return one_step_each(profiles), one_step_each(moved), tolerance


def one_step_each(profiles) -> tuple:
    """Give every stage one load step, as the start of the choice."""
    # stages keep their travels and turns
    return tuple(
        replace(profile, stages=tuple(replace(stage, steps=1) for stage in profile.stages))
        for profile in profiles
    )
