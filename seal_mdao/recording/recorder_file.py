"""Contents of a recorder file: the model, and the cases of its driver."""

import json
from dataclasses import dataclass, field

import numpy as np
from openmdao.recorders.sqlite_recorder import format_version
from openmdao.utils.units import convert_units

from seal_mdao.recording.plain_reading import (
    PlainDatabase,
    checked_units,
    fields,
    numbers,
    reading,
    unpacked,
)

OLDEST_FORMAT = 14
"""Oldest format that is read; older ones hold more pickles, and this package wrote none of them."""
OBJECTIVE, CONSTRAINT, DESIGN = "objective", "constraint", "desvar"
"""Kinds of variables of a driver."""

CASE = {"counter": int, "success": int, "msg": str | None, "inputs": str, "outputs": str}
METADATA = dict.fromkeys(("abs2prom", "abs2meta", "var_settings", "conns"), bytes)


@dataclass(eq=False)
class Case:
    """One recorded evaluation.

    Attributes
    ----------
    counter : int
        Number of the case in the file.
    failure : str
        Reason of a failed analysis; empty for a success.
    inputs, outputs : dict of str to ndarray
        Recorded values by absolute name, in the model's units.
    totals : dict of str to ndarray
        Total derivatives in driver scaling by ``"of!wrt"``; empty if they were not recorded or read.
    """

    counter: int
    failure: str
    inputs: dict
    outputs: dict
    totals: dict = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class RecordedModel:
    """The recorded model.

    Attributes
    ----------
    promoted, units, shapes, kinds : dict
        Promoted name, unit (or None), shape (or None), and kinds in the driver (``OBJECTIVE``,
        ``CONSTRAINT``, ``DESIGN``) of every variable by absolute name.
    sources : dict of str to str
        Outputs by the inputs that are connected to them.
    variables : dict of str to dict
        Settings of the driver's variables.
    driver : dict
        Name, type and abilities of the driver.
    options : dict of str to dict
        Text options of all systems by path; empty for the model itself.
    """

    promoted: dict
    units: dict
    shapes: dict
    kinds: dict
    sources: dict
    variables: dict
    driver: dict
    options: dict

    def values(self, case: Case, kind: str) -> dict[str, np.ndarray]:
        """Return the flat values of the driver's variables of one kind, in their declared units."""
        found = {}
        for name, settings in self.variables.items():
            source = settings["source"]
            if kind not in self._kinds_of(settings) or source not in case.outputs:
                continue
            value = case.outputs[source].ravel()
            if settings["indices"] is not None:
                value = value[settings["indices"]].ravel()
            found[name] = convert_units(value, self.units[source], settings["units"])
        return found

    def _kinds_of(self, settings: dict) -> set[str]:
        """Return the kinds of one of the driver's variables by its settings.

        The same output may be a constraint under an alias as well. A design variable that is a
        constraint without alias has the settings of the constraint only.
        """
        if "equals" not in settings:
            return {_kind_without_equals(settings)}
        source = settings["source"]
        own = {
            _kind_without_equals(other)
            for other in self.variables.values()
            if other["source"] == source and "equals" not in other
        }
        replaced = DESIGN in self.kinds[source] and DESIGN not in own
        return {CONSTRAINT, DESIGN} if replaced else {CONSTRAINT}


def open_model(path) -> RecordedModel:
    """Read the model of a recorder file; no code of the file is run.

    Raises
    ------
    ValueError
        For a file that does not exist or is no recorder file.
    """
    with reading(path) as database:
        return read_model(database)


