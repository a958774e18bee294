"""Where the scripts are, and the options of a model that is quick to analyse."""

from pathlib import Path

SCRIPTS = Path(__file__).parents[2] / "run_scripts"
CHEAP = ("--n-steps", "21")
