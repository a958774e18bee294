"""A finite difference that straddles a change of the contact sequence, along the door's radius."""

from pathlib import Path

import numpy as np
from verification.difference_cases import Case, at_step, case
from verification.differences import contact_states, measure_names

from figures.drawing import picture
from figures.tables import power, table
from seal_mdao.plotting.style import BLUE, GREY, VERMILION, signed

RADII = np.linspace(4.002, 4.006, 7)
PARAMETER = 25
AWAY = 5e-4
"""Distance from the change at which the differences are taken, mm."""
STEPS = (2e-3, 6e-4, 4e-4, 1e-5)


def _row(origin: Case) -> int:
    return measure_names(origin.result).index("gap_square_sum")


def slope(radius: float) -> float:
    """Analytic derivative of the sum of squared gaps in the door's radius."""
    found = case(radius)
    return found.analytic[_row(found), PARAMETER]


def find_change(radii, halvings: int) -> tuple[float, float]:
    """The two radii, near to each other, between which the derivative jumps most."""
    slopes = np.array([slope(r) for r in radii])
    first = int(np.argmax(np.abs(np.diff(slopes))))
    low, high = radii[first], radii[first + 1]
    below, above = slopes[first], slopes[first + 1]
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        value = slope(middle)
        if abs(value - below) < abs(value - above):
            low, below = middle, value
        else:
            high, above = middle, value
    return low, high


def changed_points(low: Case, high: Case) -> str:
    """Which contact states differ, in words."""
    words = ("open", "sticks", "slips")
    here, there = contact_states(low.result), contact_states(high.result)
    travel = low.result.travel
    return "; ".join(
        f"contact point {p}, {words[here[s, p]]} below and {words[there[s, p]]} above, in the step "
        f"to {travel[s]:.1f} mm"
        for s, p in np.argwhere(here != there)
    )


def make(out: Path, reduced: bool) -> dict:
    """Picture, table and numbers."""
    radii = RADII[::6] if reduced else RADII
    low, high = find_change(radii, 0 if reduced else 8)
    origin = case(low - AWAY)
    row = _row(origin)
    exact = origin.analytic[row, PARAMETER]
    rows, shown = [], {}
    for step in STEPS[2:4] if reduced else STEPS:
        found = at_step(origin, PARAMETER, "central", step)
        error = abs(found.value[row] / exact - 1.0)
        shown[step] = found.value[row]
        rows.append([power(step, 0), str(found.changed), f"{found.value[row]:.6f}", power(error)])
    _picture(out / "straddling.png", radii, (low, high), origin, shown)
    beyond = case(high)
    check = at_step(beyond, PARAMETER, "forward", 1e-6)
    head = ["step (mm)", "changed contact states", "difference quotient", "relative error"]
    return {
        "straddle_radius": f"{0.5 * (low + high):.6f}",
        "straddle_where": changed_points(case(low), beyond),
        "straddle_below": signed(slope(low), 4),
        "straddle_above": signed(slope(high), 4),
        "straddle_forward": signed(check.value[row], 4),
        "straddle_table": table(head, rows),
        "straddle_exact": f"{exact:.6f}",
    }


def _picture(path: Path, radii, change, origin: Case, quotients: dict) -> None:
    """The sum of squared gaps and its derivative over the radius, with the difference quotients."""
    low, high = change
    at = np.sort(np.concatenate([radii, change]))
    value = 1e3 * np.array([case(r).result.gap_square_sum for r in at])
    with picture(path, 1, 2, width=10.0, height=3.8) as panels:
        left, right = panels
        left.plot(at, value, "o-", color=BLUE, markersize=3)
        left.set_ylabel("sum of squared gaps ($10^{-3}$ mm²)")
        for side, label in ((at <= low, "analytic derivative"), (at >= high, None)):
            slopes = [slope(r) for r in at[side]]
            right.plot(at[side], slopes, "o-", color=BLUE, markersize=3, label=label)
        radius = origin.design.values[-1]
        for step, quotient in quotients.items():
            color = VERMILION if radius + step > high else GREY
            look = {"color": color, "linewidth": 1.4, "marker": "|", "markersize": 7}
            right.plot([radius - step, radius + step], [quotient, quotient], **look)
        right.plot([], [], color=VERMILION, marker="|", label="quotient across the kink")
        right.plot([], [], color=GREY, marker="|", label="quotient on one side")
        right.set_ylabel("derivative of this sum (mm)")
        for axes in panels:
            axes.axvline(0.5 * (low + high), color=GREY, linestyle=":", linewidth=1.0)
            axes.set(xlabel="door radius (mm)", xlim=(radii[0] - 3e-4, radii[-1] + 3e-4))
        left.figure.legend(loc="outside lower right", ncols=3)
