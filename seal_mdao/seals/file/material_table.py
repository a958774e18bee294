"""``[material.x]``: laws by name, their constants given or fitted to tests, and stable.

The laws are those of ``materials.by_name.LAWS`` and of extensions; their constants are the keys of
their tables.
"""

import re
from dataclasses import fields
from functools import cache
from inspect import getdoc
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, get_origin

from pydantic import AfterValidator, BeforeValidator
from pydantic_core import PydanticCustomError, core_schema

from seal_mdao.calibration.data import read_tests
from seal_mdao.calibration.families import MAX_TERMS, OF_TERMS
from seal_mdao.calibration.law_fit import fit
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.calibration.material_stability import check_stability, require_stable
from seal_mdao.calibration.residuals import WEIGHTINGS
from seal_mdao.errors import SealFileError
from seal_mdao.materials.by_name import LAWS
from seal_mdao.materials.hardness import BULK_MODULUS, LEAST_SHORE, MOST_SHORE, ShoreRubber
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.sponge import GRADES, graded_sponge
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.seals.file.extensions import Extensible, extension_table, keys_of
from seal_mdao.seals.file.forms import Form, Number, Text, many, number, one_of, whole
from seal_mdao.seals.file.model_table import ENTROPIC, per_stage
from seal_mdao.seals.file.schema import (
    LINE,
    TAG,
    Table,
    chosen_by,
    key,
    suggestion,
    table,
    table_of,
)
from seal_mdao.seals.file.softening_table import SofteningTable
from seal_mdao.seals.file.viscoelastic_table import ViscoelasticTable
from seal_mdao.values import formatted

MODULI = {"c10", "c01", "c20", "c30", "mu", "shear_modulus", "bulk_modulus"}
"""Constants in kPa."""
STABLE = (0.7, 1.5)
"""Stretches between which every material has to be stable unless its table says others."""


def _range(given):
    # 0 < least <= 1 <= largest: the undeformed state is in the range
    least, largest = given
    if not 0.0 < least <= 1.0 <= largest:
        raise ValueError
    return given


Range = Annotated[
    many(Number, "two numbers", 2, 2),
    AfterValidator(_range),
    Form("the least and largest stretch, such as [0.7, 1.5]"),
]


def _increasing(given):
    # two temperatures at least, one after the other
    if len(given) < 2 or any(b[0] <= a[0] for a, b in pairwise(given)):
        raise ValueError
    return given


_Factor = Annotated[tuple[number(above=ABSOLUTE_ZERO), number(above=0.0)], Form("two numbers")]
Factors = Annotated[
    Literal[ENTROPIC] | Annotated[many(_Factor, "a list"), AfterValidator(_increasing)],
    Form(
        f'"{ENTROPIC}", or a list of pairs [temperature (degC), factor above 0] with increasing '
        "temperatures"
    ),
]


@table(kw_only=True)
class MaterialTable(Table):
    """Keys of every material beside its law: density, effects of temperature and swelling."""

    density: number("kg/m3", above=0.0, most=1e5) | None = key(
        "mass per volume, which the measure `mass` needs", None
    )
    expansion: number("1/K", least=0.0, most=0.01) = key(
        "linear coefficient of thermal expansion", 0.0
    )
    modulus_over_temperature: Factors | None = key(
        "factor of all moduli except the bulk modulus, interpolated linearly in temperature; "
        f'"{ENTROPIC}": absolute temperature divided by the absolute reference temperature, as for '
        "ideal rubber",
        None,
    )
    swelling: per_stage(number(above=0.0, most=10.0), "a number above 0 and at most 10") | None = (
        key("volume in a liquid divided by dry volume; it changes from 1 in the first stage", None)
    )

    viscoelastic: ViscoelasticTable | None = key(
        "relaxation over time, for stages with a duration", None
    )
    softening: SofteningTable | None = key(
        "softening below the largest previous strain energy (Mullins effect)", None
    )

    @property
    def changes_with_temperature(self) -> bool:
        """Whether the material has an expansion, or moduli or relaxation times that depend on the
        temperature."""
        own = self.viscoelastic
        shifted = own is not None and (own.wlf is not None or own.arrhenius is not None)
        return self.expansion != 0.0 or self.modulus_over_temperature is not None or shifted


