"""Sketches of the theory pages, drawn with the package's own functions."""

from pathlib import Path

import numpy as np

from figures.drawing import picture
from seal_mdao.contact.friction import STICK, ContactLaw, elastic_slip, traction
from seal_mdao.contact.kinematics import closest_point, contact_frame
from seal_mdao.geometry.profile import corner_profile, trace
from seal_mdao.plotting.style import BLUE, GREEN, GREY, LIGHT_GREY, ORANGE, VERMILION
from seal_mdao.rkpm.kernel import cubic_b_spline
from seal_mdao.rkpm.shape_functions import Cloud, PointSet
from seal_mdao.rkpm.tables import raw_tables


def make(out: Path, reduced: bool) -> dict:
    """All sketches; no numbers."""
    for draw in (shape_functions, contact_kinematics, friction_law, touch_point):
        draw(out / f"{draw.__name__}.png")
    return {}


# ---- section 2 ----


def row_functions(n: int = 9, points: int = 401):
    """Shape functions of the middle row of an n x 5 grid along that row, (points, n)."""
    x, y = np.meshgrid(np.arange(n), np.arange(5), indexing="ij")
    particles = np.column_stack([x.ravel(), y.ravel()]).astype(float)
    cloud = Cloud(particles, np.full(len(particles), 2.0), 2.0, 3)
    middle = np.flatnonzero(particles[:, 1] == 2)
    s = np.linspace(0, n - 1, points)
    left = np.minimum(s.astype(int), n - 2)
    weights = np.column_stack([1 - (s - left), s - left])
    along = PointSet(np.column_stack([middle[left], middle[left + 1]]), weights, 1)
    table = raw_tables(cloud, along)[0].raw
    values = np.zeros((points, len(particles)))
    point = np.repeat(np.arange(points), np.diff(table.start))
    values[point, table.neighbours] = table.phi
    return s, values[:, middle]


def shape_functions(path: Path) -> None:
    z = np.linspace(-1.15, 1.15, 401)
    s, values = row_functions()
    with picture(path, 1, 2, width=9.6, height=3.4) as (left, right):
        left.plot(z, [cubic_b_spline(abs(v))[0] for v in z], color=BLUE)
        left.set(xlabel="distance / support radius", ylabel="kernel $\\phi_a$")
        chosen, other = (VERMILION, 2.0, 3), (GREY, 0.9, 2)
        for i, column in enumerate(values.T):
            color, width, zorder = chosen if i == 4 else other
            right.plot(s, column, color=color, linewidth=width, zorder=zorder)
        nodes = {"color": "black", "markersize": 4, "clip_on": False, "zorder": 4}
        right.plot(np.arange(9), np.zeros(9), "o", **nodes)
        right.set(xlabel="position along the row / spacing", ylabel="$\\Phi_I$", ylim=(-0.03, None))


# ---- section 3 ----


def _arrow(axes, start, vector, text, color, offset=(0.0, 0.0)):
    axes.annotate(
        "", xy=np.add(start, vector), xytext=start,
        arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.6}, zorder=5,
    )  # fmt: skip
    axes.text(*(np.add(start, vector) + offset), text, color=color, fontsize=12, zorder=6)


def _projected(profile, x):
    piece, xi, g_n = closest_point(profile, *x)
    e_t, e_n, *_ = contact_frame(profile, piece, xi, g_n)
    return np.array(x) - g_n * np.array(e_n), np.array(e_t), np.array(e_n), g_n


def contact_kinematics(path: Path) -> None:
    profile = corner_profile(2.0, 4.0, 6.0)
    face = trace(profile, 0.05, 30.0)
    x, before = (3.7, 0.95), (2.2, 0.35)
    foot, e_t, e_n, _ = _projected(profile, x)
    foot_0 = _projected(profile, before)[0]
    with picture(path, width=6.4, height=4.0) as axes:
        body = np.vstack([face, [[30.0, 30.0], [-30.0, 30.0]]])
        axes.fill(*body.T, facecolor=LIGHT_GREY, edgecolor="none", zorder=1)
        axes.plot(*face.T, color="black", zorder=3)
        for ends, color, width, look in (
            ((foot, x), BLUE, 1.4, "-"), ((foot_0, before), GREY, 1.0, "--"),
        ):  # fmt: skip
            axes.plot(*np.array(ends).T, look, color=color, linewidth=width, zorder=4)
        axes.plot(*x, "o", color=BLUE, zorder=6)
        axes.plot(*before, "o", markerfacecolor="white", markeredgecolor=GREY, zorder=6)
        for point, color in ((foot, "black"), (foot_0, GREY)):
            axes.plot(*point, "o", color=color, markersize=4, zorder=6)
        _arrow(axes, foot, 0.9 * e_t, "$\\mathbf{e}_t$", VERMILION, (0.05, 0.05))
        _arrow(axes, foot, 0.9 * e_n, "$\\mathbf{e}_n$", GREEN, (-0.05, -0.25))
        for at, offset, text, color, size in (
            (x, (-0.12, 0.12), "$\\mathbf{x}$", BLUE, 12),
            (before, (-0.15, 0.12), "$\\mathbf{x}^0$", GREY, 12),
            (0.5 * (foot + np.array(x)), (-0.68, -0.12), "$g_n<0$", BLUE, 11),
            (foot, (0.4, -0.35), "$\\mathbf{x}_c(\\xi_c)$", "black", 11),
            (foot_0, (-0.3, -0.35), "$\\mathbf{x}_c(\\xi_c^0)$", GREY, 11),
            ((4.2, 2.6), (0.0, 0.0), "rigid profile", "black", 11),
        ):
            axes.text(*np.add(at, offset), text, color=color, fontsize=size)
        axes.set(aspect="equal", xlim=(0.0, 6.6), ylim=(-1.0, 3.2))
        axes.set_axis_off()


