"""Input files of Abaqus, read back: mesh by meshio, the rest by their lines."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from ring_files import cylinder, ring
from seal_file.block_files import FIXED, GLUED, LID, MOVED, file_of
from seal_file.block_files import text as block_text

import seal_mdao as sm
from seal_mdao.export.abaqus import not_exported, require_exportable, write_abaqus
from seal_mdao.export.abaqus_materials import element_type, material_lines
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hardness import ShoreRubber
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.sponge import graded_sponge
from seal_mdao.materials.yeoh import Yeoh
from seal_mdao.seals.file.build import unchosen_seal

meshio = pytest.importorskip("meshio")
pytest.importorskip("netgen")
EXAMPLES = Path(__file__).parents[2] / "examples"
LAWS = {
    "neo": NeoHookean(90.0, 5e4),
    "mooney": MooneyRivlin(80.0, 20.0, 8e4),
    "yeoh": Yeoh(110.0, -4.0, 0.6, 8e4),
    "ogden": Ogden((150.0, -3.0), (1.7, -2.2), 6e4),
    "foam": Hyperfoam((40.0, 10.0), (2.5, -1.2), (0.2, 0.1)),
    "shore": ShoreRubber(70.0),
    "sponge": graded_sponge("2A4"),
}


class Exported:
    """An example, its seal, and the file that was written."""

    def __init__(self, name, folder):
        given = isinstance(name, sm.SealFile)
        self.file = name if given else sm.read_seal_file(EXAMPLES / f"{name}.toml")
        self.seal = unchosen_seal(self.file)
        self.path = folder / f"{self.file.path.stem}.inp"
        self.left_out = write_abaqus(self.file, self.seal, self.path)
        self.text = self.path.read_text(encoding="utf-8")

    def mesh(self):
        # meshio knows the geometry of these elements under their first name only
        plain = self.path.with_suffix(".plain.inp")
        plain.write_text(self.text.replace("CPE6MH", "CPE6").replace("CPE6M", "CPE6"))
        return meshio.read(plain)

    def data(self, keyword):
        """Data lines after a keyword."""
        after = self.text.partition(keyword)[2].partition("\n")[2]
        lines = after.partition("\n*")[0].splitlines()
        return [[own.strip() for own in line.split(",")] for line in lines]

    def profile(self, name):
        """Corners (k, 2) of a rigid surface, and the centre of the arc before each, or None."""
        rows = self.data(f"TYPE=SEGMENTS, NAME=RIGID_{name}")
        assert rows[0][0] == "START"
        assert {row[0] for row in rows[1:]} <= {"LINE", "CIRCL"}
        corners = np.array([row[1:3] for row in rows], float)
        centres = [np.array(row[3:], float) if row[0] == "CIRCL" else None for row in rows]
        return corners, centres


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder, made = tmp_path_factory.mktemp("abaqus"), {}

    def of(name):
        if name not in made:
            made[name] = Exported(name, folder)
        return made[name]

    return of


@pytest.mark.parametrize("name", ["d_bulb", "two_holes", "weatherstrip", "paper_seal"])
def test_the_triangles_fill_the_section(exported, name):
    own = exported(name)
    mesh, outline = own.mesh(), own.file.section.outline
    cells = np.concatenate([block.data for block in mesh.cells if block.type == "triangle6"])
    x = mesh.points[cells]
    a, b = x[:, 1, :2] - x[:, 0, :2], x[:, 2, :2] - x[:, 0, :2]
    areas = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert areas.min() > 0.0
    # the polygon through the particles; the section itself but for the chords of its curves
    assert areas.sum() == pytest.approx(own.seal.area(own.seal.check_offsets(None))[0], rel=1e-9)
    assert areas.sum() == pytest.approx(sum(c.area for c in outline.contours), rel=6e-3)
    # the further nodes are in the middle of sides 1-2, 2-3, 3-1
    middles = 0.5 * (x[:, :3] + x[:, [1, 2, 0]])
    np.testing.assert_allclose(x[:, 3:], middles, atol=1e-9)


def test_sets_of_edges_lie_on_their_edges(exported):
    own = exported("two_holes")
    mesh = own.mesh()
    edges = own.seal.body.edges
    assert {f"EDGE_{name.upper()}" for name in edges} <= set(mesh.point_sets)
    for name, edge in edges.items():
        nodes = mesh.points[mesh.point_sets[f"EDGE_{name.upper()}"], :2]
        assert len(nodes) == len(edge.sides) + len(np.unique(edge.sides))
        line = shapely.linestrings(own.seal.nominal_particles[edge.sides])
        away = shapely.distance(shapely.union_all(line), shapely.points(nodes))
        assert away.max() < 1e-9
    # chords of a circle, and the base
    bulb = mesh.points[mesh.point_sets["EDGE_BULB"], :2]
    radius = np.hypot(*(bulb - [0.0, 8.3]).T)
    assert radius.max() == pytest.approx(4.2, abs=1e-9)
    assert radius.min() > 4.2 - 0.05
    assert np.ptp(mesh.points[mesh.point_sets["EDGE_BASE"], 1]) == 0.0


def test_materials_have_their_regions(exported):
    own = exported("d_bulb")
    assert own.data("ELSET=REGION_2, MATERIAL=MATERIAL_FOOT") == [["1.", ""]]
    first = own.text.partition("NAME=MATERIAL_FOOT\n")[2].splitlines()[:2]
    assert first == ["*HYPERELASTIC, MOONEY-RIVLIN", "400, 100, 5e-06"]
    # the foot is below the cut at y = 4
    nodes = {int(row[0]): float(row[2]) for row in own.data("*NODE")}
    for number, inside in ((1, lambda y: y > 4.0), (2, lambda y: y < 4.0)):
        rows = own.data(f"ELSET=REGION_{number}")
        middle = [np.mean([nodes[int(n)] for n in row[1:4]]) for row in rows]
        assert all(map(inside, middle))


def test_a_rigid_surface_is_the_curve_of_its_profile(exported):
    """Lines and an arc of radius 3 about (3, 3) in the frame of the panel."""
    own = exported("lip")
    corners, centres = own.profile("PANEL")
    x, y = start = np.array([-3.6, 10.0])
    arcs = [i for i, centre in enumerate(centres) if centre is not None]
    for i in arcs:
        np.testing.assert_allclose(centres[i], start + 3.0, atol=1e-9)
        for end in corners[i - 1 : i + 1]:
            assert np.hypot(*(end - centres[i])) == pytest.approx(3.0, abs=1e-9)
    # horizontal at the beginning, 100 mm longer than drawn; vertical at the end
    np.testing.assert_allclose(corners[0], (x + 140.0, y), atol=1e-9)
    np.testing.assert_allclose(corners[1], (x + 3.0, y), atol=1e-9)
    np.testing.assert_allclose(corners[-1], (x, y + 140.0), atol=1e-9)
    # the rubber is on the left of the segments
    along = corners[1] - corners[0]
    away = own.seal.nominal_particles - corners[0]
    assert (along[0] * away[:, 1] - along[1] * away[:, 0]).max() > 0.0


@pytest.mark.parametrize("name", ["d_bulb", "weatherstrip"])
def test_the_rubber_is_on_the_left_of_a_plane(exported, name):
    own = exported(name)
    (corners, _) = own.profile(own.file.profiles[0].name.upper())
    along = corners[1] - corners[0]
    away = own.seal.nominal_particles - corners[0]
    distance = (along[0] * away[:, 1] - along[1] * away[:, 0]) / np.hypot(*along)
    assert distance.min() > -1e-6


def test_steps_have_total_displacements_of_the_reference_node(exported):
    own = exported("two_holes")
    steps = own.text.split("*STEP")[1:]
    assert len(steps) == 2
    for step, (x, y) in zip(steps, ((0.0, -4.0), (1.0, -4.0)), strict=True):
        rows = step.partition("*BOUNDARY\n")[2].partition("\n*")[0].splitlines()
        assert rows[0].split(", ")[:3] == ["REFERENCE_DOOR", "1", "1"]
        found = [float(row.split(", ")[3]) for row in rows]
        np.testing.assert_allclose(found, [x, y, 0.0], atol=1e-12)
    mesh = own.mesh()
    (node,) = mesh.point_sets["REFERENCE_DOOR"]
    np.testing.assert_allclose(mesh.points[node, :2], [0.0, 14.0], atol=1e-12)
    assert own.data("*FRICTION") == [["0.3", ""]]
    assert own.data("*BOUNDARY") == [["EDGE_BASE", "1", "1"], ["EDGE_BASE", "2", "2"]]


def test_contact_surfaces_are_the_sides_of_their_edges(exported):
    own = exported("d_bulb")
    sets = {row[0]: int(row[1][1]) for row in own.data("TYPE=ELEMENT, NAME=RUBBER_DOOR")}
    elements = {
        int(row[0]): [int(n) - 1 for n in row[1:]]
        for number in (1, 2)
        for row in own.data(f"ELSET=REGION_{number}")
    }
    found = set()
    for name, side in sets.items():
        for e in (int(n) for row in own.data(f"*ELSET, ELSET={name}") for n in row if n):
            found.add((elements[e][side - 1], elements[e][side % 3]))
    assert found == set(map(tuple, own.seal.body.edge("seal").sides.tolist()))


def changed(folder, name, *changes, more=""):
    """An example with other lines, exported."""
    text = (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / f"{name}.toml").write_text(text + more, encoding="utf-8")
    return Exported(sm.read_seal_file(folder / f"{name}.toml"), folder)


def sides_of(own, surface):
    """Corners of the sides of a surface, from 0."""
    elements = {
        int(row[0]): [int(n) - 1 for n in row[1:4]]
        for number, _ in enumerate(own.seal.definitions[0].regions, 1)
        for row in own.data(f"ELSET=REGION_{number}")
    }
    sets = {row[0]: int(row[1][1]) for row in own.data(f"TYPE=ELEMENT, NAME={surface}")}
    return {
        (elements[e][side - 1], elements[e][side % 3])
        for name, side in sets.items()
        for row in own.data(f"*ELSET, ELSET={name}")
        for e in (int(n) for n in row if n)
    }


def frictions(own):
    """Coefficient of every contact, 0 without, and surfaces of its pair, by its name."""
    found = {}
    for block in own.text.split("*SURFACE INTERACTION, NAME=")[1:]:
        lines = block.splitlines()
        value = float(lines[3].strip(",")) if lines[2] == "*FRICTION" else 0.0
        pair = next(i for i, line in enumerate(lines) if line.startswith("*CONTACT PAIR"))
        assert f"INTERACTION={lines[0]}" in lines[pair]
        found[lines[0]] = value, lines[pair + 1]
    return found


def test_edges_with_a_friction_of_their_own_are_pairs_of_their_own(tmp_path):
    own = changed(
        tmp_path, "d_bulb", ('contact = ["seal"]', 'contact = ["right_side", "seal"]'),
        ("friction = 0.25", "friction = { right_side = 0.1, seal = 0.4 }"),
    )  # fmt: skip
    assert frictions(own) == {
        "CONTACT_DOOR_RIGHT_SIDE": (0.1, "RUBBER_DOOR_RIGHT_SIDE, RIGID_DOOR"),
        "CONTACT_DOOR_SEAL": (0.4, "RUBBER_DOOR_SEAL, RIGID_DOOR"),
    }
    for edge in ("right_side", "seal"):
        sides = own.seal.body.edge(edge).sides.tolist()
        assert sides_of(own, f"RUBBER_DOOR_{edge.upper()}") == set(map(tuple, sides))


@pytest.mark.parametrize("others", [True, False])
def test_pairs_of_self_contact_have_their_friction(tmp_path, others):
    """All other pairs may touch only where [self_contact] has a friction."""
    pair = '[[self_contact.pair]]\nedges = ["body", "front"]\nfriction = 0.7\n'
    old = 'edges = ["body", "front", "tip"]\nfriction = 0.4\n'
    new = old if others else 'edges = ["body", "front", "tip"]\n'
    found = frictions(changed(tmp_path, "folded_lip", (old, new + pair)))
    del found["CONTACT_ROD"]
    own = "RUBBER_SELF_CONTACT_"
    expected = {"CONTACT_SELF_CONTACT_BODY_FRONT": (0.7, f"{own}BODY, {own}FRONT")}
    if others:
        for one, other in (
            ("BODY", "BODY"), ("BODY", "TIP"), ("FRONT", "FRONT"), ("FRONT", "TIP"), ("TIP", "TIP"),
        ):  # fmt: skip
            second = f" {own}{other}" if one != other else ""
            expected[f"CONTACT_SELF_CONTACT_{one}_{other}"] = 0.4, f"{own}{one},{second}"
    assert found == expected


def test_bonded_edges_move_with_the_rigid_body(tmp_path):
    own = Exported(file_of(tmp_path, FIXED, GLUED), tmp_path)
    assert "TIE NSET=GLUED_PLATE" in own.text.partition("*RIGID BODY")[2].partition("\n")[0]
    mesh = own.mesh()
    bonded, top = (mesh.point_sets[name] for name in ("GLUED_PLATE", "EDGE_TOP"))
    assert sorted(bonded) == sorted(top)
    # fixed edges alone are held
    assert own.data("*BOUNDARY") == [["EDGE_BASE", "1", "1"], ["EDGE_BASE", "2", "2"]]
    assert not own.left_out


def test_moved_edges_are_displaced_in_the_steps(tmp_path):
    text = 'directions = ["y"]\nstage = [{ translate = [0, -0.4], steps = 4 }]\n'
    own = Exported(file_of(tmp_path, FIXED, f'[[moved]]\nedges = ["top"]\n{text}'), tmp_path)
    assert own.data("*BOUNDARY") == [["EDGE_BASE", "1", "1"], ["EDGE_BASE", "2", "2"]]
    (step,) = own.text.split("*STEP")[1:]
    rows = step.partition("*BOUNDARY\n")[2].partition("\n*")[0].splitlines()
    assert rows == ["EDGE_TOP, 2, 2, -0.4"]
    assert not own.left_out
    turned = Exported(file_of(tmp_path, FIXED, MOVED), tmp_path)
    assert turned.left_out == ["rotation of the moved edges 'top'; their nodes are only translated"]


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_constants_convert_back(law):
    """Small strains: shear and bulk modulus by the formulas of Abaqus."""
    keyword, *rows = material_lines(law)
    c = [float(value) for row in rows for value in row.split(",")]
    if keyword.startswith("*HYPERFOAM"):
        n = int(keyword[-1])
        mu, nu = c[0 : 2 * n : 2], c[2 * n :]
        shear = sum(mu)
        bulk = sum(2.0 * m * (1.0 / 3.0 + v / (1.0 - 2.0 * v)) for m, v in zip(mu, nu, strict=True))
    elif "OGDEN" in keyword:
        n = int(keyword[-1])
        shear, bulk = sum(c[0 : 2 * n : 2]), 2.0 / c[2 * n]
        assert c[2 * n + 1 :] == [0.0] * (n - 1)
    else:
        size = {"NEO HOOKE": 1, "MOONEY-RIVLIN": 2, "YEOH": 3}[keyword.partition(", ")[2]]
        # only C10 and C01 act in small strains
        shear, bulk = 2.0 * sum(c[: min(size, 1 + ("MOONEY" in keyword))]), 2.0 / c[size]
    assert shear == pytest.approx(law.shear_modulus, rel=1e-10)
    assert bulk == pytest.approx(law.initial_bulk_modulus or law.bulk_modulus, rel=1e-10)
    assert element_type(law) == ("CPE6M" if keyword.startswith("*HYPERFOAM") else "CPE6MH")


@pytest.mark.parametrize("name", ["ogden", "foam"])
def test_energy_of_powers_of_stretches(name):
    """Plane strain with stretches 1.3 and 1/1.3, of which Abaqus' manual has the energy."""
    law = LAWS[name]
    keyword, *rows = material_lines(law)
    n = int(keyword[-1])
    c = [float(value) for row in rows for value in row.split(",")]
    pairs = zip(c[0 : 2 * n : 2], c[1 : 2 * n : 2], strict=True)
    stretches = np.array([1.3, 1.0 / 1.3, 1.0])
    # U = sum 2 mu/alpha^2 (l_1^alpha + l_2^alpha + l_3^alpha - 3) at J = 1
    energy = sum(2.0 * m / a**2 * ((stretches**a).sum() - 3.0) for m, a in pairs)
    t = np.array([(stretches[:2] ** 2).sum()])
    assert law.energy(t, np.ones(1))[0] == pytest.approx(energy, rel=1e-9)


