"""The documentation's own modules, importable by the tests."""

import importlib
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="session")
def docs():
    """Folder of the documentation."""
    return DOCS


@pytest.fixture(scope="session")
def docs_module():
    """A module of ``docs/`` or ``docs/_ext`` by name."""
    folders = [str(DOCS / "_ext"), str(DOCS)]
    sys.path[:0] = folders
    yield importlib.import_module
    for folder in folders:
        sys.path.remove(folder)


@pytest.fixture(scope="session")
def pages():
    """Text of every page that is written by hand, by its path."""
    found = (p for p in DOCS.rglob("*.md") if not {"_build", "_generated", "_static"} & {*p.parts})
    return {path: path.read_text(encoding="utf-8") for path in sorted(found)}
