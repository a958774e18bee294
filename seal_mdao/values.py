"""Check values given by users; one-line errors (ValueError, TypeError) state what is allowed."""

import math
import re
from numbers import Integral, Real

import numpy as np

_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


def real(name: str, value, low=-math.inf, high=math.inf, *, above=None, below=None) -> float:
    """Check a finite real number within bounds and return it as a float.

    Parameters
    ----------
    name : str
        Name of the value in the error.
    low, high : float
        Smallest and largest allowed value.
    above, below : float, optional
        Bounds that are excluded.

    Raises
    ------
    ValueError
        For a value that is no number, not finite, or out of bounds.
    """
    number = _as_float(value)
    allowed = number is not None and math.isfinite(number) and low <= number <= high
    # exclusive bounds
    if allowed:
        allowed = (above is None or number > above) and (below is None or number < below)
    if not allowed:
        raise ValueError(
            f"{name} must be a number{_range(low, high, above, below)}, got {formatted(value)}"
        )
    return number


def _as_float(value) -> float | None:
    """Convert a real number to a float, infinite where it overflows; None for anything else."""
    # bool is a subclass of int, but True is no length or modulus
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _range(low, high, above, below) -> str:
    # exclusive bounds take precedence in the text
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
    """Check an integer from ``low`` to ``high`` (not a boolean) and return it; else raise ValueError."""
    is_one = isinstance(value, Integral) and not isinstance(value, bool | np.bool_)
    if not is_one or value < low or (high is not None and value > high):
        upper = "" if high is None else f" and at most {high}"
        raise ValueError(
            f"{name} must be an integer of at least {low}{upper}, got {formatted(value)}"
        )
    return int(value)


def one_of(name: str, value, choices: tuple) -> str:
    """Check that a string is one of the ``choices`` and return it; else raise ValueError."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} must be one of {choices}, got {formatted(value)}")
    return str(value)


def flag(name: str, value) -> bool:
    """Check a boolean and return it; raise ValueError for any other value, 0 and 1 included."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be True or False, got {formatted(value)}")
    return bool(value)


def instance(name: str, value, kind: type) -> None:
    """Raise TypeError if a value is not an instance of a class."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise TypeError(f"{name} must be {article} {kind.__name__}, got {formatted(value)}")


def callback(name: str, value) -> None:
    """Raise TypeError if a value is neither callable nor None."""
    if value is not None and not callable(value):
        raise TypeError(f"{name} must be callable or None, got {formatted(value)}")


def numbers(name: str, values) -> np.ndarray:
    """Convert real numbers to an array of floats of any shape.

    Raises
    ------
    ValueError
        For text, lists of different lengths, complex numbers and other objects.
    """
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(
            f"{name} must be a rectangular array of numbers, but its lists differ in length"
        ) from None
    if array.dtype == object:  # fractions, and integers beyond 64 bits
        found = [_as_float(value) for value in array.ravel()]
        if None not in found:
            return np.array(found, float).reshape(array.shape)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be real numbers, got {formatted(values)}")
    return np.asarray(array, float)


def array(name: str, given, shape: tuple[int, ...]) -> np.ndarray:
    """Check finite real numbers of a given shape and return a new array of floats.

    Raises
    ------
    ValueError
        For another shape, numbers that are not finite, and values that ``numbers`` refuses.
    """
    found = np.array(numbers(name, given))
    require(found.shape == shape, f"{name} must have shape {shape}, got {found.shape}")
    require(np.isfinite(found).all(), f"{name} must have finite values only, not NaN or infinity")
    return found


def require(condition, message: str) -> None:
    """Raise ValueError with a message unless a condition holds."""
    if not condition:
        raise ValueError(message)


def place(point) -> str:
    """Format coordinates in mm for a message; zeros up to rounding are written as 0."""
    # 1e-9 mm is beyond any section in mm
    x, y = (round(float(own), 9) + 0.0 for own in point)
    return f"x = {x:.3g}, y = {y:.3g}"


def fraction(percentage: str) -> float:
    """Convert a percentage above 0 and at most 50, such as 1 or "1 %", to a fraction.

    Raises
    ------
    ValueError
        For a text that is none.
    """
    value = float(percentage.strip().removesuffix("%")) / 100.0
    return real("the fraction", value, above=0.0, high=0.5)


def formatted(value) -> str:
    """Format a value for an error message: one line of at most 60 characters."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # an integer of more digits than Python converts, or one inside a container
        bits = f"an integer of {value.bit_length()} bits" if isinstance(value, int) else ""
        return bits or f"a {type(value).__name__} with an integer of too many digits"
    return text if len(text) <= 60 else f"{text[:57]}..."


def without_numbers(message: str) -> str:
    """Return a message without its numbers: that of the same kind in another analysis is equal."""
    return _NUMBER.sub("", message)
