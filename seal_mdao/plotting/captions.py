"""Small print below figures: seals that they show, materials, environment, and the date."""

import os
import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime

from seal_mdao.materials.hardness import ShoreRubber
from seal_mdao.materials.sponge import GradedSponge
from seal_mdao.seals.conditions import DEGREES, SECONDS, conditions_text
from seal_mdao.structure.environment import TEMPERATURE

_SEALS: ContextVar[dict | None] = ContextVar("seals", default=None)
_VARIED: ContextVar[tuple[str, ...]] = ContextVar("varied", default=())
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
    tokens = {
        _SEALS: _SEALS.set(dict(seals or {})),
        _DATE: _DATE.set(date),
        _VARIED: _VARIED.set(()),
    }
    try:
        yield
    finally:
        for variable, token in tokens.items():
            variable.reset(token)


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
        seals[name] = seal


def name_varied(names: Collection[str]) -> None:
    """Add parameters, or numbers of a seal file by their paths, that vary between results to every seal
    in the captions of the block; their nominal values are left out."""
    if _SEALS.get() is not None:
        _VARIED.set(tuple(names))


def seal_text(seal, varied: Collection[str] = ()) -> str:
    """Describe materials and environment at the end of the path of a ``Seal`` or ``SealFile``, without
    the values of ``varied`` quantities, which are named."""
    # names of conditions without units: those of the parameters
    keys, known = {DEGREES: TEMPERATURE, SECONDS: "duration"}, seal.conditions()
    quantities = set(_quantities(varied))
    conditions = {k: own for k, own in known.items() if keys.get(k, k) not in quantities}
    # a seal of a file knows its conditions, the file also the part that planes of symmetry leave
    more = (getattr(seal, "part", ""), conditions_text(conditions))
    end = f"varied: {', '.join(varied)}" if varied else ""
    return ", ".join(filter(None, [materials_text(seal.materials, quantities), *more, end]))


def _quantities(names: Collection[str]) -> Iterator[str]:
    """List the parameters that names, or paths of numbers of a seal file, may stand for, without the
    numbers of stages: ``foot_swelling`` and ``swelling`` for ``material.foot.swelling.2``."""
    for name in names:
        parts = re.sub(r"[._]\d+$", "", name).split(".")
        yield from (parts[-1], "_".join(parts[-2:]))


def materials_text(materials: Mapping[str, object], varied: Collection[str] = ()) -> str:
    """Describe materials by their names and laws, such as ``foot (Mooney-Rivlin)``; without hardnesses
    that are ``varied``."""
    found = []
    for name, law in materials.items():
        # the only material of a seal has no prefix
        hardness = f"{name}_shore_a" if len(materials) > 1 else "shore_a"
        found.append(f"{name} ({_law_text(law, hardness in varied)})")
    return ", ".join(found)


def _law_text(law, varied: bool) -> str:
    if isinstance(law, ShoreRubber):
        return "Shore A" if varied else f"{law.shore_a:g} Shore A"
    if isinstance(law, GradedSponge):
        return "foam of ASTM D1056"
    # MooneyRivlin: Mooney-Rivlin
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", type(law).__name__)


def caption(most: int = 200) -> str:
    """Return the caption of the block, of at most ``most`` characters; empty without a seal."""
    seals, varied = _SEALS.get() or {}, _VARIED.get()
    texts = {n: own if isinstance(own, str) else seal_text(own, varied) for n, own in seals.items()}
    return caption_of(texts, most) if texts else ""


def caption_of(seals: Mapping[str, str], most: int = 200) -> str:
    """Return a caption of at most ``most`` characters for seals with their materials."""
    end = f" | {_DATE.get() or today()}"
    text = "; ".join(f"{name}: {materials}" for name, materials in seals.items())
    length = most - len(end)
    return (text if len(text) <= length else text[: length - 1] + "…") + end
