"""Description of the seal of a file for recorder files: text, files beside it, chosen steps and
penalties."""

import base64
import json
import tomllib
import zlib
from pathlib import Path

from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal

FILE = "seal_file"
"""Key of the text of the file among the settings of a seal, and of its tables among those of a
problem."""
FILE_NAME = "file_name"
"""Key of the name of the file among the settings of a problem."""
CONTENTS = "_contents"
"""Attribute of a ``SealFile`` for what was read."""
MOST_BYTES = 50 * 2**20
"""Of a file beside a seal file, unpacked."""


def note_contents(file: SealFile) -> None:
    """Attach the contents of a seal file and the files beside it to the ``SealFile`` that was read.

    ``dataclasses.replace`` does not copy them: a changed file has none.
    """
    file.__dict__[CONTENTS] = _contents(file.path)


def keep_contents(file: SealFile, read: SealFile) -> SealFile:
    """Attach the contents of the file that was read to a changed one; return the latter."""
    file.__dict__[CONTENTS] = contents(read)
    return file


def contents(file: SealFile) -> dict:
    """Return the contents of a seal file and those beside it; empty without ``note_contents``."""
    # frozen dataclass: contents are no field, so ``replace`` drops them
    return file.__dict__.get(CONTENTS, {})


def _contents(path: Path) -> dict:
    """Return the text of a file and the packed contents of those beside it, under short names.

    Empty where the name of one is written in a form that is not found in the text.
    """
    text, beside = path.read_text(encoding="utf-8"), {}
    for number, name in enumerate(named_in(tomllib.loads(text))):
        short = f"beside_{number}{Path(name).suffix}"
        # TOML strings have double or single quotes, and may have escapes; one file may be named twice
        forms = json.dumps(name, ensure_ascii=False), json.dumps(name), f"'{name}'"
        written = [form for form in forms if form in text]
        if not written:
            return {}
        for form in written:
            text = text.replace(form, f'"{short}"')
        # compressed bytes as text, for JSON
        packed = zlib.compress((path.parent / name).read_bytes())
        beside[short] = base64.b64encode(packed).decode("ascii")
    return {FILE: text, "beside": beside}


def description(file: SealFile, seal: OutlineSeal) -> dict:
    """Return a JSON description from which the seal of a file can be rebuilt; empty without
    ``note_contents``.

    ``seal_file`` is its text; ``beside`` has the packed contents of the drawing, the cloud and data by
    their names in the text; ``chosen`` has keyword arguments of ``build_seal``.
    """
    own = contents(file)
    return own | {"chosen": chosen_for(file, seal)} if own else {}


def named_in(tables: dict) -> list[str]:
    """List the names of files in the tables of a seal file, each once."""
    # drawing and mesh of the section, tests of materials, target curves
    found = [tables["section"].get(key) for key in ("dxf", "cloud")]
    found += [own.get("data") for own in (*tables["material"].values(), *tables.get("measure", ()))]
    return list(dict.fromkeys(name for name in found if isinstance(name, str)))


def unpacked(packed: str) -> bytes:
    """Unpack the contents of a file beside a seal file.

    Raises
    ------
    ValueError
        For text that is not packed, or contents larger than a drawing or a cloud can be.
    """
    # bounded: a short text may unpack to any size
    unpacker = zlib.decompressobj()
    try:
        content = unpacker.decompress(base64.b64decode(packed, validate=True), MOST_BYTES)
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if unpacker.unconsumed_tail:
        raise ValueError(f"a file to which the seal file refers is larger than {MOST_BYTES} bytes")
    if not unpacker.eof:
        raise ValueError(
            "the recorder file contains a truncated copy of a file to which the seal file refers"
        )
    return content
