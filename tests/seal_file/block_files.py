"""Seal files of a rubber block of 8 x 4 mm whose edges are fixed, moved, or bonded to a plate."""

from dataclasses import replace

import numpy as np
import pytest

import seal_mdao as sm

BLOCK = """
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = {bulk}
[section]
material = "rubber"
spacing = {spacing}
outer = [
  {{ edge = "base", line = [[-4, 0], [4, 0]] }}, {{ edge = "right", line = [[4, 0], [4, 4]] }},
  {{ edge = "top", line = [[4, 4], [-4, 4]] }}, {{ edge = "left", line = [[-4, 4], [-4, 0]] }},
]
"""
FIXED = '[fixed]\nedges = ["base"]\n'
MOVED = """[[moved]]
edges = ["top"]
pivot = [1, 4]
stage = [{ translate = [0.3, -0.4], rotate = 4.0, steps = 4 }]
"""
GLUED = """[[profile]]
name = "plate"
line = [[-10, 4], [10, 4]]
friction = 0.3
contact = ["right"]
glued = ["top"]
pivot = [1, 4]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{ translate = [0.2, -1.5], rotate = 4.0, steps = 8 }]
"""
LID = """[[profile]]
name = "lid"
friction = 0.3
contact = ["top"]
line = [[-9, 0], [9, 0]]
start = [0, 4.02]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{ translate = [0, -0.5], steps = 3 }]
[[measure]]
type = "reaction"
"""
BETWEEN_PLATES = """[fixed]
edges = ["left"]
directions = ["x"]
[[profile]]
name = "lid"
friction = {friction}
contact = ["top"]
line = [[-9, 0], [9, 0]]
start = [0, 4]
normal_penalty = 1e7
tangent_penalty = 1e6
stage = [{{ translate = [0, -0.05], steps = 2 }}]
[[profile]]
name = "floor"
friction = {friction}
contact = ["base"]
line = [[9, 0], [-9, 0]]
normal_penalty = 1e7
tangent_penalty = 1e6
"""
MEASURES = """[[measure]]
type = "reaction"
component = "y"
[[measure]]
type = "reaction"
edges = ["base"]
component = "y"
name = "on_base"
[[measure]]
type = "reaction"
edges = ["base"]
component = "x"
travel = 0.3
name = "on_base_before"
[[measure]]
type = "strain_energy"
"""
DESIGN = '[[design]]\nedges = ["left"]\nparameters = 3\nbound = 0.5\n'


def text(*tables, spacing=1.0, bulk=4e3):
    """A seal file of the block with tables."""
    return BLOCK.format(spacing=spacing, bulk=bulk) + "".join(tables)


def file_of(folder, *tables, **options):
    """The file that was read."""
    return read(folder, text(*tables, **options))


def seal_of(folder, *tables, **options):
    """The seal of such a file."""
    return sm.build_seal(file_of(folder, *tables, **options))


def between_plates(folder, friction):
    """The seal of the block between two plates that touch it at the start; the upper one moves down."""
    return seal_of(folder, BETWEEN_PLATES.format(friction=friction), spacing=0.5, bulk=1e6)


def with_model(given: str, lines: str) -> str:
    """The file with lines of its table ``[model]``."""
    if "[model]\n" in given:
        return given.replace("[model]\n", f"[model]\n{lines}\n")
    return f"[model]\n{lines}\n{given}"


def foam(given: str) -> str:
    """The file with a foam in place of its only rubber."""
    before, after = given.split('law = "mooney_rivlin"', 1)
    after = after.split("bulk_modulus", 1)[1].split("\n", 1)[1]
    after = after.replace('type = "leak_rate"\n', 'type = "leak_rate"\nmodulus = 400.0\n')
    return f'{before}law = "hyperfoam"\nmu = [120.0]\nalpha = [3.0]\nnu = [0.2]\n{after}'


def read(folder, content: str):
    """The file of a text."""
    path = folder / "seal.toml"
    path.write_text(content)
    return sm.read_seal_file(path)


def exact_seal(folder, content: str):
    """The seal of a text, whose equilibrium is found to rounding."""
    return replace(sm.build_seal(read(folder, content)), newton=sm.NewtonOptions(tolerance=1e-12))


def require_potentials(result, rng) -> None:
    """The internal forces of every load step of a material with a history are the derivative of the
    potential of that step: the error of a difference quotient falls to a quarter with half of its
    step."""
    term = result.term("structure")
    for step in result.path.nominal_steps:
        response, way = step.responses[term.index], rng.normal(size=step.d.shape)
        works = term.forces(step.d, step.fraction, response.before) * way
        errors = []
        for h in (2e-4, 1e-4):
            ends = [term.potential(step.d + s * h * way, response) for s in (1, -1)]
            errors.append((ends[0] - ends[1]) / (2.0 * h) - works.sum())
        size = np.abs(works).sum()
        assert abs(errors[0]) <= 2e-5 * size, step.fraction
        assert errors[1] == pytest.approx(0.25 * errors[0], rel=0.05, abs=1e-9 * size), (
            step.fraction
        )
