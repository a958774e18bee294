"""Files that CONTRIBUTING.md and the pages name exist, those of "Where to change what" among them."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOT_PAGES = ("README.md", "CONTRIBUTING.md")
# `folder/file.py`
PATH = re.compile(r"`((?:[a-z_]+/)+[a-z_]+\.py)`")


@pytest.fixture(scope="module")
def rows():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    section = text.split("## Where to change what", 1)[1].split("\n## ", 1)[0]
    table = [line for line in section.splitlines() if line.startswith("| ")]
    return dict(line.strip("| ").split(" | ") for line in table[1:])


def test_every_row_names_files_and_all_of_them_exist(rows):
    assert len(rows) >= 20
    for what, where in rows.items():
        # functions in brackets aside
        paths = re.findall(r"`([^`]+)`", re.sub(r"\(`\w+`\)", "", where))
        assert paths, what
        for path in paths:
            assert (ROOT / "seal_mdao" / path).exists(), f"{what}: {path}"


def test_functions_named_behind_a_file_are_in_it(rows):
    found = 0
    for where in rows.values():
        for path, name in re.findall(r"`([a-z_/]+\.py)` \(`(\w+)`\)", where):
            text = (ROOT / "seal_mdao" / path).read_text(encoding="utf-8")
            assert re.search(rf"(def|class) {name}\b", text), f"{path}: {name}"
            found += 1
    assert found


def test_python_files_that_pages_name_by_their_path_exist(pages):
    texts = {**pages, **{ROOT / name: (ROOT / name).read_text("utf-8") for name in ROOT_PAGES}}
    bases = [ROOT, ROOT / "seal_mdao", ROOT / "docs", ROOT / "tests" / "verification"]
    named = {(page, path) for page, text in texts.items() for path in PATH.findall(text)}
    assert len(named) > 50
    gone = [
        (page.name, path) for page, path in named if not any((b / path).exists() for b in bases)
    ]
    assert not gone
