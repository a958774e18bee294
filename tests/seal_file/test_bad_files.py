"""Seal files that are refused: one line that names table, key, value, and what is allowed."""

import re
import tomllib
from datetime import date
from functools import reduce
from math import inf, nan
from operator import getitem
from pathlib import Path

import pytest
from json_check import fits
from pydantic import TypeAdapter

import seal_mdao as sm
from seal_mdao.seals.file.file_tables import Written
from seal_mdao.seals.file.json_schema import json_schema
from seal_mdao.seals.file.schema import checked

BULB = (Path(__file__).parent / "bulb.toml").read_text()
ARC = "arc = { start = [4.0, 0.0], through = [0.0, 14.0], end = [-4.0, 0.0] }"
CIRCLE = "circle = { centre = [0.0, 7.0], radius = 4.5 }"
DOOR = "line = [[-40.0, 0.0], [40.0, 0.0]]"
MATERIAL = BULB[: BULB.index("[section]")]
SECTION = BULB[BULB.index("[section]") : BULB.index("[fixed]")]
PROFILE = BULB[BULB.index("[[profile]]") : BULB.index("[[design]]")]
HELD = BULB[BULB.index("[fixed]") : BULB.index("[[profile.stage]]")]
STAGES = BULB[BULB.index("[[profile.stage]]") : BULB.index("[[design]]")]
OPTIMIZE = BULB[BULB.index("[optimize]") :]
OPEN = BULB.replace("steps = 60\n", "").replace("steps = 20\n", "")
OTHER = f'[[profile]]\nname = "other"\nfriction = 0.1\ncontact = ["seal"]\n{DOOR}\nstart = [0.0, 15.0]\n'
SECOND = PROFILE.replace('"door"', '"wall"')
WIDTH = 'type = "contact_width"\nprofile = "door"'
REACTION, STRESS = 'type = "reaction"', 'type = "von_mises"'
LEAK = (
    'type = "leak_rate"\nrms_roughness = 6.0\nroll_off_wavelength = 500.0\nshortest_wavelength = 1.0\n'
    "pressure = 10.0"
)
HOLE = '[[section.hole]]\nhole = 2\nedge = "second"\ncircle = { centre = '
SAME_HOLE = HOLE.replace("hole = 2\n", "")
FIXED = '[fixed]\nedges = ["base"]\n'
SYMMETRY = '[[symmetry]]\nedges = ["base"]\nnormal = "y"\n'
SQUARE = "".join(
    f'[[section.hole]]\nedge = "{name}"\nline = [[{a}, {b}], [{c}, {d}]]\n'
    for name, a, b, c, d in (
        ("cavity", -2, 5, -2, 9), ("top", -2, 9, 2, 9), ("right", 2, 9, 2, 5), ("foot", 2, 5, -2, 5)
    )
)  # fmt: skip
ACROSS = '[[measure]]\ntype = "wall_thickness"\nedges = ["cavity"]\nopposite = ["right"]\n'
CAVITY = "[[cavity]]\nhole = 1\n"
VENTS = "vent_diameter = 3.0\nvent_spacing = 100.0\nclosing_speed = 500.0\n"
TOUCH = '[self_contact]\nfriction = 0.3\nedges = ["second"]\n'
FLUID = '[[fluid]]\nedge = "seal"\nfrom = "end"\npressure = 50.0\nsteps = 20\n'
PRESSED = FLUID.replace('from = "end"\n', "")
GAPS = """[[measure]]
type = "section_area"
name = "gaps_2"
[[measure]]
type = "gap"
name = "gaps"
"""
LOST = '[[measure]]\ntype = "friction_work"\n'
REGION = """[material.foot]
law = "neo_hookean"
c10 = 300.0
bulk_modulus = 8e4
[[section.region]]
material = "foot"
at = [0.0, 1.0]
line = [[-4.0, 0.0], [0.0, 2.5]]
"""
FITTED = '[material.rubber]\nlaw = "yeoh"\ndata = "tests.csv"\n'
YEOH = """[material.rubber]
law = "yeoh"
c10 = 100.0
c20 = -100.0
c30 = 0.0
bulk_modulus = 8e4
"""


def without(text):
    return text, ""


