"""Vary the travel of a profile of a seal file; measures at travels beyond its end are left out."""

from pathlib import Path

import numpy as np

from seal_mdao.measures.reaction import ROUNDING
from seal_mdao.seals.file.target_curve import read_target


def set_travel(tables: dict, profile: str, travel: float, folder: Path) -> dict[str, float]:
    """Set the travel (mm) of the first stage of a profile, of others in proportion.

    Measures at travels that its path does not reach any more are removed from the tables.

    Parameters
    ----------
    tables : dict
        Of a seal file, which are changed.
    profile : str
    travel : float
    folder : Path
        Of the file.

    Returns
    -------
    dict of str to float
        Farthest travel of every removed measure, mm, by its name.
    """
    stages = [own for own in _profile(tables, profile)["stage"] if any(own.get("translate", ()))]
    # t_i <- t_i travel / |t_1|
    factor = travel / float(np.hypot(*stages[0]["translate"]))
    for stage in stages:
        stage["translate"] = [factor * own for own in stage["translate"]]
    length = sum(float(np.hypot(*stage["translate"])) for stage in stages)
    beyond = {}
    for row in tables.get("measure", ()):
        farthest = _farthest(row, folder)
        if _path_of(row, tables) == profile and farthest > length * (1.0 + ROUNDING):
            beyond[row.get("name", row["type"])] = farthest
    if beyond:
        _remove(tables, beyond)
    return beyond


def _profile(tables, name) -> dict:
    return next(own for own in tables["profile"] if own["name"] == name)


def _farthest(row, folder) -> float:
    """Return the largest travel at which a measure is evaluated, mm; 0 without travels."""
    if "data" in row:
        return max(read_target(folder / row["data"])[0])
    return float(np.max(row.get("travel", 0.0)))


def _path_of(row, tables) -> str:
    """Return the name of the profile along whose path the travels of a measure are counted."""
    travelling = [
        own["name"] for own in tables["profile"]
        if any(any(stage.get("translate", ())) for stage in own.get("stage", ()))
    ]  # fmt: skip
    # of one that stands still, and of edges, the first one that travels
    own = row.get("profile", tables["profile"][0]["name"])
    if not travelling or (own in travelling and "edges" not in row):
        return own
    return travelling[0]


def _remove(tables: dict, names) -> None:
    """Remove measures, and the optimisation, which may need them; its other measures stay."""
    optimize = tables.pop("optimize", {})
    rows = tables["measure"]
    asked = [optimize.get("minimize"), *(c["measure"] for c in optimize.get("constraint", ()))]
    for name in dict.fromkeys(own for own in asked if own is not None):
        # a measure that is named by its type alone
        if name not in [row.get("name", row["type"]) for row in rows]:
            rows.append({"type": name})
    left = [row for row in rows if row.get("name", row["type"]) not in names]
    if left:
        tables["measure"] = left
    else:
        # an empty list of tables is an error of a file
        del tables["measure"]
