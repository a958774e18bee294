"""The seal problem that a recorder file belongs to."""

import json
import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import openmdao.api as om

from seal_mdao.openmdao_access import CaseReaderHooks
from seal_mdao.recording.plain_reading import reading, refuse_objects, text_options
from seal_mdao.seals.door.door_seal import DoorSeal
from seal_mdao.seals.seal import SETTINGS_OPTION

PROBLEM_OPTION = "problem_settings"
"""Option of the recorded model with the other arguments of ``seal_problem`` that define the problem,
as JSON: what a restart needs to set up the same problem again."""


@dataclass(frozen=True, eq=False)
class RecordedProblem:
    """What ``seal_problem`` needs to set up a recorded problem again.

    Attributes
    ----------
    seal : DoorSeal
    settings : dict
        Further keyword arguments of ``seal_problem``.
    """

    seal: DoorSeal
    settings: dict


class PlainCaseReader(CaseReaderHooks):
    """``CaseReader`` that loads no pickles; of the options of systems those are known that are text."""

    def read_options(self, blob):
        return text_options(blob)


def open_cases(path) -> om.CaseReader:
    """Reader of a recorder file, which runs nothing that is in it.

    Raises
    ------
    ValueError
        For a file that is not there or is no recorder file.
    """
    if not Path(path).is_file():
        raise ValueError(f"{path} is not a file")
    with reading(path), closing(sqlite3.connect(path)) as connection:
        refuse_objects(connection)
        return PlainCaseReader(str(path))


def recorded_problem(reader: om.CaseReader) -> RecordedProblem | None:
    """The problem of a recorder file; None when there is no seal in it.

    Raises
    ------
    ValueError
        When the settings are those of another version of the package.
    """
    for options in reader.list_model_options(out_stream=None).values():
        if options.get(SETTINGS_OPTION):
            seal = DoorSeal.from_settings(options[SETTINGS_OPTION])
            return RecordedProblem(seal, recorded_settings(reader))
    return None


def recorded_seals(reader: om.CaseReader) -> dict[str, DoorSeal | None]:
    """The seal of every ``SealGroup`` and ``ScenarioGroup`` by the group's path, empty for the model
    itself; None for a seal that cannot be made again from the file.

    Raises
    ------
    ValueError
        When the settings are those of another version of the package.
    """
    found = {}
    for path, options in reader.list_model_options(out_stream=None).items():
        if SETTINGS_OPTION in options:
            text = options[SETTINGS_OPTION]
            found["" if path == "root" else path] = DoorSeal.from_settings(text) if text else None
    return found


def recorded_settings(reader: om.CaseReader) -> dict:
    """The arguments that define the problem of a recorder file, as far as it holds them."""
    for options in reader.list_model_options(out_stream=None).values():
        if PROBLEM_OPTION in options:
            return json.loads(options[PROBLEM_OPTION])
    return {}
