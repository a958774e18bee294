"""What the design parameters move: the data of the right-hand sides of Eq. (70)."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.model import SealModel

CONSTANTS = ("c10", "c01", "bulk_modulus")
CONTACT_INPUTS = ("door_radius", "normal_penalty", "tangent_penalty", "friction")
SCALARS = (*CONTACT_INPUTS, *CONSTANTS, "depth")


@dataclass(frozen=True, eq=False)
class ParameterRates:
    """Rates of all data of the analysis with respect to P parameters.

    Attributes
    ----------
    names : tuple of str
    velocity : ndarray, shape (P, n, 2)
        Design velocity V of the particles, Eq. (48).
    contact : ndarray, shape (P, 4)
        Rates of door radius, w_n, w_t and mu.
    constants : ndarray, shape (P, 3)
        Rates of C10, C01 and the bulk modulus.
    motion : ndarray, shape (P, 2)
        Rate of the profile's final position; earlier ones follow in proportion.
    """

    names: tuple
    velocity: np.ndarray
    contact: np.ndarray
    constants: np.ndarray
    motion: np.ndarray

    @property
    def count(self) -> int:
        return len(self.names)


def parameter_rates(
    model: SealModel, scalars=("door_radius",), velocity: np.ndarray | None = None
) -> ParameterRates:
    """Rates for the boundary offsets followed by scalar parameters.

    Parameters
    ----------
    scalars : sequence of str
        Names out of ``SCALARS``.
    velocity : ndarray, shape (P, n, 2), optional
        Design velocities in place of those of the boundary offsets.
    """
    unknown = [name for name in scalars if name not in SCALARS]
    if unknown:
        raise ValueError(f"unknown parameter {unknown[0]!r}; known are {SCALARS}")
    if velocity is None:
        velocity = model.design_velocity
        names = tuple(f"boundary_offsets[{i}]" for i in range(len(velocity)))
    else:
        names = tuple(f"velocity[{i}]" for i in range(len(velocity)))
    shape, total = len(velocity), len(velocity) + len(scalars)
    rates = ParameterRates(
        names + tuple(scalars),
        np.concatenate([velocity, np.zeros((len(scalars), *velocity.shape[1:]))]),
        np.zeros((total, 4)), np.zeros((total, 3)), np.zeros((total, 2)),
    )  # fmt: skip
    for row, name in enumerate(scalars, start=shape):
        if name in CONTACT_INPUTS:
            rates.contact[row, CONTACT_INPUTS.index(name)] = 1.0
        elif name in CONSTANTS:
            rates.constants[row, CONSTANTS.index(name)] = 1.0
        else:
            rates.motion[row] = (0.0, -1.0)
    return rates