# what is replaced in a sound file, by what, and words of the line
BAD = {
    # TOML
    "empty": (*without(BULB), "is empty; it needs at least [material.NAME], [section], [[profile]]"),
    "a comment": (BULB, "# nothing\n", "is empty"),
    "no TOML": (BULB, "law: rubber", "not valid TOML: Expected '=' after a key"),
    "no end of a list": ("[4.0, 0.0]]", "[4.0, 0.0]", "not valid TOML:"),
    "a key twice": ("c10 = 80.0", "c10 = 80.0\nc10 = 8.0", "not valid TOML: Cannot overwrite"),
    "comma": ("c10 = 80.0", "c10 = 80,0", "not valid TOML:"),
    "single brackets": ("[[measure]]", '[measure]\ntype = "section_area"\n[measure]',
                        "not valid TOML: Cannot declare ('measure',) twice (at line 39, column 9); a "
                        "table that may be repeated has two pairs of brackets, as in [[measure]]"),
    # tables
    "no material": (*without(MATERIAL), "[material.NAME] is missing"),
    "no section": (*without(SECTION), "[section] is missing"),
    "no fixed": (*without('[fixed]\nedges = ["base"]\n'),
                 "[fixed] is missing, so profiles must support the section, but none touches it"),
    "no direction": (FIXED, FIXED + 'directions = ["z"]\n',
                     "[fixed]: directions = ['z'], but it must be a list of \"x\", \"y\" or both"),
    "air of a hole that is cut": (
        FIXED, SYMMETRY + "[[cavity]]\nhole = 2\n",
                                  "but the section has 1 hole; holes are numbered from 1; a hole that "
                                  "a plane of symmetry cuts is part of the outer contour"),
    "symmetry twice": (FIXED, FIXED + SYMMETRY, "[[symmetry]] 1: the edge 'base' is already in [fixed]"),
    "bent symmetry": (FIXED, FIXED + SYMMETRY.replace("base", "cavity"),
                      "[[symmetry]] 1: the edge 'cavity' in the list edges does not lie"),
    "region off": (FIXED, REGION.replace("2.5]", "1.0]") + FIXED,
                   "[[section.region]] 1: line ends at (0, 1) inside the section, 1 mm away from its"),
    "region of none": (FIXED, REGION.replace('"foot"', '"foo"') + FIXED,
                       "[[section.region]] 1: material = 'foo', but there is no such material"),
    "region of its own": (FIXED, REGION.replace('"foot"', '"rubber"') + FIXED,
                          "[[section.region]] 1: material = 'rubber', but [section] already has"),
    "no such hole": (FIXED, FIXED + CAVITY.replace("1", "2"),
                     "[[cavity]] 1: hole = 2, but the section has 1 hole"),
    "cavity of hole zero": (FIXED, FIXED + CAVITY.replace("1", "0"), "[[cavity]] 1: hole = 0, but"),
    "sealed twice": (FIXED, FIXED + 2 * CAVITY, "hole = 1, but [[cavity]] 1 already has"),
    "air named as a profile": (FIXED, FIXED + CAVITY + 'name = "door"\n',
                               "[[cavity]] 1: name = 'door', but a profile has it; give every"),
    "no pressure outside": (FIXED, FIXED + CAVITY + "pressure = 0.0\n",
                            "[[cavity]] 1: pressure = 0.0, but it must be a number above 0"),
    "vents without a spacing": (FIXED, FIXED + CAVITY + "vent_diameter = 3.0\n",
                                "[[cavity]] 1: the key vent_diameter is given without vent_spacing"),
    "a coefficient without vents": (FIXED, FIXED + CAVITY + "discharge_coefficient = 0.7\n",
                                    "discharge_coefficient is given without vent_diameter"),
    "vents too wide": (FIXED, FIXED + CAVITY + VENTS.replace("100.0", "2.0"),
                       "vent_spacing = 2 is less than vent_diameter = 3; give the distance"),
    "a coefficient above one": (FIXED, FIXED + CAVITY + VENTS + "discharge_coefficient = 1.1\n",
                                "but it must be a number above 0 and at most 1"),
    "no time for a turn": (STAGES, STAGES.replace("translate = [2.0, 0.0]", "")
                           + CAVITY + VENTS,
                           "[[cavity]] 1: closing_speed = 500 does not define the time of stage 2 of "
                           "the profile 'door'"),
    "a duration without vents": ("steps = 20", "steps = 20\nduration = 0.1",
                                 "[[profile]] 1 ('door'): [[profile.stage]] 2 has a duration, which "
                                 "only the first moving profile of a seal with a vented [[cavity]] "
                                 "or materials that relax needs; leave it out"),
    "a duration of zero": ("steps = 20", "steps = 20\nduration = 0.0",
                           "duration = 0.0, but it must be a number above 0"),
    "no travel at all": (STAGES, "[[profile.stage]]\nrotate = 1.0\n" + CAVITY + VENTS,
                         "[[cavity]] 1 has vents, but no profile moves; add"),
    "vents without a speed": (FIXED, FIXED + CAVITY + VENTS.replace("closing_speed = 500.0\n", ""),
                              "[[cavity]] 1 has vents but no closing_speed, and stage 1 of the "
                              "profile 'door' has no duration; give either"),
    "a speed of no stage": (STAGES, STAGES.replace("steps = 60", "steps = 60\nduration = 0.1")
                            .replace("steps = 20", "steps = 20\nduration = 0.1") + CAVITY + VENTS,
                            "closing_speed = 500 has no effect, because every stage has a duration"),
    "pressure of no cavity": (WIDTH, 'type = "cavity_pressure"',
                              "cavity = 'air', but there is no such [[cavity]]; there are none"),
    "self-contact of no edge": (FIXED, FIXED + TOUCH,
                                "[self_contact]: edges = 'second', but there is no such edge"),
    "self-contact named twice": (FIXED, FIXED + TOUCH.replace('["second"]', '["seal", "seal"]'),
                                 "[self_contact]: the list edges contains the edge 'seal' twice"),
    "impossible friction of self-contact": (FIXED, FIXED + TOUCH.replace("0.3", "4e5"),
        "[self_contact]: friction = 400000.0, but it must be a number of at least 0 and at most 10"),
    "impossible penalty of self-contact": (FIXED, FIXED + TOUCH + "normal_penalty = 1e13\n",
        "[self_contact]: normal_penalty = 10000000000000.0, but it must be a number above 0 and at "),
    "an edge that no layer can be": ('edge = "cavity"', 'edge = "lip/top"',
        "[[section.hole]] 1 (edge 'lip/top'): edge: the name 'lip/top' of an edge contains"),
    "an edge of two lines": ('edge = "cavity"', 'edge = "lip\\ntop"', "contains '\\n', which"),
    "too soft in volume": ("bulk_modulus = 80000.0", "bulk_modulus = 100.0",
        "[material.rubber]: bulk_modulus = 100 of MooneyRivlin gives a Poisson's ratio of -0.1 with"),
    "rough self-contact": (FIXED, FIXED + TOUCH.replace("0.3", "-0.3"),
                           "[self_contact]: friction = -0.3, but it must be a number"),
    "measure named as a column": (FIXED, FIXED + LOST + 'name = "converged"\n',
                                  "name = 'converged' is the name of a column of sweep.csv; give"),
    "measure named as a value of another": (FIXED, FIXED + GAPS,
        "name = 'gaps_2' is the name of a column of sweep.csv for a value of the [[measure]] 'gaps'"),
    "friction work with a fluid": (FIXED, FIXED + FLUID + LOST,
                                   "with [[fluid]], because a fluid does work"),
    "friction work with vents": (FIXED, FIXED + CAVITY + VENTS + LOST,
                                 "with vents of a [[cavity]], because air that leaves does work"),
    "fluid of no edge": (FIXED, FIXED + FLUID.replace('"seal"', '"seel"'),
                         "[[fluid]] 1: edge = 'seel', but there is no such edge (did you mean 'seal'?)"),
    "fluid of a number": (FIXED, FIXED + FLUID.replace('"seal"', "3"),
                          "[[fluid]] 1: edge = 3, but it must be the name of an edge, or a list of"),
    "fluid twice along": (FIXED, FIXED + FLUID.replace('"seal"', '["seal", "seal"]'),
                          "[[fluid]] 1: the list edge contains the edge 'seal' twice"),
    "fluid all round": (FIXED, FIXED + FLUID.replace('"seal"', '"cavity"'),
                        "[[fluid]] 1: edge = cavity is a closed curve, so it has no wet and no dry end"),
    "fluid round both": (FIXED, FIXED + FLUID.replace('"seal"', '["seal", "base"]'),
                         "[[fluid]] 1: edge = seal, base is a closed curve"),
    "fluid apart": (FIXED, FIXED + FLUID.replace('"seal"', '["seal", "cavity"]'),
                    "[[fluid]] 1: edge = seal, cavity is not one connected part of the boundary; list"),
    "fluid untouched": (FIXED, FIXED + FLUID.replace('"seal"', '"base"'), "[[fluid]] 1: edge = base, "
                        "but no profile may touch these edges, so nothing stops the fluid"),
    "fluid from nowhere": (FIXED, FIXED + PRESSED, "[[fluid]] 1: edge = seal, without from, but the "
                           "profile 'door' may touch it and stop the fluid; give the end from which"),
    "fluid in a cavity": (FIXED, FIXED + CAVITY + PRESSED.replace('"seal"', '"cavity"'), "[[fluid]] 1: "
                          "edge = cavity belongs to hole 1, whose air already presses on it"),
    "fluid from left": (FIXED, FIXED + FLUID.replace('"end"', '"left"'),
                        "[[fluid]] 1: from = 'left', but it must be one of start, end"),
    "fluid sucks": (FIXED, FIXED + FLUID.replace("50.0", "-50.0"),
                    "[[fluid]] 1: pressure = -50.0, but it must be a number above 0 and at most 1e+09"),
    "fluid presses with NaN": (FIXED, FIXED + FLUID.replace("50.0", "nan"), "[[fluid]] 1: pressure = "),
    "fluid at once": (FIXED, FIXED + FLUID.replace("20", "0"),
                      "[[fluid]] 1: steps = 0, but it must be a whole number from 1 to 100000"),
    "fluid for too long": (FIXED, FIXED + FLUID.replace("20", "81"), "[[fluid]] 1: steps = 81, but the "
                           "stages of the profiles have 80 steps in all; add a last stage with"),
    "fluid of no share": (FIXED, FIXED + FLUID + "share = 0.0\n",
                          "[[fluid]] 1: share = 0.0, but it must be a number above 0 and at most 1"),
    "fluid misspelt": (FIXED, FIXED + FLUID.replace("pressure", "presure"), "[[fluid]] 1: unknown key "
                       "'presure' (did you mean 'pressure'?); the keys are edge, pressure, from"),
    "fluid named as a profile": (FIXED, FIXED + FLUID + 'name = "door"\n',
                                 "[[fluid]] 1: name = 'door', but a profile has it; give every"),
    "two fluids of one name": (FIXED, FIXED + 2 * FLUID,
                               "[[fluid]] 2: name = 'fluid', but [[fluid]] 1 has it; give every"),
    "fluid as a cavity": (FIXED, FIXED + FLUID + 'name = "air"\n' + CAVITY,
                          "[[fluid]] 1: name = 'air', but [[cavity]] 1 has it"),
    "blow-off of no fluid": (WIDTH, 'type = "blow_off_pressure"',
                             "[[measure]] 1: fluid = 'fluid', but there is no such [[fluid]] with"),
    "no profile": (*without(PROFILE), "[[profile]] is missing"),
    "type of a measure": (WIDTH, 'type = "pressure"',
                          "type = 'pressure', but it must be one of peak_pressure, pressure_"),
    "unknown table": ("[fixed]", "[fixd]", "unknown table or key 'fixd' (did you mean 'fixed'?)"),
    "unknown key on top": ("[material", "speed = 1\n[material", "table or key 'speed'; the tables"),
    "profile no list": (
        PROFILE, PROFILE.replace("[[profile]]", "[profile]"),
        "profile must be a list of tables, each written [[profile]], got {'name': 'door'",
    ),
    "section a list": (
        "[section]\n", "[[section]]\n", "[section] must be one table, written [section], got [{",
    ),
    "fixed a number": (BULB, "fixed = 3\n" + BULB.replace('[fixed]\nedges = ["base"]\n', ""),
                       "[fixed] must be one table, got 3"),
    "profiles of numbers": (BULB, "profile = [1, 2]\n" + BULB.replace(PROFILE, ""),
                            "profile must be a list of tables, each written [[profile]], got [1, 2]"),
    "no profiles": (BULB, "profile = []\n" + BULB.replace(PROFILE, ""), "got []"),
    "measure no list": ("[[measure]]", "[measure]", "measure must be a list of tables, each written"),
    "design no list": ("[[design]]", "[design]", "design must be a list of tables, each written [[de"),
    "optimize a list": ("[optimize]\n", "[[optimize]]\n", "[optimize] must be one table, written"),
    # material
    "no law": (*without('law = "mooney_rivlin"\n'),
               "[material.rubber]: the key 'law' is missing; it must be one of neo_hookean, mooney"),
    "misspelt hardness": (MATERIAL, "[material.rubber]\nshoreA = 60\n",
                          "[material.rubber]: unknown key 'shoreA' (did you mean 'shore_a'?)"),
    "hardness beside a law": ("c10 = 80.0", "c10 = 80.0\nshoreA = 60",
                              "[material.rubber]: unknown key 'shoreA'; the keys are law, c10, c01"),
    "unknown law": ('"mooney_rivlin"', '"rubber"', "[material.rubber]: law = 'rubber', but it must"),
    "law a number": ('"mooney_rivlin"', "3", "[material.rubber]: law = 3, but it must be one of"),
    "law a list": ('"mooney_rivlin"', '["yeoh"]', "[material.rubber]: law = ['yeoh'], but it must"),
    "no constant": (*without("c01 = 20.0\n"), "[material.rubber]: the key 'c01' is missing; it must"),
    "constant of another law": ("c01 =", "c20 =", "[material.rubber]: unknown key 'c20' (did you mean"),
    "constant a text": ("c10 = 80.0", 'c10 = "80"', "c10 = '80', but it must be a number"),
    "constant a truth": ("c10 = 80.0", "c10 = true", "c10 = True, but it must be a number"),
    "constant NaN": ("c10 = 80.0", "c10 = nan", "c10 = nan, but it must be a number"),
    "constant infinite": ("bulk_modulus = 80000.0", "bulk_modulus = inf", "bulk_modulus = inf, but"),
    "negative constant": ("c10 = 80.0", "c10 = -8.0", "[material.rubber]: c10 of MooneyRivlin must"),
    "no stiffness": ("bulk_modulus = 80000.0", "bulk_modulus = 0.0", "bulk_modulus of MooneyRivlin"),
    "unstable": (MATERIAL, '[material.rubber]\nlaw = "ogden"\nmu = [-6.0]\nalpha = [2.0]\n'
                 "bulk_modulus = 8e4\n", "the initial shear modulus sum(mu alpha) / 2 of Ogden must"),
    "mu no list": (MATERIAL, '[material.rubber]\nlaw = "ogden"\nmu = 6.0\nalpha = [2.0]\n'
                   "bulk_modulus = 8e4\n", "mu = 6.0, but it must be a list of numbers"),
    "uneven": (MATERIAL, '[material.rubber]\nlaw = "ogden"\nmu = [6.0]\nalpha = [2.0, 3.0]\n'
               "bulk_modulus = 8e4\n", "[material.rubber]: Ogden needs equally many values"),
    "foam as rubber": (MATERIAL, '[material.rubber]\nlaw = "hyperfoam"\nmu = [6.0]\nalpha = [2.0]\n'
                       "nu = [0.5]\n", "nu_1 of Hyperfoam must lie between -1 and 1/2, got 0.5"),
    "data and constants": ("c10 = 80.0", 'data = "tests.csv"',
                           "[material.rubber]: unknown key 'c01'; the keys are law, data,"),
    "no data": (MATERIAL, FITTED, "tests.csv: cannot be read: No such file"),
    "data no name": (MATERIAL, FITTED.replace('"tests.csv"', "3"),
                     "[material.rubber]: data = 3, but it must be a text that is not empty"),
    "terms of yeoh": (MATERIAL, FITTED + "terms = 2\n", "[material.rubber]: unknown key 'terms'"),
    "stable no range": ("c10 = 80.0", "c10 = 80.0\nstable = [1.5, 0.7]",
                        "[material.rubber]: stable = [1.5, 0.7], but it must be the least and largest"),
    "unstable yeoh": (MATERIAL, YEOH, "a material that is not stable: uniaxial: NOT stable over "
                      "0.7 to 1.5; instability begins at a stretch of 0.7868 and 1.262; planar: "),
    "limit within": (MATERIAL, '[material.rubber]\nlaw = "gent"\nshear_modulus = 200.0\nlimit = 0.5\n'
                     "bulk_modulus = 8e4\n", "gent describes a material that is not stable: "),
    "no name": ("[material.rubber]", "[material]", "law = 'mooney_rivlin', but this is a key"),
    "unknown material": ('material = "rubber"', 'material = "ruber"',
                         "[section]: material = 'ruber', but there is no such material (did you mean"),
    # section
    "spacing and cloud": ("spacing = 0.9", 'spacing = 0.9\ncloud = "a.msh"',
                          "but has spacing and cloud; leave out all but one"),
    "spacing zero": ("spacing = 0.9", "spacing = 0.0", "spacing = 0.0, but it must be a number above 0"),
    "spacing a text": ("spacing = 0.9", 'spacing = "fine"', "[section]: spacing = 'fine', but it must"),
    "spacing too large": ("spacing = 0.9", "spacing = 9.0", "[section]: spacing = 9 mm is not less"),
    "spacing too small": ("spacing = 0.9", "spacing = 1e-3", "[section]: spacing = 0.001, which needs"),
    "coordinate too large": ("[4.0, 0.0]]", "[4e99, 0.0]]", "line: last = (4e+99, 0) is beyond 1e+09"),
    "spacing misspelt": ("spacing =", "spaceing =", "unknown key 'spaceing' (did you mean 'spacing'?)"),
    "outline and drawing": ("spacing = 0.9", 'spacing = 0.9\ndxf = "a.dxf"', "the seal file has both"),
    "two layers": ("spacing = 0.9\n", "spacing = 0.9\nlayers = 2\n", "layers = 2, but it must be a "
                   "whole number from 3 to 50"),
    "layers beside rays": ("spacing = 0.9\n", "rays = { rays = 24, layers = 4 }\nlayers = 5\n",
                           "[section]: the key layers can only be combined with spacing"),
    "edge spacing zero": ("spacing = 0.9", "spacing = 0.9\nedge_spacing = { seal = 0.0 }",
                          "[section]: edge_spacing = {'seal': 0.0}, but it must be names with numbers "),
    "edge spacing unknown": ("spacing = 0.9", "spacing = 0.9\nedge_spacing = { sael = 0.1 }",
                             "edge_spacing = 'sael', but there is no such edge (did you mean 'seal'?)"),
    "edge spacing too large": ("spacing = 0.9", "spacing = 0.9\nedge_spacing = { seal = 0.9 }",
                               "edge_spacing: seal = 0.9, which must be less than spacing = 0.9"),
    "edge spacing too small": ("spacing = 0.9", "spacing = 0.9\nedge_spacing = { seal = 1e-4 }",
                               "edge_spacing: seal = 0.0001, which needs more than 200000 particles"),
    "edge spacing beside rays": ("spacing = 0.9\n", "rays = { rays = 24, layers = 4 }\nedge_spacing = "
                                 "{ seal = 0.1 }\n", "edge_spacing can only be combined with"),
    "no outline": (SECTION, '[section]\nmaterial = "rubber"\nspacing = 0.9\n', "has neither"),
    "units without drawing": ("spacing = 0.9", 'spacing = 0.9\nunits = "mm"', "the key units applies"),
    "no such drawing": (SECTION, '[section]\nmaterial = "rubber"\nspacing = 0.9\ndxf = "no.dxf"\n',
                        "no.dxf: there is no such drawing"),
    "drawing and hole": (SECTION, '[section]\nmaterial = "rubber"\nspacing = 0.9\ndxf = "no.dxf"\n'
                         '[[section.hole]]\nedge = "cavity"\n' + CIRCLE + "\n",
                         "[[section.hole]] cannot be combined with a drawing"),
    "unknown units": (SECTION, '[section]\nmaterial = "rubber"\nspacing = 0.9\ndxf = "no.dxf"\n'
                      'units = "miles"\n', "[section]: units = 'miles', but it must be one of mm"),
    "edge without a name": (*without('edge = "base"\n'), "[[section.outer]] 1: the key 'edge' is missi"),
    "edge a number": ('edge = "base"', "edge = 3", "[[section.outer]] 1: edge = 3, but it must be a te"),
    "no segment": (*without("line = [[-4.0, 0.0], [4.0, 0.0]]\n"),
                   "[[section.outer]] 1 (edge 'base'): a segment of a curve needs exactly one of the"),
    "two segments": (ARC, ARC + "\nline = [[4.0, 0.0], [-4.0, 0.0]]", "but this one has line and arc"),
    "unknown segment": ("line = [[-4.0", "bezier = [[-4.0", "(edge 'base'): unknown key 'bezier'"),
    "one point": ("[[-4.0, 0.0], [4.0, 0.0]]", "[[-4.0, 0.0]]", "it must be a list of at least two"),
    "three coordinates": ("[4.0, 0.0]]", "[4.0, 0.0, 0.0]]", "it must be a list of at least two points"),
    "text as coordinate": ("[4.0, 0.0]]", '[4.0, "0"]]', "(edge 'base'): line = [[-4.0, 0.0], [4.0, '0"),
    "NaN coordinate": ("[4.0, 0.0]]", "[4.0, nan]]", "line = [[-4.0, 0.0], [4.0, nan]], but it must"),
    "duplicate points": ("[[-4.0, 0.0], [4.0, 0.0]]", "[[-4.0, 0.0], [4.0, 0.0], [4.0, 0.0]]",
                         "(edge 'base'): line: a line of the boundary has zero length"),
    "collinear arc": ("through = [0.0, 14.0]", "through = [0.0, 0.0]",
                      "[[section.outer]] 2 (edge 'seal'): arc: start (4, 0), through (0, 0) and end"),
    "arc without end": (ARC, ARC.replace(", end = [-4.0, 0.0]", ""), "arc: the key 'end' is missing; "),
    "arc a list": (ARC, "arc = [[4.0, 0.0], [0.0, 14.0], [-4.0, 0.0]]", "arc must be one table"),
    "arc misspelt": (ARC, ARC.replace("through", "trough"), "arc: unknown key 'trough' (did you mean"),
    "spline point twice": (ARC, "spline = [[4.0, 0.0], [0.0, 14.0], [0.0, 14.0], [-4.0, 0.0]]",
                           "spline: points 2 and 3 of a spline coincide at (0, 14)"),
    "center": (CIRCLE, CIRCLE.replace("centre", "center"), "unknown key 'center' (did you mean 'centr"),
    "no radius": (CIRCLE, CIRCLE.replace("4.5", "0"), "circle: radius = 0, but it must be a number abo"),
    "negative radius": (CIRCLE, CIRCLE.replace("4.5", "-4.5"), "circle: radius = -4.5, but it must be"),
    "open contour": (ARC, ARC.replace("end = [-4.0", "end = [-5.0"),
                     "[[section.outer]]: the contour is open: segment 2 (edge 'seal') ends at (-5, 0)"),
    "clockwise": (ARC, ARC.replace("14.0", "-14.0"), "[section]: the outer contour (edges base, seal) "
                  "runs clockwise"),
    "crossing": (ARC, "spline = [[4.0, 0.0], [-5.0, 9.0], [5.0, 9.0], [-4.0, 0.0]]", "crosses itself"),
    "hole open": (CIRCLE, "line = [[0.0, 6.0], [1.0, 7.0], [0.0, 8.0]]",
                  "[[section.hole]] of hole 1: the contour is open: segment 2 (edge 'cavity')"),
    "hole outside": (CIRCLE, CIRCLE.replace("[0.0, 7.0]", "[30.0, 7.0]"), "lies outside of the outer"),
    "hole crosses": (CIRCLE, CIRCLE.replace("4.5", "7.2"), "[section]: the outer contour, edge 'base', "
                     "crosses hole 1, edge 'cavity',"),
    "overlapping holes": ("[fixed]", HOLE + "[4.0, 7.0], radius = 1.0 }\n[fixed]",
                          "hole 1, edge 'cavity', crosses hole 2, edge 'second', at"),
    "two holes in one": ("[fixed]", SAME_HOLE + "[4.0, 7.0], radius = 1.0 }\n[fixed]",
                         "use arcs to connect other segments; segments of another hole need hole = 2"),
    "hole in a hole": ("[fixed]", HOLE + "[0.0, 7.0], radius = 1.0 }\n[fixed]", "lies inside of hole 1"),
    "hole zero": ("[fixed]", (HOLE + "[0.0, 7.0], radius = 1.0 }\n[fixed]").replace("= 2", "= 0"),
                  "hole = 0, but it must be a whole number from 1 to"),
    "an edge twice": ('edge = "cavity"', 'edge = "seal"', "the edge 'seal' is on the outer contour and"),
    "hole no list": ("[[section.hole]]", "[section.hole]", "section.hole must be a list of tables, ea"),
    # fixed
    "fixed nothing": ('edges = ["base"]', "edges = []", "[fixed]: edges = [], but it must be a list of"),
    "fixed a text": ('edges = ["base"]', 'edges = "base"', "[fixed]: edges = 'base', but it must be a"),
    "fixed unknown": ('edges = ["base"]', 'edges = ["bas"]', "[fixed]: edges = 'bas', but there is no "
                      "such edge (did you mean 'base'?); there are base, seal, cavity"),
    "fixed twice": ('edges = ["base"]', 'edges = ["base", "base"]', "contains the edge 'base' twice"),
    "fixed misspelt": ('edges = ["base"]', 'edge = ["base"]', "[fixed]: unknown key 'edge' (did you me"),
    # profile
    "no name of a profile": (*without('name = "door"\n'), "[[profile]] 1: the key 'name' is missing"),
    "odd name": ('name = "door"', 'name = "the door"', "name = 'the door', but it must be a name of l"),
    "name of the body": ('name = "door"', 'name = "structure"', "is reserved for the seal"),
    "same names": (PROFILE, PROFILE + PROFILE, "name = 'door', but an earlier [[profile]]"),
    "no friction": (*without("friction = 0.25\n"), "[[profile]] 1 ('door'): the key 'friction' is miss"),
    "negative friction": ("friction = 0.25", "friction = -0.1", "friction = -0.1, but it must be a nu"),
    "friction a text": ("friction = 0.25", 'friction = "low"', "friction = 'low', but it must be a nu"),
    "nothing behind": (HELD, HELD.replace('[fixed]\nedges = ["base"]\n', "").replace("14.45", "14.0"),
                       "the section has no support against the straight profile 'door'"),
    "no free edge": ('contact = ["seal"]\n', 'glued = ["seal", "cavity"]\n', "[[profile]] 1 ('door'): "
                     "the profile has no edge that it may touch, because all edges"),
    "which material": (MATERIAL + '[section]\nmaterial = "rubber"\n',
                       MATERIAL + "[material.foam]\nsponge = '2A2'\n[section]\n",
                       "[section]: the key 'material' is missing; with several materials it must"),
    "unknown contact": ('contact = ["seal"]', 'contact = ["sael"]', "[[profile]] 1 ('door'): contact = "
                        "'sael', but there is no such edge (did you mean 'seal'?)"),
    "contact is fixed": ('contact = ["seal"]', 'contact = ["base"]', "contact = 'base', but [fixed] p"),
    "contact apart": ('contact = ["seal"]', 'contact = ["seal", "cavity"]', "is not one connected "
                      "part of the boundary"),
    "no shape": (*without(DOOR + "\n"), "[[profile]] 1 ('door'): a segment of a curve needs exactly"),
    "profile of one point": (DOOR, "line = [[0.0, 0.0]]", "line = [[0.0, 0.0]], but it must be a list"),
    "profile there and back": (DOOR, "line = [[-9.0, 0.0], [9.0, 0.0], [-9.0, 0.0]]",
                               "overlap or form a cusp at (9, 0)"),
    "profile crosses": (DOOR, "line = [[-9.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, -9.0]]",
                        "[[profile]] 1 ('door'): the curve crosses or touches itself at (4.5, 0)"),
    "profile has a gap": (DOOR, "[[profile.segment]]\nline = [[-9.0, 0.0], [0.0, 0.0]]\n"
                          "[[profile.segment]]\nline = [[1.0, 0.0], [9.0, 0.0]]\n[profile.x]\n",
                          "('door'): unknown key 'x'"),
    "profile of pieces apart": (
        DOOR + "\nstart = [0.0, 14.45]",
        "start = [0.0, 14.45]\n[[profile.segment]]\nline = [[-9.0, 0.0], [0.0, 0.0]]\n"
        "[[profile.segment]]\nline = [[1.0, 0.0], [9.0, 0.0]]",
        "segment 1 (edge 'door') ends at (0, 0), but the next segment 2 (edge 'door') begins at",
    ),
    "profile twice": (
        DOOR + "\nstart = [0.0, 14.45]",
        DOOR + "\nstart = [0.0, 14.45]\n[[profile.segment]]\nline = [[-9.0, 0.0], [0.0, 0.0]]",
        "the key line and the tables [[profile.segment]] both define",
    ),
    "inside": ("start = [0.0, 14.45]", "start = [0.0, 13.0]", "[[profile]] 1 ('door'): start = (0, 13) "
               "puts the edge 'seal' 1 mm inside the rigid body at (0, 14); start it"),
    "wrong way": (DOOR, "line = [[40.0, 0.0], [-40.0, 0.0]]", "left of the curve's direction; "
                  "is its direction reversed?)"),
    "start a number": ("start = [0.0, 14.45]", "start = 14.5", "start = 14.5, but it must be a point"),
    "start beyond all": ("start = [0.0, 14.45]", "start = [0.0, 1e300]", "must be a point [x, y] of two "
                         "numbers, at most 100000 in size"),
    "huge penalty": (DOOR, DOOR + "\nnormal_penalty = 1e300", "a number above 0 and at most 1e+12"),
    "huge friction": ("friction = 0.25", "friction = 1e300", "a number of at least 0 and at most 10"),
    "many turns": ("rotate = 0.0", "rotate = 1e9", "a number of at least -3600 and at most 3600"),
    "no penalty": (DOOR, DOOR + "\nnormal_penalty = 0.0", "normal_penalty = 0.0, but it must be a numb"),
    "no stage": (*without(STAGES), "[[profile]]: nothing moves, because no profile has"),
    "heat without stages": (BULB, "[model]\ntemperature = [60, 80]\n" + BULB.replace(STAGES, "").replace(
        "bulk_modulus", "expansion = 2e-4\nbulk_modulus"), "[[profile]]: nothing moves, because no pro"),
    "stage no list": (STAGES, "[profile.stage]\nsteps = 3\n", "profile.stage must be a list of tables"),
    "some steps": (*without("steps = 60\n"), "load steps (steps), but [[profile]] 1 ('door'"
                   "): [[profile.stage]] 1 has none; give steps in all stages"),
    "other words": ("steps = 60", 'steps = "few"', 'of the stage that increase to 1.0, or "auto"'),
    "no shares": ("steps = 60", "steps = []", "steps = [], but it must be a whole number"),
    "shares back": ("steps = 60", "steps = [0.5, 0.4, 1.0]", "[0.5, 0.4, 1.0], but it must be a whole"),
    "shares to less": ("steps = 60", "steps = [0.5, 0.9]", "a list of fractions of the stage that inc"),
    "shares in words": ("steps = 60", 'steps = ["half", 1.0]', "['half', 1.0], but it must be a whole"),
    "tolerance of none": ("[optimize]", "[steps]\ntolerance = 0.01\n[optimize]", "[steps]: tolerance "
                          "has no effect, because all stages have steps"),
    "tolerance too large": (BULB, OPEN + "[steps]\ntolerance = 1.5\n", "tolerance = 1.5, but it must be "
                            "a number above 0 and at most 1"),
    "tolerance misspelt": (BULB, OPEN + "[steps]\ntoleranc = 0.1\n", "(did you mean 'tolerance'?)"),
    "tolerances": (BULB, OPEN + "[[steps]]\ntolerance = 0.1\n", "[steps] must be one table"),
    "uneven stages": (BULB, OPEN[: OPEN.index("[[measure]]")].replace(
        "[[design]]", OTHER + "stage = [{ translate = [0.0, -1.0] }]\n[[design]]"),
        "'door' has 2 stages ([[profile.stage]]), but 'other' has 1; stages without steps run"),
    "steps of a fluid": (BULB, OPEN.replace(FIXED, FIXED + FLUID), "[[fluid]] 1: steps = 20 cannot be"),
    "half a step": ("steps = 60", "steps = 60.5", "[[profile.stage]] 1: steps = 60.5, but it must be a"),
    "zero steps": ("steps = 60", "steps = 0", "steps = 0, but it must be a whole number from 1 to"),
    "travel a number": ("translate = [2.0, 0.0]", "translate = 2.0", "[[profile.stage]] 2: translate "),
    "rotate NaN": ("rotate = 0.0", "rotate = nan", "[[profile.stage]] 2: rotate = nan, but it must be"),
    "stage misspelt": ("rotate =", "rotat =", "unknown key 'rotat' (did you mean 'rotate'?)"),
    "uneven steps": (PROFILE, PROFILE + SECOND.replace("steps = 20", "steps = 30"),
                     "the key 'profile' is missing; with several profiles it must be one of door, wall"),
    "uneven steps alone": (BULB, (BULB[: BULB.index("[[measure]]")]).replace(
        PROFILE, PROFILE + SECOND.replace("steps = 20", "steps = 30")),
        "the stages of 'door' have 80 steps in all and those of 'wall' 90; they must be equal"),
    # design
    "no bound": (*without("bound = 0.5\n"), "[[design]] 1: the key 'bound' is missing; it must be a n"),
    "bound zero": ("bound = 0.5", "bound = 0", "[[design]] 1: bound = 0, but it must be a number above"),
    "no parameters": ("parameters = 12", "parameters = 0", "[[design]] 1: parameters = 0, but it must"),
    "design unknown": ('["seal", "cavity"]', '["seals"]', "[[design]] 1: edges = 'seals', but there is"),
    "design fixed": ('["seal", "cavity"]', '["base"]', "[[design]] 1: the list edges contains 'base'"),
    "design twice": ("[[measure]]", '[[design]]\nedges = ["seal"]\nparameters = 3\nbound = 0.1\n'
                     "[[measure]]", "[[design]] 2: the edge 'seal' is already in [[design]] 1"),
    # too many
    "measures": ("[optimize]", f"[[measure]]\n{WIDTH}\n" * 10_000 + "[optimize]",
                 "[[measure]]: 10001 tables are more than the limit of 10000"),
    "points": (DOOR, f"line = [{'[-40.0, 0.0], [40.0, 0.0], ' * 50_000}]",
               "[[profile]] 1 ('door'): line: 100000 points are more than the limit of 20000"),
    # measure
    "no type": (*without('type = "contact_width"\n'), "[[measure]] 1: the key 'type' is missing; it m"),
    "unknown type": ('"contact_width"', '"width"', "[[measure]] 1: type = 'width', but it must be one"),
    "type a number": ('"contact_width"', "3", "[[measure]] 1: type = 3, but it must be one of reaction"),
    "unknown profile": ('profile = "door"', 'profile = "dor"', "[[measure]] 1: profile = 'dor', but "
                        "there is no such profile (did you mean 'door'?); there is door"),
    "argument of another type": (WIDTH, WIDTH + "\norder = 4", "[[measure]] 1: unknown key 'order'"),
    "order one": (WIDTH, 'type = "peak_pressure"\norder = 1', "order = 1, but it must be a whole numb"),
    "no exponent": (
        WIDTH, 'type = "pressure_integral"', "[[measure]] 1: the key 'exponent' is missing"
    ),
    "exponent too small": (
        WIDTH, 'type = "pressure_integral"\nexponent = 0.5\nreference_pressure = 100.0', "exponent"
    ),
    "no roughness": (WIDTH, 'type = "leak_rate"', "[[measure]] 1: the key 'rms_roughness' is missing"),
    "wavelengths in disorder": (WIDTH, LEAK + "\nlongest_wavelength = 100.0", "the wavelengths "
                                "of the roughness must satisfy shortest_wavelength <"),
    "no pressure to leak": (WIDTH, LEAK.replace("10.0", "0.0"), "[[measure]] 1: pressure = 0.0, but it "
                            "must be a number above 0 and at most 1e+09 (kPa)"),
    "Hurst exponent of a line": (WIDTH, LEAK + "\nhurst_exponent = 1.0", "[[measure]] 1: hurst_exponent "
                                 "= 1.0, but it must be a number of at least 0.01 and at most 0.99"),
    "leak of no profile": (WIDTH, LEAK + '\nprofile = "dor"', "[[measure]] 1: profile = 'dor', but"),
    "component z": (WIDTH, 'type = "reaction"\ncomponent = "z"', "component = 'z', but it must be one"),
    "component and direction": (WIDTH, REACTION + '\ncomponent = "y"\ndirection = [0.0, 1.0]',
                                "[[measure]] 1: the keys component and direction are given together"),
    "no direction of a force": (WIDTH, REACTION + "\ndirection = [0.0, 0.0]", "direction = [0.0, 0.0], "
                                "but it must be a direction [x, y] that is not [0, 0], or \"travel\""),
    "travel beyond the path": (WIDTH, REACTION + "\ntravel = [1.0, 8.5]", "[[measure]] 1: travel = 8.5, "
                               "but the total travel of the profile 'door' is only 8 mm"),
    "travel backwards": (WIDTH, REACTION + "\ntravel = -1.0", "travel = -1.0, but it must be a travel"),
    "no travels": (WIDTH, REACTION + "\ntravel = []", "travel = [], but it must be a travel along"),
    "no length": (WIDTH, REACTION + "\nlength = 0.0", "length = 0.0, but it must be a number above 0"),
    "two choices of stress": (WIDTH, STRESS + "\ncount = 2\nat = [[0.0, 14.0]]",
                              "[[measure]] 1: the keys at and count are given together"),
    "bound of chosen stresses": (WIDTH, STRESS + "\ncount = 2\nexcess = 0.1", "the key excess "
                                 "applies only to the maximum over the complete section"),
    "wide excess": (WIDTH, STRESS + "\nexcess = 1.5", "excess = 1.5, but it must be a number above 0"),
    "gaps of another seal": (WIDTH, 'type = "gap_square_sum"\npoints = "drawn"', "points = 'drawn', but "
                             "it must be one of design, nominal"),
    "no point": (WIDTH, 'type = "displacement"', "[[measure]] 1: the key 'at' is missing; it must be a"),
    "a wall of one side": (WIDTH, 'type = "wall_thickness"\nedges = ["base"]',
                           "the keys edges and opposite are the two sides of a wall"),
    "a wall of no edge": (WIDTH, 'type = "wall_thickness"\nedges = ["base"]\nopposite = ["hole"]',
                          "opposite = 'hole', but there is no such edge"),
    "a wall that ends": (WIDTH, 'type = "wall_thickness"\nedges = ["base"]\nopposite = ["seal"]',
                         "base and seal share a point, where the thickness is zero"),
    "a wall of air": (WIDTH, 'type = "wall_thickness"\nedges = ["cavity"]\nopposite = ["cavity"]',
                      "cavity and cavity share a point"),
    "a wall across a hole": ('[[section.hole]]\nedge = "cavity"\n' + CIRCLE, SQUARE + ACROSS,
                             "[[measure]] 1: cavity and right face each other across a gap"),
    "no cavity": (WIDTH, 'type = "cavity_area"\nedge = "seal"', "is not the complete boundary of"),
    "unknown cavity": (WIDTH, 'type = "cavity_area"\nedge = "hole"', "edge = 'hole', but there is no "),
    "same measures": ("[optimize]", f"[[measure]]\n{WIDTH}\n[optimize]", "[[measure]] 2: name = 'cont"),
    "odd measure name": (WIDTH, WIDTH + '\nname = "1st"', "name = '1st', but it must be a name of let"),
    # optimize
    "nothing to minimise": (*without('minimize = "section_area"\n'), "[optimize]: the key 'minimize' "),
    "unknown aim": ('"section_area"', '"weight"', "[optimize]: minimize = 'weight', but there is no "
                    "such measure; it must be the name of a [[measure]] (contact_width)"),
    "aim misspelt": ('"section_area"', '"section_aera"', "(did you mean 'section_area'?)"),
    "aim with several values": ('"section_area"', '"gap"', "has several values; minimise a"),
    "aim needs more": ('"section_area"', '"cavity_area"', "[optimize]: minimize = 'cavity_area': the "
                       "key 'edge' is missing; it must be a text that is not empty; add a [[measure"),
    "aim needs two": ('"section_area"', '"retained_force"', "[optimize]: minimize = 'retained_force': "
                      "the key stage or time must have two numbers"),
    "aim of several profiles": ("[[profile]]", OTHER + "[[profile]]",
                                "[[optimize.constraint]] 1: measure = 'reaction': the key 'profile' is "
                                "missing; with several profiles it must be one of other, door; add a "
                                "[[measure]] of this type with its keys"),
    "aim beside a fluid": ('[optimize]\nminimize = "section_area"', FLUID + '[optimize]\nminimize = "'
                           'friction_work"', "[optimize]: minimize = 'friction_work': type = 'fricti"),
    "no bounds": (*without("lower = 40.0\nupper = 60.0\n"), "[[optimize.constraint]] 1: a constraint "),
    "bounds the other way": ("lower = 40.0", "lower = 70.0", "lower = 70 is above the upper limit"),
    "bound a text": ("lower = 40.0", 'lower = "40"', "[[optimize.constraint]] 1: lower = '40', but it"),
    "constraint unknown": ('"reaction"', '"raction"', "[[optimize.constraint]] 1: measure = 'raction'"),
    "constraint no list": ("[[optimize.constraint]]", "[optimize.constraint]", "optimize.constraint m"),
    "maximize": ("minimize =", "maximize =", "unknown key 'maximize' (did you mean 'minimize'?)"),
}  # fmt: skip

