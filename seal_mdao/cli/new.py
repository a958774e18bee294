"""Write a seal file to start from: a commented bulb, or the section of a drawing under a plate."""

import shutil
from pathlib import Path

import numpy as np

from seal_mdao.cli.arguments import WrongArgumentError, checked_arguments, existing_file, parser
from seal_mdao.seals.outline.dxf import read_dxf

SQUEEZE = 0.2
"""Travel of the plate after first contact, as a fraction of the height of the drawing."""
CLEARANCE = 0.02
"""Initial clearance of the plate, as a fraction of the height of the drawing."""
RUBBER = """\
# Rubber of about 45 Shore A (Mooney-Rivlin, kPa). Other laws: neo_hookean, yeoh, gent, ogden,
# hyperfoam (sponge); from tests: law = "ogden", data = "tests.csv"
[material.rubber]
law = "mooney_rivlin"
c10 = 240.0
c01 = 60.0
bulk_modulus = 240000.0
"""
BULB = """\
# {name}: a hollow bulb on a foot, pressed by a plate. Lengths in mm, stresses in kPa, forces in N/m.
{rubber}
# The boundary, counter-clockwise, body on the left; every piece belongs to an edge.
[section]
material = "rubber"
spacing = 0.7  # largest distance of particles; walls get at least four layers
outer = [
  {{ edge = "foot", line = [[-5.0, 0.0], [5.0, 0.0]] }},
  {{ edge = "bulb", line = [[5.0, 0.0], [5.0, 5.0]] }},
  {{ edge = "bulb", arc = {{ start = [5.0, 5.0], through = [0.0, 10.0], end = [-5.0, 5.0] }} }},
  {{ edge = "bulb", line = [[-5.0, 5.0], [-5.0, 0.0]] }},
]
hole = [{{ edge = "inside", circle = {{ centre = [0.0, 5.0], radius = 3.2 }} }}]

[fixed]
edges = ["foot"]

# A rigid profile: its solid side lies on the left of the line.
[[profile]]
name = "plate"
friction = 0.3
contact = ["bulb"]
line = [[-30.0, 0.0], [30.0, 0.0]]
start = [0.0, 10.2]
[[profile.stage]]
translate = [0.0, -2.7]  # the plate touches after 0.2 mm

# What is measured at the end; reaction is the vertical force on the plate, N/m.
[[measure]]
type = "contact_width"
[[measure]]
type = "von_mises"

# What an optimisation may change: 6 control points along the inside, by at most 0.4 mm.
[[design]]
edges = ["inside"]
parameters = 6
bound = 0.4
[optimize]
minimize = "section_area"
constraint = [{{ measure = "reaction", lower = 450.0 }}]
"""
DRAWING = """\
# {name}: the section of {drawing}, pressed by a plate. Lengths in mm, stresses in kPa, forces in N/m.
# Edges (layers of the drawing): {edges}.
# Look at section.png of `seal-mdao check {name}.toml`, then change what is fixed, which edges the
# plate touches, its start and its travel.
{rubber}
[section]
material = "rubber"
spacing = {spacing:.3g}
dxf = "{drawing}"

[fixed]
edges = ["{lowest}"]

# A rigid profile: its solid side lies on the left of the line.
[[profile]]
name = "plate"
friction = 0.3
contact = [{contact}]
line = [[{left:.5g}, 0.0], [{right:.5g}, 0.0]]
start = [0.0, {start:.5g}]
[[profile.stage]]
translate = [0.0, {travel:.5g}]

[[measure]]
type = "contact_width"
[[measure]]
type = "von_mises"

# To optimise the shape, take the "#" away and name the edges that may move.
# [[design]]
# edges = ["{lowest}"]
# parameters = 6
# bound = 0.4  # mm
# [optimize]
# minimize = "section_area"
# constraint = [{{ measure = "reaction", lower = 100.0 }}]  # force on the plate, N/m
"""


def main(arguments) -> int:
    name = arguments.name.removesuffix(".toml")
    path = arguments.out / f"{name}.toml"
    # never overwrite a file that may have been edited
    if path.exists():
        raise WrongArgumentError(f"{path} exists; take another name")
    if arguments.drawing is None:
        # the commented bulb
        text = BULB.format(name=name, rubber=RUBBER)
    else:
        with checked_arguments():
            # section, edges and plate by the bounding box of the drawing
            text = from_drawing(name, arguments.drawing, path.parent)
    path.write_text(text, encoding="utf-8")
    print(f"{path}; next: seal-mdao check {path}")
    return 0


def from_drawing(name: str, drawing: Path, folder: Path) -> str:
    """Write the seal file of a drawing: lowest edge fixed, the others pressed by a plate from above.

    Raises
    ------
    ImportError, GeometryError
        As ``read_dxf``.
    """
    outline = read_dxf(drawing)
    # bounding box, mm
    low, high = np.array(outline.box)
    width, height = high - low
    reach: dict[str, list] = {}  # lowest and highest ordinate of every edge
    for contour in (outline.outer, *outline.others):
        for segment in contour.segments:
            # nine points find the extent of a line or arc well enough
            ordinates = segment.points(np.linspace(0.0, 1.0, 9))[:, 1]
            own = reach.setdefault(segment.edge, [np.inf, -np.inf])
            own[:] = min(own[0], ordinates.min()), max(own[1], ordinates.max())
    # the edge whose highest point is lowest is the foot
    lowest = min(reach, key=lambda edge: reach[edge][1])
    # edges that reach the upper half may touch the plate
    touched = [
        edge for edge, (_, top) in reach.items() if edge != lowest and top > low[1] + 0.5 * height
    ]
    if not touched:
        raise WrongArgumentError(
            f"--from: {drawing} has one edge only, {lowest!r}; draw what is fixed and what is "
            "pressed on layers of their own"
        )
    if not (folder / drawing.name).exists():  # a seal file names files beside it
        shutil.copy(drawing, folder / drawing.name)
    # at least twelve particles across; a plate seven times as wide
    return DRAWING.format(
        name=name, drawing=drawing.name, rubber=RUBBER, edges=", ".join(outline.edge_names),
        spacing=min(width, height) / 12.0, lowest=lowest,
        contact=", ".join(f'"{edge}"' for edge in touched),
        left=low[0] - 3.0 * width, right=high[0] + 3.0 * width,
        start=high[1] + CLEARANCE * height, travel=-(SQUEEZE + CLEARANCE) * height,
    )  # fmt: skip


def arguments_parser():
    made = parser(__doc__, ".", "NAME", "seal-mdao new bulb && seal-mdao check bulb.toml")
    made.add_argument("name", metavar="NAME", help="NAME.toml is written")
    made.add_argument(
        "--from", dest="drawing", type=existing_file, metavar="DRAWING.dxf",
        help="take the section from a drawing whose layers are the edges",
    )  # fmt: skip
    return made
