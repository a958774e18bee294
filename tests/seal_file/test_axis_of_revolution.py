"""Sections of bodies of revolution that touch the axis, or lie beyond it."""

import numpy as np
import pytest
from exact_gradients import require_exact
from ring_files import HEAD, PLANE, under_a_lid

import seal_mdao as sm
from seal_mdao.errors import GeometryError

FILE = (
    HEAD.replace("{bulk}", "80000.0").replace("{spacing}", "0.5")
    + """\
outer = [ {outer} ]
[[moved]]
edges = ["top"]
stage = [{{ translate = [0.0, -0.1] }}]
[[measure]]
type = "reaction"
"""
)
BASE = '{{ edge = "top", line = [[{b}, 0.0], [{a}, 0.0]] }}'
ARC = '{{ edge = "round", arc = {{ start = [{a}, 0.0], through = [{m}, {d}], end = [{b}, 0.0] }} }}'


def half_disc(a, b):
    """A file of the lower half of a disc between the radii ``a`` and ``b``."""
    at = {"a": a, "b": b, "m": 0.5 * (a + b), "d": -0.5 * (b - a)}
    return FILE.format(outer=", ".join(own.format(**at) for own in (ARC, BASE)))


def read(tmp_path, text):
    path = tmp_path / "ring.toml"
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


def test_an_arc_beside_the_axis(tmp_path):
    assert read(tmp_path, half_disc(1.0, 5.0)).axisymmetric


def test_an_arc_that_touches_the_axis_is_refused(tmp_path):
    with pytest.raises(
        sm.SealFileError, match=r"edge '\w+' touches the axis x = 0 in the single point y = 0"
    ):
        read(tmp_path, half_disc(0.0, 4.0))


def test_an_arc_beyond_the_axis_is_refused(tmp_path):
    with pytest.raises(sm.SealFileError, match=r"reaches x = -1, beyond the axis of revolution"):
        read(tmp_path, half_disc(-1.0, 3.0))


def test_an_arc_that_ends_at_an_edge_on_the_axis(tmp_path):
    """A quarter of a disc: its arc ends where the edge on the axis does."""
    arc = "{ start = [0.0, -4.0], through = [2.8284271247, -2.8284271247], end = [4.0, 0.0] }"
    outer = f'{{ edge = "round", arc = {arc} }}, {BASE.format(a=0.0, b=4.0)}, '
    outer += '{ edge = "axis", line = [[0.0, 0.0], [0.0, -4.0]] }'
    file = read(tmp_path, FILE.format(outer=outer))
    assert file.supports["axis"] == (0,)


DOME = (
    PLANE
    + HEAD.replace("{bulk}", "20000.0").replace("{spacing}", "0.8")
    + """\
outer = [
  { edge = "base", line = [[0.0, 0.0], [4.0, 0.0]] },
  { edge = "dome", arc = { start = [4.0, 0.0], through = [2.4, 3.2], end = [0.0, 4.0] } },
  { edge = "axis", line = [[0.0, 4.0], [0.0, 0.0]] },
]
[[profile]]
name = "lid"
friction = 0.0
normal_penalty = 1e6
tangent_penalty = 1e4
line = [[0.0, 0.0], [20.0, 0.0]]
start = [0.0, START]
stage = [{ translate = [0.0, TRAVEL], steps = 4 }]
[[measure]]
type = "reaction"
[[design]]
edges = ["dome"]
parameters = 4
bound = 0.2
"""
)


def pressed_dome(tmp_path, gap):
    """A half ball on a plane of symmetry, below a lid that moves from a distance to one place."""
    text = DOME.replace("START", str(4.0 + gap)).replace("TRAVEL", str(-0.5 - gap))
    return sm.analyze(sm.build_seal(read(tmp_path, text)))


def test_a_dome_may_touch_a_lid_at_the_axis_at_the_start(tmp_path):
    """The contact point on the axis is not inside the lid; the force is that of a lid from above."""
    force, other = (pressed_dome(tmp_path, gap).value("reaction")[0] for gap in (0.0, 0.05))
    assert force > 0.5
    assert force == pytest.approx(other, rel=1e-6)


def test_gradients_of_a_dome_below_a_lid(tmp_path):
    result = pressed_dome(tmp_path, 0.05)
    require_exact(result, ["reaction"], 1e-4)
    # between its particles the axis is no boundary that could pass through the axis
    assert not result.faults


