"""List the examples, or copy one with the files that it names."""

import shutil
import sys
from pathlib import Path

from seal_mdao.cli.arguments import WrongArgumentError, parser

INSTALLED = Path(sys.prefix) / "share" / "seal_mdao" / "examples"
"""Folder of the examples in an installed wheel; an editable installation has them beside the package."""


def main(arguments) -> int:
    folder = examples_folder()
    if arguments.name is None:
        # without a name: list all
        for path in sorted(folder.glob("*.toml")):
            print(f"{path.stem:24} {summary_of(path)}")
        return 0
    name = arguments.name.removesuffix(".toml")
    source = folder / f"{name}.toml"
    if not source.is_file():
        known = ", ".join(path.stem for path in sorted(folder.glob("*.toml")))
        raise WrongArgumentError(f"there is no example {name!r}; the examples are {known}")
    text = source.read_text(encoding="utf-8")
    # the drawings and data that the file names
    beside = [path for path in folder.iterdir() if path != source and f'"{path.name}"' in text]
    paths = [source, *sorted(beside)]
    # check all before copying any
    for path in paths:
        if (arguments.out / path.name).exists():
            raise WrongArgumentError(
                f"{arguments.out / path.name} already exists; remove it or choose another folder "
                "(--out)"
            )
    for path in paths:
        print(shutil.copy(path, arguments.out / path.name))
    return 0


def examples_folder() -> Path:
    """Find the folder of the example files.

    Raises
    ------
    WrongArgumentError
        When the installation has none.
    """
    # repository first, then the installed wheel
    for folder in (Path(__file__).parents[2] / "examples", INSTALLED):
        if (folder / "d_bulb.toml").is_file():
            return folder
    raise WrongArgumentError(
        f"the folder {INSTALLED} with the example seal files is missing; reinstall seal_mdao"
    )


def summary_of(path: Path) -> str:
    """Return the first comment line of a seal file."""
    first = path.read_text(encoding="utf-8").splitlines()[0]
    return first.lstrip("# ") if first.startswith("#") else ""


def arguments_parser():
    made = parser(__doc__, ".", "[NAME]", "seal-mdao examples d_bulb --out my_seal")
    made.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="name of the example to copy; default: list all examples",
    )
    return made
