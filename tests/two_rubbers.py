"""A block of 6 x 4 mm, soft above and stiff below, that a plate presses between planes of symmetry."""

_TEXT = """\
[section]
material = "soft"
spacing = {spacing}
[[section.region]]
material = "stiff"
at = [1.0, 0.5]
line = [[0.0, 2.0], [6.0, 2.0]]
[[section.outer]]
edge = "base"
line = [[0.0, 0.0], [6.0, 0.0]]
[[section.outer]]
edge = "right"
line = [[6.0, 0.0], [6.0, 2.0], [6.0, 4.0]]
[[section.outer]]
edge = "top"
line = [[6.0, 4.0], [0.0, 4.0]]
[[section.outer]]
edge = "left"
line = [[0.0, 4.0], [0.0, 2.0], [0.0, 0.0]]
[fixed]
edges = ["base"]
directions = ["y"]
[[symmetry]]
edges = ["left", "right"]
normal = "x"
[[profile]]
name = "plate"
friction = 0.0
normal_penalty = 1e6
contact = ["top"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, {start}]
[[profile.stage]]
translate = [0.0, {travel}]
steps = 4
"""


def pressed_block(spacing: float, start: float = 4.0, travel: float = -0.4) -> str:
    """Tables of a seal file after those of its materials, ``soft`` and ``stiff``; lengths in mm."""
    return _TEXT.format(spacing=spacing, start=start, travel=travel)
