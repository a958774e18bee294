"""Values that are no good are refused by name, in one line, before anything is computed."""

from fractions import Fraction

import numpy as np
import pytest

import seal_mdao as sm

SEAL = [
    ("friction", 10**400), ("friction", 11.0), ("friction", np.array([0.1, 0.2])), ("friction", 0.1j),
    ("friction", True), ("basis_order", np.array([1, 2])), ("basis_order", True),
    ("symmetric", "no"), ("symmetric", [1, 2]), ("symmetric", 1), ("door", np.array("corner")),
    ("layers", 2), ("layers", 41), ("n_gauss", 1), ("n_gauss", 100), ("n_gauss", 1000),
    ("rays", 58 * 41), ("segments", 10**8), ("outer_parameters", 10**7), ("inner_parameters", 10**7),
    ("corner_x", 1e300), ("corner_x", 51.0), ("normal_penalty", 1e-300), ("normal_penalty", 10.0),
    ("normal_penalty", 1e30), ("tangent_penalty", 1e-300), ("depth", 1e-12), ("depth", 1e-9),
    ("start", 1e300), ("drawn_door_radius", 1e-300), ("door_radius", "wide"),
    ("door_radius", 10**400), ("support", 1e300), ("n_steps", True), ("n_steps", 10**400),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), SEAL)
def test_wrong_option_of_the_seal_is_named(name, value):
    with pytest.raises(ValueError, match=name) as error:
        sm.door_seal(**{name: value})
    assert len(str(error.value)) < 300
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("inner_radius", "7.5"), ("inner_radius", None), ("outer_radius", 10**400),
     ("outer_radius", 1e300), ("base_angle", "wide"), ("base_angle", [0.1]), ("inner_radius", np.nan)],
)  # fmt: skip
def test_wrong_type_in_a_section_is_named(name, value):
    with pytest.raises(ValueError, match=name):
        sm.Section(**{name: value})


@pytest.mark.parametrize(
    ("law", "wrong"),
    [(sm.MooneyRivlin, {"c10": "soft"}), (sm.MooneyRivlin, {"c10": None}),
     (sm.MooneyRivlin, {"c01": [1.0]}), (sm.MooneyRivlin, {"bulk_modulus": 1e30}),
     (sm.MooneyRivlin, {"bulk_modulus": 10**400}), (sm.NeoHookean, {"c10": "soft"}),
     (sm.Gent, {"limit": "far"})],
)  # fmt: skip
def test_wrong_constant_of_a_material_is_named(law, wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        law(**wrong)


@pytest.mark.parametrize("mu", ["soft", [[1.0], [1.0, 2.0]], 1j])
def test_wrong_terms_of_a_material_are_named(mu):
    with pytest.raises(ValueError, match="mu of Ogden"):
        sm.Ogden(mu=mu, alpha=(2.0,))


@pytest.mark.parametrize(
    "wrong",
    [{"tolerance": 1e9}, {"tolerance": "tight"}, {"tolerance": None}, {"tolerance": 1e-3},
     {"max_iterations": True}, {"max_iterations": 10**400}, {"max_cuts": 1000},
     {"damped_iterations": "many"}],
)  # fmt: skip
def test_wrong_newton_option_is_named(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        sm.NewtonOptions(**wrong)


@pytest.mark.parametrize(
    "offsets",
    ["drawn", ["a"] * 25, [[0.0], [0.0, 1.0]], np.zeros(25, complex), {"a": 1}, [None] * 25],
)
def test_wrong_offsets_are_named(offsets):
    with pytest.raises(ValueError, match="boundary_offsets"):
        sm.analyze(sm.door_seal(), offsets)


@pytest.mark.parametrize("radius", ["wide", [[4.0], [4.0, 5.0]], 4.0 + 1j, None, 1e-300])
def test_wrong_radius_is_named(radius):
    with pytest.raises(ValueError, match="door_radius"):
        sm.analyze(sm.door_seal(), parameters={"door_radius": radius})


def test_fractions_and_numpy_numbers_are_numbers():
    seal = sm.door_seal(friction=Fraction(1, 4), symmetric=np.bool_(False), depth=np.float32(10.0))
    assert seal == sm.door_seal()
    assert sm.DoorSeal.from_settings(seal.settings()) == seal
    assert seal.check_offsets([Fraction(0)] * 25).tolist() == [0.0] * 25