SCHEMA = json_schema()
OF_A_FORM = re.compile(
    r"unknown (key|table)|but it must be|is missing; it must be|\] is missing$|is empty|must be one "
    r"table|must be a list of tables|(tables|points) are more than|a key of a single material"
)
"""Words of the lines for what a schema can see."""
FINER = {
    "odd name", "odd measure name", "stable no range", "shares back", "shares to less",
    "no direction of a force", "uneven steps", "constant infinite",
    "aim needs more",
}  # fmt: skip
"""Forms that a schema does not describe to the end."""


@pytest.mark.parametrize("name", BAD)
def test_what_a_file_cannot_say_is_refused_in_one_line(tmp_path, name, refusing_script, capsys):
    old, new, words = BAD[name]
    assert old in BULB
    path = tmp_path / "seal.toml"
    text = BULB.replace(old, new, 1)
    path.write_text(text)
    with pytest.raises(sm.SealFileError, match=re.escape(words)) as caught:
        sm.read_seal_file(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) - len(str(path)) < 450
    assert caught.value.__cause__ is None
    assert refusing_script(path, capsys).endswith(str(caught.value))
    if "not valid TOML" not in words:  # editors see what is wrong in the form, and nothing else
        of_a_form = OF_A_FORM.search(str(caught.value)) is not None and name not in FINER
        assert fits(tomllib.loads(text), SCHEMA, SCHEMA) != of_a_form


