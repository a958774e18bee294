"""The frozen model: defaults of the example, changes, and wrong options refused at once."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.door.door_seal import options_of, with_options
from seal_mdao.seals.profiles import leading_contact, leading_motion
from seal_mdao.seals.result import analyze_particles


def last_height(model):
    """Height of the door at the end of its path."""
    return leading_motion(model).pose(model.n_steps).position[1]


def test_defaults_are_the_example():
    model = sm.door_seal()
    assert model.nominal_particles.shape == (174, 2)
    assert model.n_offsets == 25
    options = options_of(model)
    assert options == DoorOptions()
    assert (options.friction, options.corner_x, options.nominal_door_radius) == (0.25, 2.0, 4.0)
    assert (options.material.c10, options.material.c01) == (80.0, 20.0)
    assert len(model.body.constrained) == 7
    assert len(model.body.edge("outer").particles) == 51
    assert len(model.body.cells) == 116


def test_door_starts_clear_of_every_design_and_goes_down_in_equal_steps():
    model = sm.door_seal()
    positions = np.array([leading_motion(model).pose(k).position for k in range(106)])
    assert positions.shape == (106, 2)
    np.testing.assert_array_equal(positions[:, 0], 0.0)
    np.testing.assert_allclose(positions[[0, 1, 5, 105], 1], [10.1, 9.9, 9.5, -0.5], atol=1e-12)
    np.testing.assert_allclose(np.diff(positions[1:, 1]), -0.1, rtol=1e-12)
    bulge = model.particles(np.concatenate([np.full(14, 0.5), np.zeros(11)]))
    assert bulge[:, 1].max() == pytest.approx(options_of(model).start, abs=1e-12)


def test_changes_make_a_new_model():
    model = sm.door_seal()
    other = with_options(model, friction=0.3)
    assert [seal.scalars["friction"].value for seal in (model, other)] == [0.25, 0.3]
    assert with_options(other, friction=0.25).key == model.key != other.key
    with pytest.raises(FrozenInstanceError):
        model.n_steps = 4


def test_scalar_parameters_reach_the_material_and_the_law():
    model = sm.door_seal().with_parameters({"c10": 70.0, "friction": 0.1, "depth": 8.0})
    (region,) = model.terms()[0].regions
    assert (region.material.c10, region.material.c01) == (70.0, 20.0)
    assert model.scalars["depth"].value == options_of(model).depth == 8.0
    assert leading_contact(model).law.friction == 0.1
    assert last_height(model) == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("name", "value"),
    [("depth", 19.0), ("depth", 0.0), ("friction", 10.1), ("door_angle", 31.0), ("door_shift", -51.0),
     ("normal_penalty", 1.0), ("tangent_penalty", 1e13), ("c10", np.nan)],
)  # fmt: skip
def test_parameters_out_of_their_bounds_are_refused_by_name(name, value):
    """Those of the options, also where the terms themselves would take the value."""
    with pytest.raises(ValueError, match=f"{name} must be a number"):
        sm.door_seal().with_parameters({name: value})


def test_nominal_seal_has_the_nominal_door_and_the_other_parameters():
    """Also of the flat door, which has no radius."""
    for door in ("corner", "flat"):
        seal = sm.door_seal(door=door)
        assert seal.scalars["door_radius"].value == 4.0
        other = seal.with_parameters({"door_radius": 4.25, "friction": 0.125})
        assert other.scalars["door_radius"].value == 4.25
        assert other.nominal().key == seal.with_parameters({"friction": 0.125}).key != other.key
        assert seal.nominal() is seal


def test_parameters_of_the_motion_are_those_of_the_options():
    """Depth, shift and angle count from the values that the seal was built with."""
    changes = {"depth": 8.25, "door_shift": 0.5, "door_angle": 3.0}
    built = sm.door_seal(**changes)
    changed = sm.door_seal(depth=9.0, door_shift=-0.25).with_parameters(changes)
    for step in (0, 40, 105):
        here, there = (leading_motion(seal).coordinates(step) for seal in (built, changed))
        np.testing.assert_allclose(here, there, rtol=1e-14, atol=1e-14)
    assert built.with_placements() is built


@pytest.mark.parametrize("depth", [4.0, 12.0])
def test_depth_is_counted_from_the_top_of_the_drawn_seal(depth):
    model = sm.door_seal(depth=depth)
    assert 9.5 - last_height(model) == pytest.approx(depth, rel=1e-14)


def test_unknown_option_names_the_known_ones():
    with pytest.raises(TypeError, match=r"fricton.*friction_history"):
        sm.door_seal(fricton=0.3)


WRONG = [
    ("rays", 60), ("rays", 0), ("rays", 58.0), ("rays", "58"), ("layers", 1), ("layers", 2.5),
    ("n_gauss", 0), ("n_steps", 0), ("n_steps", 10.0), ("basis_order", 3), ("basis_order", "1"),
    ("support", 0.0), ("support", -1.0), ("support", np.nan), ("support", np.inf),
    ("support", "wide"), ("door", "round"), ("door", None),
    ("friction", -0.1), ("friction", np.nan), ("friction", "dry"), ("friction", None),
    ("friction_history", "none"), ("normal_penalty", 0.0), ("normal_penalty", np.inf),
    ("tangent_penalty", -1.0), ("tangent_penalty", "soft"), ("nominal_door_radius", 0.0),
    ("nominal_door_radius", np.nan), ("corner_x", np.nan), ("corner_x", None), ("segments", 3),
    ("segments", 32.0), ("segments", "32"), ("start", 9.5), ("start", np.nan), ("start", "high"),
    ("depth", 0.0), ("depth", -1.0), ("depth", 19.5), ("depth", np.nan), ("depth", None),
    ("outer_parameters", 1), ("inner_parameters", 3), ("inner_parameters", 4.5),
    ("material", "rubber"), ("material", None), ("section", None), ("newton", "fast"),
    ("pressure", "constant"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), WRONG)
def test_wrong_options_are_refused_by_name(name, value):
    with pytest.raises((ValueError, TypeError), match=name):
        sm.door_seal(**{name: value})


@pytest.mark.parametrize(
    "wrong", [{"tolerance": -1.0}, {"tolerance": np.nan}, {"max_iterations": 0},
              {"max_iterations": 2.5}, {"max_cuts": -1}]
)  # fmt: skip
def test_wrong_newton_options_are_refused_by_name(wrong):
    with pytest.raises((ValueError, TypeError), match=next(iter(wrong))):
        sm.NewtonOptions(**wrong)


def test_numpy_integers_are_integers():
    model = sm.door_seal(
        rays=np.int64(58), layers=np.int64(3), n_steps=np.int64(10), segments=np.int64(32)
    )
    assert len(leading_contact(model).shape.profile().kind) == 32


@pytest.mark.parametrize(
    ("offsets", "match"),
    [
        (np.zeros(24), r"\(25,\)"),
        (np.zeros((1, 25)), r"\(25,\)"),
        (np.r_[np.zeros(24), np.nan], r"\[24\]"),
        (np.r_[np.inf, np.zeros(24)], r"\[0\]"),
        (np.r_[0.0, -2.5, np.zeros(23)], r"\[1\].*2.5"),
    ],
)
def test_wrong_offsets_are_refused_by_number(offsets, match):
    with pytest.raises(ValueError, match=match):
        sm.analyze(sm.door_seal(), offsets)


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan, np.inf])
def test_wrong_door_radius_is_refused(radius):
    with pytest.raises(ValueError, match="door_radius"):
        sm.analyze(sm.door_seal(), parameters={"door_radius": radius})


def test_door_radius_must_be_one_number():
    with pytest.raises((ValueError, TypeError), match="door_radius"):
        sm.analyze(sm.door_seal(depth=0.5, n_steps=6), parameters={"door_radius": [4.0, 5.0]})


@pytest.mark.parametrize("radius", [120.0])
def test_door_radius_beyond_the_drawn_flat_is_refused(radius):
    """The flat ends at x = side - radius; its far end is where the profile begins."""
    with pytest.raises(ValueError, match="door_radius"):
        sm.analyze(sm.door_seal(depth=0.5, n_steps=6), parameters={"door_radius": radius})


def test_particles_of_a_wrong_shape_are_refused():
    model = sm.door_seal(depth=0.5, n_steps=6)
    with pytest.raises(ValueError, match=r"\(174, 2\)"):
        analyze_particles(model, model.nominal_particles[:-1])


def test_door_forms():
    """One line; line, arc, line; and as many straight pieces as asked for."""
    assert len(leading_contact(sm.door_seal(door="flat")).shape.profile().kind) == 1
    assert len(leading_contact(sm.door_seal()).shape.profile().kind) == 3
    assert len(leading_contact(sm.door_seal(segments=32)).shape.profile().kind) == 32


def bulged(size):
    """Boundary offsets of a seal whose outer boundary is moved out."""
    return np.concatenate([np.full(14, size), np.zeros(11)])


def test_design_at_its_bounds_has_room_below_the_door():
    """A step beyond the bound, as finite differences take it, is an analysis too."""
    seal = sm.door_seal(depth=0.5, n_steps=10)
    assert sm.analyze(seal, bulged(0.5 + 1e-3)).converged
    with pytest.raises(sm.GeometryError, match=r"overlaps the rigid profile .* by 0\.001 mm"):
        sm.analyze(with_options(seal, clearance=0.0), bulged(0.5 + 1e-3))


@pytest.mark.parametrize("size", [0.0, 0.35])
def test_room_above_the_seal_changes_no_bit(size):
    """Of a seal that is touched after the first load step."""
    seal, depth = sm.door_seal(depth=1.0, n_steps=15), ("depth",)
    found = [
        sm.analyze(with_options(seal, clearance=clearance), bulged(size))
        for clearance in (0.0, 0.1, 3.0)
    ]
    for other in found[1:]:
        for name in ("newton_iterations", "reaction", "travel", "von_mises"):
            assert np.array_equal(getattr(other, name), getattr(found[0], name)), name
        assert np.array_equal(other.displacement(), found[0].displacement())
        rates = [sm.differentiate(result, depth).von_mises for result in (other, found[0])]
        assert np.array_equal(*rates)


@pytest.mark.parametrize(
    "options", [{}, {"accuracy": "engineering"}, {"n_steps": 3, "step_ends": (0.2, 0.7, 1.0)}]
)
def test_room_lengthens_the_first_load_step_only(options):
    near, far = (
        leading_motion(sm.door_seal(**options, clearance=clearance)) for clearance in (0.0, 0.1)
    )
    for step in range(near.n_steps + 1):
        rise = np.array([0.0, 0.1, 0.0]) if step == 0 else 0.0
        assert np.array_equal(far.coordinates(step), near.coordinates(step) + rise)
        assert np.array_equal(far.rates_at(step), near.rates_at(step))
    assert far.travel == near.travel


def test_room_does_not_change_the_steps_that_are_chosen():
    """Also where the seal is touched in the first one."""
    options = {"depth": 1.0, "door": "flat", "steps": "auto", "step_tolerance": 0.05}
    near, far = (sm.door_seal(**options, clearance=clearance) for clearance in (0.0, 0.1))
    assert options_of(near).step_ends == options_of(far).step_ends


@pytest.mark.parametrize("clearance", [-0.1, 1e3, np.nan, "some", None])
def test_room_that_is_none_is_named(clearance):
    with pytest.raises(ValueError, match="clearance"):
        sm.door_seal(clearance=clearance)


def test_design_that_begins_inside_the_door_is_told_to_start_farther_away():
    offsets = np.concatenate([np.full(14, 0.8), np.zeros(11)])
    with pytest.raises(
        sm.GeometryError, match=r"overlaps the rigid profile .* by 0\.2 mm .* the door seal"
    ):
        sm.analyze(sm.door_seal(n_steps=10), offsets)
    assert sm.analyze(sm.door_seal(start=10.5, depth=1.0, n_steps=4), offsets).converged
