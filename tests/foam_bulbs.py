"""Right half of a foam bulb of radius 6 mm with a wall of 1.5 mm, on rubber, under a door."""

_TEXT = """
[material.bulb]
sponge = "2A3"
[material.rubber]
shore_a = 75
[section]
material = "bulb"
spacing = {spacing}
layers = 5
outer = [
{below}
  {{ edge = "bulb", arc = {{ start = [2.39791576, 2.5], through = [6, 8], end = [0, 14] }} }},
  {{ edge = "upper", line = [[0, 14], [0, 12.5]] }},
  {{ edge = "inside", arc = {{ start = [0, 12.5], through = [4.5, 8], end = [0, 3.5] }} }},
  {{ edge = "lower", line = [[0, 3.5], [0, 2.5], [0, 0]] }},
]
[[section.region]]
material = "rubber"
at = [1, 1]
line = [[0, 2.5], [2.39791576, 2.5]]
[fixed]
edges = ["fixed"]
[[symmetry]]
edges = ["upper", "lower"]
normal = "x"
[[profile]]
name = "door"
friction = 0
normal_penalty = 1e3
contact = ["bulb"]
line = [[-30, 0], [30, 0]]
start = [0, 14]
stage = [{{ translate = [0, -1], steps = 2 }}]
"""
CLIP = """\
  { edge = "fixed", line = [
    [0, 0], [1.5, 0], [1.5, -3], [4, -3], [4, 2.5], [2.39791576, 2.5],
  ] },"""
"""Outline of a clip with shoulders: the notch between bulb and shoulder has 24 degrees."""
BLOCK = """\
  { edge = "fixed", line = [[0, 0], [2.39791576, 0]] },
  { edge = "side", line = [[2.39791576, 0], [2.39791576, 2.5]] },"""
"""Outline of a block as wide as the foot of the bulb."""


def foam_bulb(below: str, spacing: float) -> str:
    """Text of a seal file: the bulb on ``CLIP`` or ``BLOCK``, with a distance of particles in mm."""
    return _TEXT.format(below=below, spacing=spacing)
