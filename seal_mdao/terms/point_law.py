"""Terms at single points defined by one formula, whose derivatives are computed by complex steps.

The columns of the law's linearisation are found by complex steps, exact to rounding: with the step
1e-30 i in one input, the imaginary part of the law over 1e-30 is its derivative. A class may give the
linearisation itself, as one dense block for every point.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from seal_mdao.terms.point_term import PointResponse, PointTerm
from seal_mdao.terms.term import Scalar, TermDefinition

COMPLEX_STEP = 1e-30
"""Imaginary step in an input: derivatives are exact to rounding."""


class LawInputs(NamedTuple):
    """Inputs of a law at s points.

    Attributes
    ----------
    x : ndarray, shape (s, 2)
        Deformed places, mm.
    history : ndarray, shape (s, history_size)
        As the step before passed it on; zero at first.
    measure : ndarray, shape (s, 1)
        Length that a point stands for, mm.
    parameters : SimpleNamespace
        The fields of ``PointLaw.parameters``, each of shape (s, 1).
    reference : ndarray, shape (s, 2)
        Undeformed places, mm.
    """

    x: np.ndarray
    history: np.ndarray
    measure: np.ndarray
    parameters: SimpleNamespace
    reference: np.ndarray


class PointLaw(TermDefinition):
    """Base class of a term given by its law. A subclass is a frozen dataclass with the fields
    ``label`` and ``where`` (``MaterialPoints``), and defines ``evaluate``.

    Attributes
    ----------
    parameters : dict of str to str
        Fields that are scalar parameters, with their units; ``label_field`` is the parameter's name.
    history_size : int
        Variables that a point passes to the next step.
    output_names : tuple of str
        What measures may take besides the force.
    """

    parameters: dict = {}  # noqa: RUF012
    history_size = 0
    output_names: tuple = ()

    def evaluate(self, given: LawInputs, fraction: float):
        """Evaluate the law at the path parameter ``fraction``, in nominal load steps.

        Formulas of numpy that hold for complex numbers; conditions are decided on real parts.

        Returns
        -------
        force : ndarray, shape (s, 2)
            It joins the residual as it is: minus what acts on the body.
        history, outputs : ndarray, shapes (s, history_size), (s, len(output_names))
            Where the class has any; (force, history, outputs) then.
        """
        raise NotImplementedError

    def linearize(self, given: LawInputs, fraction: float) -> np.ndarray:
        """Compute the derivatives of the law: rows force, history, outputs; columns x, history,
        measure, parameters, X; shape (s, rows, columns). Complex steps are used unless a subclass
        overrides this."""
        return self._by_complex_steps(given, fraction)

    def tangent(self, given: LawInputs, fraction: float) -> np.ndarray:
        """Compute the derivatives of the force with respect to x, for every Newton iteration; shape
        (s, 2, 2)."""
        if type(self).linearize is PointLaw.linearize:
            # dforce/dx: the columns of x alone, rows of the force
            return self._by_complex_steps(given, fraction, 2)[:, :2]
        return self.linearize(given, fraction)[:, :2, :2]

    def _by_complex_steps(self, given: LawInputs, fraction: float, count: int | None = None):
        """All columns of the linearisation, or the first ones."""
        flat, columns = _flat(given), []
        for column in range(flat.shape[1] if count is None else count):
            # column j: Im law(inputs + i h e_j) / h, exact to rounding
            moved = flat.astype(complex)
            moved[:, column] += 1j * COMPLEX_STEP
            rows = np.hstack(self.evaluated(_given(self, moved), fraction))
            columns.append(rows.imag / COMPLEX_STEP)
        return np.stack(columns, axis=2)

    def evaluated(self, given: LawInputs, fraction: float) -> tuple:
        """Return (force, history, outputs) of the law, empty arrays for those that the class does
        not have."""
        found = self.evaluate(given, fraction)
        found = found if isinstance(found, tuple) else (found,)
        none = np.empty((len(given.x), 0))
        return (*found, none, none)[:3]

    # ---- the contract of a definition ----

    @property
    def scalars(self) -> dict:
        return {
            f"{self.label}_{name}": Scalar(getattr(self, name), units, f"{name} of {self.label!r}.")
            for name, units in self.parameters.items()
        }

    def with_parameters(self, values: dict) -> "PointLaw":
        first = len(self.label) + 1
        return replace(self, **{name[first:]: value for name, value in values.items()})

    def point_set(self):
        return self.where.points

    def on(self, discretization, index) -> "LawTerm":
        return LawTerm(self, discretization, index)


def _flat(given: LawInputs) -> np.ndarray:
    """All inputs of every point, shape (s, columns)."""
    parameters = vars(given.parameters).values()
    return np.hstack([given.x, given.history, given.measure, *parameters, given.reference])


def _given(definition: PointLaw, flat: np.ndarray) -> LawInputs:
    """The inverse of ``_flat``."""
    # columns x (2), history, measure, parameters, X (2)
    at = 2 + definition.history_size
    names = enumerate(definition.parameters, at + 1)
    parameters = SimpleNamespace(**{name: flat[:, [column]] for column, name in names})
    return LawInputs(flat[:, :2], flat[:, 2:at], flat[:, [at]], parameters, flat[:, -2:])


class LawTerm(PointTerm):
    """``PointLaw`` for one design."""

    uses_reference = True

    def __init__(self, definition: PointLaw, discretization, index: int):
        self.definition = definition
        self.history_size, self.output_names = definition.history_size, definition.output_names
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, index
        )

    def no_history(self):
        return np.zeros((len(self.where), self.history_size))

    def _inputs(self, x, history, points) -> LawInputs:
        definition, column = self.definition, np.ones((points.size, 1))
        values = {name: getattr(definition, name) * column for name in definition.parameters}
        return LawInputs(
            x[points], history[points], self.length[points, None], SimpleNamespace(**values),
            self.reference[points],
        )  # fmt: skip

    def respond(self, x, fraction, history):
        every = np.arange(len(x))
        # x, h, w, theta, X of all points
        given = self._inputs(x, history, every)
        force, passed, outputs = self.definition.evaluated(given, fraction)
        # ds/dx: the first rows and columns of L
        tangent = np.ascontiguousarray(self.definition.tangent(given, fraction))
        return PointResponse(x, force, tangent, np.ones(len(x), int), passed, outputs)

    def linearize(self, response, fraction, history, points):
        given = self._inputs(response.x, history, points)
        return self.definition.linearize(given, fraction)
