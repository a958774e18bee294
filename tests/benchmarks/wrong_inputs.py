"""The wrong inputs of the sweep: keywords of the public constructors, offsets, radii, parameters."""

from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
import openmdao.api as om
from wrong_files import file_cases

import seal_mdao as sm
from seal_mdao.measures.reaction import Reaction

HUGE, TEXT, LIST = 10**400, "text", [1, 2]
NUMBERS = (np.nan, np.inf, -1.0, 1e300, 1e-300, HUGE, TEXT, None, 1j)
"""Wrong for every number; some of them are only far away."""
COUNTS = (0, -3, 2.5, 10**8, HUGE, TEXT, None, True)

SEAL = {
    "rays": (*COUNTS, 60, 58 * 41), "layers": (*COUNTS, 2, 41), "refinement": (*COUNTS, 11),
    "n_gauss": (*COUNTS, 1, 100, 1000, (2,), (2, 3, 2), (1, 3), (2, TEXT)),
    "n_steps": (0, 2.5, 10**8, HUGE, TEXT, None, True), "basis_order": (0, 3, LIST, "1", True),
    "segments": (3, 10**8, 32.0, TEXT), "outer_parameters": (1, 10**7, HUGE, TEXT),
    "inner_parameters": (3, 10**7, 4.5), "support": (0.0, 0.5, 1e300, np.nan, TEXT),
    "friction": (*NUMBERS, Fraction(1, 4), 11.0), "corner_x": (np.nan, 1e300, -51.0, -20.0, HUGE, TEXT),
    "normal_penalty": (*NUMBERS, 0.0, 20.0, 100.0, 1e12), "tangent_penalty": (0.0, 1e-300, 1e30, TEXT),
    "nominal_door_radius": (0.0, 1e-300, 0.1, 0.5, 1.0, 120.0, TEXT), "door_radius": (0.0, np.nan, TEXT),
    "door_shift": (np.nan, 51.0, TEXT), "door_angle": (np.inf, 31.0, None),
    "clearance": (np.nan, -0.1, 1e300, TEXT, None), "step_ends": (0.5, (0.5, 1.0), TEXT),
    "start": (9.5, -1.0, 1e300, np.nan, TEXT),
    "depth": (*NUMBERS, 0.0, 1e-12, 1e-9, 14.6, 16.0, 18.0, 19.0),
    "symmetric": ("no", 1, LIST, None), "door": ("round", np.array("corner"), None, 1),
    "friction_history": ("none", 1), "solver": ("lu", None), "material": (TEXT, None),
    "accuracy": ("exact", None, LIST), "steps": (3, LIST), "section": (TEXT, None),
    "newton": (TEXT, None),
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
LAWS = {
    "NeoHookean": {"c10": (0.0, np.nan, 1e300, HUGE, TEXT), "bulk_modulus": (-1.0, 1e30)},
    "Yeoh": {"c10": (-1.0, TEXT), "c20": (np.inf, 1e300, LIST), "c30": (np.nan, None)},
    "Gent": {"shear_modulus": (0.0, 1e300), "limit": (0.0, np.nan, 1e300, TEXT)},
    "Ogden": {"mu": (-1.0, np.nan, 1e300, TEXT, LIST), "alpha": (0.0, 1e300, 1e-300, HUGE, LIST)},
    "Hyperfoam": {"mu": (-1.0, 1e300), "alpha": (0.0, 1e300), "nu": (0.5, -1.0, np.nan, TEXT)},
}
OF_TERMS = {
    "Ogden": {"mu": 100.0, "alpha": 2.0},
    "Hyperfoam": {"mu": 100.0, "alpha": 2.0, "nu": 0.3},
}
PARAMETERS = {
    "friction": (np.nan, -0.1, 1e300), "depth": (0.0, np.nan, 1e300), "c10": (-1.0, 1e300, TEXT),
    "bulk_modulus": (0.0, 1e30), "normal_penalty": (0.0, 1e300), "fiction": (0.1,),
}  # fmt: skip
OTHERS = {
    "parameters": [[4.0], TEXT, {1: 4.0}], "keep_factors": ["no", 1], "callback": [3, TEXT],
}  # fmt: skip
GROUP = {
    "seal": (None, TEXT), "measures": (TEXT, ("gaps",), ("gap", "gap"), (3,)),
    "parameters": ("friction", ("fiction",)), "sensitivity": ("best", None),
    "factor_memory": (-1.0, np.nan, TEXT, None), "cache": (TEXT, 3), "callback": (3,),
}  # fmt: skip
DRIVER = {
    "tol": (np.nan, -1.0, HUGE, TEXT), "feas_tol": (np.nan, None), "maxiter": (-1, 2.5, HUGE, TEXT),
    "trust_radius": (0.0, np.nan, 1e300), "max_failures": (0, np.nan), "hotstart_file": (3, "none.sql"),
}  # fmt: skip
MEMORIES = (np.nan, np.inf, -1.0, 1e300, HUGE, TEXT, None, 1j, LIST)
TRAVELS = ((np.nan,), (-1.0,), (HUGE,), TEXT, (50.0,))


def cases(out: Path) -> list[tuple]:
    """Name and action of every input; an action returns a result or None."""
    found = [*_of_constructors(), *_of_laws(), *_of_openmdao()]
    for name, offsets in OFFSETS.items():
        found.append((f"offsets: {name}", partial(_analysis, offsets=offsets)))
    for name, radius in RADII.items():
        found.append(
            (f"door radius: {name}", partial(_analysis, parameters={"door_radius": radius}))
        )
    for name, values in PARAMETERS.items():
        for value in values:
            found.append(
                (f"{name} = {_shown(value)}", partial(_analysis, parameters={name: value}))
            )
    for name, values in OTHERS.items():
        for value in values:
            found.append((f"analyze({name}={_shown(value)})", partial(_analysis, **{name: value})))
    return found + file_cases(out)


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


def _of_laws() -> list[tuple]:
    """Of the laws that the door seal does not have: none may be made."""
    return [
        (
            f"{law}({name}={_shown(value)})",
            partial(_made, getattr(sm, law), **(OF_TERMS.get(law, {}) | {name: value})),
        )
        for law, table in LAWS.items()
        for name, values in table.items()
        for value in values
    ]


def _of_openmdao() -> list[tuple]:
    tables = (("SealGroup", GROUP, _group), ("UnoDriver", DRIVER, _driver))
    found = [
        (f"{title}({name}={_shown(value)})", partial(action, name, value))
        for title, table, action in tables
        for name, values in table.items()
        for value in values
    ]
    found += [
        (f"AnalysisCache({_shown(m)})", partial(_made, sm.AnalysisCache, m)) for m in MEMORIES
    ]
    return found + [
        (f"Reaction(travels={_shown(travels)})", partial(_group, "measures", travels))
        for travels in TRAVELS
    ]


def _shown(value) -> str:
    return "10**400" if value is HUGE else "(10**400,)" if value == (HUGE,) else repr(value)


def _analysis(make=sm.door_seal, changes=None, offsets=None, parameters=None, **more):
    return sm.analyze(make(**(changes or {})), offsets, parameters, **more)


def _made(kind, *arguments, **constants) -> None:
    kind(*arguments, **constants)


def _group(name, value) -> None:
    """A group with a wrong option, set up and run."""
    if value in TRAVELS and name == "measures":
        value = (Reaction("door", value, (1,), name="reaction_curve"),)
    seal = sm.door_seal(depth=1.0, n_steps=15)
    problem = om.Problem(sm.SealGroup(**({"seal": seal} | {name: value})), reports=None)
    problem.setup()
    problem.run_model()


def _driver(name, value) -> None:
    """A driver with a wrong option, run."""
    problem = om.Problem(driver=sm.UnoDriver(**{name: value}), reports=None)
    problem.model.add_subsystem("c", om.ExecComp("f = x**2", x=3.0), promotes=["*"])
    problem.model.add_design_var("x", lower=-5.0, upper=5.0)
    problem.model.add_objective("f")
    problem.setup()
    problem.run_driver()
