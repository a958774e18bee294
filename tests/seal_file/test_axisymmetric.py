"""Seal files of rings: what they cannot have, where the axis is, and units."""

import json
from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest
from exact_gradients import require_exact
from ring_files import FOAM, cylinder, made_of, ring

import seal_mdao as sm
from seal_mdao.cli.subcommands import main
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.result_units import PLANE

DESIGN = '[[design]]\nedges = ["side"]\nparameters = 5\nbound = 0.3\n'


def read(folder, text):
    path = folder / "ring.toml"
    path.write_text(text)
    return sm.read_seal_file(path)


def test_edges_on_the_axis_stay_there(tmp_path):
    file = read(tmp_path, cylinder())
    assert file.supports == {"bore": (0,), "base": (1,)}
    seal = sm.build_seal(file)
    axis = seal.body.edge("bore").particles
    np.testing.assert_array_equal(seal.nominal_particles[axis, 0], 0.0)
    assert seal.body.fixed[axis, 0].all()
    # held along the axis too where the base is
    assert seal.body.fixed[axis, 1].sum() == 1


@pytest.mark.parametrize(("fluid", "points"), [(False, "averages"), (True, "particles")])
def test_contact_is_at_averages_unless_a_fluid_needs_particles(tmp_path, fluid, points):
    text = ring().replace('contact_points = "particles"\n', "")
    text += '[[fluid]]\nedge = ["side", "top"]\nfrom = "start"\npressure = 1.0\n' * fluid
    (profile,) = read(tmp_path, text).profiles
    assert profile.contact_points == points


@pytest.mark.parametrize(("edges", "dry"), [('"top", "bore"', True), ('"side", "top"', False)])
def test_a_fluid_that_begins_in_the_contact_is_reported(tmp_path, edges, dry):
    text = ring(start=2.0, translate=(0.0, -0.3))
    text += f'[[fluid]]\nedge = [{edges}]\nfrom = "start"\npressure = 1.0\n'
    warnings = sm.analyze(sm.build_seal(read(tmp_path, text))).warnings
    assert dry == any("the fluid 'fluid' has no effect" in own for own in warnings)


@pytest.mark.parametrize(("pressure", "leaks"), [(1.0, False), (100.0, True)])
def test_a_fluid_that_passes_the_contact_is_reported(tmp_path, pressure, leaks):
    text = ring(start=2.0, translate=(0.0, -0.02))
    text += f'[[fluid]]\nedge = ["side", "top"]\nfrom = "start"\npressure = {pressure}\n'
    result = sm.analyze(sm.build_seal(read(tmp_path, text)))
    assert result.converged
    weight = result.response("fluid").outputs[:, 0]
    assert (weight[-1] > 0.0) == leaks
    assert leaks == any("'fluid' passes the contact" in own for own in result.warnings)


def test_the_ring_beside_the_axis_is_free_there(tmp_path):
    assert read(tmp_path, ring()).supports == {"base": (0, 1)}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            '"axisymmetric"',
            '"spherical"',
            "must be one of plane_strain, generalised_plane_strain, axi",
        ),
        ("[3.0, 0.0]", "[-1.0, 0.0]", r"reaches x = -1, beyond the axis of revolution x = 0"),
        ('"top"]', '"bore"]', "lies on the axis of revolution"),
        (
            "steps = 4",
            "steps = 4\nrotate = 5.0",
            "rotates, which is not possible for a body of revolution",
        ),
        ("[fixed]", '[[symmetry]]\nedges = ["bore"]\nnormal = "x"\n[fixed]', "x is the radius"),
    ],
)
def test_what_a_ring_cannot_have_is_refused(tmp_path, old, new, words):
    text = cylinder() if "bore" in new else ring()
    changed = text.replace(old, new)
    if "-1.0" in new:
        changed = changed.replace("[3.0, 2.0]", "[-1.0, 2.0]")
    assert changed != text
    with pytest.raises(sm.SealFileError, match=words):
        read(tmp_path, changed)


