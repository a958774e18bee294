"""Supports end at the interfaces between materials: forces, thin layers, gradients."""

import json
from pathlib import Path

import numpy as np
import pytest
from exact_gradients import require_exact
from foam_bulbs import BLOCK, foam_bulb
from scipy.optimize import brentq
from two_rubbers import layered_block
from verification.bodies import Grid

import seal_mdao as sm
from seal_mdao.materials.isotropic import invariants
from seal_mdao.plotting.field import fine_grid
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.structure.particle_stress import particle_stress

FINITE_ELEMENTS = Path(__file__).parents[1] / "verification/references/bulb_on_block.json"
BULB = f"""{foam_bulb(BLOCK, 0.8)}
[[measure]]
type = "reaction"
[[measure]]
type = "stress_norm"
[[measure]]
type = "von_mises"
excess = 0.5
"""
FOAMS = """\
[material.soft]
sponge = "2A2"
[material.stiff]
sponge = "2A5"
"""
MOVED_TOP = """\
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{ translate = [0, -0.8], steps = 2 }]
[[measure]]
type = "reaction"
edges = ["top"]
component = "y"
"""


def laminate(height: float) -> str:
    """A confined block of two foams, W = mu/2 (I1 - 3 - 2 ln J), the stiff one above ``height``, mm."""
    return FOAMS + layered_block(1.0, height, 3.9) + MOVED_TOP


def seal_of(tmp_path, text):
    path = tmp_path / "section.toml"
    path.write_text(text)
    return sm.build_seal(path)


def test_the_force_on_a_bulb_on_a_block_is_that_of_finite_elements(tmp_path):
    """With supports that reach across the interface it is 3.4 % too large."""
    expected = json.loads(FINITE_ELEMENTS.read_text())["force_N_per_m"]
    result = sm.analyze(seal_of(tmp_path, BULB))
    assert result.converged
    assert 2.0 * result.reaction[-1][1] == pytest.approx(expected, rel=0.01)


def test_parts_see_each_other_at_their_interface_only(tmp_path):
    seal = seal_of(tmp_path, BULB)
    y = seal.nominal_particles[seal.body.hidden_pairs][..., 1] - 2.5
    across = y[:, 0] * y[:, 1] < 0.0
    assert across.sum() > 100
    shared = np.flatnonzero(np.abs(seal.nominal_particles[:, 1] - 2.5) < 1e-9)
    straight = shared[seal.nominal_particles[shared, 0] < 2.3]
    assert len(straight) > 3
    assert not np.isin(seal.body.hidden_pairs, straight).any()


@pytest.mark.parametrize("design", [
    'edges = ["bulb"]\nparameters = 3\nbound = 0.5', "vertex = [2.39791576, 2.5]\nbound = 0.5",
])  # fmt: skip
def test_gradients_are_exact_beside_an_interface(tmp_path, design):
    seal = seal_of(tmp_path, f"{BULB}[[design]]\n{design}\n")
    result = sm.analyze(seal, np.linspace(0.05, -0.05, seal.n_offsets))
    require_exact(result, ("reaction", "stress_norm", "von_mises"), 1e-4)


def stress(law, stretch):
    """P_22 = 2 W_T F_22 + W_J F_11 at F = diag(1, stretch)."""
    by_t, by_j = law.derivatives(*(np.array([own]) for own in invariants(np.diag([1.0, stretch]))))[
        :2
    ]
    return (2.0 * by_t * stretch + by_j).item()


def test_small_cells_beside_large_ones_are_solved_exactly(tmp_path):
    """Corners of the large cells of the soft part are far outside the supports of the stiff part."""
    meshio = pytest.importorskip("meshio")
    levels = np.array([0.0, 1.0, 2.0, *np.linspace(2.2, 4.0, 10)])
    grid = Grid(12, len(levels) - 1)
    particles = grid.reference * [6.0, len(levels) - 1]
    particles[:, 1] = levels[np.rint(particles[:, 1]).astype(int)]
    parts = (particles[grid.cells].mean(axis=1)[:, 1] > 2.0).astype(int)
    points = np.column_stack([particles, np.zeros(len(particles))])
    mesh = meshio.Mesh(points, [("quad", grid.cells)], cell_data={"part": [parts]})
    mesh.write(tmp_path / "mesh.vtu")
    text = laminate(2.0).replace("spacing = 1.0", 'cloud = "mesh.vtu"')
    result = sm.analyze(seal_of(tmp_path, text))
    require_uniform(result, 2.0)


