"""A coarse bulb with given load steps and penalties, which is analysed in a fraction of a second."""

TEXT = """\
[material.rubber]
law = "mooney_rivlin"
c10 = 240.0
c01 = 60.0
bulk_modulus = 24000.0
[section]
spacing = 1.8
layers = 3
outer = [
  { edge = "foot", line = [[-5.0, 0.0], [5.0, 0.0]] },
  { edge = "bulb", line = [[5.0, 0.0], [5.0, 5.0]] },
  { edge = "bulb", arc = { start = [5.0, 5.0], through = [0.0, 10.0], end = [-5.0, 5.0] } },
  { edge = "bulb", line = [[-5.0, 5.0], [-5.0, 0.0]] },
]
hole = [{ edge = "inside", circle = { centre = [0.0, 5.0], radius = 3.2 } }]
[fixed]
edges = ["foot"]
[[profile]]
name = "plate"
friction = 0.3
contact = ["bulb"]
normal_penalty = 60000.0
tangent_penalty = 6000.0
line = [[-30.0, 0.0], [30.0, 0.0]]
start = [0.0, 10.2]
[[profile.stage]]
translate = [0.0, -1.7]
steps = 6
[[measure]]
type = "contact_width"
[[design]]
edges = ["inside"]
parameters = 4
bound = 0.4
[optimize]
minimize = "section_area"
constraint = [{ measure = "reaction", lower = 300.0 }]
"""


def write(folder, name="bulb.toml", text=TEXT):
    """Write the file; return its path."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def nothing(*arguments):
    """Take reports of progress, and ask for no stop."""
