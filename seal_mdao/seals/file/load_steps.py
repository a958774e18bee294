"""Load steps of a seal file: given for every stage, or left to be chosen (``[steps]``)."""

from dataclasses import replace

from seal_mdao.errors import SealFileError
from seal_mdao.geometry.motion import increases_to_one
from seal_mdao.seals.choice import STEP_TOLERANCE
from seal_mdao.seals.file.checks import Check, Key, number, table, whole

MOST_STEPS = 100_000
CHOSEN = "auto"


def _steps(value):
    """None to be chosen, how many equal ones, or the shares of the stage at their ends."""
    if value == CHOSEN:
        return None
    if not isinstance(value, list):
        return whole(1, MOST_STEPS).convert(value)
    shares = tuple(map(number(above=0.0, most=1.0).convert, value))
    if not shares or not increases_to_one(shares):
        raise ValueError
    return shares


STEPS = Check(
    f'{whole(1, MOST_STEPS).allowed}, a list of shares of the stage that increase to 1.0, or "{CHOSEN}"',
    _steps,
)
KEYS = {"tolerance": Key(number(above=0.0, most=1.0), STEP_TOLERANCE)}


def read_steps(given, profiles: tuple) -> tuple[tuple, float | None]:
    """Profiles whose stages have load steps, and the tolerance within which these are to be chosen.

    Parameters
    ----------
    given : object
        What the file has as ``[steps]``; None for nothing.
    profiles : tuple of ProfileTable
        Stages whose steps are to be chosen have None; they get one.

    Raises
    ------
    SealFileError
        When only some of the stages have steps, or all of them and there is a tolerance.
    """
    values = table("[steps]", {} if given is None else given, KEYS)
    named = [
        (f"[[profile]] {i} ({profile.name!r}): [[profile.stage]] {k}", stage.steps)
        for i, profile in enumerate(profiles, 1)
        for k, stage in enumerate(profile.stages, 1)
    ]
    without = [where for where, steps in named if steps is None]
    if not without:
        if given is not None:
            raise SealFileError(
                "[steps]: tolerance is for load steps that are chosen, but all stages have steps; leave "
                "out either"
            )
        return profiles, None
    for where, steps in named:
        if steps is not None:
            raise SealFileError(
                f"{where} has steps, but {without[0]} has none; give them to all stages, or to none, to "
                "have them chosen"
            )
    return one_step_each(profiles), values["tolerance"]


def one_step_each(profiles) -> tuple:
    """The profiles with one load step for every stage, for a choice to begin with."""
    return tuple(
        replace(profile, stages=tuple(replace(stage, steps=1) for stage in profile.stages))
        for profile in profiles
    )