def read_model(database: PlainDatabase) -> RecordedModel:
    """Read the model of an open recorder file.

    Raises
    ------
    ValueError
        For a format that is not supported, or metadata of several models.
    """
    # one row per model
    versions = database.rows("metadata", {"format_version": int})
    if len(versions) != 1:
        raise ValueError(
            f"the table 'metadata' of the recorder file has {len(versions)} rows, not one"
        )
    version = versions[0][0]
    if version < OLDEST_FORMAT:
        raise ValueError(
            f"the format {version} of the recorder file is older than {OLDEST_FORMAT}, the oldest "
            "supported format; record the optimisation again"
        )
    if version > format_version:
        raise ValueError(
            f"the format {version} of the recorder file is newer than {format_version}, the format "
            "of the installed OpenMDAO; update OpenMDAO"
        )
    (row,) = database.rows("metadata", METADATA)
    names, metadata, variables, sources = map(unpacked, row)
    variables.pop("execution_order", None)
    # the tree of systems with their options, as the N2 diagram shows it
    viewed = database.rows("driver_metadata", {"model_viewer_data": str})
    viewer = json.loads(viewed[0][0]) if viewed else {}
    # convert_units evaluates units as Python: check them before
    for settings in (*metadata.values(), *variables.values()):
        checked_units(settings.get("units"))
    return RecordedModel(
        promoted=names["input"] | names["output"],
        units={name: own.get("units") for name, own in metadata.items()},
        shapes={name: _shape(own.get("shape")) for name, own in metadata.items()},
        kinds={name: own.get("type", ()) for name, own in metadata.items()},
        sources=sources,
        variables=variables,
        driver=viewer.get("driver") or {},
        options=_text_options(viewer["tree"]) if viewer else {},
    )


def _kind_without_equals(settings: dict) -> str:
    """Return whether settings are those of a design variable, which has bounds, or of an objective."""
    return DESIGN if "lower" in settings else OBJECTIVE


def _shape(found) -> tuple | None:
    """Return a recorded shape as a tuple; None for anything else."""
    is_shape = isinstance(found, list | tuple) and all(isinstance(size, int) for size in found)
    return tuple(found) if is_shape else None


def _text_options(tree: dict) -> dict[str, dict[str, str]]:
    """Collect the text options of all systems of a tree by path; those of a list are joined."""
    # depth first, without recursion: a file may nest its tree arbitrarily deep
    found, waiting = {}, [("", tree)]
    while waiting:
        path, system = waiting.pop()
        options = system.get("options") or {}
        found[path] = {name: value for name, value in options.items() if isinstance(value, str)}
        found[path] |= {
            name: "".join(value)
            for name, value in options.items()
            if isinstance(value, list) and all(isinstance(piece, str) for piece in value)
        }
        inner = [child for child in system.get("children") or () if child["type"] == "subsystem"]
        prefix = f"{path}." if path else ""
        waiting += [(prefix + child["name"], child) for child in reversed(inner)]
    return found


def read_driver_cases(database: PlainDatabase) -> list[tuple[int, Case]]:
    """Read iteration number and evaluation of every case of the driver, in order."""
    rows = database.numbered_rows("driver_iterations", {"iteration_coordinate": str} | CASE)
    # coordinates such as rank0:Uno|12
    return [(int(coordinate.rsplit("|", 1)[1]), _case(*row)) for coordinate, *row in rows]


def read_totals(database: PlainDatabase) -> dict[int, dict]:
    """Read the total derivatives by the number of the case to which they belong."""
    found = {}
    columns = {"counter": int, "derivatives": bytes}
    for counter, blob in database.numbered_rows("driver_derivatives", columns):
        # the fields of the array are named "of!wrt"
        found.setdefault(counter, {}).update(fields(blob))
    return found


def read_problem_case(database: PlainDatabase) -> Case | None:
    """Read the last case that the problem itself recorded."""
    rows = database.numbered_rows("problem_cases", CASE)
    return _case(*rows[-1]) if rows else None


def read_gradient_counters(database: PlainDatabase) -> set[int]:
    """Read the numbers of the cases after which a gradient was recorded."""
    return {counter for (counter,) in database.rows("driver_derivatives", {"counter": int})}


def _case(counter, success, message, inputs, outputs) -> Case:
    # the driver may give no reason of a failure
    failure = "" if success else message or "the analysis failed"
    return Case(counter, failure, numbers(inputs), numbers(outputs))
