"""Messages on the page about troubleshooting are those of the package."""

import ast
import re
from pathlib import Path

import seal_mdao

PACKAGE = Path(seal_mdao.__file__).parent
HOLE = "\0"
"""Stands for an interpolated value."""


def _text(node) -> str:
    """The text of a string literal, with ``HOLE`` for each value in it."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    return "".join(_text(part) if isinstance(part, ast.Constant) else HOLE for part in node.values)


def package_texts() -> list[str]:
    """Every string literal of the package."""
    return [
        _text(node)
        for path in sorted(PACKAGE.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.JoinedStr | ast.Constant)
    ]


def messages(page: str) -> list[str]:
    """The first cell of every row of a table, in backquotes."""
    return re.findall(r"^\| `([^`]+)`.*\|.*\|.*\|$", page, re.MULTILINE)


def is_in_package(message: str, texts: list[str]) -> bool:
    """Whether one literal has all the fixed parts of a message in their order."""
    parts = (re.escape(part.strip()) for part in message.split("..."))
    pattern = re.compile(".*".join(parts), re.DOTALL)
    return any(pattern.search(text) for text in texts)


def test_every_message_is_one_of_the_package(docs):
    texts = package_texts()
    listed = messages((docs / "troubleshooting.md").read_text(encoding="utf-8"))
    assert len(listed) > 60
    assert not [message for message in listed if not is_in_package(message, texts)]


def test_a_message_that_is_not_there_is_found_out():
    assert not is_in_package("the seal has ... wings", package_texts())
