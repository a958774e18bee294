"""A lip with a round tip of 0.5 mm, pressed so little by a plate that few points touch."""

PRESSED_TIP = """[material.rubber]
shore_a = 60
[section]
{section}
outer = [
  {{ edge = "foot", line = [[-0.5, 0.0], [0.5, 0.0]] }},
  {{ edge = "front", line = [[0.5, 0.0], [0.5, 3.0]] }},
  {{ edge = "tip", arc = {{ start = [0.5, 3.0], through = [0.0, 3.5], end = [-0.5, 3.0] }} }},
  {{ edge = "back", line = [[-0.5, 3.0], [-0.5, 0.0]] }},
]
[fixed]
edges = ["foot"]
[[profile]]
name = "plate"
friction = 0.2
contact = ["tip"]
line = [[-9.0, 0.0], [9.0, 0.0]]
start = [0.0, 3.5]
normal_penalty = 1e7
tangent_penalty = 3e5
stage = [{{ translate = [0.0, -0.01], steps = 4 }}]
[[measure]]
type = "reaction"
"""
"""Seal file with the ``section`` keys of its particles."""
