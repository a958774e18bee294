"""Forces of exported sections against those of CalculiX, which reads the exported input files.

The references are those of ``references/calculix.py``. Forces are in N/m, those of complete rings in N.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import leading_motion
from seal_mdao.seals.result import analyze

REFERENCES = Path(__file__).parent / "references"


def stage_forces(name: str, refinement: float = 1.0) -> list[dict]:
    """Analyze the seal file of a section, or with its spacing divided by ``refinement``: forces at the
    end of every stage, by label."""
    file = read_seal_file(REFERENCES / f"{name}.toml")
    section = replace(file.section, spacing=file.section.spacing / refinement)
    seal = build_seal(replace(file, section=section))
    result = analyze(seal)
    result.require_converged()
    ends = leading_motion(seal).ends
    steps = [int(np.abs(ends - n).argmin()) for n in range(1, int(ends[-1]) + 1)]
    labels = reference(name)["stages"][0]
    return [{label: result.path.reaction(label)[step] for label in labels} for step in steps]


def reference(name: str) -> dict:
    """Read the results of CalculiX."""
    return json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
