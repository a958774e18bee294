"""Variations between scenarios: parameters that are replaced, shifted or multiplied."""

from dataclasses import dataclass, field

import numpy as np

from seal_mdao import values
from seal_mdao.distributions import FACTOR, KINDS, SHIFT, VALUE
from seal_mdao.seals.seal import Seal

SCENARIOS_OPTION = "scenarios_table"
"""Option of a ``ScenarioGroup`` with the JSON text of ``Scenarios.table``, for recorder files."""

STEP = 2.0**-100
"""Complex step: a power of two, by which products and quotients are exact."""


@dataclass(frozen=True)
class Variation:
    """Varying quantity, with one number per scenario.

    Attributes
    ----------
    name : str
    kind : {"value", "shift", "factor"}
        The number replaces the value of the design, is added to it, or multiplies it.
    parameters : tuple of str
        Scalar parameters of the seal; ``(name,)`` by default. A hardness may be a factor of all
        constants of a rubber except the bulk modulus.
    """

    name: str
    kind: str = VALUE
    parameters: tuple = ()

    def __post_init__(self):
        values.one_of(f"kind of {self.name!r}", self.kind, KINDS)
        # by default the parameter of the same name
        object.__setattr__(self, "parameters", tuple(self.parameters) or (self.name,))

    def applied(self, value: float, number: float) -> float:
        """Apply the number to the value of a parameter."""
        # p = n, p = v + n, or p = v n
        return {VALUE: number, SHIFT: value + number, FACTOR: value * number}[self.kind]

    def heading(self, seal: Seal) -> str:
        """Format its name with kind and unit, such as ``lid_y (shift, mm)``, for a column of numbers."""
        units = {seal.scalars[name].units for name in self.parameters if name in seal.scalars}
        # a factor has no unit, nor have parameters with different ones
        unit = units.pop() if len(units) == 1 and self.kind != FACTOR else None
        parts = [*([] if self.kind == VALUE else [self.kind]), *([unit] if unit else [])]
        return f"{self.name} ({', '.join(parts)})" if parts else self.name

    def described(self, number: float) -> str:
        """Format one of its numbers, such as ``lid_friction = 0.3`` or ``hardness * 1.1``."""
        if self.kind == SHIFT:
            return f"{self.name} {'-' if number < 0.0 else '+'} {abs(number):.6g}"
        return f"{self.name} {'=' if self.kind == VALUE else '*'} {number:.6g}"


