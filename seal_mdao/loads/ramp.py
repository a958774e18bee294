"""How a load grows along the path."""

import numpy as np


def at_fraction(values: np.ndarray, fraction: float) -> np.ndarray:
    """Values (n_steps + 1, ...) given after every nominal step, at a path parameter between them."""
    first = min(int(fraction), len(values) - 2)
    share = fraction - first
    return values[first] + share * (values[first + 1] - values[first])


def at_ends(values: np.ndarray, ends) -> np.ndarray:
    """The values (len(ends) + 1, ...) for load steps that end elsewhere, in nominal steps of now."""
    return np.stack([values[0], *(at_fraction(values, end) for end in ends)])
