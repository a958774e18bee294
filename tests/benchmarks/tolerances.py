"""Keep what a tolerance study and a robust optimisation have found for the page on tolerances.

``python tests/benchmarks/tolerances.py STUDY ROBUST --out docs/benchmarks`` reads the folders of
``seal-mdao study`` and ``seal-mdao robust``. Not collected by pytest.
"""

import argparse
import json
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np

from seal_mdao.plotting.captions import today

DESIGNS = ("nominal", "robust")


def columns(file: Path) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of the measures, their values (n, M), and of each sample its seconds and when it ended."""
    with closing(sqlite3.connect(file)) as connection:
        names = [row[1] for row in connection.execute("PRAGMA table_info(results)")][5:]
        rows = connection.execute("SELECT * FROM results WHERE status = 'completed'").fetchall()
    values = np.array([row[5:] for row in rows], float)
    return names, values, np.array([row[3:5] for row in rows], float)


def rounded(values: np.ndarray) -> list:
    return [float(f"{value:.4g}") for value in values]


def main(study: Path, robust: Path, out: Path) -> None:
    summary = json.loads((robust / "summary.json").read_text(encoding="utf-8"))
    shapes, designs = {"nominal": summary["nominal"], "robust": summary}, {}
    for name in DESIGNS:
        names, values, times = columns(robust / f"{name}.sqlite")
        by_name = dict(zip(names, values.T, strict=True))
        wall = times[:, 1].max() - (times[:, 1] - times[:, 0]).min()
        designs[name] = {
            "gap": rounded(by_name["gap_square_integral"]),
            "reaction": rounded(by_name["reaction[1]"]),
            "boundary_offsets": shapes[name]["boundary_offsets"],
            "door_radius": shapes[name]["door_radius"],
            "both_busy": float(times[:, 0].sum() / (2.0 * wall)),
        }
    kept = (
        "reaction_band_N_per_m", "pressure_floor_kPa", "compared", "ratio_of_95_percent_gaps",
        "scenarios", "samples", "widen", "deviations", "model_evaluations",
    )  # fmt: skip
    found = {
        "date": today(),
        "study": json.loads((study / "summary.json").read_text(encoding="utf-8"))["measures"],
        "robust": {name: summary[name] for name in kept},
        "designs": designs,
    }
    text = json.dumps(found, separators=(",", ":"))
    (out / "tolerances.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", type=Path)
    parser.add_argument("robust", type=Path)
    parser.add_argument("--out", type=Path, default=Path("docs/benchmarks"))
    main(**vars(parser.parse_args()))
