"""Shapes of rigid profiles: what may change about them, and the profile that follows."""

from dataclasses import dataclass
from typing import Protocol

from seal_mdao.geometry.profile import RigidProfile


class Shape(Protocol):
    """A frozen dataclass with what may change as fields.

    Attributes
    ----------
    names : tuple of str
        Fields that are parameters, in the order of the profile's rates.
    """

    names: tuple

    def profile(self) -> RigidProfile:
        """Pieces and their rates with respect to ``names``, in the profile's own frame."""


@dataclass(frozen=True, eq=False)
class GivenShape:
    """A shape without parameters.

    Attributes
    ----------
    outline : RigidProfile
    """

    outline: RigidProfile
    names = ()

    def profile(self) -> RigidProfile:
        """The outline."""
        return self.outline