def cylinder(radius):
    """A file of a ring that nothing holds at its base, with this inner radius."""
    own = under_a_lid((radius, 4.0), 2.0, 2.1, -0.3, 3, bulk=80000.0, points="edges")
    return own + '[[measure]]\ntype = "reaction"\n'


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_a_plane_of_symmetry_across_the_axis_holds_a_ring(tmp_path, radius):
    """And no profile has to touch it at the start: it can only move along the axis."""
    file = read(tmp_path, PLANE + cylinder(radius))
    result = sm.analyze(sm.build_seal(file))
    result.require_converged()
    assert result.value("reaction")[-1] > 0.0


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_the_axis_holds_nothing_along_itself(tmp_path, radius):
    with pytest.raises(sm.SealFileError, match="profiles must support the section"):
        read(tmp_path, cylinder(radius))


CIRCLE = """\
outer = [
  {{ edge = "outside", arc = {{ start = [{x}, -2.0], through = [{right}, 0.0], end = [{x}, 2.0] }} }},
  {{ edge = "inside", arc = {{ start = [{x}, 2.0], through = [{left}, 0.0], end = [{x}, -2.0] }} }},
]
[[moved]]
edges = ["outside"]
directions = ["y"]
stage = [{{ translate = [0.0, -0.1] }}]
"""


def circle(inner):
    """A file of an O-ring with this inner radius."""
    text = HEAD.replace("{bulk}", "80000.0").replace("{spacing}", "0.5")
    return text + CIRCLE.format(x=inner + 2.0, left=inner, right=inner + 4.0)


def test_an_arc_that_touches_the_axis_between_its_ends_is_refused(tmp_path):
    assert read(tmp_path, circle(0.1)).axisymmetric
    with pytest.raises(
        sm.SealFileError, match="'inside' touches the axis x = 0 in the single point y = 0;"
    ):
        read(tmp_path, circle(0.0))


MOVED = '[[moved]]\nedges = ["EDGE"]\nstage = [{ translate = TRAVEL, steps = 2 }]\n'
GLUED = """\
[[profile]]
name = "plate"
friction = 0.3
contact = ["side"]
glued = ["EDGE"]
line = [[0.0, 0.0], [20.0, 0.0]]
start = [0.0, 2.0]
stage = [{ translate = TRAVEL, steps = 2 }]
"""


def pulled(inner, edge, travel, table=MOVED):
    """A file of a ring on a smooth base of which an edge moves by ``travel``."""
    text, _, _ = under_a_lid((inner, 4.0), 2.0, 2.0, -0.1, 2).partition("[[profile]]")
    table = table.replace("EDGE", edge).replace("TRAVEL", str(list(travel)))
    return f'{text}[fixed]\nedges = ["base"]\ndirections = ["y"]\n{table}'


@pytest.mark.parametrize("table", [MOVED, GLUED])
def test_an_edge_that_touches_the_axis_does_not_move_along_x(tmp_path, table):
    """There the particle on the axis would stay, and the one beside it would move."""
    assert read(tmp_path, pulled(0.0, "top", (0.0, -0.1), table)).axisymmetric
    with pytest.raises(
        sm.SealFileError, match="touches the axis of revolution x = 0, where nothing"
    ):
        read(tmp_path, pulled(0.0, "top", (0.2, -0.1), table))


def held_by(tmp_path, fixed, inner=0.0):
    """The file of a ring of which the outside moves along y, held by another table ``[fixed]``."""
    text = pulled(inner, "side", (0.0, -0.1))
    return read(tmp_path, text.replace('edges = ["base"]\ndirections = ["y"]\n', fixed))


@pytest.mark.parametrize(
    "fixed", ['edges = ["inside"]\n', 'edges = ["base", "inside"]\ndirections = ["y"]\n']
)
def test_the_axis_is_no_support_along_y(tmp_path, fixed):
    """A force on a line causes an infinite displacement there; between particles it is finite."""
    words = (
        r"\[fixed\] prescribes displacements along y of the edge 'inside', which lies on the axis"
    )
    with pytest.raises(sm.SealFileError, match=words):
        held_by(tmp_path, fixed)


@pytest.mark.parametrize(("directions", "inner"), [('["x", "y"]', 0.5), ('["x"]', 0.0)])
def test_an_edge_beside_the_axis_may_be_fixed_and_the_axis_along_x(tmp_path, directions, inner):
    fixed = f'edges = ["inside"]\ndirections = {directions}\n'
    assert held_by(tmp_path, fixed, inner).axisymmetric


def test_the_axis_is_not_glued_to_a_profile(tmp_path):
    with pytest.raises(sm.SealFileError, match=r"\('plate'\) prescribes displacements along y"):
        read(tmp_path, pulled(0.0, "inside", (0.0, -0.1), GLUED))


