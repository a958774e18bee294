"""Input files for Abaqus, as the package writes them, analysed by CalculiX (ccx 2.20).

Not run by the usual tests. It exports the seal file beside it, runs ``ccx`` and writes the forces at the
ends of the steps to ``NAME.json``::

    apt-get install calculix-ccx
    PYTHONPATH=. python tests/verification/references/calculix.py exported_bulb

The input file is read as it is; a keyword or parameter that is not in ``KNOWN`` is an error. Only what
CalculiX does not have is translated:

- modified or hybrid triangles: plain quadratic triangles, so the bulk modulus must be moderate
- an analytical rigid surface: a layer of elements on the right of its segments, whose nodes are all
  prescribed
- a step: one step for every increment, so that a rotation is a sequence of short chords, and some
  increments without motion at the end, because CalculiX takes the pairs and the normals of contact from
  the start of an increment
- hard contact: pressure = stiffness * penetration
- D_i = 0 of a term of higher order, which CalculiX would replace by a value of its own: a large value

The reaction force RF is that of the support on the profile, the negative force of the seal. CalculiX
gives it for a sector of two degrees of a body of revolution.
"""

import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from seal_mdao.export.abaqus import write_abaqus
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_seal_file

STIFFNESS = 1e5
"""Contact pressure over penetration, kPa/mm: 1 um at 100 kPa."""
STICK = 0.1
"""Tangential over normal contact stiffness."""
ARC_TURN = np.pi / 90.0
"""Largest angle of the straight elements along an arc: their sagitta is 0.015 % of the radius."""
LAYER = 0.5
"""Thickness of the layer of elements behind a rigid surface, mm."""
NEAREST_AXIS = 1e-6
"""Radius at which rigid surfaces of revolution end, mm: CalculiX excludes contact faces at the axis."""
SECTORS = 180
"""Sectors of CalculiX in a body of revolution."""
LARGE_D = 1e20
"""D_i of a volumetric term (J - 1)^(2 i) / D_i without effect, 1/kPa."""
REFINEMENT = 1.5
"""Spacing of the seal file over that of the finest mesh."""
PER_LINE = 8
"""Numbers in a line of constants."""
LEAST_INCREMENT = 1e-5
DWELL = 4
"""Increments without motion at the end of every step: CalculiX takes the pairs and the normals of
contact from the start of an increment."""
ELEMENTS = {"CPE6MH": "CPE6", "CPE6M": "CPE6", "CAX6MH": "CAX6", "CAX6M": "CAX6"}
COMPONENTS = {1: 0, 2: 1, 6: 2}
"""Index in (x, y, angle) of the degrees of freedom of a reference node."""
UNUSED = {"HEADING", "OUTPUT", "NODE OUTPUT", "END STEP"}
KNOWN = {
    "NODE": set(), "ELEMENT": {"TYPE", "ELSET"}, "NSET": {"NSET"}, "ELSET": {"ELSET"},
    "SOLID SECTION": {"ELSET", "MATERIAL"}, "MATERIAL": {"NAME"},
    "HYPERELASTIC": {"MOONEY-RIVLIN", "NEO HOOKE", "YEOH", "OGDEN", "N"}, "HYPERFOAM": {"N"},
    "SURFACE": {"TYPE", "NAME"}, "RIGID BODY": {"ANALYTICAL SURFACE", "REF NODE", "TIE NSET"},
    "SURFACE INTERACTION": {"NAME"}, "FRICTION": set(), "CONTACT PAIR": {"INTERACTION", "TYPE"},
    "BOUNDARY": set(), "STEP": {"NAME", "NLGEOM", "INC"}, "STATIC": set(),
}  # fmt: skip
"""Keywords and their parameters."""


@dataclass
class Block:
    """A keyword, its parameters and its data lines."""

    keyword: str
    options: dict
    rows: list = field(default_factory=list)

    def lines(self, **changes) -> list[str]:
        """Write the block with other parameters."""
        options = self.options | changes
        words = [f"*{self.keyword}", *(f"{k}={v}" if v else k for k, v in options.items())]
        return [", ".join(words), *(", ".join(row) for row in self.rows)]


def blocks(text: str) -> list[Block]:
    """Divide an input file by its keywords; an unknown keyword or parameter raises a ValueError."""
    found = []
    for line in text.splitlines():
        if line.startswith("**"):
            continue
        words = [word.strip() for word in line.lstrip("*").split(",")]
        if not line.startswith("*"):
            found[-1].rows.append(words)
            continue
        options = dict(word.partition("=")[::2] for word in words[1:])
        if words[0] not in UNUSED and not (words[0] in KNOWN and set(options) <= KNOWN[words[0]]):
            raise ValueError(f"unknown keyword or parameter: {line}")
        found.append(Block(words[0], options))
    return found


