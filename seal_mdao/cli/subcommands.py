"""Dispatch of the command ``seal-mdao``: subcommands, general help, version."""

import argparse
import gc
import sys
from difflib import get_close_matches
from importlib import import_module

from seal_mdao._version import __version__
from seal_mdao.cli.garbage_collection import collect_less
from seal_mdao.cli.one_line_parser import OneLineParser

COMMANDS = {
    "new": "write a commented seal file to start from, or one from a DXF drawing",
    "keys": "list the tables and keys of seal files with units",
    "check": "check a seal file, draw the section and its particles, estimate the computing time",
    "refine": "choose a particle spacing for a given accuracy of the results",
    "analyze": "analyse a seal: forces, contact, stresses, figures, CSV files",
    "studio": "change a seal in the browser by dragging, with immediate estimates of the forces",
    "optimize": "optimise the shape of a seal as specified in its seal file",
    "study": "compute the scatter of the results due to manufacturing tolerances (random samples)",
    "robust": "optimise a seal under manufacturing tolerances and compare it with the nominal "
    "optimum",
    "sweep": "analyse a seal for several values of one number; draw curves and results",
    "compare": "compare seals: load-deflection, contact pressure and sections in one figure",
    "animate": "make an animation of the closing of a seal",
    "materials": "list material constants of rubber by Shore A hardness and of foam by ASTM D1056 "
    "grade",
    "fit": "fit material constants of a rubber to test data",
    "calibrate": "identify material constants or friction of a seal from its measured force",
    "report": "write an HTML report of an optimisation from its recorder file",
    "history": "draw figures of an optimisation from its recorder file",
    "examples": "list the example seal files, or copy one",
}
"""Subcommands, in the order of use; each is a module of this folder with ``main`` and
``arguments_parser``."""


def main(argv=None) -> int:
    """Run one subcommand.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments; those of the process when left out.

    Returns
    -------
    int
        Exit status: 0, 1 for an analysis that did not converge or a file that cannot be written, 2 for
        wrong use, 130 after Ctrl-C.
    """
    argv = sys.argv[1:] if argv is None else list(argv)
    if argv and argv[0] in COMMANDS:
        try:
            return _run(argv[0], argv[1:])
        except KeyboardInterrupt:  # while modules are imported; ``run`` handles it afterwards
            print(f"seal-mdao {argv[0]}: interrupted", file=sys.stderr)
            return 130
    made = _general_parser()
    if not argv:
        # no subcommand: general help and the status of wrong use
        made.print_help()
        return 2
    # --help and --version, or the error for an unknown command
    near = get_close_matches(argv[0], COMMANDS, 1)
    if near and not argv[0].startswith("-"):
        made.error(f"there is no command {argv[0]!r} (did you mean {near[0]!r}?)")
    made.parse_args(argv)
    return 0


def _run(name: str, argv) -> int:
    """Run a subcommand, with usage and errors under its name."""
    # the numerics are imported only after the subcommand is known; modules are no garbage, and the
    # collector would traverse them repeatedly
    gc.disable()
    try:
        from seal_mdao.cli.arguments import run

        command = import_module(f"seal_mdao.cli.{name}")
        collect_less()
    finally:
        gc.enable()
    made = command.arguments_parser()
    made.prog = f"seal-mdao {name}"
    return run(made, command.main, argv)


def _general_parser() -> argparse.ArgumentParser:
    width = max(map(len, COMMANDS))
    listed = "\n".join(f"  {name:{width}}  {text}" for name, text in COMMANDS.items())
    made = OneLineParser(
        prog="seal-mdao", formatter_class=argparse.RawDescriptionHelpFormatter,
        usage="%(prog)s COMMAND [options]",
        description="Design rubber seals: analysis, sensitivities and optimisation of seal files.",
        epilog=f"commands:\n{listed}\n\nOptions of a command: seal-mdao COMMAND --help.\n"
        "Begin with: seal-mdao new bulb && seal-mdao check bulb.toml && seal-mdao analyze bulb.toml",
    )  # fmt: skip
    made.add_argument("--version", action="version", version=f"seal_mdao {__version__}")
    made.add_argument("command", choices=COMMANDS, metavar="COMMAND", help=argparse.SUPPRESS)
    return made