def test_what_is_not_exported_is_reported(exported, tmp_path):
    own = exported("sealed_bulb")
    assert own.left_out == ["[[cavity]] of hole 1: trapped air"]
    assert "** NOT EXPORTED: [[cavity]] of hole 1: trapped air" in own.text
    slammed = exported("slammed_strip").left_out
    assert "[material.sponge.viscoelastic]: relaxation" in slammed
    # the conditions that the file has, and no others
    assert not [text for text in slammed if "temperature" in text or "axial_stretch" in text]
    stretched = [text.partition(";")[0] for text in exported("stretched_strip").left_out]
    assert stretched == ["[model]: temperature", "[model]: axial_stretch"]
    fluid = exported("o_ring_under_pressure")
    assert not_exported(fluid.file, fluid.seal) == ["[[fluid]] 'fluid': fluid pressure"]


def test_a_law_that_abaqus_does_not_have(tmp_path):
    text = (EXAMPLES / "d_bulb.toml").read_text(encoding="utf-8")
    old = 'law = "mooney_rivlin"\nc10 = 80.0\nc01 = 20.0\n'
    path = tmp_path / "gent.toml"
    path.write_text(text.replace(old, 'law = "gent"\nshear_modulus = 200.0\nlimit = 40.0\n'))
    file = sm.read_seal_file(path)
    assert isinstance(file.materials["bulb"], Gent)
    with pytest.raises(
        sm.SealFileError, match=r"\[material.bulb\]: the material law Gent has no counterpart"
    ):
        write_abaqus(file, unchosen_seal(file), tmp_path / "gent.inp")
    assert not (tmp_path / "gent.inp").exists()


