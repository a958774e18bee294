"""The lip of the examples, folded on its body."""

from pathlib import Path

from figures.drawing import picture
from seal_mdao.contact.friction import OPEN
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import BLUE, VERMILION
from seal_mdao.seals.result import SealResult

FRACTIONS = 0.25, 0.5, 0.86, 1.0
"""Of the load steps, at which the lip is drawn."""
CLEARANCE = 1.5
"""For the rod above the lip, mm."""


def draw(path: Path, result: SealResult) -> dict:
    """Write the picture of the lip on its way down, and return how many points touch."""
    fine, responses = fine_grid(result), result.path.at_nominal("self_contact")
    steps = [round(fraction * (len(responses) - 1)) for fraction in FRACTIONS]
    low, high = section.window(map(fine.deformed, steps))
    high = high[0], high[1] + CLEARANCE
    with picture(path, 1, len(steps), width=12.0, height=2.6) as panels:
        for axes, step in zip(panels, steps, strict=True):
            section.draw_section(axes, fine, step, facecolor=BLUE, alpha=0.35, edgecolor=BLUE)
            touching = responses[step].x[responses[step].branch != OPEN]
            axes.plot(*touching.T, ".", color=VERMILION, markersize=5)
            section.frame(axes, low, high)
            axes.set_title(f"step {step + 1}")
    return {"touching": max(int((own.branch != OPEN).sum()) for own in responses)}