def segments(rows: list) -> np.ndarray:
    """List points along the lines and arcs of a rigid surface, (k, 2)."""
    points = []
    for word, *numbers in rows:
        end = np.array(numbers[:2], float)
        if word == "CIRCL":
            # x(a) = c + r (cos a, sin a) from the last point to the end, less than half a circle
            centre = np.array(numbers[2:], float)
            (a, b), (c, d) = points[-1] - centre, end - centre
            turn = np.arctan2(a * d - b * c, a * c + b * d)
            count = int(np.ceil(abs(turn) / ARC_TURN))
            at = np.arctan2(b, a) + np.linspace(0.0, turn, count + 1)[1:]
            points += list(centre + np.hypot(c, d) * np.column_stack([np.cos(at), np.sin(at)]))
        elif word in ("START", "LINE"):
            points.append(end)
        else:
            raise ValueError(f"unknown segment: {word}")
    return np.array(points)


def outside_axis(points: np.ndarray) -> np.ndarray:
    """Cut a rigid surface of revolution at the axis."""
    kept = []
    for a, b in pairwise(points):
        # x = a + t (b - a) is at the axis for t = -a_x / (b_x - a_x)
        ends = [
            p if p[0] >= NEAREST_AXIS else p + (NEAREST_AXIS - p[0]) / (q[0] - p[0]) * (q - p)
            for p, q in ((a, b), (b, a))
            if max(a[0], b[0]) > NEAREST_AXIS
        ]
        kept += ends[len(kept) > 0 :]
    return np.array(kept)


def volumetric(block: Block) -> Block:
    """Replace D_i = 0 of higher order, the last N - 1 constants of a law, by a large value."""
    order = 3 if "YEOH" in block.options else int(block.options.get("N", 1))
    constants = [word for row in block.rows for word in row]
    for i in range(len(constants) - order + 1, len(constants)):
        constants[i] = constants[i] if float(constants[i]) else f"{LARGE_D:g}"
    rows = [constants[i : i + PER_LINE] for i in range(0, len(constants), PER_LINE)]
    return replace(block, rows=rows)


@dataclass
class Body:
    """A rigid surface: its nodes with those of bonded edges, and its reference node."""

    nodes: list
    reference: int = 0