def test_a_compressible_law_needs_a_volumetric_energy(tmp_path, monkeypatch):
    """That of the package has one; one from outside may be known in plane strain only."""
    text = made_of(FOAM, ring())
    (law,) = read(tmp_path, text).materials.values()
    assert law.bulk_modulus == 0.0
    monkeypatch.setattr(Hyperfoam, "volumetric", Isotropic.volumetric)
    with pytest.raises(sm.SealFileError, match="Hyperfoam supports plane strain only"):
        read(tmp_path, text)
    assert read(tmp_path, text.replace('"axisymmetric"', '"plane_strain"')).materials


def test_a_section_that_touches_the_axis_at_a_point_is_refused(tmp_path):
    text = ring().replace(
        "line = [[3.0, 2.0], [3.0, 0.0]]", "line = [[3.0, 2.0], [0.0, 1.0], [3.0, 0.0]]"
    )
    with pytest.raises(sm.SealFileError, match="touches the axis x = 0 in the single point y = 1"):
        read(tmp_path, text)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('[[measure]]\ntype = "reaction"\nlength = 100.0\n', "length needs kinematics"),
        ('[[design]]\nedges = ["bore"]\nparameters = 5\nbound = 0.1\n', "lies on the axis"),
    ],
)
def test_tables_that_need_a_long_seal_are_refused(tmp_path, table, words):
    with pytest.raises(sm.SealFileError, match=words):
        read(tmp_path, cylinder() + table)


def test_volume_is_of_a_ring(tmp_path):
    text = ring().replace('[model]\nkinematics = "axisymmetric"\n', "")
    with pytest.raises(sm.SealFileError, match="the measure volume needs a body of revolution"):
        sm.build_seal(read(tmp_path, text + '[[measure]]\ntype = "volume"\n'))


def test_plane_strain_is_what_a_file_without_a_model_has(tmp_path):
    text = ring()
    plain = text.replace('[model]\nkinematics = "axisymmetric"\n', "")
    named = text.replace('"axisymmetric"', '"plane_strain"')
    forces = []
    for own in (plain, named):
        seal = sm.build_seal(read(tmp_path, own))
        assert seal.units is PLANE
        assert not seal.body.axisymmetric
        forces.append(sm.analyze(seal).path.reaction("plate"))
    np.testing.assert_array_equal(*forces)


def test_forces_of_a_ring_are_in_newton(tmp_path, capsys):
    path = tmp_path / "ring.toml"
    path.write_text(
        ring() + '[[measure]]\ntype = "reaction"\n[[measure]]\ntype = "strain_energy"\n'
    )
    assert main(["analyze", str(path), "--out", str(tmp_path / "out")]) in (0, None)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    end = summary["profiles"]["plate"]["force_N"]
    assert summary["measures"]["reaction"]["unit"] == "N"
    assert summary["measures"]["strain_energy"]["unit"] == "mJ"
    assert summary["measures"]["reaction"]["value"] == pytest.approx(end[1], rel=1e-12)
    shown = capsys.readouterr().out
    assert f"{end[1]:.2f} N (x, y)" in shown
    # per mm of the circumference at the centroid of the section
    around = 2.0 * np.pi * summary["mean_radius_mm"]
    assert summary["mean_radius_mm"] == pytest.approx(4.0, rel=1e-12)
    assert (
        f"N per mm of circumference at the mean radius {summary['mean_radius_mm']:.4g} mm" in shown
    )
    assert f", {end[1] / around:.4g} N/mm, " in shown
    assert f" N ({end[1] / around:.6g} N/mm)" in shown
    # last row of the table: travel, force, force per mm, bar
    (row,) = (line for line in shown.splitlines() if line.split()[:1] == ["0.539"])
    assert row.split()[4] == f"{end[1] / around:.4f}"
    at = summary["profiles"]["plate"]
    assert at["force_N_per_mm"] == pytest.approx(np.array(end) / around, rel=1e-12)
    assert at["force_N_per_100mm"] == pytest.approx(100.0 * np.array(end) / around, rel=1e-12)
    assert summary["measures"]["reaction"]["N_per_mm"] == pytest.approx(end[1] / around, rel=1e-12)
    assert "N_per_mm" not in summary["measures"]["strain_energy"]
    assert (tmp_path / "out" / "ring_view.png").exists()
    header, *rows = (tmp_path / "out" / "curve_plate.csv").read_text().splitlines()
    row = dict(zip(header.split(","), map(float, rows[-1].split(",")), strict=True))
    assert row["Fy_N"] == pytest.approx(end[1], rel=1e-9)
    # per 100 mm of the mean circumference 2 pi 4 mm
    assert row["Fy_N_per_100mm"] == pytest.approx(end[1] * 100.0 / (8.0 * np.pi), rel=2e-2)


