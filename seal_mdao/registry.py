"""Extensions by name: friction laws, materials, terms, profiles and measures of other packages.

An installed distribution offers them as entry points, a script by ``register``. Seal files know them by
name alone: what a file names is looked up here, never imported from a path or a module in the file.
"""

from collections.abc import Callable, Iterable
from dataclasses import is_dataclass
from functools import cache
from importlib.metadata import entry_points
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
"""What an extension of every kind has to be. The entry points of a kind are ``seal_mdao.KIND``."""


class Extension(NamedTuple):
    """Something that is known by name.

    Attributes
    ----------
    source : str
        Where it comes from, for messages.
    load : callable
        Gives it.
    """

    source: str
    load: Callable


_registered: dict[tuple[str, str], Extension] = {}


def register(kind: str, name: str, value=None):
    """Register an extension for seal files that this process reads; also a decorator of it.

    Parameters
    ----------
    kind : {"friction_laws", "materials", "terms", "profiles", "measures"}
    name : str
        What seal files call it.
    value : object, optional
        A function of the pressure and constants for a friction law, else a class; left out in a
        decorator.

    Raises
    ------
    ValueError
        For an unknown kind, a name that is no identifier or that something else has, or a value that is
        no such extension.

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
        raise ValueError(f"kind must be one of {', '.join(CONTRACTS)}, got {kind!r}")
    if not isinstance(name, str) or not name.isidentifier():
        raise ValueError(f"the name of an extension must be an identifier, got {name!r}")
    new = Extension(f"register() in the module {value.__module__!r}", lambda: value)
    old = _registered.get((kind, name), new)
    if old.source != new.source or old.load().__qualname__ != value.__qualname__:
        raise ValueError(f"{_what(kind)} {name!r} is known already, from {old.source}")
    _checked(kind, name, new.source, value)
    _registered[kind, name] = new
    return value


def names(kind: str) -> tuple:
    """Names of all extensions of a kind, sorted; nothing is loaded."""
    own = {name for of, name in _registered if of == kind}
    return tuple(sorted(own | {*installed(kind)}))


def installed(kind: str) -> tuple:
    """Names of the extensions of a kind that installed distributions offer, sorted."""
    return tuple(sorted({point.name for point in _installed(kind)}))


def find(kind: str, name: str, shipped: Iterable[str] = ()):
    """Find the extension of a name; None where there is none of it, or it is that of the package alone.

    Parameters
    ----------
    shipped : iterable of str
        Names that the package itself has of this kind.

    Raises
    ------
    ValueError
        One line with the distribution, for a name that several have or that is no identifier, an entry
        point that fails to load, or one that is no such extension.
    """
    found = [own for (of, its), own in _registered.items() if (of, its) == (kind, name)]
    for point in _installed(kind):
        if point.name == name:
            found.append(Extension(f"the distribution {point.dist.name!r}", point.load))
    sources = [own.source for own in found]
    if name in shipped:
        sources.insert(0, "seal_mdao itself")
    if len(sources) > 1:
        raise ValueError(
            f"the name {name!r} of {_what(kind)} comes from {' and from '.join(sources)}; rename or "
            "uninstall all but one"
        )
    if not found:
        return None
    (own,) = found
    if not name.isidentifier():
        raise ValueError(
            f"the name {name!r} of {_what(kind)} of {own.source} must be an identifier"
        )
    try:
        value = own.load()
    except Exception as error:
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise ValueError(
            f"{_what(kind)} {name!r} of {own.source} cannot be loaded ({reason})"
        ) from error
    return _checked(kind, name, own.source, value)


def _checked(kind, name, source, value):
    allowed, fits = CONTRACTS[kind]
    if not fits(value):
        shown = getattr(value, "__qualname__", repr(value))
        raise ValueError(f"{_what(kind)} {name!r} of {source} must be {allowed}, got {shown}")
    return value


def _what(kind: str) -> str:
    return kind.replace("_", " ").removesuffix("s")


@cache
def _installed(kind: str) -> tuple:
    return tuple(entry_points(group=f"seal_mdao.{kind}"))
