"""Edges that are moved or bonded to a profile: exact states, forces, sensitivities, files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from block_files import DESIGN, FIXED, GLUED, MEASURES, MOVED, file_of, seal_of

import seal_mdao as sm
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.loads.moved_edges import MovedEdges
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.work import StrainEnergy
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.result import analyze_particles
from seal_mdao.seals.settings import seal_of as seal_of_settings

REFERENCE = Path(__file__).parents[1] / "verification" / "references" / "bonded_block.json"
TIGHT = sm.NewtonOptions(tolerance=1e-11)
STRETCH = """[[moved]]
edges = ["base"]
directions = ["y"]
[[moved]]
edges = ["left"]
directions = ["x"]
[[moved]]
edges = ["right"]
directions = ["x"]
stage = [{ translate = [0.8, 0], steps = 3 }]
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{ translate = [0, -0.5], steps = 3 }]
"""
TURN = """[[moved]]
edges = ["base", "right", "top", "left"]
name = "frame"
pivot = [3, 1]
stage = [{ translate = [1, 2], rotate = 50, steps = 5 }]
"""


def test_a_block_stretched_by_its_edges_is_in_a_uniform_state(tmp_path):
    """Affine displacements, and the forces of the stress 2 W_T F + W_J cof F."""
    result = sm.analyze(replace(seal_of(tmp_path, STRETCH), newton=TIGHT))
    f = np.diag([1.1, 0.875])
    exact = (result.particles - [-4.0, 0.0]) @ (f - np.eye(2))
    np.testing.assert_allclose(result.path.displacement(), exact, rtol=0.0, atol=1e-10)
    material = result.seal.definitions[0].regions[0].material
    square, volume = np.array([(f**2).sum()]), np.array([np.linalg.det(f)])
    w_t, w_j = (own[0] for own in material.derivatives(square, volume)[:2])
    w_j += material.bulk_modulus * (volume[0] - 1.0)
    p = 2.0 * w_t * f + w_j * np.diag([f[1, 1], f[0, 0]])
    # the seal pulls back on what stretches it
    assert result.path.reaction("right")[-1, 0] == pytest.approx(-4.0 * p[0, 0], rel=1e-10)
    assert result.path.reaction("top")[-1, 1] == pytest.approx(-8.0 * p[1, 1], rel=1e-10)


def test_edges_begin_where_they_are_also_with_another_placement():
    """Before the first nominal step, in preliminary increments, too; the placement is reached in it."""
    motion = staged_motion([Stage(4, (0.0, -1.0), 20.0)], start=(1.0, 2.0), pivot=(0.5, 0.0))
    placed = motion.with_placement(x="x", angle="angle").moved({"x": 0.3, "angle": 5.0})
    start = np.array([*motion.positions[0], motion.angles[0]])
    edges = MovedEdges("top", np.arange(3), (0, 1), placed, start)
    places = np.array([[0.0, 2.0], [1.0, 2.5], [3.0, 2.0]])
    for fraction in (-1.0, -0.4, 0.0):
        np.testing.assert_allclose(edges.displacements(places, fraction), 0.0, atol=1e-15)
        np.testing.assert_allclose(edges.rates(places, fraction), 0.0, atol=1e-15)
    assert np.abs(edges.displacements(places, 1.0)).min() > 0.0


def test_a_block_turned_by_all_its_edges_stays_free_of_stress(tmp_path):
    result = sm.analyze(replace(seal_of(tmp_path, TURN), newton=TIGHT))
    angle, pivot = np.radians(50.0), np.array([3.0, 1.0])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    places = pivot + [1.0, 2.0] + (result.particles - pivot) @ turn.T
    np.testing.assert_allclose(
        result.particles + result.path.displacement(), places, rtol=0.0, atol=1e-10
    )
    assert abs(result.value(StrainEnergy())[0]) < 1e-11


def test_forces_of_a_bonded_block_are_those_of_finite_elements(tmp_path):
    reference = json.loads(REFERENCE.read_text())
    moved = '[[moved]]\nedges = ["top"]\nstage = [{ translate = [0, -0.2], steps = 3 }, '
    moved += "{ translate = [0.6, 0], steps = 4 }]\n"
    seal = seal_of(tmp_path, FIXED, moved, spacing=0.25, bulk=2000.0)
    force = sm.analyze(seal).path.reaction("top")
    assert force[2, 1] == pytest.approx(reference["compression_N_per_m"], rel=0.01)
    sheared = np.multiply(reference["sheared_N_per_m"], [-1.0, 1.0])
    np.testing.assert_allclose(force[-1], sheared, rtol=0.01)


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    """The block with its top bonded to a plate, which its right side touches, placed elsewhere."""
    folder = tmp_path_factory.mktemp("glued")
    seal = replace(seal_of(folder, FIXED, GLUED, MEASURES, DESIGN).with_placements(), newton=TIGHT)
    return sm.analyze(seal, [0.1, 0.05, 0.1], PLACED)


PLACED = {"plate_x": 0.01, "plate_y": -0.02, "plate_angle": 0.3}


def test_bonded_points_follow_the_plate(pressed):
    """They begin undeformed, wherever the plate is placed; it is clear by rounding there."""
    (own,) = pressed.seal.imposed().edges
    pose = pressed.term("plate").motion.pose(8.0)
    start = pressed.particles[own.particles] - own.start[:2]
    found = (pressed.particles + pressed.path.displacement())[own.particles]
    np.testing.assert_allclose(found, pose.places(start), rtol=0.0, atol=1e-9)
    assert not pressed.path.problem.imposed.at(0.0).any()


def test_forces_on_plate_and_base_balance(pressed):
    """Contact, which some of the bonded points carry too, and adhesion together."""
    assert pressed.response("plate").total[1] > 1.0
    both = pressed.path.reaction("plate") + Reaction("", edges=("base",)).forces(pressed)
    size = np.abs(pressed.path.reaction("plate")).max()
    np.testing.assert_allclose(both, 0.0, atol=1e-9 * size)
    assert pressed.value(pressed.measure("reaction"))[0] == pytest.approx(
        pressed.path.reaction("plate")[-1, 1], rel=1e-12
    )


NAMES = (*PLACED, "c10", "bulk_modulus", "plate_friction", "plate_normal_penalty")


def test_load_deflection_curves_have_the_forces_of_glued_and_fixed_edges(pressed):
    """They are the values at these travels, and those of the plate not the forces of its contact."""
    motion = pressed.term("plate").motion
    travels = tuple(motion.travels[1:].tolist())
    for own in (Reaction("plate", travels, (1,)), Reaction("", travels, (1,), edges=("base",))):
        along, force = own.curve(pressed)
        np.testing.assert_allclose(along, [0.0, *travels], rtol=1e-12)
        np.testing.assert_allclose(force[1:], pressed.value(own), rtol=1e-9)
    contact = [response.total[1] for response in pressed.path.at_nominal("plate")]
    assert np.abs(Reaction("plate", travels, (1,)).curve(pressed)[1][1:] - contact).max() > 1.0


def test_direct_and_adjoint_derivatives_agree(pressed):
    direct, adjoint = (
        sm.differentiate(pressed, NAMES, pressed.seal.standard, method)
        for method in ("direct", "adjoint")
    )
    for measure in pressed.seal.standard:
        one, other = direct[measure.name], adjoint[measure.name]
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * np.abs(other).max())


@pytest.mark.parametrize("name", ["offset", *PLACED, "c10"])
def test_derivatives_are_those_of_difference_quotients(pressed, name):
    standard, offsets = pressed.seal.standard, np.array([0.1, 0.05, 0.1])
    exact = sm.differentiate(pressed, NAMES, standard)
    column = 1 if name == "offset" else 3 + NAMES.index(name)
    errors = []
    for step in (1e-4, 1e-5):
        ends = []
        for sign in (1.0, -1.0):
            changed, parameters = offsets.copy(), dict(PLACED)
            if name == "offset":
                changed[1] += sign * step
            else:
                parameters[name] = pressed.seal.scalars[name].value + sign * step
            other = sm.analyze(replace(pressed.seal, changed={}), changed, parameters)
            ends.append([other.value(measure) for measure in standard])
        error = 0.0
        for measure, high, low in zip(standard, *ends, strict=True):
            slope = np.atleast_2d(exact[measure.name])[:, column]
            quotient = (high - low) / (2.0 * step)
            error = max(error, np.abs(quotient - slope).max() / np.abs(slope).max())
        errors.append(error)
    assert min(errors) < 1e-6


def test_derivatives_by_the_particles_of_a_turning_edge(tmp_path):
    """Where the edge is undeformed decides how far a turn moves it."""
    seal = replace(seal_of(tmp_path, FIXED, MOVED), newton=TIGHT)
    result, measure = sm.analyze(seal), Reaction("top", components=(1,))
    (own,) = seal.imposed().edges
    which = int(own.particles[2])
    for method in ("direct", "adjoint"):
        gradient = particle_gradient(result, (), [measure], method)["particles"]["reaction"]
        for component in range(2):
            ends = []
            for sign in (1.0, -1.0):
                particles = result.particles.copy()
                particles[which, component] += sign * 1e-5
                ends.append(analyze_particles(seal, particles).value(measure)[0])
            slope = (ends[0] - ends[1]) / 2e-5
            assert gradient[0, which, component] == pytest.approx(slope, rel=1e-6)


OPEN = [own.replace(", steps = 4", "").replace(", steps = 8", "") for own in (MOVED, GLUED)]


@pytest.mark.parametrize("moved", OPEN, ids=["moved", "glued"])
def test_steps_are_chosen_and_the_seal_is_rebuilt_from_its_settings(tmp_path, moved):
    seal = seal_of(tmp_path, FIXED, moved, MEASURES).with_placements()
    assert seal.n_steps > 4
    other = seal_of_settings(seal.settings())
    assert other.n_steps == seal.n_steps
    assert other.scalars == seal.scalars
    force = sm.analyze(seal).value(seal.standard[0])
    np.testing.assert_array_equal(sm.analyze(other).value(other.standard[0]), force)


def test_a_design_is_written_with_its_moved_edges(tmp_path):
    for library in ("ezdxf", "meshio", "tomli_w"):
        pytest.importorskip(library)
    file = file_of(tmp_path, FIXED, OPEN[0], MEASURES, DESIGN)
    seal, offsets = sm.build_seal(file), [0.1, 0.05, 0.1]
    paths = write_design(file, seal, np.array(offsets), seal.standard, tmp_path, "design")
    other = sm.build_seal(paths[0])
    assert sm.read_seal_file(paths[0]).step_tolerance is None
    for measure in seal.standard:
        again = sm.analyze(other).value(other.measures((measure.name,))[0])
        np.testing.assert_allclose(again, sm.analyze(seal, offsets).value(measure), rtol=1e-9)


ALSO_ON_TOP = GLUED.replace("= 8", "= 4")
WRONG = {
    "unknown edge": (MOVED.replace('"top"', '"topp"'), "no such edge (did you mean 'top'?)"),
    "fixed and moved": (
        MOVED.replace('"top"', '"base"'),
        "contains the edge 'base', which [fixed] already constrains",
    ),
    "fixed and glued": (GLUED.replace('["top"]', '["base"]'), "which [fixed] already constrains"),
    "moved and glued": (
        MOVED + ALSO_ON_TOP,
        "the list glued contains the edge 'top', which [[moved]] 1 ('top') already constrains",
    ),
    "glued and in contact": (
        GLUED.replace('["right"]', '["top"]'),
        "contact = 'top', but [[profile]] 1",
    ),
    "one corner, two motions": (
        MOVED.replace('"top"', '"right"'),
        "meets 'base' of [fixed] at a corner",
    ),
    "free direction": (
        MOVED.replace("pivot", 'directions = ["y"]\npivot'),
        "but the list directions contains only",
    ),
    "turn in one direction": (
        MOVED.replace("pivot", 'directions = ["y"]\npivot').replace("0.3, -0.4", "0, 0"),
        "rotates the edges, which needs both directions, but",
    ),
    "nothing moves in this seal file, because no": (
        '[[moved]]\nedges = ["top"]\n',
        "nothing moves in this seal file, because no",
    ),
    "designed": (
        MOVED + DESIGN.replace('"left"', '"top"'),
        "contains 'top', which [[moved]] 1 ('top') already constrains",
    ),
    "reaction of a free edge": (
        MOVED + '[[measure]]\ntype = "reaction"\nedges = ["left"]\n',
        "contains 'left', which is neither fixed nor moved; the fixed and moved edges are base, top",
    ),
    "edges and profile": (
        MOVED + '[[measure]]\ntype = "reaction"\nedges = ["top"]\nprofile = "top"\n',
        "the keys edges and profile are given together; use only one of them",
    ),
    "contact of moved edges": (
        MOVED + '[[measure]]\ntype = "contact_width"\n',
        "needs a [[profile]], but the seal file has none",
    ),
    "work": (
        MOVED + '[[measure]]\ntype = "friction_work"\n',
        "is not available with [[moved]]",
    ),
    "steps": (MOVED + GLUED.replace('glued = ["top"]', ""), "they must be equal"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_contradictions_are_refused(tmp_path, wrong):
    tables, message = WRONG[wrong]
    with pytest.raises(sm.SealFileError) as caught:
        file_of(tmp_path, FIXED, tables)
    assert message in str(caught.value)
