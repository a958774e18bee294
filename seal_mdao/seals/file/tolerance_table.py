"""``[tolerance]`` of a seal file, and the content of a file of tolerances: what varies, and how."""

from dataclasses import MISSING, fields

from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from seal_mdao.distributions import DISTRIBUTIONS, FACTOR, KINDS
from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.forms import FORM, Names, number, one_of
from seal_mdao.seals.file.schema import Table, chosen_by, key, known, table, table_of
from seal_mdao.seals.seal import Seal
from seal_mdao.values import formatted

TRAVEL = "_travel"
"""Ending of the names of travels, which are no parameters of a seal."""
NUMBERS = {
    "low": "smallest value",
    "likely": "most probable value",
    "high": "largest value",
    "mean": "mean value before truncation by cut",
    "std": "standard deviation before truncation by cut",
    "cut": "values farther than cut standard deviations from the mean are rejected",
}
"""Meaning of the numbers of all distributions."""


@table(kw_only=True)
class VaryTable(Table):
    """Distribution of a parameter."""

    distribution: one_of(*DISTRIBUTIONS) = key("distribution of the parameter")
    kind: one_of(*KINDS) | None = key(
        "whether a random number replaces the value of the parameters (value, the default, whose "
        "range must include the nominal value), is added to it (shift) or multiplies it (factor)",
        None,
    )
    parameters: Names = key(
        "parameters that vary together; default: the parameter with the name of the table", ()
    )

    @property
    def law(self):
        """Distribution with its numbers."""
        kind = DISTRIBUTIONS[self.distribution]
        return kind(**{own.name: getattr(self, own.name) for own in fields(kind)})

    @model_validator(mode="after")
    def _possible(self):
        # the distribution checks its own numbers: low < high, std > 0
        _ = self.law
        return self


@table
class BoundaryTable(Table):
    """Random error of an extruded boundary."""

    std: number("mm", above=0.0) = key("standard deviation of the error along the normal")
    length: number("mm", above=0.0) = key("correlation length along the boundary")


def _vary_table(name: str) -> type[Table]:
    """Make the table of a distribution with its numbers as keys."""
    # one key per field of the distribution, with its default
    keys = {"distribution": (one_of(name), key("distribution of the parameter"))}
    for own in fields(DISTRIBUTIONS[name]):
        default = () if own.default is MISSING else (own.default,)
        keys[own.name] = number(), key(NUMBERS[own.name], *default)
    return table_of(VaryTable, f"{DISTRIBUTIONS[name].__name__}Table", keys)


VARY_TABLES = {name: _vary_table(name) for name in DISTRIBUTIONS}
"""Classes of tables by distribution."""
AnyVary = chosen_by("distribution", VARY_TABLES)


@table
class ToleranceTable(Table):
    """Tolerances: parameters that vary between seals, and errors of the boundary."""

    vary: dict[str, AnyVary] = key("parameters that vary, one table each", {})
    boundary: BoundaryTable | None = key("random error of the edges of [[design]]", None)

    @field_validator("vary", mode="before")
    @classmethod
    def _named(cls, given):
        """Refuse what is no table of tables, and names that cannot be printed."""
        if not isinstance(given, dict):
            allowed = "tables, each written [vary.name]"
            raise PydanticCustomError(FORM, "{allowed}", {"allowed": allowed})
        for name in given:
            if not name.strip() or not name.isprintable():
                raise ValueError(
                    f"{formatted(name)} is not a valid name of a manufacturing tolerance; use "
                    "printable characters"
                )
        return given

    @model_validator(mode="after")
    def _something_varies(self):
        if not self.vary and self.boundary is None:
            raise ValueError(
                "the file has no manufacturing tolerance; add a table [vary.NAME] for a parameter, "
                "or [boundary] for random errors of the boundary"
            )
        return self

    def check(self, where: str, seal: Seal) -> None:
        """Raise SealFileError for parameters that a seal does not have, factors of zero, and values
        far from the present one if ``kind`` is not given.

        Parameters
        ----------
        where : str
            Place of the table for messages: ``bulb.toml: [tolerance.`` or ``tolerances.toml: [``.
        seal : Seal
            With the placements of its profiles.

        Raises
        ------
        SealFileError
        """
        for name, own in self.vary.items():
            place = f"{where}vary.{name}]"
            for parameter in own.parameters or (name,):
                label = parameter.removesuffix(TRAVEL)
                if label != parameter and f"{label}_y" in seal.scalars:
                    raise SealFileError(
                        f"{place}: the parameter {parameter} cannot have a manufacturing "
                        "tolerance, because it can vary only in sweeps; give a tolerance of the "
                        f"position of the profile instead: {label}_x or {label}_y (shift, mm) or "
                        f"{label}_angle (degrees)"
                    )
                known(place, "parameters", parameter, list(seal.scalars), "parameter of the seal")
                # 0 n = 0: nothing would vary
                if own.kind == FACTOR and seal.scalars[parameter].value == 0.0:
                    raise SealFileError(
                        f'{place}: kind = "factor" has no effect on {parameter}, which is zero; '
                        'use kind = "shift"'
                    )
                if own.kind is None:
                    _check_replaced(place, own.law, parameter, seal.scalars[parameter])


def _check_replaced(where: str, law, name: str, scalar) -> None:
    """Refuse numbers without ``kind`` that do not include the value they would take the place of."""
    low, high = law.ends
    if low <= scalar.value <= high:
        return
    raise SealFileError(
        f"{where}: kind is missing, and the present value {name} = {scalar.value:.4g} is outside of "
        f"the range {low:.4g} to {high:.4g} of the numbers that would replace it; give "
        'kind = "shift" (added to the present value), "factor" (multiplies it) or "value" '
        "(replaces it)"
    )
