"""A parameter of a seal gives the results of the seal whose file has that number."""

import tomllib

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.file.read import read_changed
from seal_mdao.seals.file.reference import unit_of_key

SEAL = """\
[model]
temperature = 60.0
[material.rubber]
law = "mooney_rivlin"
c10 = 400.0
c01 = 100.0
bulk_modulus = 20000.0
expansion = 2e-4
viscoelastic = { g = [0.3], tau = [2.0] }
[section]
material = "rubber"
spacing = 1.2
hole = [{ edge = "hole", circle = { centre = [0.0, 2.2], radius = 0.8 } }]
outer = [
  { edge = "base", line = [[-3, 0], [3, 0]] },
  { edge = "right", line = [[3, 0], [3, 4]] },
  { edge = "top", arc = { start = [3.0, 4.0], through = [0.0, 4.6], end = [-3.0, 4.0] } },
  { edge = "left", line = [[-3, 4], [-3, 0]] },
]
[[moved]]
name = "foot"
edges = ["base"]
stage = [{ translate = [0.1, 0.1], steps = 3 }, { steps = 3 }]
[[cavity]]
hole = 1
pressure = 101.0
gamma = 1.3
[[profile]]
name = "lid"
contact = ["top"]
friction = 0.2
normal_penalty = 1e5
tangent_penalty = 3e3
line = [[-100.0, 0.0], [100.0, 0.0]]
start = [0.0, 4.7]
angle = 1.0
stage = [
  { translate = [0.2, -0.8], steps = 3, duration = 1.0 },
  { translate = [0.0, -0.1], steps = 3, duration = 2.0 },
]
[[profile]]
name = "wall"
contact = ["right"]
friction = 0.1
normal_penalty = 1e5
tangent_penalty = 3e3
line = [[0.0, 100.0], [0.0, -100.0]]
start = [3.05, 0.0]
[[fluid]]
edge = ["top", "left"]
from = "end"
pressure = 150.0
[[measure]]
type = "cavity_pressure"
[[measure]]
type = "blow_off_pressure"
[[measure]]
type = "stress_norm"
[[measure]]
type = "profile_work"
profile = "lid"
"""


def profile(number, *keys):
    """Path of a number of a profile in the tables of the file."""
    return "profile", number, *keys


RUBBER = ("material", "rubber")
NUMBERS = {
    "c10": (*RUBBER, "c10"),
    "c01": (*RUBBER, "c01"),
    "bulk_modulus": (*RUBBER, "bulk_modulus"),
    "expansion": (*RUBBER, "expansion"),
    "temperature": ("model", "temperature"),
    "g_1": (*RUBBER, "viscoelastic", "g", 0),
    "tau_1": (*RUBBER, "viscoelastic", "tau", 0),
    "air_pressure": ("cavity", 0, "pressure"),
    "air_gamma": ("cavity", 0, "gamma"),
    "duration_1": profile(0, "stage", 0, "duration"),
    "duration_2": profile(0, "stage", 1, "duration"),
    "lid_friction": profile(0, "friction"),
    "lid_normal_penalty": profile(0, "normal_penalty"),
    "lid_tangent_penalty": profile(0, "tangent_penalty"),
    "lid_x": profile(0, "start", 0),
    "lid_y": profile(0, "start", 1),
    "lid_angle": profile(0, "angle"),
    "wall_friction": profile(1, "friction"),
    "wall_normal_penalty": profile(1, "normal_penalty"),
    "wall_tangent_penalty": profile(1, "tangent_penalty"),
    "wall_x": profile(1, "start", 0),
    "fluid_pressure": ("fluid", 0, "pressure"),
}
"""Where the number of every parameter is in the file; placements are shifts of theirs."""


def results(seal, parameters=None):
    result = sm.analyze(seal, parameters=parameters)
    assert result.converged, result.failure
    forces = [result.path.reaction(label).ravel() for label in ("lid", "wall", "foot")]
    # weight of the fluid and contact pressure along its edge
    fluid = result.response("fluid").outputs.ravel()
    return np.concatenate([*forces, fluid, *(result.value(own) for own in result.measures())])


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("seal") / "seal.toml"
    path.write_text(SEAL)
    return path


@pytest.fixture(scope="module")
def seal(path):
    return sm.build_seal(path).with_placements()


@pytest.fixture(scope="module")
def nominal(seal):
    return results(seal)


@pytest.mark.parametrize("name", NUMBERS)
def test_a_parameter_has_the_effect_of_its_number(path, seal, nominal, name):
    *tables, key = NUMBERS[name]

    def change(own, factor=1.0, shift=0.0):
        for table in tables:
            own = own[table]
        own[key] = factor * own[key] + shift
        return own[key]

    placed = seal.scalars[name].value == 0.0
    how = {"shift": 0.02} if placed else {"factor": 1.03}
    number = change(tomllib.loads(SEAL), **how)
    given = results(seal, {name: how["shift"] if placed else number})
    written = results(sm.build_seal(read_changed(path, lambda own: change(own, **how))))
    size = np.abs(nominal).max()
    assert np.abs(given - nominal).max() > 1e-7 * size
    np.testing.assert_allclose(given, written, rtol=1e-8, atol=1e-10 * size)


def test_every_parameter_is_compared(seal):
    """But for those that are no number of the file, and shifts along a straight profile."""
    others = {name for name in seal.scalars if name not in NUMBERS}
    assert others == {
        "wall_y", "wall_angle", "foot_x", "foot_y", "foot_angle", "time",
    }  # fmt: skip


UNITS = {
    "material.hard.shore_a": "Shore A", "material.hard.bulk_modulus": "kPa",
    "material.grade.density": "kg/m3", "material.rubber.c10": "kPa", "model.temperature": "degC",
    "section.edge_spacing.lip": "mm", "material.rubber.modulus_over_temperature.1.2": "",
    "profile.lid.stage.1.translate.2": "mm", "measure.1.travel": "mm", "profile.lid.friction": "",
}  # fmt: skip


@pytest.mark.parametrize("path", UNITS)
def test_units_of_numbers_are_those_of_their_keys(path):
    materials = {
        "hard": {"shore_a": 60}, "grade": {"sponge": "2A2"}, "rubber": {"law": "mooney_rivlin"},
    }  # fmt: skip
    assert unit_of_key({"material": materials}, path) == UNITS[path]