def test_components_have_the_units_of_a_ring(tmp_path):
    path = tmp_path / "ring.toml"
    path.write_text(ring() + '[[measure]]\ntype = "reaction"\n' + DESIGN)
    problem = om.Problem(sm.SealGroup(seal=sm.build_seal(path)))
    problem.setup()
    problem.final_setup()
    units = {
        own["prom_name"]: own["units"]
        for _, own in problem.model.list_outputs(out_stream=None, units=True, prom_name=True)
    }
    assert units["reaction"] == "N"


SIDE = '[[section.outer]]\nedge = "side"\nline = [[5.0, 0.0], [5.0, 2.0]]\n'
HALVES = """[[section.outer]]
edge = "lower"
line = [[5.0, 0.0], [5.0, 1.0]]
[[section.outer]]
edge = "upper"
line = [[5.0, 1.0], [5.0, 2.0]]
"""


@pytest.mark.parametrize("shared", [True, False])
def test_two_fluids_on_one_edge_are_reported(tmp_path, shared):
    """Not two on edges that meet in a point."""
    text = ring(start=2.0, translate=(0.0, -0.3))
    assert SIDE in text
    text = text.replace(SIDE, HALVES).replace('["top"]', '["lower", "upper", "top"]')
    below = '["lower", "upper"]' if shared else '["lower"]'
    for name, edges in (("a", '["upper", "top"]'), ("b", below)):
        text += f'[[fluid]]\nname = "{name}"\nedge = {edges}\nfrom = "start"\npressure = 1.0\n'
    result = sm.analyze(sm.build_seal(read(tmp_path, text)))
    assert all(result.response(name).outputs[0, 0] == 1.0 for name in "ab")
    assert shared == any("'a' and 'b' both act on the boundary" in own for own in result.warnings)


STACKED_RINGS = """\
[model]
kinematics = "axisymmetric"
[material.rubber]
law = "neo_hookean"
c10 = 300.0
bulk_modulus = 2e3
[section]
spacing = {spacing}
outer = [
  {{ edge = "base", line = [[{inner}, 0.0], [{outer}, 0.0]] }},
  {{ edge = "right", line = [[{outer}, 0.0], [{outer}, {low}]] }},
  {{ edge = "joint", line = [[{outer}, {low}], [{inner}, {low}]] }},
  {{ edge = "left", line = [[{inner}, {low}], [{inner}, 0.0]] }},
  {{ body = 2, edge = "under", line = [[{inner}, {high}], [{outer}, {high}]] }},
  {{ body = 2, edge = "upper", line = [[{outer}, {high}], [{outer}, {top}]] }},
  {{ body = 2, edge = "top", line = [[{outer}, {top}], [{inner}, {top}]] }},
  {{ body = 2, edge = "upper_left", line = [[{inner}, {top}], [{inner}, {high}]] }},
]
[self_contact]
edges = ["joint", "under"]
friction = 0.3
normal_penalty = {normal}
tangent_penalty = {tangent}
[fixed]
edges = ["base"]
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{{ translate = [0.0, {travel}], steps = 2 }}]
[[design]]
edges = ["right"]
parameters = 3
bound = 0.3
[[measure]]
name = "reaction_of_top"
type = "reaction"
[[measure]]
type = "strain_energy"
"""


LENGTHS = {
    "spacing": 1.0, "inner": 10.0, "outer": 16.0, "low": 2.0, "high": 2.05, "top": 4.05,
    "travel": -0.5,
}  # fmt: skip