def test_an_objective_at_a_profile_needs_a_profile(tmp_path):
    """Without any profile the cure is a profile, not keys of the measure."""
    moved = '[[moved]]\nedges = ["base"]\n[[moved.stage]]\ntranslate = [0.0, 1.0]\nsteps = 2\n'
    path = tmp_path / "seal.toml"
    path.write_text(
        BULB[: BULB.index("[fixed]")] + moved + '[optimize]\nminimize = "largest_gap"\n'
    )
    with pytest.raises(
        sm.SealFileError,
        match=r"\[optimize\]: minimize = 'largest_gap': .* or leave out this measure$",
    ):
        sm.read_seal_file(path)


WRONG = (
    3, -1.5, True, nan, inf, 10**400, "", "x", "\0gap", [], [1], [[1]], ["a"], [{}], {}, {"a": 1},
    [{"type": "gap"}], {"law": "yeoh", "data": 3}, date(2000, 1, 1),
)  # fmt: skip


def places(given, before=()):
    """Keys that lead to every value of a file."""
    for key, own in given.items() if isinstance(given, dict) else enumerate(given):
        yield (*before, key)
        if isinstance(own, dict | list):
            yield from places(own, (*before, key))


@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: repr(wrong)[:20])
def test_any_value_anywhere_gives_one_line_or_is_read(wrong):
    lines = []
    for *before, last in places(tomllib.loads(BULB)):
        given = tomllib.loads(BULB)
        reduce(getitem, before, given)[last] = wrong
        try:
            checked(TypeAdapter(Written), given)
        except sm.SealFileError as error:
            lines.append(str(error))
    assert len(lines) > 50
    assert max(map(len, lines)) < 450
    assert "\n" not in "".join(lines)


