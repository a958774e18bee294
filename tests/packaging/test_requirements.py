"""What pyproject.toml asks for, and the version in every place."""

import re
import sys
import tomllib
from importlib.metadata import requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import seal_mdao as sm
from seal_mdao.seals.file.export import WRITERS, require_writers

ROOT = Path(__file__).parents[2]


def lower_bound(requirements, name):
    found = next(r for r in map(Requirement, requirements) if r.name == name and r.marker is None)
    return max(tuple(map(int, s.version.split("."))) for s in found.specifier if s.operator == ">=")


def test_numpy_is_at_least_what_openmdao_needs():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    own = lower_bound(project["dependencies"], "numpy")
    assert own >= max(lower_bound(requires("openmdao"), "numpy"), (2, 0))


def test_one_extra_has_all_that_writes_designs():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"][
        "optional-dependencies"
    ]
    names = {own: {Requirement(line).name for line in lines} for own, lines in extras.items()}
    assert set(WRITERS.values()) <= names["dxf"]
    assert set(WRITERS.values()) <= names["test"]


@pytest.mark.parametrize("missing", [("meshio",), ("ezdxf", "tomli_w")])
def test_writers_that_are_missing_are_named_with_their_extra(monkeypatch, missing):
    for module in missing:
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError) as found:
        require_writers()
    said = str(found.value)
    names = " and ".join(WRITERS[own] for own in missing)
    assert f"needs {names}, not installed: pip install" in said
    assert "seal_mdao[dxf]" in said


def test_version_is_the_same_everywhere():
    """The package, the citation and the newest version of the changelog; dates agree, too."""
    changelog = (ROOT / "CHANGELOG.md").read_text()
    citation = (ROOT / "CITATION.cff").read_text()
    version, date = re.search(r"^## \[(\d[\d.]*)\] - (\S+)$", changelog, re.MULTILINE).groups()
    assert version == sm.__version__
    assert re.search(r"^version: (\S+)$", citation, re.MULTILINE)[1] == version
    assert re.search(r"^date-released: (\S+)$", citation, re.MULTILINE)[1] == date
