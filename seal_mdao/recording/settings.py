"""The seal problem that a recorder file belongs to."""

import json
from contextlib import suppress
from dataclasses import dataclass

from seal_mdao.recording.plain_reading import PlainDatabase, reading
from seal_mdao.recording.recorder_file import RecordedModel, read_model
from seal_mdao.seals.seal import SETTINGS_OPTION, Seal
from seal_mdao.seals.settings import seal_of

PROBLEM_OPTION = "problem_settings"
"""Option of the recorded model with the other arguments of ``seal_problem`` that define the problem,
as JSON: what a restart needs to set up the same problem again."""


@dataclass(frozen=True, eq=False)
class RecordedProblem:
    """What ``seal_problem`` needs to set up a recorded problem again.

    Attributes
    ----------
    seal : Seal
    settings : dict
        Further keyword arguments of ``seal_problem``.
    """

    seal: Seal
    settings: dict


def open_model(path) -> RecordedModel:
    """The model of a recorder file, of which nothing is run.

    Raises
    ------
    ValueError
        For a file that is not there or is no recorder file.
    """
    with reading(path), PlainDatabase(path) as database:
        return read_model(database)


def recorded_problem(model: RecordedModel) -> RecordedProblem | None:
    """The problem of a recorder file; None when there is no seal in it.

    Raises
    ------
    ValueError
        When the settings are those of another version of the package.
    """
    for options in model.options.values():
        if options.get(SETTINGS_OPTION):
            seal = seal_of(options[SETTINGS_OPTION])
            return RecordedProblem(seal, recorded_settings(model))
    return None


def recorded_seals(model: RecordedModel) -> dict[str, Seal | None]:
    """The seal of every ``SealGroup`` and ``ScenarioGroup`` by the group's path, empty for the model
    itself; None for a seal that cannot be made again from the file.

    Raises
    ------
    ValueError
        When the settings are those of another version of the package.
    """
    texts = {
        path: options[SETTINGS_OPTION]
        for path, options in model.options.items()
        if SETTINGS_OPTION in options
    }
    return {path: seal_of(text) if text else None for path, text in texts.items()}


def recorded_settings(model: RecordedModel) -> dict:
    """The arguments that define the problem of a recorder file, as far as it holds them.

    Raises
    ------
    ValueError
        When they are no JSON object.
    """
    for options in model.options.values():
        if PROBLEM_OPTION in options:
            with suppress(RecursionError):
                found = json.loads(options[PROBLEM_OPTION])
                if isinstance(found, dict):
                    return found
            raise ValueError(f"its {PROBLEM_OPTION} are not those of a problem")
    return {}
