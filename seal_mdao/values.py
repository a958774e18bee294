"""Values that users give, checked: one line that names what was wrong and what is allowed."""

import math
from numbers import Integral, Real

import numpy as np


def real(name: str, value, low=-math.inf, high=math.inf, *, above=None, below=None) -> float:
    """A finite number as a float.

    Parameters
    ----------
    name : str
        What the error calls it.
    low, high : float
        Smallest and largest value that is allowed.
    above, below : float, optional
        Bounds that are not allowed themselves.

    Raises
    ------
    ValueError
        When it is no number, not finite, or out of bounds.
    """
    number = _as_float(value)
    allowed = number is not None and math.isfinite(number) and low <= number <= high
    if allowed and above is not None:
        allowed = number > above
    if allowed and below is not None:
        allowed = number < below
    if not allowed:
        raise ValueError(
            f"{name} must be a number{_range(low, high, above, below)}, got {shown(value)}"
        )
    return number


def _as_float(value) -> float | None:
    """A real number as a float, infinite where it is too large for one; None for anything else."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _range(low, high, above, below) -> str:
    words = []
    if above is not None:
        words.append(f"above {above:.12g}")
    elif low > -math.inf:
        words.append(f"of at least {low:.12g}")
    if below is not None:
        words.append(f"below {below:.12g}")
    elif high < math.inf:
        words.append(f"at most {high:.12g}")
    return f" {' and '.join(words)}" if words else " that is finite"


def integer(name: str, value, low: int, high: int | None = None) -> int:
    """An integer from ``low`` to ``high``; booleans are none.

    Raises
    ------
    ValueError
        When it is none, or out of bounds.
    """
    is_one = isinstance(value, Integral) and not isinstance(value, bool | np.bool_)
    if not is_one or value < low or (high is not None and value > high):
        upper = "" if high is None else f" and at most {high}"
        raise ValueError(f"{name} must be an integer of at least {low}{upper}, got {shown(value)}")
    return int(value)


def one_of(name: str, value, choices: tuple) -> str:
    """One of some words.

    Raises
    ------
    ValueError
        When it is not.
    """
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} must be one of {choices}, got {shown(value)}")
    return str(value)


def flag(name: str, value) -> bool:
    """True or False; nothing else stands for them.

    Raises
    ------
    ValueError
        When it is something else.
    """
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False, got {shown(value)}")
    return bool(value)


def instance(name: str, value, kind: type) -> None:
    """Refuse what is not of a class.

    Raises
    ------
    TypeError
        With the class that it has to be of.
    """
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise TypeError(f"{name} must be {article} {kind.__name__}, got {shown(value)}")


def callback(name: str, value) -> None:
    """Refuse what is neither None nor can be called.

    Raises
    ------
    TypeError
        When it is something else.
    """
    if value is not None and not callable(value):
        raise TypeError(f"{name} must be callable or None, got {shown(value)}")


def numbers(name: str, values) -> np.ndarray:
    """Real numbers as an array of floats of any shape.

    Raises
    ------
    ValueError
        For text, lists of different lengths, complex numbers and other objects.
    """
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name} must be numbers in lists of one length") from None
    if array.dtype == object:  # fractions and integers too large for any other type
        found = [_as_float(value) for value in array.ravel()]
        if None not in found:
            return np.array(found, float).reshape(array.shape)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be real numbers, got {shown(values)}")
    return np.asarray(array, float)


def array(name: str, given, shape: tuple[int, ...]) -> np.ndarray:
    """Finite real numbers as a new array of floats of a shape.

    Raises
    ------
    ValueError
        For another shape, numbers that are not finite, and what ``numbers`` refuses.
    """
    found = np.array(numbers(name, given))
    require(found.shape == shape, f"{name} must have shape {shape}, got {found.shape}")
    require(np.isfinite(found).all(), f"{name} must be finite numbers")
    return found


def require(condition, message: str) -> None:
    """Refuse what does not fulfil a condition.

    Raises
    ------
    ValueError
        With the message.
    """
    if not condition:
        raise ValueError(message)


def shown(value) -> str:
    """A value in an error message, in one line of some length."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # an integer with too many digits, or in it
        bits = f"an integer of {value.bit_length()} bits" if isinstance(value, int) else ""
        return bits or f"a {type(value).__name__} with an integer of too many digits"
    return text if len(text) <= 60 else f"{text[:57]}..."