class Deck:
    """An input file for CalculiX, made from one for Abaqus.

    Attributes
    ----------
    lines : list of str
    forces : dict
        Set of nodes whose reaction is printed, by the name of a set of reference nodes or of an edge.
    ends : dict
        Number of the last step of CalculiX in every step of the file, by its name.
    """

    def __init__(self, text: str, stiffness: float = STIFFNESS):
        self.stiffness, self.lines, self.ends = stiffness, [], {}
        self.nodes, self.sets, self.bodies, self.forces = {}, {}, {}, {}
        self.n_elements, self.axisymmetric = 0, False
        given = blocks(text)
        first = next(i for i, block in enumerate(given) if block.keyword == "STEP")
        for number, block in enumerate(given[:first]):
            self._model(block, given[number + 1])
        self._steps(given[first:])

    def _model(self, block: Block, following: Block) -> None:
        """Write a block before the steps."""
        own = block.options
        if block.keyword == "NODE":
            self.nodes |= {int(n): np.array(x, float) for n, *x in block.rows}
        elif block.keyword == "NSET":
            self.sets[own["NSET"]] = [int(n) for row in block.rows for n in row]
        if block.keyword == "ELEMENT":
            self.n_elements = max(self.n_elements, *(int(row[0]) for row in block.rows))
            self.axisymmetric |= own["TYPE"].startswith("CAX")
            self.lines += block.lines(TYPE=ELEMENTS[own["TYPE"]])
        elif block.keyword == "HYPERELASTIC":
            self.lines += volumetric(block).lines()
        elif block.keyword == "SURFACE" and own["TYPE"] == "SEGMENTS":
            self._layer(own["NAME"], segments(block.rows))
        elif block.keyword == "RIGID BODY":
            body = self.bodies[own["ANALYTICAL SURFACE"]]
            body.reference = int(own["REF NODE"])
            body.nodes += self.sets[own["TIE NSET"]] if "TIE NSET" in own else []
        elif block.keyword == "SURFACE INTERACTION":
            friction = following.rows[0][0] if following.keyword == "FRICTION" else None
            self._interaction(own["NAME"], friction)
        elif block.keyword == "CONTACT PAIR":
            if "" in block.rows[0]:
                raise ValueError("CalculiX has no contact of a surface with itself")
            self.lines += block.lines(TYPE="SURFACE TO SURFACE")
        elif block.keyword not in UNUSED | {"FRICTION"}:
            self.lines += block.lines()

    def _layer(self, name: str, points: np.ndarray) -> None:
        """Write the elements behind a rigid surface, whose outward normal is on the left."""
        points = outside_axis(points) if self.axisymmetric else points
        first = max(self.nodes) + 1
        behind = []
        for a, b in pairwise(points):
            # on the right of the tangent t: (t_y, -t_x)
            t = (b - a) / np.hypot(*(b - a))
            behind += [own + LAYER * np.array([t[1], -t[0]]) for own in (a, b)]
        new = dict(enumerate([*points, *behind], first))
        self.nodes |= new
        self.bodies[name] = Body(list(new))
        elements = {}
        for i in range(len(points) - 1):
            self.n_elements += 1
            back = first + len(points) + 2 * i
            elements[self.n_elements] = first + i, back, back + 1, first + i + 1
        kind = "CAX4" if self.axisymmetric else "CPE4"
        self.lines += [
            "*NODE", *(f"{n}, {x:.12g}, {y:.12g}" for n, (x, y) in new.items()),
            f"*ELEMENT, TYPE={kind}, ELSET={name}_LAYER",
            *(", ".join(map(str, (e, *own))) for e, own in elements.items()),
            # the elements move as rigid bodies: any elastic constants
            f"*MATERIAL, NAME={name}_LAYER", "*ELASTIC", "1., 0.",
            f"*SOLID SECTION, ELSET={name}_LAYER, MATERIAL={name}_LAYER", "1.,",
            # side 4 lies between the last and the first node
            f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{e}, S4" for e in elements),
        ]  # fmt: skip

    def _interaction(self, name: str, friction: str | None) -> None:
        """Write a contact law: p = k penetration, stick stiffness, Coulomb's friction."""
        self.lines += [f"*SURFACE INTERACTION, NAME={name}"]
        self.lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{self.stiffness:g}, 0."]
        if friction is not None:
            self.lines += ["*FRICTION", f"{friction}, {STICK * self.stiffness:g}"]

    def _steps(self, given: list[Block]) -> None:
        """Write a step for every increment of the steps of the file."""
        by_reference = {body.reference: body for body in self.bodies.values()}
        before, number = {}, 0
        for step, static, boundary in zip(given, given[1:], given[2:], strict=False):
            if step.keyword != "STEP":
                continue
            assert (static.keyword, boundary.keyword) == ("STATIC", "BOUNDARY")
            # total displacements (x, y, angle) at the end, by the set of nodes
            after = {name: np.full(3, np.nan) for name, *_ in boundary.rows}
            for name, component, last, value in boundary.rows:
                assert component == last
                after[name][COMPONENTS[int(component)]] = float(value)
            for name in after:
                body = by_reference.get(self.sets[name][0])
                nodes = self.sets[name] if body is None else body.nodes
                if name not in self.forces:
                    self.forces[name] = f"{name}_FORCE"
                    self.lines += [f"*NSET, NSET={name}_FORCE", *(f"{n}," for n in nodes)]
            increments = round(1.0 / float(static.rows[0][0]))
            # fractions of the motion, the last one several times
            for k in [*range(1, increments + 1), *[increments] * DWELL]:
                self.lines += [f"*STEP, NLGEOM, INC={step.options['INC']}", "*STATIC"]
                self.lines += [f"1., 1., {LEAST_INCREMENT:g}, 1.", "*BOUNDARY"]
                for name, end in after.items():
                    start = before.get(name, np.zeros(3))
                    self._prescribed(name, start + k / increments * (end - start), by_reference)
                for printed in self.forces.values():
                    self.lines += [f"*NODE PRINT, NSET={printed}, TOTALS=ONLY", "RF"]
                self.lines.append("*END STEP")
            before, number = after, number + increments + DWELL
            self.ends[step.options["NAME"]] = number

    def _prescribed(self, name: str, pose: np.ndarray, by_reference: dict) -> None:
        """Write the displacements of the nodes of a rigid surface, or of those of an edge."""
        body = by_reference.get(self.sets[name][0])
        if body is None:
            rows = [(name, c, u) for c, u in zip((1, 2), pose, strict=False) if np.isfinite(u)]
        else:
            # u = z + (Q - 1) (x - x_reference)
            cos, sin = np.cos(pose[2]), np.sin(pose[2])
            turn = np.array([[cos - 1.0, -sin], [sin, cos - 1.0]])
            arms = np.array([self.nodes[n] - self.nodes[body.reference] for n in body.nodes])
            moved = pose[:2] + arms @ turn.T
            rows = [
                (n, c, u[c - 1]) for n, u in zip(body.nodes, moved, strict=True) for c in (1, 2)
            ]
        self.lines += [f"{n}, {c}, {c}, {u:.12g}" for n, c, u in rows]

    def run(self) -> dict:
        """Run CalculiX: the negative reactions at the end of every step of the file, by the names of the
        step and of the set."""
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "seal.inp").write_text("\n".join(self.lines) + "\n", encoding="utf-8")
            done = subprocess.run(
                ["ccx", "seal"], cwd=folder, capture_output=True, text=True, check=False
            )
            printed = (Path(folder) / "seal.dat").read_text(encoding="utf-8")
        if "*ERROR" in done.stdout:
            raise RuntimeError(done.stdout[done.stdout.index("*ERROR") :])
        found = {}
        pattern = r"total force \(fx,fy,fz\) for set (\S+) and time +(\S+)\s+(\S+) +(\S+) "
        for name, time, x, y in re.findall(pattern, printed):
            found[name, float(time)] = np.array([float(x), float(y)])
        factor = -SECTORS if self.axisymmetric else -1
        return {
            step: {own: factor * found[printed, float(end)] for own, printed in self.forces.items()}
            for step, end in self.ends.items()
        }


