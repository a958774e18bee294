"""Small print below figures: seals that they show, materials, environment, and the date."""

import os
import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime

from seal_mdao.materials.hardness import ShoreRubber
from seal_mdao.materials.sponge import GradedSponge
from seal_mdao.seals.conditions import conditions_text

_SEALS: ContextVar[dict[str, str] | None] = ContextVar("seals", default=None)
_DATE: ContextVar[str] = ContextVar("date", default="")


@contextmanager
def captioned(seals: Mapping[str, str] | None = None, date: str = "") -> Iterator[None]:
    """Print a caption below all figures that are saved inside this block.

    Parameters
    ----------
    seals : mapping of str to str, optional
        Materials by the names of the seals; ``name_seal`` adds others.
    date : str, optional
        Date of stored values that the figures show; without it ``today``.
    """
    token, day = _SEALS.set(dict(seals or {})), _DATE.set(date)
    try:
        yield
    finally:
        _SEALS.reset(token)
        _DATE.reset(day)


def today() -> str:
    """Return the date in the form ``2026-11-25``.

    It is that of ``SOURCE_DATE_EPOCH`` (seconds since 1970, as reproducible builds set it) where the
    variable is set.
    """
    stamp = os.environ.get("SOURCE_DATE_EPOCH")
    date = datetime.fromtimestamp(int(stamp), UTC) if stamp else datetime.now().astimezone()
    return f"{date:%Y-%m-%d}"


def name_seal(name: str, seal) -> None:
    """Add a ``Seal`` or a ``SealFile`` to the captions of the block, if any."""
    seals = _SEALS.get()
    if seals is not None:
        seals[name] = seal_text(seal)


def name_varied(names: Collection[str]) -> None:
    """Add parameters that vary between results to every seal in the captions of the block, if any."""
    seals = _SEALS.get() or {}
    for name in seals if names else ():
        seals[name] += f", varied: {', '.join(names)}"


def seal_text(seal) -> str:
    """Describe materials and environment at the end of the path of a ``Seal`` or ``SealFile``."""
    # a seal of a file knows its conditions, the file also the part that planes of symmetry leave
    more = (getattr(seal, "part", ""), conditions_text(seal.conditions()))
    return ", ".join([materials_text(seal.materials), *filter(None, more)])


def materials_text(materials: Mapping[str, object]) -> str:
    """Describe materials by their names and laws, such as ``foot (Mooney-Rivlin)``."""
    return ", ".join(f"{name} ({_law_text(law)})" for name, law in materials.items())


def _law_text(law) -> str:
    if isinstance(law, ShoreRubber):
        return f"{law.shore_a:g} Shore A"
    if isinstance(law, GradedSponge):
        return "foam of ASTM D1056"
    # MooneyRivlin: Mooney-Rivlin
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", type(law).__name__)


def caption(most: int = 200) -> str:
    """Return the caption of the block, of at most ``most`` characters; empty without a seal."""
    seals = _SEALS.get()
    return caption_of(seals, most) if seals else ""


def caption_of(seals: Mapping[str, str], most: int = 200) -> str:
    """Return a caption of at most ``most`` characters for seals with their materials."""
    end = f" | {_DATE.get() or today()}"
    text = "; ".join(f"{name}: {materials}" for name, materials in seals.items())
    length = most - len(end)
    return (text if len(text) <= length else text[: length - 1] + "…") + end
