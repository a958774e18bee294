"""The live section in a notebook, in a frame."""

import asyncio
from html import escape
from pathlib import Path

from seal_mdao.studio.project import Project
from seal_mdao.studio.server import Studio


class Frame:
    """The page of a seal file, shown as the value of a cell.

    The server runs in the event loop of the notebook, on this machine: the browser has to run here, too.

    Parameters
    ----------
    path : str or Path
        Seal file.
    height : int
        Pixels.

    Raises
    ------
    RuntimeError
        Outside of a notebook.
    """

    def __init__(self, path, height: int = 900):
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            raise RuntimeError(
                "the page of seal_mdao.studio.notebook needs the event loop of a notebook; in a "
                "terminal use the command seal-mdao studio FILE"
            ) from None
        path, self.height = Path(path), height
        project = Project(path.parent)
        # a wrong name is refused before the server starts
        project.path(path.name)
        self.studio = Studio(project)
        self.studio.session.open(path.name)

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{escape(self.studio.address)}" width="100%" height="{self.height}" '
            'style="border: 0" title="seal-mdao studio"></iframe>'
        )

    def close(self) -> None:
        """End the server and its worker."""
        self.studio.end()


def show(path, height: int = 900) -> Frame:
    """Show a seal file in a notebook (``Frame``)."""
    return Frame(path, height)
