"""A coarse, quick run of all figures; the pages refer to nothing that is not made."""

import json
import os
import re
import subprocess
import sys

import matplotlib.image
import numpy as np
import pytest
from verification.tolerances import TOLERANCES


@pytest.fixture(scope="module")
def made(docs, tmp_path_factory):
    """Folder with everything that a build makes, in the reduced mode."""
    out = tmp_path_factory.mktemp("generated")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    for script in (
        [docs / "make_figures.py", "--reduced", "--out", out],
        [docs / "_ext" / "code_reference.py", out / "fragments"],
    ):
        subprocess.run([sys.executable, *map(str, script)], check=True, env=environment)
    return out


def references(pages, pattern):
    return {(path, found) for path, text in pages.items() for found in re.findall(pattern, text)}


def generated(target):
    """The part of a path below ``_generated``, or None."""
    return target.partition("_generated/")[2] or None


@pytest.mark.long
def test_every_figure_of_the_pages_is_made(made, docs, pages):
    figures = references(pages, r"```\{figure\} (\S+)") | references(pages, r"<(\S+\.html)>`")
    for path, target in figures:
        inside = generated(target)
        file = made / inside if inside else path.parent / target
        assert file.is_file(), f"{path.relative_to(docs)}: {target}"


@pytest.mark.long
def test_every_figure_shows_something(made):
    pictures = sorted(made.rglob("*.png"))
    for path in pictures:
        picture = matplotlib.image.imread(path)[..., :3]
        assert min(picture.shape[:2]) > 300, path.name
        assert 0.005 < np.mean(np.any(picture < 0.97, axis=2)) < 0.9, path.name


@pytest.mark.long
def test_every_figure_that_is_made_is_shown(made, pages):
    text = "\n".join(pages.values())
    for path in made.glob("*.png"):
        assert f"_generated/{path.name}" in text, path.name


@pytest.mark.long
def test_every_included_fragment_is_made(made, docs, pages):
    for path, target in references(pages, r"```\{include\} (\S+)"):
        # the equation table and those of seal files (test_page.py) are made by the build itself
        if not target.endswith("equation_index.md") and "/seal_file_" not in target:
            inside = generated(target)
            file = made / inside if inside else path.parent / target
            assert file.is_file(), f"{path.relative_to(docs)}: {target}"


@pytest.mark.long
def test_numbers_come_from_their_group(made, docs, pages):
    """The coarse run makes some of a group's numbers only; the build fails on unknown ones."""
    groups = {file.stem: json.loads(file.read_text()) for file in (made / "numbers").glob("*.json")}
    used = references(pages, r"\{\{ (\w+)\.(\w+) \}\}")
    for path, (group, name) in used:
        if group == "tolerances":
            assert name in TOLERANCES, f"{path.relative_to(docs)}: {name}"
    quoted = {group for _, (group, _) in used}
    # these make pictures and text blocks only
    assert quoted == {*groups, "tolerances"} - {"examples", "theory"}


def test_tolerances_are_stated_by_the_pages(docs_module, pages):
    limits, text = docs_module("figures.limits"), "\n".join(pages.values())
    unstated = {name for name in TOLERANCES if f"{{{{ tolerances.{name} }}}}" not in text}
    assert not unstated
    assert limits.text("patch") == "10⁻¹⁰"
    assert limits.text("cook_32") == "0.25 %"
    assert limits.text("flat_116_mm") == "0.015 mm"


def test_blocks_of_pages_are_closed(docs):
    """An open figure takes the text and the figures after it into its caption, without a warning."""
    for page in sorted(docs.glob("**/*.md")):
        if "_generated" in page.parts:
            continue
        opened = None
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            fence = re.match(r"(`{3,})(.*)", line)
            if fence is None:
                continue
            begins = bool(fence[2].strip())
            assert begins == (opened is None), f"{page.name}, line {number}: {opened or 'no block'}"
            opened = number if begins else None
        assert opened is None, f"{page.name}: the block of line {opened} is not closed"