def slide(law, path, steps: int):
    """Slip and traction of a point that slides along ``path`` (n,) at unit penetration."""
    corners = np.concatenate([[0.0], path])
    fractions = np.linspace(0, len(path), steps + 1)
    xi = np.interp(fractions, np.arange(len(corners)), corners)
    carried, tau_history = 0.0, [0.0]
    for way in np.diff(xi):
        _, tau = traction(law, 0, -1.0, elastic_slip(-1.0, way, STICK, 1.0, carried))
        carried = tau / law.tangent_penalty if law.accumulated else 0.0
        tau_history.append(tau)
    return xi, np.array(tau_history)


def friction_law(path: Path) -> None:
    law, g = ContactLaw(1.0, 1.0, 0.25, True), np.linspace(-1, 1, 201)
    traction_label = "tangential traction $\\tau$"
    with picture(path, 1, 2, width=9.6, height=3.4) as (left, right):
        left.plot(g, [traction(law, 0, -1.0, v)[1] for v in g], color=BLUE, label="regularised")
        left.step([-1, 0, 1], [-0.25, -0.25, 0.25], color=GREY, linestyle="--", label="Coulomb")
        left.annotate("slope $\\omega_t$", (0.12, 0.12), xytext=(0.3, 0.05))
        left.annotate("$\\mu\\,\\omega_n|g_n|$", (0.6, 0.25), xytext=(0.45, 0.275))
        left.set(xlabel="slip $g_t$", ylabel=traction_label, ylim=(-0.33, 0.33))
        left.legend(loc="lower right")
        to_and_fro = np.array([0.6, -0.2, 0.1])
        for accumulated, steps, color, style, label in (
            (True, 300, BLUE, "-", "accumulated"),
            (False, 12, ORANGE, "-", "incremental, 12 steps"),
            (False, 48, VERMILION, "--", "incremental, 48 steps"),
        ):
            xi, tau = slide(law._replace(accumulated=accumulated), to_and_fro, steps)
            right.plot(xi, tau, color=color, linestyle=style, label=label)
        right.set_xlabel("position $\\xi$ of a point that slides 0 → 0.6 → −0.2 → 0.1")
        right.set(ylabel=traction_label, ylim=(-0.33, 0.48))
        right.legend(loc="upper left", ncols=2)


def touch_point(path: Path) -> None:
    gap = np.array([0.6, -0.4])
    # linear gap over the step: g_n = 0 at the fraction g_n^0 / (g_n^0 - g_n)
    share = gap[0] / (gap[0] - gap[1])
    with picture(path, width=6.4, height=3.4) as axes:
        axes.axhline(0.0, color="black", linewidth=1.0)
        axes.plot([0, 1], gap, color=BLUE, label="gap $g_n$")
        axes.plot([0, 1], [-0.2, 0.9], color=ORANGE, label="natural coordinate $\\xi_c$")
        axes.axvline(share, color=GREY, linestyle=":", linewidth=1.2)
        axes.axvspan(share, 1.0, color=ORANGE, alpha=0.12, linewidth=0)
        axes.plot(share, 0.0, "o", color=VERMILION, zorder=5)
        for text, at, offset, color in (
            ("touches", (share, 0.0), (6, 6), VERMILION),
            ("$g_n^0$", (0, gap[0]), (5, 4), BLUE), ("$g_n$", (1, gap[1]), (-22, 12), BLUE),
        ):  # fmt: skip
            axes.annotate(text, at, xytext=offset, textcoords="offset points", color=color)
        for x, text in ((0.5 * (1 + share), "sliding counts"), (0.5 * share, "open")):
            axes.text(x, 0.98, text, ha="center", color=GREY, fontsize=9.5)
        axes.set_xticks([0, share, 1], ["previous step", "$g_n^0/(g_n^0-g_n)$", "this step"])
        axes.set_yticks([0.0])
        axes.set(xlim=(0, 1), ylim=(-0.5, 1.08))
        axes.legend(loc="lower left", bbox_to_anchor=(0.22, 0.0))