def stacked_rings(folder, size, **changed):
    """The analysis of two rings that press on each other, with all lengths multiplied by ``size``."""
    scaled = {name: size * length for name, length in {**LENGTHS, **changed}.items()}
    path = folder / f"rings_{size:g}.toml"
    path.write_text(STACKED_RINGS.format(**scaled, normal=1e4 / size, tangent=1e3 / size))
    return sm.analyze(sm.build_seal(path))


def test_the_penalty_of_two_rings_in_contact_is_a_pressure_per_penetration(tmp_path):
    """Lengths twice as large, penalties (kPa/mm) half as large: the pressures are the same, the forces
    four times, the energies eight times as large."""
    one, two = (stacked_rings(tmp_path, size) for size in (1.0, 2.0))
    np.testing.assert_allclose(two.displacement(), 2.0 * one.displacement(), rtol=0.0, atol=1e-11)
    assert two.reaction_of_top == pytest.approx(4.0 * one.reaction_of_top, rel=1e-11)
    assert two.strain_energy == pytest.approx(8.0 * one.strain_energy, rel=1e-11)


@pytest.mark.parametrize("inner", [10.0, 0.0])
def test_the_contact_of_two_rings_has_exact_derivatives(tmp_path, inner):
    """And that of two discs, whose axis is part of the loops."""
    result = stacked_rings(tmp_path, 1.0, inner=inner)
    require_exact(result, ["reaction_of_top", "strain_energy"], 1e-3)


BETWEEN_PLATES = """[[profile]]
name = "plate"
friction = 0.0
contact = ["top"]
line = [[-20.0, 0.0], [20.0, 0.0]]
start = [0.0, {top}]
stage = [{{ translate = [0.0, -0.4], steps = 2 }}]
normal_penalty = 1e6
[[profile]]
name = "floor"
friction = 0.0
contact = ["base"]
line = [[20.0, 0.0], [-20.0, 0.0]]
normal_penalty = 1e6
"""


@pytest.mark.parametrize("inner", [10.0, 0.0])
def test_two_rings_and_two_discs_press_on_each_other_with_one_pressure(tmp_path, inner):
    """From the axis, or the inner edge, to the outer edge (contact patch test)."""
    text = STACKED_RINGS.replace("friction = 0.3", "friction = 0.0")
    before, _, after = text.partition("[fixed]")
    text = before + BETWEEN_PLATES + after[after.index("[[design]]") :]
    text = text.replace('type = "reaction"', 'type = "reaction"\nprofile = "plate"')
    path = tmp_path / "discs.toml"
    path.write_text(text.format(**{**LENGTHS, "inner": inner}, normal=1e6, tangent=1e5))
    result = sm.analyze(sm.build_seal(path))
    assert result.converged, result.failure
    _, gap = result.term("self_contact").gaps(result.response("self_contact").x)
    assert gap.max() < 0.0
    assert np.ptp(gap) < 1e-9 * np.abs(gap).max()


def test_the_mean_radius_does_not_depend_on_the_particles(tmp_path):
    """That of an O-ring whose particles are concentrated on its outside is that of its circle."""
    example = Path(__file__).parents[2] / "examples" / "o_ring_in_gland.toml"
    seal = unchosen_seal(sm.read_seal_file(example))
    # chords of the circle leave out a part of order h^2
    assert seal.units.radius == pytest.approx(14.26, rel=1e-4)
    assert abs(seal.nominal_particles[:, 0].mean() - 14.26) > 0.2


def test_the_mean_radius_of_a_written_design_is_its_own(tmp_path):
    """By Pappus: volume over 2 pi times area of the section; not that of the seal it was made from."""
    text = ring() + '[[measure]]\ntype = "volume"\n[[measure]]\ntype = "section_area"\n' + DESIGN
    file = read(tmp_path, text)
    seal = sm.build_seal(file)
    path = write_design(file, seal, np.full(5, 0.3), seal.measures(), tmp_path, "design")[0]
    written = sm.build_seal(path)
    result = sm.analyze(written)
    expected = result.value("volume")[0] / (2.0 * np.pi * result.value("section_area")[0])
    assert written.units.radius == pytest.approx(expected, rel=1e-10)
    assert written.units.radius > seal.units.radius + 0.05
