"""A seal with all lengths multiplied by a power of two: the same bits times that power."""

import numpy as np
import pytest

import seal_mdao as sm

FILE = """
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 80000.0
[section]
spacing = {spacing}
outer = [
  {{ edge = "base", line = [{left}, {right}] }},
  {{ edge = "seal", arc = {{ start = {right}, through = {top}, end = {left} }} }},
]
hole = [{{ edge = "cavity", circle = {{ centre = {centre}, radius = {radius} }} }}]
[fixed]
edges = ["base"]
[[profile]]
name = "door"
friction = 0.25
normal_penalty = {normal}
tangent_penalty = {tangent}
line = [{far_left}, {far_right}]
start = {top}
stage = [{{ translate = {travel}, steps = 6 }}]
[self_contact]
edges = ["cavity"]
friction = 0.25
normal_penalty = {normal}
tangent_penalty = {tangent}
"""
LENGTHS = {
    "spacing": 0.9, "left": [-4.0, 0.0], "right": [4.0, 0.0], "top": [0.0, 14.0],
    "centre": [0.0, 7.0], "radius": 4.5, "far_left": [-40.0, 0.0], "far_right": [40.0, 0.0],
    "travel": [0.0, -2.0],
}  # fmt: skip


def analyzed(folder, scale: float):
    """Analyse the seal with lengths times ``scale`` and penalties (kPa/mm) divided by it."""
    lengths = {name: (scale * np.array(own)).tolist() for name, own in LENGTHS.items()}
    path = folder / f"seal_{scale:g}.toml"
    path.write_text(FILE.format(**lengths, normal=3e4 / scale, tangent=1e3 / scale))
    return sm.analyze(sm.build_seal(path))


@pytest.fixture(scope="module", params=[2.0**-3, 64.0])
def pair(request, tmp_path_factory):
    """The scale and the results without and with it."""
    folder = tmp_path_factory.mktemp("units_of_length")
    return request.param, analyzed(folder, 1.0), analyzed(folder, request.param)


def test_particles_are_multiplied(pair):
    """Netgen has absolute tolerances: at 64 times the size its triangles are others."""
    scale, one, other = pair
    np.testing.assert_array_equal(other.particles, scale * one.particles)


def test_rounding_error_of_the_residual_is_a_force_per_length(pair):
    """That of contact is a penalty times a length of the boundary times a penetration."""
    scale, one, other = pair
    assert other.path.problem.rounding == pytest.approx(
        scale * one.path.problem.rounding, rel=1e-14
    )


def test_path_is_multiplied(pair):
    scale, one, other = pair
    np.testing.assert_array_equal(other.newton_iterations, one.newton_iterations)
    np.testing.assert_array_equal(other.displacement(), scale * one.displacement())
    np.testing.assert_array_equal(other.reaction, scale * one.reaction)