@table(kw_only=True)
class LawTable(MaterialTable):
    """Material given by the name of its law and its constants."""

    law: one_of(*LAWS) = key("name of the material law: one of these, or that of an extension")
    stable: Range = key(
        "range of stretches in which the law must be stable: more strain requires more stress "
        "in every test",
        STABLE,
    )

    def made(self, where: str, folder: Path) -> Isotropic:
        """Make the law, which has to be stable.

        Parameters
        ----------
        where : str
            Name of the table for messages.
        folder : Path
            That of the file, which ``data`` is relative to.

        Raises
        ------
        SealFileError
            For constants that give no stable material; tests that cannot be read or fitted.
        """
        # all further keys are constants of the law, or arguments of its fit
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in FURTHER}
        try:
            law = self._law(own, folder)
            # d sigma / d lambda > 0 in every mode of testing, within the range of stretches
            between = dict.fromkeys(MODES, self.stable)
            require_stable(check_stability(law, between, margin=0.0), self.law)
        except ValueError as error:
            raise SealFileError(f"{where}: {error}") from None
        return law

    def _law(self, own, folder) -> Isotropic:
        return self.makes(**own)


@table(kw_only=True)
class FitTable(LawTable):
    """Material whose constants are fitted to tests."""

    data: Text = key(
        "file of material tests, to which the constants are fitted; path relative to the seal file"
    )
    weighting: one_of(*WEIGHTINGS) = key(
        "differences that the fit minimises: relative or absolute", "relative"
    )

    def _law(self, own, folder) -> Isotropic:
        return fit(self.law, read_tests(folder / self.data), **own).law


FURTHER = (*LawTable.entries(), "data")
"""Keys of these tables that are no arguments of the law or its fit."""


def _constants_table(name: str) -> type[Table]:
    """Make the table of a law with its constants: fields, meanings and units of its class."""
    keys, texts = {"law": (one_of(name), key("name of the law"))}, _meanings(LAWS[name])
    # every field of the law is a key, moduli in kPa
    for own in fields(LAWS[name]):
        unit = "kPa" if own.name in MODULI else ""
        # laws of several terms have lists of constants
        several = get_origin(own.type) is tuple
        allowed = f"a list of numbers{f' ({unit})' * bool(unit)}"
        form = many(Number, allowed) if several else number(unit)
        keys[own.name] = form, key(texts.get(own.name) or f"constant of {LAWS[name].__name__}")
    makes = staticmethod(LAWS[name])
    return table_of(LawTable, f"{LAWS[name].__name__}Table", keys, makes=makes)


def _meanings(law: type) -> dict[str, str]:
    """Read what the docstring of a law says of its constants (Attributes of numpydoc)."""
    attributes = getdoc(law).partition("Attributes\n----------\n")[2]
    # "c10, c01 : float" and the indented lines below it
    found = {}
    for names, text in re.findall(r"^([\w, ]+) : .*\n((?: +.*\n?)*)", attributes, re.MULTILINE):
        found |= dict.fromkeys(names.split(", "), " ".join(text.replace("``", "`").split()))
    return found


def _fit_table(name: str) -> type[Table]:
    """Make the table of a law whose constants are fitted."""
    keys = {"law": (one_of(name), key("name of the law"))}
    # tests of nearly incompressible rubber do not determine its bulk modulus
    if name != "hyperfoam":
        text = "bulk modulus of the law, which material tests do not determine"
        keys["bulk_modulus"] = number("kPa", above=0.0), key(text, 80_000.0)
    if name in OF_TERMS:
        keys["terms"] = whole(1, MAX_TERMS), key("number of terms of the law", 1)
    # a foam has no lateral stretch of its own unless it was measured
    if name == "hyperfoam":
        text = "Poisson's ratio, where the lateral stretch was not measured"
        keys["nu"] = number() | None, key(text, None)
    return table_of(FitTable, f"{LAWS[name].__name__}Fit", keys)


