"""``[material.x]``: laws by name, their constants given or fitted to tests, and stable."""

from dataclasses import fields
from pathlib import Path
from typing import get_origin

from seal_mdao.calibration.data import read_tests
from seal_mdao.calibration.families import MAX_TERMS, OF_TERMS
from seal_mdao.calibration.fit import fit
from seal_mdao.calibration.modes import MODES
from seal_mdao.calibration.residuals import WEIGHTINGS
from seal_mdao.calibration.stability import check_stability, require_stable
from seal_mdao.errors import SealFileError
from seal_mdao.materials.by_name import LAWS
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.registry import names
from seal_mdao.seals.file.checks import NUMBERS, TEXT, Check, Key, number, one_of, table, whole
from seal_mdao.seals.file.extensions import extension, keys_of

STABLE = (0.7, 1.5)
"""Stretches between which every material has to be stable unless its table says others."""


def _range(value):
    least, largest = NUMBERS.convert(value)
    if not 0.0 < least <= 1.0 <= largest:
        raise ValueError
    return least, largest


LAW_KEYS = {
    "law": Key(one_of(*LAWS)),
    "data": Key(TEXT),
    "stable": Key(Check("the least and largest stretch, such as [0.7, 1.5]", _range), STABLE),
}
FIT_KEYS = {
    "bulk_modulus": Key(number(above=0.0), 80_000.0),
    "weighting": Key(one_of(*WEIGHTINGS), "relative"),
}
TERM_KEYS = {"terms": Key(whole(1, MAX_TERMS), 1)}
FOAM_KEYS = {"weighting": FIT_KEYS["weighting"], **TERM_KEYS, "nu": Key(number(), None)}


def read_law(where: str, given, folder: Path) -> Isotropic:
    """The law of a table.

    Parameters
    ----------
    where : str
        Its name for messages.
    given : object
        What the file has there.
    folder : Path
        That of the file, which ``data`` is relative to.

    Raises
    ------
    SealFileError
        For an unknown law, constants that are missing, unknown, or give no stable material; tests
        that cannot be read or fitted.
    """
    name = given.get("law") if isinstance(given, dict) else None
    made = extension(where, "materials", name, LAWS)
    if made is None and (not isinstance(name, str) or name not in LAWS):
        # the name of the law is what is wrong, whatever else there is
        given = given if not isinstance(given, dict) else {k: given[k] for k in given if k == "law"}
        table(where, given, {"law": Key(one_of(*LAWS, *names("materials")))})
    if made is not None:
        own = keys_of(made) | {"law": Key(TEXT), "stable": LAW_KEYS["stable"]}
    else:
        own = _fit_keys(name) if "data" in given else _constant_keys(name)
    values = table(where, given, own)
    try:
        law = _law(made or LAWS[name], name, values, own, folder)
        between = dict.fromkeys(MODES, values["stable"])
        require_stable(check_stability(law, between, margin=0.0), name)
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None
    return law


def _constant_keys(name) -> dict:
    keys = {constant.name: Key(_form(constant)) for constant in fields(LAWS[name])}
    return keys | {key: LAW_KEYS[key] for key in ("law", "stable")}


def _form(constant):
    return NUMBERS if get_origin(constant.type) is tuple else number()


def _fit_keys(name) -> dict:
    if name == "hyperfoam":
        return LAW_KEYS | FOAM_KEYS
    return LAW_KEYS | FIT_KEYS | (TERM_KEYS if name in OF_TERMS else {})


def _law(made, name, values, keys, folder) -> Isotropic:
    own = {key: values[key] for key in keys if key not in LAW_KEYS}
    if "data" not in keys:
        return made(**own)
    return fit(name, read_tests(folder / values["data"]), **own).law
