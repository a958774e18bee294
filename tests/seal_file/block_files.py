"""Seal files of a rubber block of 8 x 4 mm whose edges are fixed, moved, or bonded to a plate."""

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
    path = folder / "block.toml"
    path.write_text(text(*tables, **options))
    return sm.read_seal_file(path)


def seal_of(folder, *tables, **options):
    """The seal of such a file."""
    return sm.build_seal(file_of(folder, *tables, **options))