def test_a_ring_has_axisymmetric_elements(tmp_path):
    """Its axis is held, and what no rigid body of revolution does is left out."""
    texts = {}
    for name, text in (("ring", ring()), ("cylinder", cylinder())):
        path = tmp_path / f"{name}.toml"
        path.write_text(text)
        file = sm.read_seal_file(path)
        out = tmp_path / f"{name}.inp"
        left_out = write_abaqus(file, unchosen_seal(file), out)
        texts[name] = out.read_text(), left_out
    text, left_out = texts["cylinder"]
    assert "ring, forces in mN" in text.splitlines()[1]
    assert "*ELEMENT, TYPE=CAX6MH, ELSET=REGION_1" in text
    assert "EDGE_BORE, 1, 1" in text
    assert left_out == []
    text, left_out = texts["ring"]
    assert any("radial motion" in own for own in left_out)
    # its plate moves by (0.2, -0.5)
    assert "REFERENCE_PLATE, 1, 1, 0\nREFERENCE_PLATE, 2, 2, -0.5\n" in text


def travels(text: str, reference: str) -> dict:
    """Total vertical displacement of a reference node at the end of every step, by the step's name."""
    found = {}
    for step in text.split("*STEP, NAME=")[1:]:
        (row,) = (line for line in step.splitlines() if line.startswith(f"{reference}, 2, 2, "))
        found[step.partition(",")[0]] = float(row.rpartition(",")[2])
    return found


