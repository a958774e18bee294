"""``[[cavity]]`` and ``[[fluid]]``: air that a hole keeps, a fluid that presses on one side."""

from typing import Annotated

from pydantic import AfterValidator

from seal_mdao.errors import SealFileError
from seal_mdao.loads.fluid_pressure import ENDS, SHARE
from seal_mdao.loads.trapped_air import ADIABATIC, ATMOSPHERE
from seal_mdao.seals.file.edges import check_edges, contour_of, stretch_order
from seal_mdao.seals.file.forms import Form, Name, Names, Text, number, one_of, whole
from seal_mdao.seals.file.load_steps import MOST_STEPS
from seal_mdao.seals.file.schema import Table, key, table

MOST_PRESSURE = 1e9
"""kPa."""
Stretch = Annotated[
    Text | Names,
    AfterValidator(lambda given: (given,) if isinstance(given, str) else given),
    Form('the name of an edge, or a list of neighbours, such as ["left", "top"]'),
]


@table
class CavityTable(Table):
    """A hole that does not let its air out."""

    hole: whole(1, 1000) = key("its number, from 1")
    name: Name = key("put before the names of its parameters: air_pressure, air_gamma", "air")
    pressure: number("kPa", above=0.0) = key(
        "absolute pressure outside, and inside at the start", ATMOSPHERE
    )
    gamma: number(above=0.0) = key(
        "exponent: 1.4 for air that has no time to give off its heat, 1 for air that has", ADIABATIC
    )


@table(kw_only=True)
class FluidTable(Table):
    """A fluid at one end of an edge: it presses on what it wets, as far as the profiles let it."""

    edges: Stretch = key(
        "an edge, or a list of neighbours, from the wet side under all that seals to the dry side",
        alias="edge",
    )
    end: one_of(*ENDS) = key(
        "the end of it where the fluid is; the outside is walked counter-clockwise, holes clockwise",
        alias="from",
    )
    pressure: number("kPa", above=0.0, most=MOST_PRESSURE) = key("over that on the dry side")
    steps: whole(1, MOST_STEPS) | None = key(
        "the last load steps of the path, over which it grows from 0 in equal parts; those of the last "
        "stage unless given",
        None,
    )
    name: Name = key("put before the name of its parameter: fluid_pressure", "fluid")
    share: number(above=0.0, most=1.0) = key(
        "a point is dry where the seal presses with 1 + share times the pressure of the fluid",
        SHARE,
    )


def check_cavities(file) -> None:
    """Refuse holes that there are not, or that two cavities name.

    Raises
    ------
    SealFileError
    """
    holes, seen = len(file.section.outline.holes), {}
    for number_, cavity in enumerate(file.cavities, 1):
        where = f"[[cavity]] {number_}"
        if cavity.hole > holes:
            raise SealFileError(
                f"{where}: hole = {cavity.hole}, but the section has "
                + ("no hole" if not holes else f"{holes} hole{'s' if holes > 1 else ''}")
            )
        if cavity.hole in seen:
            raise SealFileError(
                f"{where}: hole = {cavity.hole}, which {seen[cavity.hole]} has already"
            )
        seen[cavity.hole] = where


def check_fluids(file) -> None:
    """Refuse fluids that have no edge to go along, nothing to hold them back, or no time to grow.

    Raises
    ------
    SealFileError
        With the first contradiction.
    """
    for number_, fluid in enumerate(file.fluids, 1):
        where = f"[[fluid]] {number_}"
        _check_edges(where, fluid.edges, file)
        if fluid.steps is None:
            continue
        if file.step_tolerance is not None:
            raise SealFileError(
                f"{where}: steps = {fluid.steps}, but load steps are chosen where stages have none; "
                "leave it out, and the pressure grows in the last stage"
            )
        if fluid.steps > file.n_steps:
            raise SealFileError(
                f"{where}: steps = {fluid.steps}, but the stages of the profiles have {file.n_steps} "
                "steps in all; give them a last stage that only has steps, in which the pressure grows"
            )


def _check_edges(where, edges, file) -> None:
    outline, shown = file.section.outline, ", ".join(edges)
    check_edges(where, "edge", edges, outline)
    if contour_of(edges, outline) is None:
        raise SealFileError(f"{where}: edge = {shown} is not one stretch of the boundary")
    if stretch_order(edges, outline)[1]:
        raise SealFileError(
            f"{where}: edge = {shown} goes all round and has no ends; divide it where the fluid comes "
            "in and where it must not come out"
        )
    touching = dict.fromkeys(name for profile in file.profiles for name in profile.contact)
    if not any(name in touching for name in edges):
        raise SealFileError(
            f"{where}: edge = {shown}, which no profile may touch, so nothing would hold the fluid "
            f"back; edges that profiles may touch: {', '.join(touching)}"
        )


def check_names(file) -> None:
    """Refuse cavities, fluids, terms and contact of the section with itself under a taken name.

    Raises
    ------
    SealFileError
        With the table and what has the name already.
    """
    seen = {"structure": "the body itself"} | {p.name: "a profile" for p in file.profiles}
    for kind, rows in (("cavity", file.cavities), ("fluid", file.fluids), ("term", file.terms)):
        for number_, row in enumerate(rows, 1):
            where = f"[[{kind}]] {number_}"
            if row.name in seen:
                raise SealFileError(
                    f"{where}: name = {row.name!r}, but {seen[row.name]} has it; give every {kind} a "
                    "name of its own"
                )
            seen[row.name] = where
    if file.self_contact is not None and "self_contact" in seen:
        raise SealFileError(
            f"[self_contact]: {seen['self_contact']} has the name 'self_contact'; give it another one"
        )
