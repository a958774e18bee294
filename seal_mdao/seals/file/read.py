"""Reading a seal file: TOML, every table checked, then all of them against each other."""

import tomllib
from pathlib import Path

from seal_mdao.errors import SealFileError
from seal_mdao.input_files import read_text
from seal_mdao.loads.fluid_pressure import ENDS, SHARE
from seal_mdao.loads.trapped_air import ADIABATIC, ATMOSPHERE
from seal_mdao.seals.choice import PENALTY_TOLERANCE
from seal_mdao.seals.file.checks import (
    NAME,
    NAMES,
    Check,
    Key,
    many,
    number,
    one_of,
    shown,
    suggestion,
    table,
    tables,
    whole,
)
from seal_mdao.seals.file.contact_points import with_contact_points
from seal_mdao.seals.file.cross_checks import check
from seal_mdao.seals.file.extensions import FRICTION, read_term
from seal_mdao.seals.file.laws import read_law
from seal_mdao.seals.file.load_steps import MOST_STEPS, read_steps
from seal_mdao.seals.file.measures import read_measure
from seal_mdao.seals.file.optimization import read_optimize
from seal_mdao.seals.file.profiles import PENALTY, read_profile
from seal_mdao.seals.file.sections import read_section
from seal_mdao.seals.file.tables import (
    CavityTable,
    DesignTable,
    FixedTable,
    FluidTable,
    SealFile,
    SelfContactTable,
    SymmetryTable,
)

TABLES = (
    "material", "section", "profile", "fixed", "symmetry", "cavity", "self_contact", "fluid", "design",
    "measure", "optimize", "steps", "penalties", "term",
)  # fmt: skip
NEEDED = TABLES[:3]
MOST_PARAMETERS = 1000
MOST_PRESSURE = 1e9
"""kPa."""

DIRECTIONS = Check('a list of "x", "y" or both', many(one_of("x", "y"), "").convert)
FIXED_KEYS = {"edges": Key(NAMES), "directions": Key(DIRECTIONS, ("x", "y"))}
SYMMETRY_KEYS = {"edges": Key(NAMES), "normal": Key(one_of("x", "y"))}
CAVITY_KEYS = {
    "hole": Key(whole(1, 1000)),
    "name": Key(NAME, "air"),
    "pressure": Key(number(above=0.0), ATMOSPHERE),
    "gamma": Key(number(above=0.0), ADIABATIC),
}
SELF_CONTACT_KEYS = {
    "edges": Key(NAMES),
    "friction": Key(FRICTION),
    "normal_penalty": Key(PENALTY, None),
    "tangent_penalty": Key(PENALTY, None),
}
PENALTIES_KEYS = {"tolerance": Key(number(above=0.0, most=1.0), PENALTY_TOLERANCE)}
STRETCH = Check(
    'the name of an edge, or a list of neighbours, such as ["left", "top"]',
    lambda value: NAMES.convert([value] if isinstance(value, str) else value),
)
FLUID_KEYS = {
    "edge": Key(STRETCH),
    "from": Key(one_of(*ENDS)),
    "pressure": Key(number(above=0.0, most=MOST_PRESSURE)),
    "steps": Key(whole(1, MOST_STEPS), None),
    "name": Key(NAME, "fluid"),
    "share": Key(number(above=0.0, most=1.0), SHARE),
}
DESIGN_KEYS = {
    "edges": Key(NAMES),
    "parameters": Key(whole(1, MOST_PARAMETERS)),
    "bound": Key(number(above=0.0)),
}


def read_seal_file(path) -> SealFile:
    """The decisions of a seal file; nothing is analysed.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    SealFileError
        One line that says what is wrong, in which table and key, and what is allowed.
    """
    path = Path(path)
    try:
        return _read(_parsed(path), path)
    except SealFileError as error:
        raise SealFileError(f"{path}: {error}") from None


