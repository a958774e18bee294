"""Extensions by name: friction laws, materials, terms, profiles and measures of other packages.

An installed distribution offers them as entry points, a script by ``register``. Seal files refer to them
by name only: a name is looked up here; a file cannot import a path or a module.
"""

from collections.abc import Callable, Iterable
from dataclasses import is_dataclass
from functools import cache
from importlib.metadata import EntryPoints, entry_points
from typing import NamedTuple

from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.measures.measure import Measure
from seal_mdao.terms.term import TermDefinition


def _is_dataclass_of(base: type) -> Callable:
    return lambda value: isinstance(value, type) and issubclass(value, base) and is_dataclass(value)


def _is_shape(value) -> bool:
    return is_dataclass(value) and hasattr(value, "names") and hasattr(value, "profile")


CONTRACTS = {
    "friction_laws": ("a function of the contact pressure and of constants", callable),
    "materials": ("a dataclass that derives from Isotropic", _is_dataclass_of(Isotropic)),
    "terms": ("a dataclass that derives from TermDefinition", _is_dataclass_of(TermDefinition)),
    "profiles": ("a dataclass with names and profile()", _is_shape),
    "measures": ("a dataclass that derives from Measure", _is_dataclass_of(Measure)),
}
"""Requirement on the extensions of every kind, whose entry points are ``seal_mdao.KIND``."""


class Extension(NamedTuple):
    """A named extension: its source, for messages, and the function that loads it."""

    source: str
    load: Callable


_registered: dict[tuple[str, str], Extension] = {}
_replaced: list[tuple[str, str]] = []
"""Kind and name of every registered definition that another one has replaced."""


def replacements() -> int:
    """Count the registered definitions that were replaced in this process: seal files that are read
    before and after a replacement may describe different seals by the same text."""
    return len(_replaced)


def register(kind: str, name: str, value=None):
    """Register an extension for seal files that this process reads; also usable as a decorator.

    Parameters
    ----------
    kind : {"friction_laws", "materials", "terms", "profiles", "measures"}
    name : str
        Name in seal files.
    value : object, optional
        A function of the pressure and constants for a friction law, else a class; omitted in a
        decorator.

    Raises
    ------
    ValueError
        For an unknown kind, a name that is no identifier or already in use, or an invalid extension.

    Examples
    --------
    >>> @register("friction_laws", "limited")
    ... def limited(pressure, friction, most):
    ...     limit = friction * pressure
    ...     return limit if limit.real < most.real else most
    """
    if value is None:
        return lambda decorated: register(kind, name, decorated)
    if kind not in CONTRACTS:
        raise ValueError(
            f"the kind of an extension must be one of {', '.join(CONTRACTS)}, got {kind!r}"
        )
    if not isinstance(name, str) or not name.isidentifier():
        raise ValueError(f"the name of an extension must be a Python identifier, got {name!r}")
    new = Extension(f"register() in the module {value.__module__!r}", lambda: value)
    # the same definition may be registered again, as when a module is reloaded
    old = _registered.get((kind, name), new)
    if old.source != new.source or old.load().__qualname__ != value.__qualname__:
        raise ValueError(
            f"the {_what(kind)} {name!r} is already registered, from {old.source}; register it under "
            "another name"
        )
    _checked(kind, name, new.source, value)
    if old.load() is not value:
        _replaced.append((kind, name))
    _registered[kind, name] = new
    return value


def names(kind: str) -> tuple:
    """List the names of all extensions of a kind, sorted; nothing is loaded."""
    own = {name for of, name in _registered if of == kind}
    return tuple(sorted(own | {*installed(kind)}))


def installed(kind: str) -> tuple:
    """List the names of the extensions of a kind in installed distributions, sorted."""
    return tuple(sorted({point.name for point in _installed(kind)}))


def find(kind: str, name: str, shipped: Iterable[str] = ()):
    """Find the extension of a name; None if there is none, or only one ``shipped`` with the package.

    Raises
    ------
    ValueError
        One line with the distribution, for a name in several distributions or that is no identifier, an
        entry point that fails to load, or an invalid extension.
    """
    found = [own for (of, its), own in _registered.items() if (of, its) == (kind, name)]
    for point in _installed(kind):
        if point.name == name:
            found.append(Extension(f"the distribution {point.dist.name!r}", point.load))
    # a name must be unique among the package, registered extensions and distributions
    sources = [own.source for own in found]
    if name in shipped:
        sources.insert(0, "seal_mdao itself")
    if len(sources) > 1:
        raise ValueError(
            f"more than one source defines the {_what(kind)} {name!r}: {' and '.join(sources)}; rename "
            "it in one of them, or uninstall all of these packages but one"
        )
    if not found:
        return None
    (own,) = found
    if not name.isidentifier():
        raise ValueError(
            f"the name {name!r} of the {_what(kind)} of {own.source} must be an identifier"
        )
    try:
        value = own.load()
    except Exception as error:
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise ValueError(
            f"the {_what(kind)} {name!r} of {own.source} cannot be loaded ({reason}); repair or "
            "uninstall it"
        ) from error
    return _checked(kind, name, own.source, value)


def _checked(kind, name, source, value):
    allowed, fits = CONTRACTS[kind]
    if not fits(value):
        shown = getattr(value, "__qualname__", repr(value))
        raise ValueError(f"the {_what(kind)} {name!r} of {source} must be {allowed}, got {shown}")
    return value


def _what(kind: str) -> str:
    return kind.replace("_", " ").removesuffix("s")


@cache
def _entry_points() -> EntryPoints:
    # read once for all kinds: the files of every installed distribution
    return entry_points()


def _installed(kind: str) -> EntryPoints:
    return _entry_points().select(group=f"seal_mdao.{kind}")