def test_preliminary_increments_are_a_step_of_their_own(tmp_path):
    """So the first stage has the increments and the path of its load steps."""
    lid = LID.replace("[0, 4.02]", "[0, 3.85]\ninterference = 0.2")
    own = Exported(file_of(tmp_path, FIXED, lid), tmp_path)
    motion = own.seal.terms()[1].motion
    begin, count = motion.retraction[-1][1], len(motion.retraction)
    assert travels(own.text, "REFERENCE_LID") == pytest.approx(
        {"PRELIMINARY": -begin, "STAGE_1": -begin - 0.5}
    )
    _, preliminary, stage = own.text.split("*STATIC\n")
    assert float(preliminary.partition(",")[0]) == pytest.approx(1.0 / count)
    assert float(stage.partition(",")[0]) == pytest.approx(1.0 / 3.0)
    assert own.left_out == []


def test_glued_edges_are_not_moved_by_preliminary_increments(tmp_path):
    glued = GLUED.replace("line =", "interference = 0.3\nline =").replace(", rotate = 4.0", "")
    # the free edge beside the glued one rises above it
    rising = "arc = { start = [8, 0], through = [6, 4.1], end = [4, 4] }"
    given = block_text(FIXED, glued).replace("line = [[4, 0], [4, 4]]", rising)
    under = (
        '{ edge = "base", line = [[-4, 0], [4, 0]] }, { edge = "under", line = [[4, 0], [8, 0]] }'
    )
    path = tmp_path / "seal.toml"
    path.write_text(given.replace('{ edge = "base", line = [[-4, 0], [4, 0]] }', under))
    own = Exported(sm.read_seal_file(path), tmp_path)
    assert len(own.seal.terms()[1].motion.retraction) > 0
    assert travels(own.text, "REFERENCE_PLATE") == {"STAGE_1": -1.5}
    (left_out,) = own.left_out
    assert left_out.startswith("preliminary increments of the profile 'plate'")


