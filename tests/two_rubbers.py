"""A block of 6 x 4 mm of two materials, one above the other, between planes of symmetry."""

_SECTION = """\
[section]
material = "soft"
spacing = {spacing}
[[section.region]]
material = "stiff"
at = [1.0, {at}]
line = [[0.0, {height}], [6.0, {height}]]
[[section.outer]]
edge = "base"
line = [[0.0, 0.0], [6.0, 0.0]]
[[section.outer]]
edge = "right"
line = [[6.0, 0.0], [6.0, {height}], [6.0, 4.0]]
[[section.outer]]
edge = "top"
line = [[6.0, 4.0], [0.0, 4.0]]
[[section.outer]]
edge = "left"
line = [[0.0, 4.0], [0.0, {height}], [0.0, 0.0]]
[fixed]
edges = ["base"]
directions = ["y"]
[[symmetry]]
edges = ["left", "right"]
normal = "x"
"""
_PLATE = """\
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


def layered_block(spacing: float, height: float = 2.0, at: float = 0.5) -> str:
    """Tables of the section, its base and its planes: the interface lies at ``height``, and the part
    with the point (1, ``at``) is ``stiff``, the other one ``soft``; lengths in mm."""
    return _SECTION.format(spacing=spacing, height=height, at=at)


def pressed_block(spacing: float, start: float = 4.0, travel: float = -0.4) -> str:
    """Tables of a seal file after those of its materials: the block, soft above and stiff below, under a
    plate."""
    return layered_block(spacing) + _PLATE.format(start=start, travel=travel)