def test_an_edge_does_not_move_beyond_the_axis(tmp_path):
    assert read(tmp_path, pulled(0.5, "inside", (-0.3, 0.0))).axisymmetric
    with pytest.raises(sm.SealFileError, match=r"moves the edge 'inside' to x = -0\.1, but a body"):
        read(tmp_path, pulled(0.5, "inside", (-0.6, 0.0)))


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_boundary_beyond_the_axis_is_no_result(tmp_path):
    """A parameter moves the bore farther than the file does."""
    text = pulled(0.5, "inside", (-0.3, 0.0))
    seal = sm.build_seal(read(tmp_path, text)).placed(("inside_x",))
    assert sm.analyze(seal).trustworthy
    result = sm.analyze(seal, parameters={"inside_x": -0.3})
    assert result.converged
    assert not result.trustworthy
    assert any("beyond the axis of revolution x = 0" in own for own in result.faults)


def test_the_axis_is_no_support_whose_force_is_a_measure(tmp_path):
    text = pulled(0.0, "top", (0.0, -0.1)) + '[[measure]]\ntype = "reaction"\nedges = ["{edge}"]\n'
    assert read(tmp_path, text.replace("{edge}", "top")).axisymmetric
    with pytest.raises(
        sm.SealFileError, match="contains 'inside', which is neither fixed nor moved"
    ):
        read(tmp_path, text.replace("{edge}", "inside"))


def test_an_edge_that_its_position_moves_away_from_the_axis_is_no_result(tmp_path):
    text = pulled(0.0, "top", (0.0, -0.1)) + '[[measure]]\ntype = "strain_energy"\n'
    seal = sm.build_seal(read(tmp_path, text)).placed(("top_x",))
    assert sm.analyze(seal, parameters={"top_y": -0.05}).trustworthy
    result = sm.analyze(seal, parameters={"top_x": 0.1})
    assert result.converged
    assert any("0.1 mm away from the axis of revolution" in own for own in result.faults)


BORE = """\
[[design]]
edges = ["inside"]
parameters = 4
bound = 0.6
[[measure]]
type = "volume"
"""


def test_a_design_beyond_the_axis_is_refused(tmp_path):
    """The bore moves by up to 2/3 of the offsets towards the axis, 0.2 mm away."""
    seal = sm.build_seal(read(tmp_path, pulled(0.2, "top", (0.0, -0.1)) + BORE))
    offsets = np.array([0.0, 1.0, 1.0, 0.0])
    assert sm.analyze(seal, 0.2 * offsets).converged
    with pytest.raises(
        GeometryError, match="reaches the axis of revolution x = 0 or lies beyond it"
    ):
        sm.analyze(seal, 0.28 * offsets)


def test_a_design_that_touches_the_axis_in_a_point_is_refused(tmp_path):
    vertex = BORE.replace(
        'edges = ["inside"]\nparameters = 4', 'vertex = [0.2, 2.0]\ndirections = ["x"]'
    )
    seal = sm.build_seal(read(tmp_path, pulled(0.2, "side", (0.0, 0.0)) + vertex))
    assert sm.analyze(seal, [-0.19]).converged
    with pytest.raises(GeometryError, match="reaches the axis of revolution"):
        sm.analyze(seal, [-0.2])


@pytest.mark.parametrize("rounding", [1e-8, -5e-7])
def test_nodes_of_a_mesh_that_rounding_leaves_beside_the_axis(tmp_path, rounding):
    """The hoop stretch on the axis is the limit there, also where a mesh file has few digits."""
    meshio = pytest.importorskip("meshio")
    text = pulled(0.0, "top", (0.0, -0.1)) + '[[measure]]\ntype = "von_mises"\n'
    seal = sm.build_seal(read(tmp_path, text))
    stress = {}
    for radius in (0.0, rounding):
        nodes = seal.nominal_particles.copy()
        nodes[nodes[:, 0] == 0.0, 0] = radius
        cells = [list(dict.fromkeys(own)) for own in seal.body.cells.tolist()]
        blocks = [("triangle", [own for own in cells if len(own) == 3])]
        blocks += [("quad", [own for own in cells if len(own) == 4])]
        mesh = meshio.Mesh(np.pad(nodes, ((0, 0), (0, 1))), [own for own in blocks if own[1]])
        mesh.write(tmp_path / "nodes.vtu")
        other = text.replace("spacing = 0.5", 'cloud = "nodes.vtu"')
        stress[radius] = sm.analyze(sm.build_seal(read(tmp_path, other))).value("von_mises")[0]
    assert stress[rounding] == pytest.approx(stress[0.0], rel=1e-12)


def test_an_edge_that_rounding_leaves_beside_the_axis_lies_on_it(tmp_path):
    file = read(tmp_path, pulled(5e-7, "top", (0.0, -0.1)))
    assert file.supports["inside"] == (0,)
    result = sm.analyze(sm.build_seal(file))
    assert (result.particles[result.seal.body.edge("inside").particles, 0] == 0.0).all()
