"""Particles are closer to each other at narrow notches, and their faces do not see each other."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from exact_gradients import require_exact
from foam_bulbs import CLIP, foam_bulb

import seal_mdao as sm
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.errors import GeometryError
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.rkpm.cells import support_radii
from seal_mdao.seals.checks import crosses_itself, squeezed_corner
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.outline import section_cloud
from seal_mdao.seals.outline.notches import notch_places
from seal_mdao.seals.outline.outline_seal import reseed
from seal_mdao.structure.elastic_body import elastic_body

NOTCHED = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 1.0
outer = [
  {{ edge = "base", line = [[0, 0], [10, 0], [10, 6]] }},
  {{ edge = "top", line = [[10, 6], [{right}, 6], [5, 3], [{left}, 6], [0, 6]] }},
  {{ edge = "base", line = [[0, 6], [0, 0]] }},
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.2
contact = ["top"]
line = [[-30, 0], [30, 0]]
start = [5, 6]
stage = [{{ translate = [0, -0.5], steps = 2 }}]
"""
HOLE = 'hole = [{ edge = "hole", line = [[4, 1], [5, 4.2], [6, 1], [4, 1]] }]'
"""A triangle whose corners are wedges of rubber's void, one of 35 degrees."""
DESIGN = """
[[design]]
vertex = [5.0, 3.0]
bound = 0.5
[[measure]]
type = "reaction"
[[measure]]
type = "stress_norm"
"""
MOVED_VERTEX = """
[[design]]
vertex = [5.0, 3.0]
bound = 0.5
"""
FINITE_ELEMENTS = Path(__file__).parents[1] / "verification/references/notched_bulb.json"
CLOSING = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 1.0
outer = [
  { edge = "base", line = [[0, 0], [10, 0]] },
  { edge = "right", line = [[10, 0], [10, 6]] },
  { edge = "top", line = [[10, 6], [5.5289809, 6], [5, 3], [4.4710191, 6], [0, 6]] },
  { edge = "left", line = [[0, 6], [0, 0]] },
]
[fixed]
edges = ["right"]
[[moved]]
edges = ["left"]
stage = [{ translate = [0.8, 0.0], steps = 5 }]
[self_contact]
edges = ["top"]
friction = 0.0
normal_penalty = 1e5
[[measure]]
type = "reaction"
edges = ["left"]
component = "x"
"""
HALF = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 1.0
edge_spacing = { top = 0.2 }
outer = [
  { edge = "base", line = [[0, 0], [5, 0]] },
  { edge = "middle", line = [[5, 0], [5, 3]] },
  { edge = "top", line = [[5, 3], [4.4710191, 6], [0, 6]] },
  { edge = "left", line = [[0, 6], [0, 0]] },
]
[[symmetry]]
edges = ["middle"]
normal = "x"
[[moved]]
edges = ["left"]
stage = [{ translate = [0.4, 0.0], steps = 5 }]
[[profile]]
name = "middle_plane"
friction = 0.0
normal_penalty = 1e5
contact = ["top"]
line = [[-30, 0], [30, 0]]
start = [5, 3]
angle = -90
[[measure]]
type = "reaction"
edges = ["left"]
component = "x"
"""
"""A block whose notch of 20 degrees closes, and its half whose face closes on the plane of symmetry."""


def file_of(tmp_path, text):
    path = tmp_path / "section.toml"
    path.write_text(text)
    return sm.read_seal_file(path)


def notched(degrees):
    half = 3.0 * np.tan(0.5 * np.radians(degrees))
    return NOTCHED.format(left=5.0 - half, right=5.0 + half)


def seal_of(tmp_path, degrees, change=lambda text: text):
    return unchosen_seal(file_of(tmp_path, change(notched(degrees))))


def with_hole(text):
    block = 'top", line = [[10, 6], [0, 6]] }},\n'.replace("}}", "}")
    begin, end = text.index('top", line'), text.index('  { edge = "base", line = [[0, 6]')
    return (text[:begin] + block + text[end:]).replace("[fixed]", f"{HOLE}\n[fixed]")