@pytest.mark.parametrize("height", [2.0, 3.2, 3.8])
def test_two_confined_materials_are_solved_exactly(tmp_path, height):
    """Each of them is compressed uniformly, so that their stresses are equal; the layer above has two
    layers of cells or one."""
    result = sm.analyze(seal_of(tmp_path, laminate(height)))
    require_uniform(result, height)


def require_uniform(result, height):
    """Both materials with their exact uniform strains and stresses, the interface at this height."""
    seal = result.seal
    assert result.converged
    soft, stiff = (own.material for own in seal.definitions[0].regions)

    def above(below):
        return (3.2 - height * below) / (4.0 - height)

    # P_22 of both is the same, between no strain above and no strain below
    ends = 1.0 - 0.8 / height, min(1.0, (3.2 - 0.1 * (4.0 - height)) / height)
    below = brentq(lambda x: stress(soft, x) - stress(stiff, above(x)), *ends, xtol=1e-15)
    y = seal.nominal_particles[:, 1]
    exact = np.where(y < height, y * (below - 1.0), -0.8 + (above(below) - 1.0) * (y - 4.0))
    np.testing.assert_allclose(result.displacement()[:, 1], exact, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(result.displacement()[:, 0], 0.0, rtol=0.0, atol=1e-9)
    (force,) = result.value(result.measure("reaction"))
    assert abs(force) == pytest.approx(-6.0 * stress(soft, below), rel=1e-9)
    # stress and volume change everywhere are those of the own material, also on the interface
    grid = fine_grid(result)
    own = [von_mises(*both) for both in ((soft, below), (stiff, above(below)))]
    np.testing.assert_allclose(grid.von_mises(), np.array(own)[grid.region], rtol=1e-9)
    samples, structure = np.arange(len(seal.body.samples.anchors)), result.term("structure")
    at_samples = np.array(own)[structure.sample_regions]
    np.testing.assert_allclose(particle_stress(result.path, samples).value, at_samples, rtol=1e-9)
    every = EvaluationPoints(result.path)
    exact = np.array([below, above(below)])
    parts = np.concatenate([structure.particle_regions, every._between.points.parts])
    np.testing.assert_allclose(every.volume_change, exact[parts], rtol=1e-9)


def von_mises(law, stretch):
    """Of the deviator of diag(s_1, s_2, s_1), |s_2 - s_1| with s_i = 2 W_T lambda_i^2 / J."""
    by_t, _ = law.derivatives(*(np.array([own]) for own in invariants(np.diag([1.0, stretch]))))[:2]
    return abs(2.0 * by_t * (stretch**2 - 1.0) / stretch).item()


def test_largest_stress_does_not_depend_on_the_order_of_the_regions(tmp_path):
    """The stress on the interface is that of each material, whichever is named last."""
    text = laminate(2.0).replace('[[symmetry]]\nedges = ["left", "right"]\nnormal = "x"\n', "")
    for old, new in (('directions = ["y"]\n', ""), ("[0, -0.8]", "[0.5, -0.8]")):
        text = text.replace(old, new)
    text += '[[measure]]\ntype = "von_mises"\nexcess = 0.01\n'
    other = text.replace('material = "soft"', 'material = "STIFF"').replace("3.9]", "0.1]")
    other = other.replace('material = "stiff"', 'material = "soft"').replace("STIFF", "stiff")
    results = [sm.analyze(seal_of(tmp_path, own)) for own in (text, other)]
    one, both = ([r.value(r.measure(n))[0] for r in results] for n in ("reaction", "von_mises"))
    assert one[0] == pytest.approx(one[1], rel=1e-9)
    assert both[0] == pytest.approx(both[1], rel=1e-9)
    changes = []
    for result in results:
        # all particles and midpoints of the interface, in both materials
        regions, every = result.term("structure").sample_regions, EvaluationPoints(result.path)
        found = on_interface(*result.section_stress(), regions)
        assert len(found[0]) == len(found[1]) > 10
        assert abs(found[0].max() / found[1].max() - 1.0) > 0.1
        changes.append(on_interface(every.undeformed, every.volume_change, every.regions))
    for own, same in zip(changes[0], reversed(changes[1]), strict=True):
        np.testing.assert_allclose(np.sort(own), np.sort(same), rtol=1e-9)


def on_interface(places, values, regions):
    """The values at the interface y = 2 mm in each of two regions."""
    there = np.abs(places[:, 1] - 2.0) < 1e-9
    return [values[there & (regions == number)] for number in (0, 1)]


MESH = """
[material.soft]
sponge = "2A2"
[material.stiff]
shore_a = 60
[section]
material = "soft"
cloud = "mesh.vtu"
outer = [
  {{ edge = "base", line = [[0, 0], [6, 0]]}},
  {{ edge = "right", line = [[6, 0], [6, 4]]}},
  {{ edge = "top", line = [[6, 4], [0, 4]]}},
  {{ edge = "left", line = [[0, 4], [0, 0]]}},
]
[[section.region]]
material = "stiff"
at = [0.25, 2.25]
line = {line}
[fixed]
edges = ["base"]
[[moved]]
edges = ["top"]
stage = [{{ translate = [0.1, -0.4], steps = 1}}]
[[measure]]
type = "reaction"
edges = ["top"]
component = "y"
"""
"""A block with squares of 0.5 mm as cells, and the parts of its mesh file."""


def meshed(tmp_path, line, part_of):
    """Seal of the block, ``part_of`` the middles (m, 2) of its cells."""
    meshio = pytest.importorskip("meshio")
    grid = Grid(12, 8)
    particles = grid.reference * [6.0, 4.0]
    parts = part_of(*particles[grid.cells].mean(axis=1).T)
    points = np.column_stack([particles, np.zeros(len(particles))])
    meshio.Mesh(points, [("quad", grid.cells)], cell_data={"part": [parts]}).write(
        tmp_path / "mesh.vtu"
    )
    return seal_of(tmp_path, MESH.format(line=line))


def test_gauss_points_see_particles_of_their_own_material_only(tmp_path):
    """Of a tongue of one layer of cells, all corners of which lie on the interface."""
    line = "[[0, 2], [3, 2], [3, 2.5], [0, 2.5]]"
    seal = meshed(tmp_path, line, lambda x, y: ((x < 3.0) & (abs(y - 2.25) < 0.1)).astype(int))
    tongue, gauss = seal.parts == 1, sm.analyze(seal).path.discretization.cells.gauss
    assert tongue.sum() == 6
    raw, size, inside = gauss.raw, gauss.raw.group_size, np.unique(seal.body.cells[tongue])
    for cell in np.flatnonzero(tongue):
        first, last = raw.start[cell : cell + 2]
        slopes = raw.grad[2 * size * first : 2 * size * last].reshape(2 * size, -1)
        assert (slopes[:, np.isin(raw.neighbours[first:last], inside)] != 0.0).any(
            axis=0
        ).sum() >= 4
        assert not slopes[:, ~np.isin(raw.neighbours[first:last], inside)].any()


def test_parts_of_one_material_are_one(tmp_path):
    """The numbers of a mesh file make no interfaces where the material is the same."""

    def seal(other):
        line = "[[0, 2], [6, 2]]"
        return meshed(tmp_path, line, lambda x, y: np.where(y > 2.0, 1, other * (x > 3.0)))

    both, one = (sm.analyze(seal(other)) for other in (2, 0))
    assert np.array_equal(both.displacement(), one.displacement())
    assert one.value(one.measure("reaction")) == both.value(both.measure("reaction"))


def test_an_interface_may_end_on_an_arc_in_contact(tmp_path):
    """Contact points there are means of edges of both materials, bent like the arc. The other rubber is
    the same, so that the force is that of finite elements."""
    path = FINITE_ELEMENTS.parent / "half_ring.toml"
    material, section = path.read_text().split("[section]")
    other = material[material.index("[material.rubber]") :].replace("rubber", "other")
    line = [[4.2426406871, 4.2426406871], [3.0405591591, 3.0405591591]]
    region = f'[[section.region]]\nmaterial = "other"\nat = [5, 1]\nline = {line}\n[fixed]'
    text = f"{material}{other}[section]{section}".replace("[fixed]", region)
    result = sm.analyze(seal_of(tmp_path, text))
    expected = json.loads(path.with_suffix(".json").read_text())["force_N_per_m"][-1]
    assert abs(result.value("reaction")[0]) == pytest.approx(expected, rel=0.01)
