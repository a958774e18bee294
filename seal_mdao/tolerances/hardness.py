"""Stiffness of a rubber from its hardness."""

from seal_mdao.values import real

LEAST_SHORE, MOST_SHORE = 20.0, 95.0


def shore_modulus(shore: float) -> float:
    """Compute Young's modulus of a rubber from its Shore A hardness, kPa.

    E = 98.1 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)), Gent (1958), "On the relation between
    indentation hardness and Young's modulus", Rubber Chemistry and Technology 31.

    Raises
    ------
    ValueError
        Below 20 and above 95 Shore, where the formula does not hold.
    """
    # E(S) of Gent (1958)
    s = real("Shore hardness", shore, LEAST_SHORE, MOST_SHORE)
    return 98.1 * (56.0 + 7.62336 * s) / (0.137505 * (254.0 - 2.54 * s))


def hardness_factor(shore: float, change: float) -> float:
    """Compute the factor of all constants of a rubber except the bulk modulus, for a change of hardness.

    Parameters
    ----------
    shore, change : float
        Nominal hardness and its change, Shore A.

    Examples
    --------
    >>> round(hardness_factor(50.0, 5.0), 3)
    1.208
    """
    return shore_modulus(shore + change) / shore_modulus(shore)
