"""Prescribed displacements of the fixed components, with parameters."""

from dataclasses import dataclass, field, replace

import numpy as np

from seal_mdao.terms.ramp import at_ends, at_fraction
from seal_mdao.terms.term import Scalar


@dataclass(frozen=True, eq=False)
class ImposedDisplacements:
    """Prescribed displacements along the path: base + sum of parameters times shapes.

    Attributes
    ----------
    values : ndarray, shape (n_steps + 1, n, 2)
        At the start and after every nominal step; linear between. Those of free components are not
        used.
    names : tuple of str
        Scalar parameters.
    rates : ndarray, shape (len(names), n_steps + 1, n, 2)
        Derivatives of ``values`` with respect to them.
    """

    values: np.ndarray
    names: tuple = ()
    rates: np.ndarray = field(default_factory=lambda: np.empty((0, 0, 0, 0)))

    @property
    def scalars(self) -> dict:
        """Parameters, zero at the given ``values``."""
        return {name: Scalar(0.0, None, f"Imposed displacement: {name}.") for name in self.names}

    @property
    def labels(self) -> tuple:
        """Names of moved edges: none."""
        return ()

    @property
    def varies(self) -> bool:
        """Whether the displacements depend on a parameter or on the undeformed particles."""
        return bool(self.names)

    def on(self, particles: np.ndarray) -> "ImposedDisplacements":
        """Bind the displacements to a design, on which they do not depend."""
        return self

    def with_parameters(self, values: dict) -> "ImposedDisplacements":
        """Return the displacements with parameters changed by ``values``."""
        # u = u_base + sum_p p du/dp
        change = sum(
            (value * self.rates[self.names.index(name)] for name, value in values.items()),
            np.zeros_like(self.values),
        )
        return replace(self, values=self.values + change)

    def with_ends(self, ends) -> "ImposedDisplacements":
        """Return the displacements for other load steps, whose ``ends`` are in nominal steps."""
        values, *rates = (at_ends(one, ends) for one in (self.values, *self.rates))
        return replace(self, values=values, rates=np.array(rates) if rates else self.rates)

    def at(self, fraction: float) -> np.ndarray:
        """Interpolate displacements (n, 2) at a path parameter."""
        return at_fraction(self.values, fraction)

    def linearization(self, fraction: float) -> np.ndarray:
        """Return the derivatives of the displacements with respect to the parameters, particle by
        particle: a matrix (2 n, len(names)) that the direct method multiplies, and the adjoint
        method's transpose."""
        rates = [at_fraction(rates, fraction).ravel() for rates in self.rates[: len(self.names)]]
        return np.array(rates).reshape(len(self.names), self.values[0].size).T

    def by_particles(self, fraction: float) -> np.ndarray:
        """Differentiate by the undeformed place of every particle: zero, shape (n, 2, 2)."""
        return np.zeros((*self.values[0].shape, 2))
