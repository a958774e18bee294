"""Standard streams of a command: closed ones, and encodings that lack characters."""

import codecs
import os
import sys

PLAIN = {"²": "^2", "³": "^3", "≥": ">=", "≤": "<=", "°": " deg", "±": "+-", "·": "*", "µ": "u"}
"""Replacements of characters that the encoding of a stream lacks."""
HANDLER = "seal_mdao.plain"


def make_writable() -> None:
    """Replace characters that an encoding lacks, and open closed streams (``2>&-``) as the null device.

    Otherwise the next file, such as a recorder file, would take the number of a closed stream, and
    libraries would print into it.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            # the lowest number that is free is this one
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
        if getattr(sys, name) is None:
            mode = "r" if name == "stdin" else "w"
            setattr(sys, name, os.fdopen(number, mode, encoding="utf-8", closefd=False))
    codecs.register_error(HANDLER, _plain)
    for stream in (sys.stdout, sys.stderr):
        # notebooks and tests replace the streams by other objects
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=HANDLER)


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    # from the table, else as an escape sequence
    signs = error.object[error.start : error.end]
    found = (PLAIN.get(sign) or sign.encode("ascii", "backslashreplace").decode() for sign in signs)
    return "".join(found), error.end
