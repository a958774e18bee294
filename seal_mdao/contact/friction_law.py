"""Friction laws other than Coulomb's (``friction``): each one function of pressure and constants.

    def pressure_dependent(pressure, friction, reference):
        return friction * pressure / (1.0 + pressure / reference)

A law gives the largest tangential traction, which takes the place of mu w_n |g_n| in Eqs. (28), (29):
one number, or a pair for slip along +e_t and along -e_t. Penalty, stick and slip, the history and all
derivatives are those of ``contact.friction``: numba compiles the function for complex numbers, and a
complex step of 1e-30 in an input gives that derivative exact to rounding.
"""

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numba
import numpy as np

from seal_mdao import values
from seal_mdao.terms.point_law import COMPLEX_STEP

MOST_SLOPE = 1e15
"""Larger derivatives show that the function is not real there: Im(f) / h with h = 1e-30."""

SAMPLES = np.array([0.7, 13.0, 170.0])
"""Pressures at which every law is checked, kPa."""

QUOTIENT_STEP, AGREEMENT = 1e-5, 1e-6
"""Relative step of difference quotients, and largest relative difference of the complex step."""

RESERVED = ("law", "normal_penalty", "tangent_penalty")
"""Names that no constant can have."""


@dataclass(frozen=True)
class FrictionLaw:
    """Friction law with the values of its constants; ``friction_law`` builds one from their names.

    Attributes
    ----------
    limits : callable
        ``limits(pressure, *constants)``: the largest tangential traction at a contact pressure (kPa), or
        two, for slip towards increasing and decreasing natural coordinate of the profile. It must be
        analytic where it is used: comparisons take ``pressure.real``, and ``abs``, ``min``, ``max``
        are not.
    constants : tuple of float
        In the order of its arguments.

    Raises
    ------
    ValueError
        For a function that numba cannot compile for complex numbers, whose complex step is not its
        derivative, or that gives no limit of at least zero; for constants that are no numbers.
    """

    limits: Callable
    constants: tuple

    def __post_init__(self):
        # constants are finite real numbers
        for name, value in self.by_name.items():
            values.real(f"{name} of the friction law {self.name!r}", value)
        self._check()

    @property
    def name(self) -> str:
        """Name of the function."""
        return getattr(self.limits, "__name__", repr(self.limits))

    @property
    def by_name(self) -> dict:
        """Constants by name."""
        return dict(zip(constant_names(self.limits), self.constants, strict=True))

    def with_constants(self, changed: dict) -> "FrictionLaw":
        """Return the law with some constants changed."""
        return replace(self, constants=tuple((self.by_name | changed).values()))

    def at(self, pressure: np.ndarray) -> np.ndarray:
        """Evaluate limits and their derivatives at pressures (k,).

        Returns
        -------
        ndarray, shape (k, 2, 2 + m)
            For slip along -e_t and along +e_t: the limit, d limit / d pressure, and d limit / d constant
            of the m constants. Zero without pressure; NaN where the limit is negative or no real number.
        """
        # an imaginary step in the pressure, then in every constant
        steps = COMPLEX_STEP * np.eye(1 + len(self.constants))
        found = np.stack([self._evaluated(pressure, stepped) for stepped in steps], axis=2)
        # limit = Re, slopes = Im / h
        limit, slopes = found[:, :, 0].real, found.imag / COMPLEX_STEP
        no_limit = (limit < 0.0) | (np.abs(slopes) > MOST_SLOPE).any(axis=2)
        return np.concatenate([np.where(no_limit, np.nan, limit)[:, :, None], slopes], axis=2)

    def highest(self, pressure: np.ndarray) -> np.ndarray:
        """The larger limit of both directions at pressures (k,), shape (k,)."""
        return self._evaluated(pressure, np.zeros(1 + len(self.constants))).real.max(axis=1)

    def _evaluated(self, pressure, stepped) -> np.ndarray:
        """Limits (k, 2) with imaginary steps (1 + m,) in the pressure and in the constants."""
        out = np.empty((pressure.size, 2), complex)
        constants = tuple(np.add(self.constants, 1j * stepped[1:]).tolist())
        _compiled(self.limits)(pressure + 1j * stepped[0], constants, out)
        return out

    def _check(self) -> None:
        """Compare complex steps with difference quotients at some pressures."""
        try:
            found = self.at(SAMPLES)
        except (numba.core.errors.NumbaError, NotImplementedError) as error:
            # numba's first sentence; of min and max of complex numbers a NotImplementedError
            reason = re.split(r" There are | During: ", " ".join(str(error).split()))[0]
            raise ValueError(
                f"friction law {self.name!r} cannot be compiled by Numba for complex numbers: "
                f"{reason}"
            ) from None
        if not np.isfinite(found).all():
            raise ValueError(
                f"friction law {self.name!r} must return finite friction limits of at least 0 kPa, "
                f"got {self._evaluated(SAMPLES, np.zeros(found.shape[2] - 1)).real.tolist()} at "
                f"the pressures {SAMPLES.tolist()}"
            )
        names = ("pressure", *self.by_name)
        for column, name in enumerate(names):
            quotient = self._quotient(column)
            # complex step against central difference
            off = np.abs(found[:, :, 1 + column] - quotient)
            if (off > AGREEMENT * (np.abs(quotient) + np.abs(found[:, :, 0]).max())).any():
                raise ValueError(
                    f"the complex-step derivative of friction law {self.name!r} with respect to "
                    f"{name} is wrong; replace abs, min, max and similar functions by comparisons "
                    "of real parts"
                )

    def _quotient(self, column: int) -> np.ndarray:
        """Central difference quotients (k, 2) of the limits by the pressure or a constant."""
        # (f(p + h) - f(p - h)) / (2 h)
        sides, place = [], np.array(self.constants, float)
        steps = np.full(SAMPLES.size, QUOTIENT_STEP) * SAMPLES
        if column:
            steps[:] = QUOTIENT_STEP * (abs(place[column - 1]) or 1.0)
        for sign in (1.0, -1.0):
            pressure, constants = SAMPLES + 0j, place.copy()
            if column:
                constants[column - 1] += sign * steps[0]
            else:
                # one step for each of the sample pressures
                pressure += sign * steps
            out = np.empty((SAMPLES.size, 2), complex)
            _compiled(self.limits)(pressure, tuple((constants + 0j).tolist()), out)
            sides.append(out.real)
        return (sides[0] - sides[1]) / (2.0 * steps[:, None])