def test_files_that_are_none(tmp_path):
    with pytest.raises(sm.SealFileError, match="there is no such file"):
        sm.read_seal_file(tmp_path / "none.toml")
    with pytest.raises(sm.SealFileError, match=r"cannot be read \(Is a directory\)"):
        sm.read_seal_file(tmp_path)
    path = tmp_path / "binary.toml"
    path.write_bytes(b"[fixed]\nedges = \xff")
    with pytest.raises(
        sm.SealFileError, match=r"not a text file in UTF-8 \(first invalid byte: 16\)"
    ):
        sm.read_seal_file(path)


def test_a_section_in_metres_is_recognised(tmp_path):
    """Its segments are too short, and the message says that lengths are in mm."""
    text = (Path(__file__).parent / "bulb.toml").read_text()
    for old, new in (
        ("[[-4.0, 0.0], [4.0, 0.0]]", "[[-0.004, 0.0], [0.004, 0.0]]"),
        ("start = [4.0, 0.0], through = [0.0, 14.0], end = [-4.0, 0.0]",
         "start = [0.004, 0.0], through = [0.0, 0.014], end = [-0.004, 0.0]"),
    ):  # fmt: skip
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "metres.toml"
    path.write_text(text)
    words = "0.008 mm long; .* only 0.014 mm in size; lengths must be in mm .are these in metres"
    with pytest.raises(sm.SealFileError, match=words):
        sm.read_seal_file(path)


