"""Compare seals whose particles are chosen by ``accuracy = "1 %"`` with seals of half their spacing.

    python tests/benchmarks/chosen_particles.py --out docs/benchmarks

The forces of examples without creases. The choice starts with twice the spacing of the file and three
layers across walls. The finer seal has the same load steps and penalties. Writes
``chosen_particles.json``; takes minutes.
"""

import time
from pathlib import Path

from by_example import store

import seal_mdao as sm
from seal_mdao.accuracy.chosen_spacing import with_factor
from seal_mdao.file_seal import file_and_seal
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.read import read_changed

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = ("lip", "o_ring", "stretched_strip", "shaft_lip")
"""Examples whose force at the end is not zero, and that are analysed in seconds."""
START = 2.0
"""Spacing of the start over that of the file."""
ADMISSIBLE = "1 %"


def compared(name: str) -> dict:
    """Chosen particles of an example, with estimated errors and differences from half the spacing,
    relative."""

    def change(tables: dict) -> None:
        section = tables["section"]
        section.pop("layers", None)
        section["spacing"] *= START
        forces = [own for own in tables["measure"] if own["type"] == "reaction"]
        section["accuracy"] = {own.get("name", own["type"]): ADMISSIBLE for own in forces}

    tried, begun = [], time.process_time()
    path = EXAMPLES / f"{name}.toml"
    file, seal = file_and_seal(read_changed(path, change), report=tried.append)
    seconds = time.process_time() - begun
    result, found = sm.analyze(seal), chosen_for(file, seal)
    half = found | {"filling": with_factor(file.section.filling, 0.5)}
    finer = sm.analyze(file_and_seal(read_changed(path, change), **half)[1])
    rows = {}
    for measure in file.section.accuracy:
        own = tried[-1].estimates[measure]
        away = abs(result.value(measure) - finer.value(measure)).max() / own.scale
        rows[measure] = {"bar": _digits(own.bar.max() / own.scale), "difference": _digits(away)}
    return {
        "spacings_mm": [cloud.file.section.spacing for cloud in tried],
        "particles": [len(cloud.result.particles) for cloud in tried],
        "load_steps": seal.n_steps, "seconds": round(seconds, 1), "errors": rows,
    }  # fmt: skip


def _digits(value: float) -> float:
    return float(f"{value:.2g}")


def compared_or_failure(name: str) -> dict:
    """As ``compared``; the message where the choice or an analysis fails."""
    try:
        return compared(name)
    except (ValueError, sm.LoadPathError) as error:
        return {"failure": str(error)}


def main(argv=None) -> int:
    return store(compared_or_failure, NAMES, "chosen_particles.json", __doc__, argv)


if __name__ == "__main__":
    raise SystemExit(main())
