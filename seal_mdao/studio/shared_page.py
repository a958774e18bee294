"""HTML file to share: a design with its pictures, curves and comparison, without controls."""

import json

from seal_mdao.studio.assets_of import asset

SCRIPTS, STYLES = ("chart.js", "shape.js", "studio.js"), ("page.css", "studio.css")


def shared_page(file: str, scene: dict, exact: dict, kept: list, errors: dict | None) -> str:
    """Format the page, which needs no other file and no server.

    Parameters
    ----------
    file : str
        Name of the seal file.
    scene, exact, kept, errors
        As the pages of the server have them.
    """
    text = asset("studio.html")
    for name in STYLES:
        text = text.replace(
            f'<link rel="stylesheet" href="{name}">', f"<style>\n{asset(name)}</style>"
        )
    for name in SCRIPTS:
        text = text.replace(f'<script src="{name}" defer></script>\n', "")
    data = {"file": file, "scene": scene, "exact": exact, "kept": kept, "errors": errors}
    # names in a seal file are data: no tag of them ends the script
    data = json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    scripts = "\n".join(asset(name) for name in SCRIPTS)
    return text.replace(
        "</body>",
        f'<script type="application/json" id="shared">{data}</script>\n<script>\n{scripts}</script>\n'
        "</body>",
    )
