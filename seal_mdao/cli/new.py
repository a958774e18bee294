"""Write a seal file to start from: a commented bulb, or the section of a drawing under a plate."""

from seal_mdao.cli.arguments import WrongArgumentError, checked_arguments, existing_file, parser
from seal_mdao.seals.file.from_drawing import from_drawing
from seal_mdao.seals.outline.dxf_entities import MODEL_UNITS

RUBBER = """\
# Rubber of about 45 Shore A (Mooney-Rivlin, kPa). Other laws: neo_hookean, yeoh, gent, ogden,
# hyperfoam (foam); from tests: law = "ogden", data = "tests.csv"
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
spacing = 0.7  # largest distance of particles; a wall gets at least three layers (key layers)
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
away_from_singular = 0.7  # mm from ends of fixed edges and sharp corners (infinite stress)

# What an optimisation may change: 6 control points along the inside, by at most 0.4 mm.
[[design]]
edges = ["inside"]
parameters = 6
bound = 0.4
[optimize]
minimize = "section_area"
constraint = [{{ measure = "reaction", lower = 450.0 }}]
"""


def main(arguments) -> int:
    name = arguments.name.removesuffix(".toml")
    if not name.strip("."):
        raise WrongArgumentError(
            f"{arguments.name!r} is no name of a file; give the name of the seal, such as bulb"
        )
    path = arguments.out / f"{name}.toml"
    # never overwrite a file that may have been edited
    if path.exists():
        raise WrongArgumentError(
            f"{path} already exists; choose another NAME or another folder (--out), or remove the "
            "file"
        )
    if arguments.drawing is None:
        # the commented bulb
        text = BULB.format(name=name, rubber=RUBBER)
    else:
        with checked_arguments():
            # section, edges and plate by the bounding box of the drawing
            text = from_drawing(
                name, arguments.drawing, path.parent, arguments.units, arguments.parting or [],
                arguments.ignore or [],
            )  # fmt: skip
    path.write_text(text, encoding="utf-8")
    print(f"{path}; next: seal-mdao check {path}")
    return 0


def arguments_parser():
    made = parser(__doc__, ".", "NAME", "seal-mdao new bulb && seal-mdao check bulb.toml")
    made.add_argument("name", metavar="NAME", help="name of the seal; NAME.toml is written")
    made.add_argument(
        "--from", dest="drawing", type=existing_file, metavar="DRAWING.dxf",
        help="DXF drawing of the section; each layer of the drawing becomes an edge of the section",
    )  # fmt: skip
    made.add_argument(
        "--units",
        choices=tuple(MODEL_UNITS),
        help="unit of length of the drawing, if the header of the drawing has none",
    )
    made.add_argument(
        "--parting", nargs="+", metavar="LAYER",
        help="layers of the drawing with lines between two rubbers; default: one such layer is "
        "detected",
    )  # fmt: skip
    made.add_argument(
        "--ignore", nargs="+", metavar="LAYER",
        help="layers of the drawing that are not part of the boundary; layers of annotation are "
        "always ignored",
    )  # fmt: skip
    return made
