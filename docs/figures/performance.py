"""How the cost grows with the cloud, drawn from the figures of the last benchmark."""

import json
import re
from pathlib import Path

import numpy as np

from figures.drawing import DOOR_SEAL, ROOT, picture
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.style import BLUE, GREY, VERMILION

BENCHMARKS = ROOT / "docs" / "benchmarks" / "benchmarks.json"


def _by_particles(table: dict, start: str) -> np.ndarray:
    """Particles and values of the rows whose name begins with ``start``, shape (2, n)."""
    found = [
        (int(size[1]) * int(size[2]), value)
        for name, value in table.items()
        if name.startswith(start) and (size := re.search(r"(\d+) x (\d+)", name))
    ]
    return np.array(sorted(found)).T


def make(out: Path, reduced: bool) -> dict:
    """Times of a load step and an iteration, and shares of the sensitivities, against particles."""
    figures = json.loads(BENCHMARKS.read_text(encoding="utf-8"))
    growth = figures["load steps of seals with many particles"]
    shares = figures["sensitivities of 8 steps"]
    with (
        captioned(DOOR_SEAL, figures["date"]),
        picture(out / "growth.png", 1, 2, width=10.0, height=3.8) as (left, right),
    ):
        for kind, color in (("load step", VERMILION), ("iteration", BLUE)):
            n, time = _by_particles(growth, kind)
            left.loglog(n, time, "o-", color=color, label=kind)
            left.loglog(n, time[0] * n / n[0], "--", color=GREY)
        left.plot([], [], "--", color=GREY, label="proportional to the number of particles")
        left.set(xlabel="particles", ylabel="time, ms")
        for method, color in (("direct", VERMILION), ("adjoint", BLUE)):
            right.semilogx(*_by_particles(shares, method), "o-", color=color, label=method)
        right.set(xlabel="particles", ylabel="sensitivities / analysis, 8 steps", ylim=(0.0, None))
        for axes in (left, right):
            axes.legend()
        left.figure.get_layout_engine().set(wspace=0.06)
    path = figures["analysis of 35 load steps"]["growth exponent"]
    return {"path_exponent": f"{path:.2f}"} | {
        kind: f"{growth[f'growth exponent, {name}']:.2f}"
        for kind, name in (("step", "load step"), ("iteration", "iteration"))
    }
