"""``[material.x]``: laws by name, with the constants that their classes have."""

from dataclasses import fields
from typing import get_origin

from seal_mdao.errors import SealFileError
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh
from seal_mdao.seals.file.checks import NUMBERS, Key, number, one_of, shown, table

LAWS = {
    "neo_hookean": NeoHookean,
    "mooney_rivlin": MooneyRivlin,
    "yeoh": Yeoh,
    "gent": Gent,
    "ogden": Ogden,
    "hyperfoam": Hyperfoam,
}

_LAW = Key(one_of(*LAWS))


def read_law(where: str, given) -> Isotropic:
    """The law of a table.

    Raises
    ------
    SealFileError
        For an unknown law, constants that are missing, unknown, or give no stable material.
    """
    if isinstance(given, dict) and "data" in given:
        raise SealFileError(
            f"{where}: data = {shown(given['data'])}, but constants are not fitted here; fit them to "
            "the data first and give them by name"
        )
    name = given.get("law") if isinstance(given, dict) else None
    law = LAWS.get(name) if isinstance(name, str) else None
    keys = {} if law is None else {constant.name: Key(_form(constant)) for constant in fields(law)}
    if law is None:
        # the name of the law is what is wrong, whatever else there is
        given = given if not isinstance(given, dict) else {k: given[k] for k in given if k == "law"}
    values = table(where, given, {"law": _LAW, **keys})
    values.pop("law")
    try:
        return law(**values)
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None


def _form(constant):
    return NUMBERS if get_origin(constant.type) is tuple else number()