def test_a_short_segment_of_a_section_of_usual_size_is_no_matter_of_units(tmp_path):
    text = (Path(__file__).parent / "bulb.toml").read_text()
    old = "line = [[-4.0, 0.0], [4.0, 0.0]]"
    divided = "[[-4.0, 0.0], [-3.999, 0.0]]", "[[-3.999, 0.0], [4.0, 0.0]]"
    new = '\n[[section.outer]]\nedge = "base"\n'.join(f"line = {own}" for own in divided)
    path = tmp_path / "short.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(sm.SealFileError, match=r"only 0.001 mm long; .* longer than 0.01 mm$"):
        sm.read_seal_file(path)


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("friction = 0.25", 'friction = { "1 side" = 0.2 }', "[[profile]] 1 ('door'): friction"),
        (FIXED, f'{FIXED}[[moved]]\nedges = ["1 side"]\n', "[[moved]] 1: edges"),
        (
            FIXED,
            f'{FIXED}[self_contact]\nfriction = 0.3\nedges = ["1 side"]\n'
            '[[self_contact.pair]]\nedges = ["1 side", "1 side"]\nfriction = 0.1\n',
            "[[self_contact.pair]] 1: edges",
        ),
    ],
)
def test_an_edge_whose_name_parameters_cannot_have(tmp_path, old, new, where):
    text = BULB.replace('"seal"', '"1 side"').replace(old, new)
    path = tmp_path / "side.toml"
    path.write_text(text)
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file(path)
    assert (
        f"{where}: parameters are named after the edge '1 side', which therefore needs a name of"
        in (str(caught.value))
    )


