"""Show a seal in the browser, where it is changed by dragging: forces at once to first order, then
exactly."""

import asyncio
import webbrowser
from pathlib import Path

from seal_mdao.cli.arguments import WrongArgumentError, parser

MISSING = (
    "seal-mdao studio needs the Python package tornado, which is not installed: pip install "
    "seal_mdao[studio]"
)


def main(arguments) -> int:
    try:
        from seal_mdao.studio.server import Studio
    except ImportError as error:
        raise WrongArgumentError(MISSING) from error
    from seal_mdao.studio.project import Project, ProjectError

    file = arguments.file
    try:
        project = Project(file.parent if file is not None else arguments.out)
        if file is not None and not project.path(file.name).is_file():
            raise WrongArgumentError(f"{file}: there is no such file")
        if file is not None and file.suffix != ".toml":
            raise WrongArgumentError(
                f"{file} is not a seal file (TOML); a drawing can be dropped on the page of "
                "seal-mdao studio without a file, or converted by seal-mdao new NAME --from DRAWING.dxf"
            )
    except ProjectError as error:
        raise WrongArgumentError(str(error)) from error
    try:
        asyncio.run(serve(Studio, project, arguments))
    except KeyboardInterrupt:
        print("closed")
    return 0


async def serve(studio_class, project, arguments) -> None:
    """Run the server until it is interrupted."""
    studio = studio_class(project, arguments.port)
    try:
        print(
            f"{studio.address}\nKeep this address secret: it gives access to your files. Ctrl-C "
            "stops the server.",
            flush=True,
        )
        if arguments.file is not None:
            studio.session.open(arguments.file.name)
        if not arguments.no_browser:
            webbrowser.open(studio.address)
        await asyncio.Event().wait()
    finally:
        studio.end()


def port(text: str) -> int:
    """Parse a port for argparse."""
    import argparse

    if not text.isdecimal() or not 0 <= int(text) < 65536:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port number (0 to 65535)")
    return int(text)


def arguments_parser():
    made = parser(__doc__, ".", "[FILE]", "seal-mdao studio bulb.toml")
    made.add_argument(
        "file", type=Path, nargs="?", metavar="FILE",
        help="seal file (TOML); the page reads and writes files in the folder of this file",
    )  # fmt: skip
    made.add_argument(
        "--port",
        type=port,
        default=0,
        metavar="N",
        help="TCP port of the local server; 0: any free port",
    )
    made.add_argument(
        "--no-browser",
        action="store_true",
        help="print the address of the page without opening a browser",
    )
    return made
