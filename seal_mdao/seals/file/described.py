"""A seal file as text that recorder files keep: its tables, the files beside it, and what was chosen."""

import base64
import json
import tomllib
import zlib
from pathlib import Path

from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.seal_file import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal

FILE = "seal_file"
"""Key of the text of the file among the settings of a seal."""
CONTENTS = "_contents"
"""Attribute of a ``SealFile`` for what was read."""
MOST_BYTES = 50 * 2**20
"""Of a file beside a seal file, unpacked."""


def note_contents(file: SealFile) -> None:
    """Keep what a seal file and the files beside it hold now with the ``SealFile`` that was read.

    One that is made of it by ``dataclasses.replace`` has nothing of it.
    """
    file.__dict__[CONTENTS] = _contents(file.path)


def _contents(path: Path) -> dict:
    """Text of a file, with names of its own for the packed contents of those beside it; empty where one
    is named in a way that is not found in the text."""
    text, beside = path.read_text(encoding="utf-8"), {}
    for number, name in enumerate(named_in(tomllib.loads(text))):
        short = f"beside_{number}{Path(name).suffix}"
        written = next((q for q in (json.dumps(name), f"'{name}'") if q in text), None)
        if written is None:
            return {}
        text = text.replace(written, f'"{short}"')
        packed = zlib.compress((path.parent / name).read_bytes())
        beside[short] = base64.b64encode(packed).decode("ascii")
    return {FILE: text, "beside": beside}


def description(file: SealFile, seal: OutlineSeal) -> dict:
    """What the seal of a file can be made from again, as JSON holds it; empty for a file whose contents
    were not noted.

    Returns
    -------
    dict
        ``seal_file``, its text; ``beside``, the packed contents of the drawing, the cloud and data by
        names that the text has in their place; ``chosen``, keyword arguments of ``build_seal``.
    """
    contents = file.__dict__.get(CONTENTS)
    return contents | {"chosen": chosen_for(file, seal)} if contents else {}


def named_in(tables: dict) -> list[str]:
    """Names of files in the tables of a seal file."""
    found = [tables["section"].get(key) for key in ("dxf", "cloud")]
    found += [own.get("data") for own in tables["material"].values()]
    return list(dict.fromkeys(name for name in found if isinstance(name, str)))


def unpacked(packed: str) -> bytes:
    """Contents of a file beside a seal file.

    Raises
    ------
    ValueError
        For what is not packed, or larger than a drawing or a cloud can be.
    """
    unpacker = zlib.decompressobj()
    try:
        content = unpacker.decompress(base64.b64decode(packed, validate=True), MOST_BYTES)
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if unpacker.unconsumed_tail:
        raise ValueError(f"a file beside it has more than {MOST_BYTES} bytes")
    if not unpacker.eof:
        raise ValueError("a file beside it is not complete")
    return content
