"""Numbers of a seal file that the live section changes: offsets of the design, placements and stages of
profiles, friction, constants of materials, temperature, pressures and times."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.file_optimization import design_bounds
from seal_mdao.geometry.motion import Motion
from seal_mdao.loads.moved_edges import ImposedMotions
from seal_mdao.materials.hardness import LEAST_SHORE, MOST_SHORE
from seal_mdao.seals.file.file_tables import MOVING, SealFile
from seal_mdao.seals.profiles import moved_edges
from seal_mdao.seals.seal import Seal

SHIFT = 0.15
"""Largest shift of a profile, over the size of the section."""
STRETCH = 0.5
"""Largest change of the travel of a stage, over that travel."""
TURN = 15.0
"""Largest turn of a profile, degrees."""
FACTOR = 3.0
"""Largest factor of moduli, pressures and times."""
COLDEST, HOTTEST = -40.0, 150.0
"""Range of the slider of the temperature, degC."""
MOTION = ("travel", "start")
"""Groups of numbers of a motion."""
SAME = 1e-12
"""Relative difference up to which a number of the file is the parameter of the seal."""


@dataclass(frozen=True)
class Adjustable:
    """Number that the page can change.

    Attributes
    ----------
    name : str
        Of the parameter of the seal.
    text : str
        What it is, for the page.
    unit : str
    value, low, high : float
        Nominal value and range, as the seal file has it.
    zero : float
        Value in the file at which the parameter of the seal is zero.
    path : tuple
        Keys to the number in the tables of the file; empty for an offset of the design.
    group : str
        Heading under which the page lists it.
    """

    name: str
    text: str
    unit: str
    value: float
    low: float
    high: float
    zero: float = 0.0
    path: tuple = ()
    group: str = "section"

    def admissible(self, value: float) -> float:
        """Return the nearest value within the range."""
        return min(max(float(value), self.low), self.high)

    def write(self, tables: dict, value: float) -> None:
        """Set the number in the tables of a seal file; that of a motion is changed by as much as its
        parameter, for a design may begin farther back."""
        *owners, last = self.path
        # tables and lists that the file leaves out are made
        for key, following in zip(owners, self.path[1:], strict=True):
            if isinstance(tables, dict):
                empty = [0.0, 0.0] if isinstance(following, int) else {}
                tables = tables.setdefault(key, empty)
            else:
                tables = tables[key]
        if self.group in MOTION:
            known = tables[last] if isinstance(tables, list) else tables.get(last, 0.0)
            value = float(known) + (value - self.value)
        tables[last] = value


def with_handles(seal: Seal, file: SealFile) -> Seal:
    """Return the seal with parameters for the start of every profile and of moved edges, ``NAME_x``,
    ``NAME_y`` (mm), ``NAME_angle`` (degrees), and for the travel and turn of each of their stages,
    ``NAME_stage_1_x`` and so on; all zero at the motion of the file."""
    stages = {own.name: len(own.stages) for own in file.moving}

    def changed(own):
        motion = _with_stages(own.motion, own.label, stages.get(own.label, 0))
        return replace(own, motion=motion)

    imposed = seal.imposed_displacements
    if isinstance(imposed, ImposedMotions):
        imposed = ImposedMotions(tuple(map(changed, imposed.edges)))
    definitions = tuple(
        changed(own) if isinstance(own, RigidContact) else own for own in seal.definitions
    )
    return replace(seal, definitions=definitions, imposed_displacements=imposed)


def _with_stages(motion: Motion, label: str, count: int) -> Motion:
    """Add the parameters of the start and of ``count`` stages to a motion."""
    motion = motion.with_placement(*(f"{label}_{axis}" for axis in ("x", "y", "angle")))
    # dw_k/dp = e for the waypoints w_k from the end of the stage on
    units = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "angle": (0.0, 0.0, np.pi / 180.0)}
    names, rows = [], []
    for stage in range(1, count + 1):
        after = np.arange(len(motion.angles)) >= stage
        names += [f"{label}_stage_{stage}_{axis}" for axis in units]
        rows += [np.outer(after, unit) for unit in units.values()]
    if not rows:
        return motion
    return replace(
        motion, rates=np.concatenate([motion.rates, rows]), names=(*motion.names, *names)
    )


def adjustables(file: SealFile, tables: dict, seal: Seal) -> list[Adjustable]:
    """List the numbers that the page can change, the offsets of the design first.

    Parameters
    ----------
    file : SealFile
    tables : dict
        Those of the file as written.
    seal : Seal
        Of ``with_handles``.
    """
    found = []
    bounds = design_bounds(file, seal) if seal.n_offsets else ()
    for number, bound in enumerate(bounds):
        bound = min(float(bound), seal.offset_limit)
        text = f"design parameter {number + 1}"
        found.append(Adjustable(f"boundary_offsets[{number}]", text, "mm", 0.0, -bound, bound))
    numbers = [*_of_motions(file, tables, seal), *_of_materials(tables, seal), *_others(tables)]
    count = Counter(own.name for own in numbers)
    for own in numbers:
        known = seal.scalars.get(own.name)
        # only what the file has as one number, and the seal as a parameter
        single = known is not None and count[own.name] == 1
        if single and _same(known.value + own.zero, own.value):
            found.append(own)
    return found


def _same(one: float, other: float) -> bool:
    return abs(one - other) <= SAME * max(abs(one), abs(other))


def _at(tables, path):
    """Look up a number of the tables; None where there is none."""
    try:
        value = reduce(lambda table, key: table[key], path, tables)
    except (KeyError, IndexError, TypeError):
        return None
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if plain else None


def _of_motions(file: SealFile, tables: dict, seal: Seal) -> Iterator[Adjustable]:
    size = float(np.ptp(seal.nominal_particles, axis=0).max())
    for table, read in zip(MOVING, (file.profiles, file.moved), strict=True):
        for i, row in enumerate(tables.get(table, ())):
            # that of moved edges may be left out
            name = read[i].name
            if table == "profile":
                path = (table, i, "friction")
                friction = _at(tables, path)
                if friction is not None:
                    high = max(1.0, 2.0 * friction)
                    yield Adjustable(
                        f"{name}_friction", f"friction on {name}", "", friction, 0.0, high, 0.0,
                        path, "friction",
                    )  # fmt: skip
            # travel of every stage, then where the motion starts
            for j, _ in enumerate(row.get("stage", ())):
                yield from _of_stage(tables, (table, i, "stage", j), name)
            # a glued edge is bonded where the profile starts: another start moves the edge, too
            placed = table == "profile" and "glued" not in row
            places = [("x", "start", 0), ("y", "start", 1)] if placed else []
            for axis, *path in places:
                path = (table, i, *path)
                value, reach = _at(tables, path) or 0.0, SHIFT * size
                yield _of_motion(
                    f"{name}_{axis}", f"start of {name}, {axis}", "mm", value, reach, path
                )
            if placed:
                path = (table, i, "angle")
                value = _at(tables, path) or 0.0
                yield _of_motion(f"{name}_angle", f"angle of {name}", "°", value, TURN, path)


def _of_motion(name, text, unit, value, reach, path, group="start") -> Adjustable:
    # the parameter of the seal is the change of the number in the file
    return Adjustable(name, text, unit, value, value - reach, value + reach, value, path, group)


def _of_stage(tables: dict, path: tuple, name: str) -> Iterator[Adjustable]:
    stage = path[-1] + 1
    travel = [_at(tables, (*path, "translate", k)) or 0.0 for k in (0, 1)]
    reach = STRETCH * float(np.hypot(*travel))
    for k, axis in enumerate("xy"):
        if reach:
            yield _of_motion(
                f"{name}_stage_{stage}_{axis}", f"travel of {name} in stage {stage}, {axis}", "mm",
                travel[k], reach, (*path, "translate", k), "travel",
            )  # fmt: skip
    turn = _at(tables, (*path, "rotate")) or 0.0
    if turn:
        yield _of_motion(
            f"{name}_stage_{stage}_angle", f"turn of {name} in stage {stage}", "°", turn,
            STRETCH * abs(turn), (*path, "rotate"), "travel",
        )  # fmt: skip
    duration = _at(tables, (*path, "duration"))
    if duration is not None:
        yield Adjustable(
            f"duration_{stage}", f"duration of stage {stage}", "s", duration, duration / FACTOR,
            duration * FACTOR, 0.0, (*path, "duration"), "time",
        )  # fmt: skip


def _of_materials(tables: dict, seal: Seal) -> Iterator[Adjustable]:
    prefixes = {own.name: own.prefix for own in seal.definitions[0].regions}
    for material, row in tables.get("material", {}).items():
        # the only material of a seal has no prefix
        prefix = prefixes.get(material, "")
        of = f" of {material}" if len(tables["material"]) > 1 else ""
        for key, value in row.items():
            for name, path in _constants(key, value):
                path = ("material", material, *path)
                number = _at(tables, path)
                if number is None or name == "bulk_modulus":
                    continue
                if name == "shore_a":
                    yield Adjustable(
                        f"{prefix}{name}", f"hardness{of}", "Shore A", number,
                        max(LEAST_SHORE, number - 25.0), min(MOST_SHORE, number + 25.0), 0.0, path,
                        "rubber",
                    )  # fmt: skip
                    continue
                ends = sorted((number / FACTOR, number * FACTOR))
                units = seal.scalars.get(f"{prefix}{name}")
                unit = (units and units.units) or ""
                yield Adjustable(
                    f"{prefix}{name}", f"{name}{of}", unit, number, *ends, 0.0, path, "rubber"
                )


def _constants(key: str, value) -> list[tuple[str, tuple]]:
    """List names and paths of the constants in a key of a material."""
    if isinstance(value, list):
        return [(f"{key}_{n}", (key, n - 1)) for n in range(1, len(value) + 1)]
    return [(key, (key,))]


def _others(tables: dict) -> Iterator[Adjustable]:
    path = ("model", "temperature")
    value = _at(tables, path)
    if value is not None:
        low, high = min(COLDEST, value), max(HOTTEST, value)
        yield Adjustable(
            "temperature", "temperature", "°C", value, low, high, 0.0, path, "environment"
        )
    path = ("model", "axial_stretch")
    value = _at(tables, path)
    if value is not None:
        yield Adjustable(
            "axial_stretch", "axial stretch", "", value, 0.9 * value, 1.1 * value, 0.0, path,
            "environment",
        )  # fmt: skip
    for i, row in enumerate(tables.get("fluid", ())):
        path = ("fluid", i, "pressure")
        value = _at(tables, path)
        if value is not None:
            name = row.get("name", "fluid")
            yield Adjustable(
                f"{name}_pressure", f"pressure of {name}", "kPa", value, value / FACTOR,
                FACTOR * value, 0.0, path, "environment",
            )  # fmt: skip


def moving_labels(seal: Seal) -> list[str]:
    """List the labels of profiles and of moved edges without a profile."""
    own = [term.label for term in seal.definitions if isinstance(term, RigidContact)]
    return [*own, *(edge.label for edge in moved_edges(seal) if edge.label not in own)]