def test_a_profile_that_backs_off_radially_is_reported(tmp_path):
    """It stands still in all load steps."""
    path = tmp_path / "ring.toml"
    given = ring().replace('contact = ["top"]', 'contact = ["bore"]\ninterference = 0.2')
    given = given.replace("line = [[-40.0, 0.0], [40.0, 0.0]]", "line = [[0.0, -9.0], [0.0, 9.0]]")
    given = given.replace("start = [0.0, 2.05]", "start = [3.1, 0.0]")
    path.write_text(given.replace("translate = [0.2, -0.5]\n", ""))
    own = Exported(sm.read_seal_file(path), tmp_path)
    (left_out,) = own.left_out
    assert left_out.startswith("radial motion of the profile 'plate'")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"left"', '"Base"', "the edges 'base' and 'Base' have the same name BASE in Abaqus"),
        ('"left"', '"base_"', None),
        ('"left"', '"left.side"', None),
    ],
)
def test_names_that_abaqus_does_not_distinguish(tmp_path, old, new, message):
    """Node sets of one name would be joined: supports of one edge would act on the other, too."""
    path = tmp_path / "seal.toml"
    path.write_text(block_text(FIXED, LID).replace(old, new))
    file = sm.read_seal_file(path)
    if message is None:
        require_exportable(file)
        return
    with pytest.raises(sm.SealFileError, match=message):
        write_abaqus(file, unchosen_seal(file), tmp_path / "seal.inp")
    assert not (tmp_path / "seal.inp").exists()