def exported(file: SealFile, refinement: float = 1.0) -> str:
    """Export a seal file as it is, or with a fraction of its spacing."""
    section = replace(file.section, spacing=file.section.spacing / refinement)
    own = replace(file, section=section)
    with tempfile.TemporaryDirectory() as folder:
        left_out = write_abaqus(own, build_seal(own), Path(folder) / "seal.inp")
        assert not left_out, left_out
        return (Path(folder) / "seal.inp").read_text(encoding="utf-8")


def forces(text: str, stiffness: float = STIFFNESS) -> list[dict]:
    """Analyse an input file: forces of the seal (N/m, of a ring N) at the end of every stage, by the
    label of the profile or the name of the edge."""
    deck = Deck(text, stiffness)
    # mN of a ring to N
    unit = 1e-3 if deck.axisymmetric else 1.0
    return [
        {label.partition("_")[2].lower(): unit * force for label, force in own.items()}
        for step, own in deck.run().items()
        if step != "PRELIMINARY"
    ]


def change(one: list[dict], other: list[dict]) -> float:
    """Compute the largest change of a component of a force over the largest force of the stage."""
    return max(
        max(np.abs(own[label] - last[label]).max() for label in last)
        / max(np.hypot(*force) for force in last.values())
        for own, last in zip(one, other, strict=True)
    )


def rounded(stages: list[dict]) -> list[dict]:
    """Round forces to six digits."""
    return [
        {label: [float(f"{value:.6g}") for value in force] for label, force in own.items()}
        for own in stages
    ]


def main(name: str) -> None:
    file = read_seal_file(Path(__file__).with_name(f"{name}.toml"))
    coarse, fine = (exported(file, refinement) for refinement in (1.0, REFINEMENT))
    first = forces(coarse)
    print(name, first, flush=True)
    best = forces(fine)
    try:
        stiffer = change(forces(coarse, 3.0 * STIFFNESS), first)
    except RuntimeError as error:
        # CalculiX does not find every equilibrium with the stiffer contact
        print(error)
        stiffer = None
    found = {
        "stages_at_spacing_of_file": rounded(first),
        "stages": rounded(best),
        "change_by_last_refinement": round(change(first, best), 5),
        "change_by_three_times_the_penalty": None if stiffer is None else round(stiffer, 5),
        "spacing_mm": round(file.section.spacing / REFINEMENT, 6),
        "method": "quadratic triangles of the exported input file; penalty contact",
        "code": "CalculiX 2.20 (calculix.py)",
    }
    path = Path(__file__).with_name(f"{name}.json")
    path.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(found, flush=True)


if __name__ == "__main__":
    for given in sys.argv[1:]:
        main(given)
