"""Docstrings as they stand in the code, made safe for reStructuredText.

The docstrings are plain text with formulas such as ``|t|``, ``Phi_,x`` and indented lines. Symbols
that reStructuredText would take for markup are escaped, and indented formulas before the first
section become literal blocks.
"""

import re

from seal_mdao.seals.file.schema import Table

UNDERLINE = re.compile(r"-{3,}")
LITERAL = re.compile(r"(``.+?``)")
STAR_NAME = re.compile(r"\*{1,2}\w+$")
TYPE_FIELD = re.compile(r"(\s*:(?:var)?type [^:]+: )(.+)$")
EMPHASIS = re.compile(r"((?<!\w)\*[A-Za-z][^*]*\*(?!\w))")


def escape(line: str) -> str:
    """Escape the symbols outside literals."""
    parts = LITERAL.split(line)
    for i in range(0, len(parts), 2):
        text = re.sub(r"(\w)_(?!\w)", r"\1\\_", parts[i].replace("|", r"\|"))
        if not STAR_NAME.match(text.strip()):
            pieces = EMPHASIS.split(text)
            pieces[::2] = [piece.replace("*", r"\*") for piece in pieces[::2]]
            text = "".join(pieces)
        parts[i] = text
    return "".join(parts)


def rewritten(lines: list[str]) -> list[str]:
    """Escaped lines, with indented paragraphs of the introduction as literal blocks."""
    out, in_sections, literal = [], False, False
    for i, line in enumerate(lines):
        following = lines[i + 1] if i + 1 < len(lines) else ""
        in_sections |= bool(UNDERLINE.fullmatch(following.strip()))
        if in_sections or not line.startswith("    "):
            literal = literal and not line.strip()
            out.append(line if UNDERLINE.fullmatch(line.strip()) else escape(line))
            continue
        if not literal:
            out += ["::", ""] if not (out and out[-1].strip()) else ["", "::", ""]
            literal = True
        out.append(line)
    return out


def process(app, what, name, obj, options, lines) -> None:
    lines[:] = rewritten(lines)


def table_keys(app, what, name, obj, options, lines) -> None:
    """Keys of the tables of seal files as attributes, from what their classes say of them."""
    if isinstance(obj, type) and issubclass(obj, Table) and obj.entries():
        lines += ["Attributes", "----------"]
        for field, own in obj.__pydantic_fields__.items():
            form = obj.allowed(own.alias or field)
            lines += [
                f"{field} : {form}",
                f"    {own.description[0].upper()}{own.description[1:].rstrip('.')}.",
                "",
            ]


def quiet_types(app, what, name, obj, options, lines) -> None:
    """Types that are no class of the package, such as "ndarray, shape (n, 2)", without references.

    Sphinx would look for each of them, a float too, among all names of the package.
    """
    for i, line in enumerate(lines):
        found = TYPE_FIELD.match(line)
        if found and not re.fullmatch(r"(\w+\.)*[A-Z]\w*", found[2]):
            lines[i] = f"{found[1]}*{found[2]}*"


def skip(app, what, name, obj, skipped, options):
    """Leave out what a NamedTuple says about its fields: the docstring's Attributes do."""
    text = getattr(obj, "__doc__", None) or ""
    return True if text.startswith("Alias for field number") else None


def setup(app):
    app.connect("autodoc-process-docstring", table_keys, priority=300)
    # before napoleon (500), which turns the sections into field lists
    app.connect("autodoc-process-docstring", process, priority=400)
    app.connect("autodoc-process-docstring", quiet_types, priority=600)
    app.connect("autodoc-skip-member", skip)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
