"""Parts of the page: HTML, style and scripts of the live section and of the report."""

from importlib.resources import files

ASSETS = {
    "studio.js": ("seal_mdao.studio", "text/javascript"),
    "studio.css": ("seal_mdao.studio", "text/css"),
    "chart.js": ("seal_mdao.report", "text/javascript"),
    "shape.js": ("seal_mdao.report", "text/javascript"),
    "page.css": ("seal_mdao.report", "text/css"),
}
"""Parts with the packages in whose folder ``assets`` they are, and their media types."""


def asset(name: str) -> str:
    """Return the text of a part of the page."""
    package = ASSETS[name][0] if name in ASSETS else "seal_mdao.studio"
    return (files(package) / "assets" / name).read_text(encoding="utf-8")