CORNERS = [(4.0, 0.0), (6.0, 10.0), (3.0, 14.0), (-3.0, 14.0), (-6.0, 10.0), (-4.0, 0.0)]
SEGMENTS = '[[section.outer]]\nedge = "'.join(
    f'{name}"\nline = [[{x}, {y}], [{u}, {v}]]\n'
    for name, (x, y), (u, v) in zip("abcde", CORNERS, CORNERS[1:], strict=False)
)
"""Five edges, a to e, from one end of the base to the other, in place of the arc."""


@pytest.mark.parametrize(
    ("contact", "fixed", "words"),
    [
        (["a", "c"], ["base"], "add 'b' between them, or a second [[profile]]"),
        (["e", "c", "a"], ["base"], "add 'b', 'd' between them, or a second"),
        (["a", "e"], ["base"], "add 'b', 'c', 'd' between them, or a second"),
        (
            ["b", "d"],
            ["base", "c"],
            "of the boundary; add a second [[profile]] with the same curve",
        ),
        (
            ["b", "cavity"],
            ["base"],
            "of the boundary; add a second [[profile]] with the same curve",
        ),
    ],
)
def test_edges_that_are_missing_between_edges_in_contact_are_named(tmp_path, contact, fixed, words):
    text = BULB.replace(f'"seal"\n{ARC}\n', f'"{SEGMENTS}').replace(
        'contact = ["seal"]', f"contact = {contact}"
    )
    text = text.replace('edges = ["seal", "cavity"]', 'edges = ["cavity"]')
    (tmp_path / "seal.toml").write_text(text.replace('["base"]', str(fixed)))
    with pytest.raises(
        sm.SealFileError, match=re.escape("is not one connected part of the boundary")
    ) as caught:
        sm.read_seal_file(tmp_path / "seal.toml")
    assert words in str(caught.value)