def _parsed(path) -> dict:
    try:
        content = read_text(path)
    except FileNotFoundError:
        raise SealFileError("there is no such file") from None
    except OSError as error:
        raise SealFileError(f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError as error:
        raise SealFileError(f"is not text in UTF-8 (byte {error.start})") from None
    try:
        found = tomllib.loads(content)
    except (ValueError, RecursionError) as error:
        raise SealFileError(f"is not valid TOML: {' '.join(str(error).split())}") from None
    if not found:
        raise SealFileError(f"is empty; it needs {_written(NEEDED)}")
    return found


def _written(names) -> str:
    forms = {"material": "[material.NAME]", "profile": "[[profile]]"}
    return ", ".join(forms.get(name, f"[{name}]") for name in names)


def _read(given, path) -> SealFile:
    for name in given:
        if name not in TABLES:
            raise SealFileError(
                f"unknown table or key {name!r}{suggestion(name, TABLES)}; known are "
                + ", ".join(TABLES)
            )
    missing = [name for name in NEEDED if name not in given]
    if missing:
        raise SealFileError(f"{_written(missing[:1])} is missing")
    profiles = tuple(
        read_profile(i, one) for i, one in enumerate(tables("profile", given["profile"]), 1)
    )
    _check_profile_names(profiles)
    profiles, step_tolerance = read_steps(given.get("steps"), profiles)
    measures = tuple(
        read_measure(f"[[measure]] {i}", one, profiles)
        for i, one in enumerate(_optional(given, "measure"), 1)
    )
    optimize = None
    if "optimize" in given:
        optimize, measures = read_optimize(given["optimize"], measures, profiles)
    materials = _materials(given["material"], path.parent)
    section = read_section(given["section"], path.parent)
    fixed = FixedTable()
    if "fixed" in given:
        fixed = FixedTable(**table("[fixed]", given["fixed"], FIXED_KEYS))
    fluids = tuple(_fluid(i, one) for i, one in enumerate(_optional(given, "fluid"), 1))
    file = SealFile(
        path,
        materials,
        section,
        fixed,
        tuple(
            SymmetryTable(**table(f"[[symmetry]] {i}", one, SYMMETRY_KEYS))
            for i, one in enumerate(_optional(given, "symmetry"), 1)
        ),
        with_contact_points(profiles, section, fixed, fluids),
        tuple(
            DesignTable(**table(f"[[design]] {i}", one, DESIGN_KEYS))
            for i, one in enumerate(_optional(given, "design"), 1)
        ),
        measures,
        optimize,
        tuple(
            CavityTable(**table(f"[[cavity]] {i}", one, CAVITY_KEYS))
            for i, one in enumerate(_optional(given, "cavity"), 1)
        ),
        SelfContactTable(**table("[self_contact]", given["self_contact"], SELF_CONTACT_KEYS))
        if "self_contact" in given
        else None,
        fluids,
        step_tolerance,
        table("[penalties]", given.get("penalties", {}), PENALTIES_KEYS)["tolerance"],
        tuple(read_term(f"[[term]] {i}", one) for i, one in enumerate(_optional(given, "term"), 1)),
    )
    check(file)
    return file


def _fluid(position, given) -> FluidTable:
    values = table(f"[[fluid]] {position}", given, FLUID_KEYS)
    return FluidTable(values.pop("edge"), values.pop("from"), **values)


def _optional(given, name) -> list:
    return tables(name, given[name]) if name in given else []


def _materials(given, folder) -> dict:
    if not isinstance(given, dict) or not given:
        raise SealFileError(
            f"[material.NAME] must be a table for every material, got {shown(given)}"
        )
    for name, value in given.items():
        if not isinstance(value, dict):
            raise SealFileError(
                f"[material]: {name} = {shown(value)}, but a material needs a name: write "
                "[material.rubber]"
            )
    return {name: read_law(f"[material.{name}]", value, folder) for name, value in given.items()}


def _check_profile_names(profiles) -> None:
    names = [profile.name for profile in profiles]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise SealFileError(f"[[profile]] {i + 1}: name = {name!r}, but an earlier one has it")
        if name == "structure":
            raise SealFileError(
                f"[[profile]] {i + 1}: name = 'structure', but that is the name of the body itself"
            )
