"""Texts use the terms of the field: some private phrases must not come back."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PRIVATE = {
    r"hand(s|ed|ing)? on": "carried to, passes to the next increment",
    r"(is|are|be|was|were) told": "is reported",
    r"tells": "reports, gives, determines",
    r"turned inside out": "inverted",
    r"made to stick": "forced to stick",
    r"mov(ed|es) on": "continues, advances",
    r"(goes|going) on": "continues",
    r"go on side by side": "run at the same time",
    r"st(and|ands|ood) open": "gap region, open",
    r"open stretch": "gap region",
    r"law that is none|which are none": "invalid",
    r"that are no units": "invalid",
    r"unsettled": "not converged in contact state",
    r"hangs? on": "depends on",
    r"(begin|begins|begun) anew": "starts again",
    r"drawn (seal|design)s?": "nominal seal",
    r"(good|bad) day": "fault",
    r"does not mind": "insensitive to",
    r"lie in each other": "penetration",
    r"twice as far": "with numbers and units",
    r"lies in wait": "occurs",
    r"held (on all sides|all round|alike|axially)": "confined, constrained",
    r"keeps? to (its|the) (\w+ )?limits?": "satisfies the limit",
    r"from which on": "the least ... that",
    r"(is|are) answered with": "the error gives, is followed by",
    r"beside [\w.\[\]{} ]+; use one": "are given together",
    r"in earnest": "name what is done",
    r"where that is meant": "if this is intended",
}
"""Phrase and what to write in its place."""
PATTERNS = {re.compile(rf"\b({phrase})\b"): cure for phrase, cure in PRIVATE.items()}
SOURCES = ("seal_mdao", "run_scripts", "examples", "docs", "tests")
OWN = "test_words.py"


def texts():
    """Text of every page and source, with strings and comments joined over their lines."""
    for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md"):
        yield ROOT / name
    for folder in SOURCES:
        for kind in ("*.md", "*.py", "*.toml", "*.ipynb"):
            for path in sorted((ROOT / folder).rglob(kind)):
                if not {"_build", "_generated"} & {*path.parts} and path.name != OWN:
                    yield path


def plain(path: Path) -> str:
    """Words of a file: code in backquotes left out, literals and comments of several lines joined."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        text = re.sub(r"`[^`\n]*`", "", text)
    text = re.sub(r'"\s*f?"', "", text)
    return re.sub(r"\s*\n\s*(# )?\s*", " ", text).lower()


def found_in(text: str) -> list[str]:
    """Private phrases in a text, with their surroundings and what to write."""
    return [
        f"...{text[max(0, hit.start() - 40) : hit.end() + 20]}...: write {cure}"
        for pattern, cure in PATTERNS.items()
        for hit in pattern.finditer(text)
    ]


@pytest.mark.parametrize("path", list(texts()), ids=lambda path: str(path.relative_to(ROOT)))
def test_no_private_phrases(path):
    assert not found_in(plain(path))


def test_a_private_phrase_is_found_out(tmp_path):
    page = tmp_path / "page.py"
    page.write_text('raise ValueError("the law hands "\n    "on nothing")\n')
    assert len(found_in(plain(page))) == 1
