"""Standard output and error of a command, whatever is at their ends."""

import codecs
import os
import sys

PLAIN = {"²": "^2", "³": "^3", "≥": ">=", "≤": "<=", "°": " deg", "±": "+-", "·": "*", "µ": "u"}
"""What stands for characters that the encoding of a stream does not have."""
HANDLER = "seal_mdao.plain"


def make_writable() -> None:
    """Let everything be printed: characters that an encoding does not have are written otherwise, and
    streams that were closed (``2>&-``) lead nowhere.

    A closed stream is opened as the null device under its own number. Otherwise the next file, a
    recorder file perhaps, would be given that number, and what libraries print would end up in it.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            # the lowest number that is free is this one
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
        if getattr(sys, name) is None:
            way = "r" if name == "stdin" else "w"
            setattr(sys, name, os.fdopen(number, way, encoding="utf-8", closefd=False))
    codecs.register_error(HANDLER, _plain)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # not what notebooks and tests put in their place
            stream.reconfigure(errors=HANDLER)


def _plain(error: UnicodeError) -> tuple[str, int]:
    """What is written in place of characters that cannot be encoded."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    signs = error.object[error.start : error.end]
    found = (PLAIN.get(sign) or sign.encode("ascii", "backslashreplace").decode() for sign in signs)
    return "".join(found), error.end