def friction_law(limits: Callable, **constants: float) -> FrictionLaw:
    """Build a friction law from its function and the values of its constants; those with a default
    may be omitted.

    Raises
    ------
    ValueError
        For an unknown or a missing constant, and as of ``FrictionLaw``.
    """
    # constants by name: unknown and missing ones are errors
    names, defaults = constant_names(limits), constant_defaults(limits)
    name = getattr(limits, "__name__", repr(limits))
    for given in constants:
        if given not in names:
            raise ValueError(
                f"friction law {name!r} has no constant {given!r}; it has {', '.join(names) or 'none'}"
            )
    for wanted in names:
        if wanted not in constants | defaults:
            raise ValueError(
                f"friction law {name!r} has no value of its constant {wanted!r}; give one"
            )
    return FrictionLaw(limits, tuple((defaults | constants)[n] for n in names))


@cache
def constant_names(limits: Callable) -> tuple:
    """Return the names of the constants of a law: the arguments of its function after the pressure.

    Raises
    ------
    ValueError
        For a function without arguments, with such as ``*args``, or with a reserved name.
    """
    parameters = list(inspect.signature(limits).parameters.values())
    name = getattr(limits, "__name__", repr(limits))
    # the first argument is the pressure
    if not parameters or any(p.kind is not p.POSITIONAL_OR_KEYWORD for p in parameters):
        raise ValueError(
            f"friction law {name!r} must be a function of the pressure and of named constants"
        )
    names = tuple(p.name for p in parameters[1:])
    for taken in set(names) & set(RESERVED):
        raise ValueError(
            f"friction law {name!r}: the name {taken!r} of a constant is reserved; choose another "
            "name"
        )
    return names


def constant_defaults(limits: Callable) -> dict:
    """Return the defaults of the constants that have one."""
    parameters = list(inspect.signature(limits).parameters.values())[1:]
    return {p.name: p.default for p in parameters if p.default is not p.empty}


@cache
def _compiled(limits: Callable):
    """The law at points, compiled for complex numbers when it is made."""
    # one type signature: complex pressure and constants
    law = numba.njit(error_model="numpy")(limits)
    types = (numba.complex128,) * (1 + len(constant_names(limits)))
    law.compile(types)

    def one_limit(pressure, constants, out):
        for i in range(pressure.size):
            # no friction without pressure; one limit for both directions
            out[i] = law(pressure[i], *constants) if pressure[i].real > 0.0 else 0.0

    def two_limits(pressure, constants, out):
        out[:] = 0.0
        for i in range(pressure.size):
            if pressure[i].real > 0.0:
                # the law returns (+e_t, -e_t), the columns are (-e_t, +e_t)
                out[i, 1], out[i, 0] = law(pressure[i], *constants)

    pair = isinstance(law.overloads[types].signature.return_type, numba.types.BaseTuple)
    points = two_limits if pair else one_limit
    points.__module__ = limits.__module__  # for ``compilation``: it is no kernel of this package
    return numba.njit(error_model="numpy")(points)