@dataclass(frozen=True, eq=False)
class Scenarios:
    """Numbers of S scenarios of a seal.

    Attributes
    ----------
    variations : tuple of Variation
    numbers : ndarray, shape (S, len(variations))
    offsets : ndarray, shape (S, P), optional
        Added to the boundary offsets of the design, mm.

    Raises
    ------
    ValueError
        For arrays that do not fit each other, numbers that are not finite, names that repeat.
    """

    variations: tuple
    numbers: np.ndarray
    offsets: np.ndarray | None = field(default=None)

    def __post_init__(self):
        object.__setattr__(self, "variations", tuple(self.variations))
        names = [variation.name for variation in self.variations]
        if len(set(names)) < len(names):
            raise ValueError(
                f"the variations of scenarios must have different names, got {', '.join(names)}"
            )
        numbers = values.numbers("numbers of scenarios", self.numbers)
        if numbers.ndim != 2 or numbers.shape[1] != len(names) or not len(numbers):
            raise ValueError(
                f"the parameter values of scenarios (numbers) must have shape (S, {len(names)}) with "
                f"at least one scenario (S), got {numbers.shape}"
            )
        object.__setattr__(self, "numbers", numbers)
        if self.offsets is not None:
            offsets = values.numbers("offsets of scenarios", self.offsets)
            if offsets.ndim != 2 or len(offsets) != len(numbers):
                raise ValueError(
                    f"the boundary offsets of scenarios (offsets) must have shape ({len(numbers)}, "
                    f"P), got {offsets.shape}"
                )
            object.__setattr__(self, "offsets", offsets)
        for array in (numbers, self.offsets):
            if array is not None and not np.isfinite(array).all():
                raise ValueError(
                    "the parameter values (numbers) and boundary offsets (offsets) of scenarios "
                    "must be finite"
                )

    def __len__(self) -> int:
        return len(self.numbers)

    @property
    def parameters(self) -> tuple:
        """Names of all parameters that vary, each once."""
        return tuple(dict.fromkeys(name for own in self.variations for name in own.parameters))

    def check(self, seal: Seal) -> None:
        """Raise ValueError if a seal lacks the parameters, has another number of offsets, or has a
        parameter of zero that is to be multiplied."""
        unknown = [name for name in self.parameters if name not in seal.scalars]
        if unknown:
            raise ValueError(
                f"scenarios vary the unknown parameter {unknown[0]!r}; the parameters of the seal "
                f"are {', '.join(seal.scalars)}"
            )
        for variation in self.variations:
            for name in variation.parameters if variation.kind == FACTOR else ():
                if seal.scalars[name].value == 0.0:
                    raise ValueError(
                        f'scenarios: kind = "factor" has no effect on {name}, which is zero; use kind = '
                        '"shift" or "value"'
                    )
        if self.offsets is not None and self.offsets.shape[1] != seal.n_offsets:
            raise ValueError(
                f"the boundary offsets of scenarios (offsets) must have shape ({len(self)}, "
                f"{seal.n_offsets}), got {self.offsets.shape}"
            )

    def described(self, number: int) -> str:
        """Describe a scenario by its number from 1 and the numbers of its variations, for messages."""
        pairs = zip(self.variations, self.numbers[number].tolist(), strict=True)
        found = [variation.described(own) for variation, own in pairs]
        found += [] if self.offsets is None else ["boundary offsets of its own"]
        return f"scenario {number + 1} of {len(self)}" + (f" ({', '.join(found)})" if found else "")

    def table(self, seal: Seal) -> dict:
        """Tabulate the numbers for reports: names of ``columns`` with the units of the seal's
        parameters, and ``rows`` of S scenarios; of the offsets the largest of each scenario, mm."""
        columns = [variation.heading(seal) for variation in self.variations]
        rows = self.numbers
        if self.offsets is not None:
            columns.append("largest boundary offset (mm)")
            # max_p |b_p| of every scenario
            largest = np.abs(self.offsets).max(axis=1, initial=0.0)
            rows = np.column_stack([rows, largest])
        return {"columns": columns, "rows": rows.tolist()}

    def values(self, number: int, design: dict) -> dict:
        """Compute the parameters of one scenario by name, from those of the design."""
        return self._varied(self.numbers[number], design)

    def boundary(self, number: int, offsets: np.ndarray) -> np.ndarray:
        """Compute the boundary offsets of one scenario from those of the design, (P,)."""
        return offsets if self.offsets is None else offsets + self.offsets[number]

    def rates(self, number: int, design: dict) -> tuple[np.ndarray, np.ndarray]:
        """Differentiate the N parameters of a scenario, in the order of ``design``.

        Returns
        -------
        by_design : ndarray, shape (N,)
            Derivative of every parameter in its own value of the design.
        by_number : ndarray, shape (N, K)
            Derivatives in the numbers of the K variations.
        """
        row, step = self.numbers[number], 1j * STEP
        # dp/dv = Im p(v + i h) / h; a parameter depends on its own value only, so all step at once
        stepped = self._varied(row, {name: value + step for name, value in design.items()})
        by_design = np.imag([stepped[name] for name in design]) / STEP
        # dp/dn_k = Im p(n + i h e_k) / h
        by_number = np.zeros((len(design), row.size))
        for k, unit in enumerate(np.eye(row.size)):
            stepped = self._varied(row + step * unit, design)
            by_number[:, k] = np.imag([stepped[name] for name in design]) / STEP
        return by_design, by_number

    def _varied(self, row: np.ndarray, design: dict) -> dict:
        found = dict(design)
        for variation, own in zip(self.variations, row.tolist(), strict=True):
            for name in variation.parameters:
                found[name] = variation.applied(found[name], own)
        return found
