"""Shapes of rigid profiles as functions of their shape parameters."""

from dataclasses import dataclass
from typing import Protocol

from seal_mdao.geometry.profile import RigidProfile


class Shape(Protocol):
    """Base class of shapes: a frozen dataclass with the shape parameters as fields.

    Attributes
    ----------
    names : tuple of str
        Fields that are parameters, in the order of the profile's rates.
    """

    names: tuple

    def profile(self) -> RigidProfile:
        """Build the pieces and their rates with respect to ``names``, in the profile's own frame."""


@dataclass(frozen=True, eq=False)
class GivenShape:
    """Shape without parameters.

    Attributes
    ----------
    outline : RigidProfile
    """

    outline: RigidProfile
    names = ()

    def profile(self) -> RigidProfile:
        """Return the outline."""
        return self.outline