def longest_sides(seal):
    """Of the cells at every particle."""
    return support_radii(seal.body.cells, seal.nominal_particles, 1.0)


@pytest.mark.parametrize("degrees", [20.0, 55.0])
def test_cells_are_small_at_the_vertex_of_a_narrow_notch_and_grow_from_there(tmp_path, degrees):
    seal = seal_of(tmp_path, degrees)
    size, away = longest_sides(seal), np.hypot(*(seal.nominal_particles - [5.0, 3.0]).T)
    assert size[away == 0.0].item() < 0.15
    assert (size <= np.maximum(0.15 + 0.6 * away, 1.25)).all()
    assert size.max() > 0.7


def test_the_faces_of_a_notch_do_not_see_each_other(tmp_path):
    seal = seal_of(tmp_path, 20.0)
    particles, radius = seal.nominal_particles, seal.body.support_radius
    np.testing.assert_allclose(radius, 2.2 * longest_sides(seal), rtol=1e-12)
    away = particles - [5.0, 3.0]
    # on the faces, 10 degrees from the vertical, and closer to each other than the supports reach
    faces = np.flatnonzero((away[:, 1] > 1e-9) & (np.abs(away[:, 0]) < np.tan(0.18) * away[:, 1]))
    one, other = faces[away[faces, 0] < 0.0], faces[away[faces, 0] > 0.0]
    apart = np.hypot(*(particles[one][:, None] - particles[other]).transpose(2, 0, 1))
    near = np.argwhere(apart < radius[one][:, None])
    assert len(near) > 20
    hidden = set(map(tuple, seal.body.hidden_pairs.tolist()))
    assert hidden.issuperset(zip(one[near[:, 0]].tolist(), other[near[:, 1]].tolist(), strict=True))


def test_sections_without_narrow_notches_keep_their_particles(tmp_path, monkeypatch):
    new = {angle: seal_of(tmp_path, angle) for angle in (20.0, 65.0)}
    monkeypatch.setattr(section_cloud, "AT_NOTCHES", ())
    old = {angle: seal_of(tmp_path, angle) for angle in (20.0, 65.0)}
    assert np.array_equal(new[65.0].nominal_particles, old[65.0].nominal_particles)
    assert len(new[20.0].nominal_particles) > len(old[20.0].nominal_particles)


def test_a_notch_without_room_for_small_cells_is_filled_with_larger_ones(tmp_path, monkeypatch):
    """Where the section cannot be filled with small cells at the vertex, it is filled without them."""
    tried, filled = [], section_cloud.cloud

    def cloud(loops, *args):
        least = min(np.hypot(*np.diff(loop, axis=0).T).min() for loop in loops)
        tried.append(least)
        if least < 0.4:
            raise GeometryError("too small")
        return filled(loops, *args)

    monkeypatch.setattr(section_cloud, "cloud", cloud)
    seal = seal_of(tmp_path, 20.0)
    # every fraction of the spacing before larger cells at the vertex
    n = len(section_cloud.FRACTIONS)
    assert max(tried[:n]) < 0.08 < min(tried[n : 2 * n])
    assert max(tried[n : 2 * n]) < 0.4 < tried[2 * n]
    assert longest_sides(seal).min() > 0.4


def test_corners_of_holes_are_notches(tmp_path):
    seal = seal_of(tmp_path, 60.0, with_hole)
    # the two corners at the foot of the triangle have 72.6 degrees, the outer corner 60
    np.testing.assert_allclose(notch_places(seal.boundaries), [[5.0, 4.2]])


def test_the_force_on_a_bulb_beside_a_notch_is_that_of_finite_elements(tmp_path):
    """Without small cells at the vertex, and with supports that reach across it, it is 9 % too large."""
    expected = json.loads(FINITE_ELEMENTS.read_text())["force_N_per_m"]
    seal = sm.build_seal(file_of(tmp_path, foam_bulb(CLIP, 0.5)))
    result = sm.analyze(seal)
    assert result.converged
    assert 2.0 * result.reaction[-1][1] == pytest.approx(expected, rel=0.02)
    assert len(seal.nominal_particles) < 1.5 * 361


