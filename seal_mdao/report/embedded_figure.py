"""Figures of matplotlib as HTML that needs no other file."""

from base64 import b64encode
from html import escape

from matplotlib.figure import Figure

from seal_mdao.plotting.style import png

DPI = 160


def embedded(figure: Figure, text: str) -> str:
    """Format a figure as an HTML element with its image as a data address and a text for readers."""
    image = b64encode(png(figure, DPI)).decode("ascii")
    return (
        f'<figure><img src="data:image/png;base64,{image}" alt="{escape(text)}" '
        'style="max-width:100%"></figure>'
    )


def figure_section(figure: Figure, name: str, title: str, note: str) -> str:
    """Format a figure as a section of the report with a title and a note; ``name`` is its identifier."""
    return (
        f'<section aria-labelledby="{name}-title"><h2 id="{name}-title">{escape(title)}</h2>'
        f'{embedded(figure, title)}<p class="note">{escape(note)}</p></section>'
    )
