"""Initial and optimised design side by side (Figure 7)."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seal_mdao.plotting import field, section
from seal_mdao.plotting.deformation import panel_size
from seal_mdao.plotting.style import BLUE, GREY, styled, subplots
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import SealResult


@styled
def design_comparison(initial: SealResult, optimised: SealResult, numbers=("", "")) -> Figure:
    """Plot both undeformed sections in one panel, and the deformed ones with one colour scale.

    Parameters
    ----------
    initial, optimised : SealResult
        Completed analyses of two designs of one model.
    numbers : pair of str
        Text in the titles of both.

    Returns
    -------
    Figure
    """
    results = initial, optimised
    fines = [field.fine_grid(result) for result in results]
    shapes = [field.deformed(r, fine) for r, fine in zip(results, fines, strict=True)]
    undeformed = [field.undeformed(r, fine) for r, fine in zip(results, fines, strict=True)]
    # one scale and one window for both designs, so that colours and sizes compare
    scale = section.stress_scale(
        field.von_mises(*pair) for pair in zip(results, fines, strict=True)
    )
    low, high = section.window(shapes + undeformed)
    width, height = panel_size(low, high)
    figure, axes = subplots(1, 3, width=3 * width + 1.6, height=height + 1.2, sharey=True)
    # left panel: both undeformed shapes; right panels: deformed shapes with stress
    _draw_shapes(axes[0], results, fines, undeformed)
    section.frame(axes[0], low, high)
    axes[0].set_title("undeformed")
    for axis, result, fine, name, text in zip(
        axes[1:], results, fines, ("initial", "optimised"), numbers, strict=True
    ):
        contours = section.draw_stress(axis, result, fine, -1, scale)
        section.frame(axis, low, high)
        axis.set_title(f"{name}: {text}" if text else name)
        axis.set_ylabel("")
    # one legend for all panels: shapes of the first, contact points of the second
    handles, labels = axes[0].get_legend_handles_labels()
    points = axes[1].get_legend_handles_labels()
    figure.legend(
        handles + points[0], labels + points[1], loc="outside lower center", ncols=6,
    )  # fmt: skip
    bar = figure.colorbar(contours, ax=axes, shrink=0.85, aspect=28, pad=0.01)
    bar.set_label("von Mises stress (kPa)")
    return figure


def _draw_shapes(axes: Axes, results, fines, undeformed) -> None:
    section.draw_held(axes, results[0])
    section.fill_outline(axes, undeformed[1], fines[1].loops, color=BLUE, alpha=0.12, lw=0)
    looks = (("initial", GREY, "--", 1.2), ("optimised", BLUE, "-", 1.6))
    for result, fine, points, (name, color, style, width) in zip(
        results, fines, undeformed, looks, strict=True
    ):
        section.draw_outline(
            axes, points, fine.loops, color=color, linestyle=style, linewidth=width, label=name
        )
        for contact in contacts(result.seal):
            # profiles with parameters, as the radius of the door, show their values in the legend
            text = ", ".join(
                f"{key.replace('_', ' ')} {getattr(contact.shape, key):.2f} mm"
                for key in contact.shape.names
            )
            face = section.profile_face(result, contact, 0.0)
            axes.plot(*face.T, color=color, linestyle=style, linewidth=1.2, label=text or None)
