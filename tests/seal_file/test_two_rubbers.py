"""A section of two rubbers between planes of symmetry against the exact solution."""

import meshio
import numpy as np
import pytest
from scipy.optimize import brentq
from two_rubbers import pressed_block
from verification.layered_cylinder import principal_stress

import seal_mdao as sm
from seal_mdao.seals.outline.cloud_file import write_cloud

SOFT, STIFF = sm.MooneyRivlin(80.0, 20.0, 2e3), sm.MooneyRivlin(320.0, 80.0, 6e3)
MATERIALS = """
[material.soft]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 2e3
[material.stiff]
law = "mooney_rivlin"
c10 = 320.0
c01 = 80.0
bulk_modulus = 6e3
"""
MEASURE = """\
[[measure]]
type = "reaction"
"""


def block(spacing):
    return MATERIALS + pressed_block(spacing) + MEASURE


def pressed(folder, spacing):
    path = folder / "block.toml"
    path.write_text(block(spacing))
    result = sm.analyze(sm.build_seal(sm.read_seal_file(path)))
    assert result.converged, result.failure
    return result


def exact_force(joint=np.inf):
    """Both layers keep their width, so each is strained uniformly: equal stress, strains that add up;
    the plate's penetration is stress over penalty, and so is that of the layers in each other where
    the ``joint`` has one."""

    def stress(law, stretch):
        return principal_stress(law, stretch, 1.0)

    def lower(upper):
        return brentq(lambda x: stress(STIFF, x) - stress(SOFT, upper), 0.5, 1.0, xtol=1e-15)

    def travel(upper):
        inside = stress(SOFT, upper) * (1.0 / 1e6 + 1.0 / joint)
        return 4.0 - 2.0 * (upper + lower(upper)) - inside - 0.4

    return -6.0 * stress(SOFT, brentq(travel, 0.7, 1.0, xtol=1e-15))


def test_two_layers_between_planes_of_symmetry(tmp_path):
    """Supports end at the interface, where the displacement has a kink: the force is exact with any
    spacing."""
    for spacing in (0.8, 0.4, 0.2):
        result = pressed(tmp_path, spacing)
        (force,) = result.value(result.measures()[0])
        assert force == pytest.approx(exact_force(), rel=1e-6)


def test_cells_lie_on_one_side_of_the_line(tmp_path):
    result = pressed(tmp_path, 0.8)
    soft, stiff = result.seal.definitions[0].regions
    height = result.particles[result.seal.body.cells, 1]
    assert height[soft.cells].min() == 2.0
    assert height[stiff.cells].max() == 2.0
    assert (soft.prefix, stiff.prefix) == ("soft_", "stiff_")
    names = {
        "soft_c10",
        "soft_c01",
        "soft_bulk_modulus",
        "stiff_c10",
        "stiff_c01",
        "stiff_bulk_modulus",
    }
    assert names <= set(result.seal.scalars)


def test_a_point_outside_of_the_section_marks_no_part(tmp_path):
    path = tmp_path / "block.toml"
    path.write_text(block(0.8).replace("at = [1.0, 0.5]", "at = [1.0, -0.5]"))
    with pytest.raises(sm.SealFileError, match=r"\) of a region is outside of the section; give a"):
        sm.build_seal(sm.read_seal_file(path))


def test_a_line_that_ends_at_a_hole_divides_nothing(tmp_path):
    path = tmp_path / "block.toml"
    line = "line = [[0.0, 2.0], [6.0, 2.0]]"
    hole = (
        '[[section.hole]]\nedge = "hole"\ncircle = { centre = [3.0, 2.0], radius = 0.8 }\n[fixed]'
    )
    text = block(0.8).replace(line, "line = [[0.0, 2.0], [2.2, 2.0]]").replace("[fixed]", hole)
    path.write_text(text)
    with pytest.raises(
        sm.SealFileError, match="do not divide the section, so that all of it is in"
    ):
        sm.build_seal(path)


def without_parts(seal, text, folder):
    """The seal file ``text`` with the particles of the seal from a mesh that does not tell its parts."""
    mesh = meshio.read(write_cloud(seal, np.zeros(seal.n_offsets), folder / "mesh.vtu"))
    meshio.Mesh(mesh.points, mesh.cells).write(folder / "mesh.vtu")
    path = folder / "given.toml"
    path.write_text(text.replace("spacing = 0.8", 'cloud = "mesh.vtu"'))
    return sm.read_seal_file(path)


def test_a_mesh_that_does_not_tell_the_parts_of_a_body_is_refused(tmp_path):
    path = tmp_path / "block.toml"
    path.write_text(block(0.8))
    seal = sm.build_seal(sm.read_seal_file(path))
    with pytest.raises(sm.SealFileError, match="give the mesh cell data 'part'"):
        sm.build_seal(without_parts(seal, path.read_text(), tmp_path))


def test_planes_stay_planes_in_a_design(tmp_path):
    path = tmp_path / "block.toml"
    design = '[[design]]\nedges = ["top"]\nparameters = 5\nbound = 0.3\n'
    path.write_text(block(0.8) + design)
    seal = sm.build_seal(sm.read_seal_file(path))
    for name in ("left", "right"):
        particles = seal.body.edge(name).particles
        velocity = seal.design_velocity[:, particles]
        assert np.abs(velocity[..., 0]).max() == 0.0
        height = seal.nominal_particles[particles, 1]
        share = (height - height[0]) / (height[-1] - height[0])
        linear = velocity[:, :1] + share[:, None] * (velocity[:, -1:] - velocity[:, :1])
        assert np.abs(velocity - linear).max() < 1e-14
