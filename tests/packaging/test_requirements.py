"""What pyproject.toml asks for."""

import tomllib
from importlib.metadata import requires
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]


def lower_bound(requirements, name):
    found = next(r for r in map(Requirement, requirements) if r.name == name and r.marker is None)
    return max(tuple(map(int, s.version.split("."))) for s in found.specifier if s.operator == ">=")


def test_numpy_is_at_least_what_openmdao_needs():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    own = lower_bound(project["dependencies"], "numpy")
    assert own >= max(lower_bound(requires("openmdao"), "numpy"), (2, 0))
