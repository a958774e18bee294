"""Figure of the undeformed section: cloud, named edges, and profiles at the start."""

import numpy as np
from matplotlib.figure import Figure
from shapely import box

from seal_mdao.plotting import field, section
from seal_mdao.plotting.deformation import panel_size
from seal_mdao.plotting.style import CYCLE, LIGHT_GREY, styled, subplots
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import SealResult


@styled
def section_cloud(result: SealResult) -> Figure:
    """Plot particles, background cells, edges by name, and the profiles at the start.

    Parameters
    ----------
    result : SealResult
        Its undeformed section is plotted.

    Returns
    -------
    Figure
    """
    seal, particles = result.seal, result.particles
    fine = field.fine_grid(result, 1)
    faces = [section.profile_face(result, contact, 0.0) for contact in contacts(seal)]
    low, high = _window(particles, faces)
    width, height = panel_size(low, high)
    figure, axes = subplots(width=1.35 * width + 2.2, height=1.35 * height + 0.6)
    corners = particles[seal.body.cells]
    # one line a cell: axes.plot takes arrays (5 points, m cells) of x and of y
    closed = np.concatenate([corners, corners[:, :1]], axis=1)
    axes.plot(*closed.transpose(2, 1, 0), color="#C9C9C9", linewidth=0.5, zorder=2)
    section.fill_outline(
        axes, field.undeformed(result, fine), fine.loops, facecolor=LIGHT_GREY, alpha=0.25, lw=0
    )
    axes.plot(*particles.T, "o", color="#777777", markersize=_marker(len(particles)), zorder=3)
    for number, (name, edge) in enumerate(seal.body.edges.items()):
        line = particles[
            np.append(edge.particles, edge.particles[:1]) if edge.closed else edge.particles
        ]
        color = CYCLE[number % len(CYCLE)]
        axes.plot(*line.T, color=color, linewidth=2.4, label=name, zorder=4)
    fixed = particles[seal.body.fixed.any(axis=1)]
    axes.plot(*fixed.T, "s", color="black", markersize=3.5, zorder=5, label="fixed")
    section.draw_held(axes, result)
    section.draw_profiles(axes, result, 0.0)
    _name_profiles(axes, result, low, high)
    section.frame(axes, low, high)
    axes.set_title(f"{len(particles)} particles, {len(seal.body.cells)} cells", loc="left")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), title="edges", alignment="left")
    return figure


def _name_profiles(axes, result, low, high) -> None:
    """Write the name of each profile inside its visible part."""
    seen = box(*low, *high)
    for contact in contacts(result.seal):
        # buffer(0) makes the polygon valid for the intersection with the window
        body = section.profile_body(result, contact, 0.0).buffer(0.0).intersection(seen)
        if not body.is_empty:
            axes.text(
                *body.representative_point().coords[0], contact.label, ha="center", va="center",
                zorder=6, bbox={"facecolor": "white", "edgecolor": "none", "pad": 2.0},
            )  # fmt: skip


def _marker(count: int) -> float:
    """Choose the size of the dots: larger for fewer particles."""
    return float(np.clip(60.0 / np.sqrt(count), 0.8, 3.0))


def _window(particles, faces):
    """Compute the window around the section and nearby parts of the profiles."""
    low, high = section.window([particles], 0.2)
    # profiles extend far beyond the section: only their points within 20 % of its size count
    near = [face[((face >= low) & (face <= high)).all(axis=1)] for face in faces]
    return section.window([particles, *near], 0.1)
