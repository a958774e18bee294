"""Seal file of a block that relaxes under a lid: temperature, series, dwell, design and optimisation."""

from seal_file.block_files import DESIGN, FIXED, LID, text, with_model

SERIES = """
[material.rubber.viscoelastic]
g = [0.3, 0.2]
tau = [1.0, 100.0]
wlf = { c1 = 4.0, c2 = 150.0, reference = 23.0 }
[section]
"""
STAGES = """
stage = [{ translate = [0, -0.5], steps = 3, duration = 0.5 }, { steps = 3, duration = 20.0 }]
"""
MEASURES = """[[measure]]
type = "reaction"
name = "closing_force"
stage = 1
[[measure]]
type = "reaction"
name = "force_after_dwell"
stage = 2
[[measure]]
type = "retained_force"
stage = [1, 2]
"""
OPTIMIZE = """[optimize]
minimize = "section_area"
constraint = [{ measure = "force_after_dwell", lower = 1300.0 }]
"""


def relaxing_block() -> str:
    """The file: a block of 8 x 4 mm with 73 particles, one analysis of a fraction of a second."""
    given = text(FIXED, LID, DESIGN, MEASURES, OPTIMIZE).replace("\n[section]\n", SERIES)
    given = given.replace("\nstage = [{ translate = [0, -0.5], steps = 3 }]\n", STAGES)
    return with_model(given, "temperature = [40.0, 40.0]")


def written(folder):
    """The file in a folder."""
    path = folder / "block.toml"
    path.write_text(relaxing_block(), encoding="utf-8")
    return path
