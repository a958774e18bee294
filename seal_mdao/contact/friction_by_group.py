"""Several friction laws in one contact, by groups of points: edges, or pairs of edges in self-contact.

Every group has Coulomb's law or another one; constants have the name of the group behind theirs:
``friction_lip``. At the points of a kernel the laws are limits and slopes, as those of ``friction_law``.
"""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao import values
from seal_mdao.contact.friction_law import FrictionLaw


@dataclass(frozen=True, eq=False)
class FrictionByGroup:
    """Friction laws by group.

    Attributes
    ----------
    names : tuple of str
        Of the groups; "" adds nothing to the names of constants.
    laws : tuple of float or FrictionLaw
        Coulomb coefficient, or another law, of every group.
    groups : ndarray of int, shape (k,), or None
        Group of every point; None until it is bound to points.

    Raises
    ------
    ValueError
        For a negative coefficient, or one that is no number.
    """

    names: tuple
    laws: tuple
    groups: np.ndarray | None = None

    name = "by group"

    def __post_init__(self):
        for name, law in zip(self.names, self.laws, strict=True):
            if not isinstance(law, FrictionLaw):
                values.real(f"friction of {name!r}", law, 0.0)

    def _constants(self, index: int) -> dict:
        """Return the constants of a group by the names that they have in the law itself."""
        law = self.laws[index]
        return law.by_name if isinstance(law, FrictionLaw) else {"friction": law}

    def _name(self, index: int, constant: str) -> str:
        return "_".join(filter(None, (constant, self.names[index])))

    @property
    def by_name(self) -> dict:
        """Constants of all groups by name."""
        return {
            self._name(i, constant): value
            for i in range(len(self.laws))
            for constant, value in self._constants(i).items()
        }

    def with_constants(self, changed: dict) -> "FrictionByGroup":
        """Return the laws with some constants changed."""
        laws = []
        for i, law in enumerate(self.laws):
            own = {c: changed.get(self._name(i, c), v) for c, v in self._constants(i).items()}
            laws.append(
                law.with_constants(own) if isinstance(law, FrictionLaw) else own["friction"]
            )
        return replace(self, laws=tuple(laws))

    def among(self, groups: np.ndarray) -> "FrictionByGroup":
        """Bind the laws to points of ``groups`` (k,)."""
        return replace(self, groups=groups)

    def at(self, pressure: np.ndarray) -> np.ndarray:
        """Evaluate limits and their derivatives at pressures (k,), as ``FrictionLaw.at``.

        Returns
        -------
        ndarray, shape (k, 2, 2 + m)
        """
        out, first = np.zeros((pressure.size, 2, 2 + len(self.by_name))), 2
        for i, law in enumerate(self.laws):
            points, end = self.groups == i, first + len(self._constants(i))
            if isinstance(law, FrictionLaw):
                # limit, d/dp, then the derivatives by the constants of this group
                found = law.at(pressure[points])
                out[points, :, :2], out[points, :, first:end] = found[..., :2], found[..., 2:]
            else:
                # mu p, d/dp = mu, d/dmu = p
                p = pressure[points, None]
                out[points, :, 0], out[points, :, 1], out[points, :, first] = law * p, law, p
            first = end
        return out

    def highest(self, pressure: np.ndarray) -> np.ndarray:
        """Return the largest limit of all groups and directions at pressures (k,), shape (k,)."""
        limits = [
            law.highest(pressure) if isinstance(law, FrictionLaw) else law * pressure
            for law in self.laws
        ]
        return np.max(limits, axis=0)
