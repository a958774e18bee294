"""The nominal seal under a wholly flat door, friction 0.25, from an independent finite element code.

Biquadratic displacements, discontinuous linear pressure, 8 x 232 elements, augmented-Lagrangian
contact, 100 steps to 10 mm. Its own discretisation error is about 0.5 %; with 4 x 116 elements the
final force differs by 0.1 %.
"""

import numpy as np

# door travel from first touch (mm), vertical reaction (N/m)
REACTION = np.array(
    [
        [2.0, 13.674875],
        [4.0, 24.233102],
        [6.0, 35.704187],
        [8.0, 49.517427],
        [10.0, 64.567162],
    ]
)


def at_its_travels(travel: np.ndarray, reaction: np.ndarray) -> np.ndarray:
    """A vertical reaction (k,) along the travel (k,) since first touch, mm, at those of ``REACTION``."""
    return np.interp(REACTION[:, 0], travel, reaction)


def reaction_errors(travel: np.ndarray, reaction: np.ndarray) -> np.ndarray:
    """Its relative errors there, shape (5,)."""
    return at_its_travels(travel, reaction) / REACTION[:, 1] - 1.0


# the right half of the outer boundary at the rays of the 58 x 3 particles, from the base to the
# top: undeformed X, Y and deformed x, y at 10 mm (mm); the left half mirrors it
BOUNDARY = np.array(
    [
        [4.084438, -8.828369, 4.001312, -9.188641],
        [4.926642, -8.188142, 4.840704, -8.990482],
        [5.749155, -7.562884, 5.717550, -8.960136],
        [6.533145, -6.896957, 6.648714, -8.998326],
        [7.240540, -6.150170, 7.629846, -8.997696],
        [7.863045, -5.331277, 8.656089, -8.904323],
        [8.393364, -4.449880, 9.707801, -8.656628],
        [8.825279, -3.516312, 10.738313, -8.193734],
        [9.153725, -2.541519, 11.665815, -7.471712],
        [9.374852, -1.536929, 12.377490, -6.488990],
        [9.486067, -0.514320, 12.756542, -5.310066],
        [9.486067, 0.514320, 12.729080, -4.064362],
        [9.374852, 1.536929, 12.301943, -2.905845],
        [9.153725, 2.541519, 11.558648, -1.955093],
        [8.825279, 3.516312, 10.617428, -1.265222],
        [8.393364, 4.449880, 9.586587, -0.826490],
        [7.863045, 5.331277, 8.541549, -0.591564],
        [7.240540, 6.150170, 7.522739, -0.502538],
        [6.533145, 6.896957, 6.542770, -0.500014],
        [5.749155, 7.562884, 5.586464, -0.500000],
        [4.897762, 8.140143, 4.644953, -0.500000],
        [3.988946, 8.621966, 3.710712, -0.500001],
        [3.033365, 9.002705, 2.781599, -0.500001],
        [2.042219, 9.277895, 1.854116, -0.500001],
        [1.027131, 9.444311, 0.927025, -0.500032],
        [0.000000, 9.500000, 0.000000, -0.500088],
    ]
)