@cache
def _extension(name: str, made: type[Isotropic]) -> type[LawTable]:
    """Make the table of a law of another package."""
    return extension_table(LawTable, "law", name, made, keys_of(made, LawTable))


# a table has constants, or ``data`` to which they are fitted
LAW_TABLES = {name: _constants_table(name) for name in LAWS}
FIT_TABLES = {f"{name}: data": _fit_table(name) for name in LAWS}
AnyLaw = Annotated[
    chosen_by(
        "law",
        LAW_TABLES | FIT_TABLES,
        lambda given: given["law"] + (": data" if "data" in given else ""),
    ),
    Extensible("materials", "law", _extension, LAWS),
]


@table(kw_only=True)
class ShoreTable(MaterialTable):
    """Dense rubber by its hardness: neo-Hookean, Young's modulus by Gent's relation (1958)."""

    shore_a: number("Shore A", least=LEAST_SHORE, most=MOST_SHORE) = key(
        "hardness, instead of a law; a parameter that may vary"
    )
    bulk_modulus: number("kPa", above=0.0) = key("bulk modulus of dense rubber", BULK_MODULUS)

    def made(self, where: str, folder: Path) -> Isotropic:
        """Make the law, as ``LawTable.made``."""
        return _checked_law(where, ShoreRubber, self.shore_a, self.bulk_modulus)


@table(kw_only=True)
class SpongeTable(MaterialTable):
    """Foam rubber given by its grade of ASTM D1056: hyperfoam of one term, alpha = 2, nu = 0."""

    sponge: one_of(*GRADES) = key("grade, instead of a law: closed cells, such as foam of EPDM")

    def made(self, where: str, folder: Path) -> Isotropic:
        """Make the law, as ``LawTable.made``."""
        return graded_sponge(self.sponge)


def _checked_law(where: str, law, *constants) -> Isotropic:
    """Make a law; what is wrong with its constants is said of its table."""
    try:
        return law(*constants)
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None


SHORT = {"shore_a": ShoreTable, "sponge": SpongeTable}
"""Tables of materials without a law, by the key that each of them has."""


def _kind(given) -> str:
    """Find the tag of the class of a table of a material; without a law also by a misspelt key."""
    keys = [str(key) for key in given] if isinstance(given, dict) else []
    own = next((name for name in SHORT if name in keys), None)
    if own is None and "law" not in keys:
        own = next((name for name in SHORT if suggestion(name, keys)), None)
    return TAG + (own or "law")


class _OrShort:
    """Annotation of a table with a law: one of ``SHORT`` may take its place."""

    def __get_pydantic_core_schema__(self, source, handler):
        choices = {TAG + name: handler.generate_schema(own) for name, own in SHORT.items()}
        return core_schema.tagged_union_schema({TAG + "law": handler(source)} | choices, _kind)


AnyMaterial = Annotated[AnyLaw, _OrShort()]


def _named(given):
    """Refuse anything but materials with names."""
    if not isinstance(given, dict) or not given:
        line = (
            "[material] must contain one table for every material, [material.NAME], got "
            f"{formatted(given)}"
        )
        raise PydanticCustomError(LINE, "{line}", {"line": line})
    for name, value in given.items():
        # [material] with the keys of a material in place of [material.NAME]
        if not isinstance(value, dict):
            line = (
                f"[material]: {name} = {formatted(value)}, but this is a key of a single material; "
                "write it in a table with the name of the material, such as [material.rubber]"
            )
            raise PydanticCustomError(LINE, "{line}", {"line": line})
    return given


Materials = Annotated[dict[str, AnyMaterial], BeforeValidator(_named)]
