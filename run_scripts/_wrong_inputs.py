"""The wrong inputs of the sweep: keywords of the public constructors, offsets, radii, files."""

from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np

import seal_mdao as sm
from seal_mdao.plotting.recorded import read_optimization
from seal_mdao.recording.evaluations import read_cases

HUGE, TEXT, LIST = 10**400, "text", [1, 2]
NUMBERS = (np.nan, np.inf, -1.0, 1e300, 1e-300, HUGE, TEXT, None, 1j)
"""Wrong for every number; some of them are only far away."""
COUNTS = (0, -3, 2.5, 10**8, HUGE, TEXT, None, True)

SEAL = {
    "rays": (*COUNTS, 60, 58 * 41), "layers": (*COUNTS, 2, 41), "n_gauss": (*COUNTS, 1, 100, 1000),
    "n_steps": (0, 2.5, 10**8, HUGE, TEXT, None, True), "basis_order": (0, 3, LIST, "1", True),
    "segments": (3, 10**8, 32.0, TEXT), "outer_parameters": (1, 10**7, HUGE, TEXT),
    "inner_parameters": (3, 10**7, 4.5), "support": (0.0, 0.5, 1e300, np.nan, TEXT),
    "friction": (*NUMBERS, Fraction(1, 4), 11.0), "corner_x": (np.nan, 1e300, -51.0, -20.0, HUGE, TEXT),
    "normal_penalty": (*NUMBERS, 0.0, 20.0, 100.0, 1e12), "tangent_penalty": (0.0, 1e-300, 1e30, TEXT),
    "drawn_door_radius": (0.0, 1e-300, 0.1, 0.5, 1.0, 120.0, TEXT), "door_radius": (0.0, np.nan, TEXT),
    "start": (9.5, -1.0, 1e300, np.nan, TEXT),
    "depth": (*NUMBERS, 0.0, 1e-12, 1e-9, 14.6, 16.0, 18.0, 19.0),
    "symmetric": ("no", 1, LIST, None), "door": ("round", np.array("corner"), None, 1),
    "friction_history": ("none", 1), "solver": ("lu", None), "material": (TEXT, None),
    "section": (TEXT, None), "newton": (TEXT, None),
}  # fmt: skip
SECTION = {
    "inner_radius": (*NUMBERS, 9.5, 5.75, 6.0, 9.4), "outer_radius": (7.5, 51.0, HUGE, TEXT),
    "base_angle": (0.0, 1.0, np.nan, TEXT),
}  # fmt: skip
MATERIAL = {
    "c10": (-1.0, np.nan, HUGE, TEXT, LIST),
    "c01": (-1.0, None),
    "bulk_modulus": (0.0, 1e30, TEXT),
}
NEWTON = {
    "tolerance": (0.0, 1e9, np.nan, TEXT), "max_iterations": (0, 2.5, HUGE, TEXT, True),
    "max_cuts": (-1, 1000, TEXT), "damped_iterations": (-1, HUGE, TEXT),
}  # fmt: skip
OFFSETS = {
    "24 of them": np.zeros(24), "text": TEXT, "ragged": [[0.0], [0.0, 1.0]], "complex": [1j] * 25,
    "nan": np.full(25, np.nan), "3 mm": np.full(25, 3.0), "1.2 mm": np.full(25, 1.2),
    "folded": 1.9 * (-1.0) ** np.arange(25), "dictionary": {"a": 1},
}  # fmt: skip
RADII = {
    "text": TEXT,
    "two": [4.0, 5.0],
    "ragged": [[4.0], [4.0, 5.0]],
    "complex": 4j,
    "none": None,
}
FILES = {
    "empty": b"", "text": b"no database", "database without a page": b"SQLite format 3\x00" + bytes(84),
    "zeros": bytes(4096),
}  # fmt: skip


def cases(out: Path) -> list[tuple]:
    """Name and action of every input; an action returns a result or None."""
    found = _of_constructors()
    for name, offsets in OFFSETS.items():
        found.append((f"offsets: {name}", partial(_analysis, offsets=offsets)))
    for name, radius in RADII.items():
        found.append((f"door radius: {name}", partial(_analysis, radius=radius, given=True)))
    for name, content in FILES.items():
        path = out / f"{name.replace(' ', '_')}.sql"
        path.write_bytes(content)
        for read in (read_optimization, read_cases):
            found.append((f"{read.__name__}: {name}", partial(_read, read, path)))
    return found


def _of_constructors() -> list[tuple]:
    tables = (
        ("door_seal", SEAL, lambda **one: sm.door_seal(**one)),
        ("Section", SECTION, lambda **one: sm.door_seal(section=sm.Section(**one))),
        ("MooneyRivlin", MATERIAL, lambda **one: sm.door_seal(material=sm.MooneyRivlin(**one))),
        ("NewtonOptions", NEWTON, lambda **one: sm.door_seal(newton=sm.NewtonOptions(**one))),
    )
    return [
        (f"{title}({name}={_shown(value)})", partial(_analysis, make=make, changes={name: value}))
        for title, table, make in tables
        for name, values in table.items()
        for value in values
    ]


def _shown(value) -> str:
    return "10**400" if value is HUGE else repr(value)


def _analysis(make=sm.door_seal, changes=None, offsets=None, radius=None, given=False):
    seal = make(**(changes or {}))
    return sm.analyze(seal, offsets, {"door_radius": radius} if given else None)


def _read(read, path):
    read(path)
