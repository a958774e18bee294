"""The run scripts as a user runs them: their pictures and what they print."""

import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

from figures.drawing import ROOT

COMMANDS = {
    "analysis": "analyze_door_seal.py --out out/analysis",
    "sensitivities": (
        "verify_sensitivities.py --parameters 2 25 --steps 1e-4 1e-5 1e-6 --repeats 2"
        " --out out/sensitivities"
    ),
    "optimization": "optimize_door_seal.py --out out/optimization",
    "history": "history out/optimization/cases.sql --out out/history",
}
"""Command lines in the order in which they run."""
REDUCED = {
    "analysis": " --n-steps 21",
    "sensitivities": " --n-steps 21 --parameters 25 --steps 1e-5 --repeats 1",
    "optimization": " --n-steps 21 --max-iterations 2",
    "history": "",
}


def make(out: Path, reduced: bool) -> dict:
    """Run the scripts in ``out/examples`` and keep their output as MyST fragments."""
    # scripts do not replace the results of another run
    shutil.rmtree(out / "examples", ignore_errors=True)
    for name, command in COMMANDS.items():
        write_example(name, command, out, reduced, REDUCED[name])
    return {"commands": str(len(COMMANDS))}


def write_example(name: str, command: str, out: Path, reduced: bool, less: str = "") -> None:
    """Run a script in ``out/examples``, in the reduced mode with the options ``less``; write its command
    line and its output as ``fragments/example_<name>.md``."""
    folder, fragments = out / "examples", out / "fragments"
    for own in (folder, fragments):
        own.mkdir(parents=True, exist_ok=True)
    printed = run(command + (less if reduced else ""), folder, reduced)
    shown = " \\\n    ".join(textwrap.wrap(f"$ {shown_command(command)}", 82))
    text = f"```text\n{shown}\n{printed.rstrip()}\n```\n"
    (fragments / f"example_{name}.md").write_text(text, encoding="utf-8")


def started(script: str) -> list[str]:
    """Start of the command line of a script, or of a subcommand of ``seal-mdao``."""
    if script.endswith(".py"):
        return [sys.executable, str(ROOT / "run_scripts" / script)]
    return [sys.executable, "-m", "seal_mdao", script]


def shown_command(command: str) -> str:
    """The command line as a user types it."""
    script = command.split()[0].endswith(".py")
    return f"python run_scripts/{command}" if script else f"seal-mdao {command}"


def run(command: str, folder: Path, unfinished: bool) -> str:
    """Return the output of a script; with ``unfinished`` an optimisation may end at its iteration limit.

    Raises
    ------
    RuntimeError
        When it fails.
    """
    script, *arguments = command.split()
    # the script runs in another folder: files of the repository by their full paths
    arguments = [str(ROOT / own) if (ROOT / own).is_file() else own for own in arguments]
    environment = {**os.environ, "OPENMDAO_REPORTS": "0", "OPENMDAO_WORKDIR": str(folder)}
    done = subprocess.run(
        [*started(script), *arguments], cwd=folder, env=environment,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode not in ((0, 1) if unfinished else (0,)) or not done.stdout:
        raise RuntimeError(f"{command} failed:\n{done.stdout}{done.stderr}")
    return done.stdout
