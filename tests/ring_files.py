"""Bodies of revolution as seal files: a ring between a fixed base and a plate, a cylinder, and a ring
under a smooth lid, of rubber, foam or sponge."""

HEAD = """\
[model]
kinematics = "axisymmetric"
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = {bulk}
[section]
material = "rubber"
spacing = {spacing}
"""
_RING = (
    HEAD.replace("{bulk}", "2e3")
    + """\
[[section.outer]]
edge = "base"
line = [[{inner}, 0.0], [{outer}, 0.0]]
[[section.outer]]
edge = "side"
line = [[{outer}, 0.0], [{outer}, 2.0]]
[[section.outer]]
edge = "top"
line = [[{outer}, 2.0], [{inner}, 2.0]]
[[section.outer]]
edge = "bore"
line = [[{inner}, 2.0], [{inner}, 0.0]]
[fixed]
edges = ["base"]
directions = {directions}
[[profile]]
name = "plate"
friction = {friction}
normal_penalty = {penalty:g}
tangent_penalty = 1e4
contact = ["top"]
contact_points = "{points}"
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, {start}]
[[profile.stage]]
translate = {translate}
steps = 4
"""
)


def ring(inner: float = 3.0, spacing: float = 0.5, points: str = "particles", penalty: float = 1e5,
         friction: float = 0.3, start: float = 2.05, translate=(0.2, -0.5)) -> str:  # fmt: skip
    """A seal file of the ring, bonded to its base; lengths in mm."""
    return _RING.format(
        inner=inner, outer=inner + 2.0, spacing=spacing, points=points, penalty=penalty,
        friction=friction, start=start, translate=list(translate), directions='["x", "y"]',
    )  # fmt: skip


def cylinder(spacing: float = 0.5, points: str = "averages", travel: float = 0.4,
             penalty: float = 1e7) -> str:  # fmt: skip
    """A seal file of a solid cylinder between smooth plates; "bore" is its axis."""
    return _RING.format(
        inner=0.0, outer=2.0, spacing=spacing, points=points, penalty=penalty, friction=0.0,
        start=2.0, translate=[0.0, -travel], directions='["y"]',
    )  # fmt: skip


FOAM = """\
law = "hyperfoam"
mu = [60.0, 25.0]
alpha = [6.2, -3.1]
nu = [0.3, 0.2]
"""
SPONGE = 'sponge = "2A3"\n'


def made_of(material: str, text: str) -> str:
    """The file ``text`` with another material in place of the rubber."""
    before, _, after = text.partition("[material.rubber]\n")
    return f"{before}[material.rubber]\n{material}{after[after.index('[section]') :]}"


_LID = """\
outer = [
  {{ edge = "base", line = [[{inner}, 0.0], [{outer}, 0.0]] }},
  {{ edge = "side", line = [[{outer}, 0.0], [{outer}, {height}]] }},
  {{ edge = "top", line = [[{outer}, {height}], [{inner}, {height}]] }},
  {{ edge = "inside", line = [[{inner}, {height}], [{inner}, 0.0]] }},
]
[[profile]]
name = "lid"
friction = 0.0
contact = ["top"]
contact_points = "{points}"
line = [[0.0, 0.0], [20.0, 0.0]]
start = [0.0, {start}]
normal_penalty = 1e5
tangent_penalty = 1e4
stage = [{{ translate = [0.0, {travel}], steps = {steps} }}]
"""
PLANE = 'symmetry = [{ edges = ["base"], normal = "y" }]\n'
"""The base lies in a plane of symmetry; before all tables."""


def under_a_lid(radii, height: float, start: float, travel: float, steps: int, *, bulk=2e3,
                spacing=0.5, points="averages") -> str:  # fmt: skip
    """A seal file of a ring with inner and outer ``radii``; nothing holds its base."""
    lid = _LID.format(
        inner=radii[0], outer=radii[1], height=height, start=start, travel=travel, steps=steps,
        points=points,
    )  # fmt: skip
    return HEAD.format(bulk=bulk, spacing=spacing) + lid
