"""The lip of the examples, folded on its body."""

from pathlib import Path

import seal_mdao as sm
from figures.seal_files import begun
from seal_mdao.contact.friction import OPEN
from seal_mdao.plotting import field
from seal_mdao.plotting.section import draw_held, draw_profiles, fill_outline, frame, window
from seal_mdao.plotting.style import BLUE, VERMILION, save, styled, subplots

FILE = Path(__file__).resolve().parents[2] / "examples" / "folded_lip.toml"
SHARES = 0.25, 0.5, 0.86, 1.0
"""Of the load steps, at which the lip is drawn."""

ROOM = 1.5
"""For the rod above the lip, mm."""


def make(out: Path, reduced: bool) -> dict:
    """The picture, and how many points touch."""
    file = sm.read_seal_file(FILE)
    result = sm.analyze(sm.build_seal(begun(file) if reduced else file))
    result.require_converged()
    save(fold_picture(result), out / "self_contact.png")
    answers = result.path.at_nominal("self_contact")
    return {"touching": max(int((answer.branch != OPEN).sum()) for answer in answers)}


@styled
def fold_picture(result):
    """The lip on its way down."""
    figure, panels = subplots(1, len(SHARES), width=12.0, height=2.6)
    fine, last = field.fine_grid(result), len(result.path.nominal_steps) - 1
    low, high = window([field.deformed(result, fine, round(share * last)) for share in SHARES])
    high = high[0], high[1] + ROOM
    for axes, share in zip(panels, SHARES, strict=True):
        step = round(share * last)
        fill_outline(
            axes, field.deformed(result, fine, step), fine.loops, facecolor=BLUE, alpha=0.35,
            edgecolor=BLUE,
        )  # fmt: skip
        draw_held(axes, result)
        draw_profiles(axes, result, step + 1.0)
        answer = result.response("self_contact", result.path.nominal_steps[step])
        axes.plot(*answer.x[answer.branch != OPEN].T, ".", color=VERMILION, markersize=5)
        frame(axes, low, high)
        axes.set_title(f"step {step + 1}")
    return figure
