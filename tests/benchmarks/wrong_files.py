"""The wrong files of the sweep: recorder files, seal files, drawings."""

from functools import partial
from pathlib import Path

import seal_mdao as sm
from seal_mdao.recording.evaluations import read_cases
from seal_mdao.recording.recorded_optimization import read_optimization

EXAMPLES = Path(__file__).parents[2] / "examples"
RECORDS = {
    "empty": b"", "text": b"no database", "database without a page": b"SQLite format 3\x00" + bytes(84),
    "zeros": bytes(4096),
}  # fmt: skip
SOUND = """[material.rubber]
law = "mooney_rivlin"
c10 = 500.0
c01 = 125.0
bulk_modulus = 400000.0
[section]
material = "rubber"
spacing = 0.4
[[section.outer]]
edge = "ring"
arc = { start = [0.0, 0.0], through = [3.0, 3.0], end = [0.0, 6.0] }
[[section.outer]]
edge = "middle"
line = [[0.0, 6.0], [0.0, 0.0]]
[[symmetry]]
edges = ["middle"]
normal = "x"
[[profile]]
name = "lid"
friction = 0.1
normal_penalty = 2e5
tangent_penalty = 2e3
contact = ["ring"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 6.0]
[[profile.stage]]
translate = [0.0, -1.5]
steps = 40
[[profile]]
name = "bottom"
friction = 0.1
normal_penalty = 2e5
tangent_penalty = 2e3
contact = ["ring"]
line = [[40.0, 0.0], [-40.0, 0.0]]
[[profile]]
name = "wall"
friction = 0.1
normal_penalty = 2e5
tangent_penalty = 2e3
contact = ["ring"]
line = [[3.5, 40.0], [3.5, -40.0]]
[[measure]]
type = "reaction"
profile = "lid"
[[measure]]
type = "reaction"
name = "on_the_wall"
profile = "wall"
component = "x"
[[measure]]
type = "peak_pressure"
profile = "lid"
"""
"""An O-ring in a groove: a seal file with nothing wrong."""
LINES = {
    'law = "mooney_rivlin"': ('law = "hooke"', "law = 3", ""),
    "c10 = 500.0": ("c10 = -1.0", "c10 = nan", "c10 = 1e300", 'c10 = "soft"', "c10 = [1.0]", ""),
    "bulk_modulus = 400000.0": ("bulk_modulus = 0.0", "bulk_modulus = 1e30", "bulk_modulus = inf"),
    "spacing = 0.4": (
        "spacing = 0.0", "spacing = -1.0", "spacing = nan", "spacing = 1e-9", "spacing = 1e300",
        "spacing = 0.001", 'spacing = "fine"', "spacing = true",
    ),
    "through = [3.0, 3.0]": ("through = [0.0, 3.0]", "through = [nan, 3.0]", "through = [3.0]"),
    "line = [[0.0, 6.0], [0.0, 0.0]]": ("line = [[0.0, 6.0], [0.0, 1.0]]", "line = []", "line = 3"),
    'normal = "x"': ('normal = "z"', "normal = 1", ""),
    'edges = ["middle"]': ('edges = ["midle"]', "edges = []", 'edges = "middle"'),
    "friction = 0.1": ("friction = -0.1", "friction = nan", "friction = 1e300"),
    "normal_penalty = 2e5": ("normal_penalty = 0.0", "normal_penalty = 1e300", "normal_penalty = 1.0"),
    'contact = ["ring"]': ('contact = ["rung"]', "contact = []"),
    "start = [0.0, 6.0]": ("start = [0.0, 5.0]", "start = [0.0, nan]", "start = 6.0"),
    "translate = [0.0, -1.5]": (
        "translate = [0.0, -1e300]", "translate = [0.0]",
        "translate = [0.0, -5.9]",
    ),
    "steps = 40": (
        "steps = 0", "steps = 2.5", "steps = 100000000", 'steps = "many"', "steps = []",
        "steps = [0.6, 0.5, 1.0]", "steps = [nan, 1.0]",
    ),
    'type = "peak_pressure"': ('type = "pressure"', "type = 3"),
    "[section]": ("[sektion]", "[[section]]", "[steps]\ntolerance = 0.1\n[section]"),
}  # fmt: skip
"""Lines of it, and what is put in their places."""
TEXTS = {
    "empty": b"", "no TOML": b"law: rubber", "binary": bytes(range(256)), "a comment": b"# nothing\n",
}  # fmt: skip
DRAWINGS = {"empty": b"", "text": b"no drawing", "zeros": bytes(4096)}


def file_cases(out: Path) -> list[tuple]:
    """Name and action of every file; an action returns a result or None."""
    found = []
    for name, content in RECORDS.items():
        path = _written(out / f"{name.replace(' ', '_')}.sql", content)
        for read in (read_optimization, read_cases):
            found.append((f"{read.__name__}: {name}", partial(_read, read, path)))
    texts = {
        f"{line} -> {other or 'left out'}": SOUND.replace(line, other).encode()
        for line, others in LINES.items()
        for other in others
    }
    for number, (name, content) in enumerate({**TEXTS, **texts}.items()):
        path = _written(out / f"{number}.toml", content)
        found.append((f"seal file: {name}", partial(_analysed, path)))
    whole = (EXAMPLES / "weatherstrip.dxf").read_bytes()
    cut = {f"cut at {share:.0%}": whole[: int(share * len(whole))] for share in (0.1, 0.5, 0.9)}
    for number, (name, content) in enumerate({**DRAWINGS, **cut}.items()):
        path = _written(out / f"{number}.dxf", content)
        found.append((f"drawing: {name}", partial(_read, sm.read_dxf, path)))
    for read in (sm.read_seal_file, sm.read_dxf, read_optimization):
        for path in (out, out / "nowhere"):
            name = "a folder" if path == out else "not there"
            found.append((f"{read.__name__}: {name}", partial(_read, read, path)))
    return found


def _written(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def _read(read, path) -> None:
    read(path)


def _analysed(path):
    return sm.analyze(sm.build_seal(sm.read_seal_file(path)))