def test_the_patch_test_is_passed(tmp_path):
    """The complete boundary is moved by a linear field: the inside follows it."""
    seal = seal_of(tmp_path, 20.0)
    particles, body = seal.nominal_particles, seal.body
    fixed = np.zeros(particles.shape, bool)
    fixed[np.concatenate(seal.loops)] = True
    field = particles @ np.array([[0.12, 0.2], [-0.05, -0.08]]).T
    body = replace(body, fixed=fixed)
    terms = (elastic_body(sm.MooneyRivlin(80.0, 20.0, 3000.0)),)
    ramp = np.linspace(0.0, 1.0, 3)[:, None, None]
    disc = discretize(body, particles, terms)
    problem = PathProblem(disc, terms, ImposedDisplacements(ramp * field))
    path = solve_path(problem, 2, sm.NewtonOptions(1e-13))
    assert path.converged
    np.testing.assert_allclose(path.displacement(), field, rtol=0.0, atol=1e-10)


def test_gradients_are_exact_in_a_design_that_moves_the_vertex(tmp_path):
    text = notched(20.0).replace("-0.5], steps = 2", "-0.05], steps = 2")
    seal = sm.build_seal(file_of(tmp_path, text + DESIGN))
    offsets = np.full(seal.n_offsets, 0.05)
    result = sm.analyze(seal, offsets)
    require_exact(result, ("reaction", "stress_norm"), 1e-4)


def test_the_faces_of_a_notch_touch_each_other_close_to_its_vertex(tmp_path):
    """Excluded are neighbours within three sides; they are small here."""
    result = sm.analyze(sm.build_seal(file_of(tmp_path, CLOSING)))
    half = sm.analyze(sm.build_seal(file_of(tmp_path, HALF)))
    assert result.converged
    assert half.converged
    term, response = result.term("self_contact"), result.response("self_contact")
    away = np.hypot(*(term.reference[response.branch > 0] - [5.0, 3.0]).T)
    assert away.min() < 0.3
    force, expected = (float(own.value(own.seal.standard[0])[0]) for own in (result, half))
    assert force == pytest.approx(expected, rel=0.01)
    assert not crosses_itself(result.path)


def test_an_analysis_that_ends_at_the_vertex_of_a_notch_says_so(tmp_path):
    before, after = CLOSING.split("[self_contact]")
    alone = before + after[after.index("[[measure]]") :]

    def pressed(travel, steps):
        text = alone.replace("[0.8, 0.0], steps = 5", f"[{travel}, 0.0], steps = {steps}")
        seal = sm.build_seal(file_of(tmp_path, text))
        return sm.analyze(replace(seal, newton=sm.NewtonOptions(max_cuts=0)))

    failed, slightly = pressed(12.0, 8), pressed(0.05, 1)
    assert not failed.converged
    text = squeezed_corner(EvaluationPoints(failed.path))
    assert text.startswith("material is inverted at the re-entrant corner at x = 5, y = 3 ")
    assert f"At the last converged load step {text}. " in failed.failure
    assert "round this corner" in text
    # not where material is hardly compressed
    assert slightly.converged
    assert squeezed_corner(EvaluationPoints(slightly.path)) == ""


def test_gradients_are_exact_where_a_notch_closes(tmp_path):
    text = CLOSING.replace("friction = 0.0", "friction = 0.3\ntangent_penalty = 1e4")
    seal = sm.build_seal(file_of(tmp_path, text + MOVED_VERTEX))
    result = sm.analyze(seal, np.full(seal.n_offsets, 0.05))
    assert np.count_nonzero(result.response("self_contact").branch > 0) > 5
    require_exact(result, ("reaction",), 1e-5)


def test_new_particles_of_the_first_design_are_those_of_the_section(tmp_path):
    seal = unchosen_seal(file_of(tmp_path, notched(20.0) + DESIGN))
    again = reseed(seal, np.zeros(seal.n_offsets))
    assert np.array_equal(again.nominal_particles, seal.nominal_particles)
    assert np.array_equal(again.body.support_radius, seal.body.support_radius)
