"""Pressure of a fluid that comes from one end of an edge and gets as far as the contact lets it.

    R_i += -p w_i a_i,    a_i = 1/2 sum of the sides at i, turned into the body

A follower load: the sides turn. The weights w_i are those of ``fluid_law``, from the contact pressures
of the rigid profiles that may touch the edge; they couple a point of the front with all beyond it.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from seal_mdao import values
from seal_mdao.loads.fluid_closing import Closing, ClosingRates, closing_names
from seal_mdao.loads.fluid_law import accumulated, wetting
from seal_mdao.loads.ramp import at_fraction
from seal_mdao.terms.coupled_term import CoupledResponse, CoupledTerm, LocalMap
from seal_mdao.terms.points import MaterialPoints, fixed_points, single_points
from seal_mdao.terms.term import Scalar, TermDefinition

SHARE = 0.05
"""Of the fluid's pressure, by which the seal has to press with more where it is to stay dry."""

ENDS = ("start", "end")

_NO_BRANCH = np.empty(0, int)


@dataclass(frozen=True, eq=False)
class FluidPressure(TermDefinition):
    """A fluid at one end of an edge.

    Attributes
    ----------
    label : str
        Before the name of its parameter, ``label_pressure``.
    edge : ndarray of int, shape (k,)
        Particles along the edge, the body on the left.
    end : {"start", "end"}
        Of the edge, from which the fluid comes.
    pressure : float
        Over that at the other end, kPa, at a ramp of 1.
    ramp : ndarray, shape (n_steps + 1,)
        Multiplier at the start and after every nominal step; straight between.
    contacts : tuple of RigidContact
        Profiles that close the edge; their points are particles. What is a parameter of theirs is one of
        the fluid's, too.
    share : float
        Where the seal presses with more than 1 + share times the fluid's pressure it is dry.

    Raises
    ------
    ValueError
        For a negative pressure or ramp, a share that is not above 0 and at most 1, another end, an edge
        of less than two particles, contacts whose points lie between particles.
    """

    label: str
    edge: np.ndarray
    end: str
    pressure: float
    ramp: np.ndarray
    contacts: tuple
    share: float = SHARE

    def __post_init__(self):
        values.real(f"pressure of {self.label!r}", self.pressure, 0.0)
        values.real(f"share of {self.label!r}", self.share, above=0.0, high=1.0)
        values.one_of(f"end of {self.label!r}", self.end, ENDS)
        ramp = values.numbers(f"ramp of {self.label!r}", self.ramp)
        if ramp.ndim != 1 or not (np.isfinite(ramp) & (ramp >= 0.0)).all():
            raise ValueError(f"ramp of {self.label!r} must be numbers of at least 0, one a step")
        if len(self.edge) < 2:
            raise ValueError(f"the edge of {self.label!r} needs at least two particles")
        for contact in self.contacts:
            contact.where.at_particles  # noqa: B018

    @property
    def particles(self) -> np.ndarray:
        """From the wet end on."""
        edge = np.asarray(self.edge, int)
        return edge if self.end == "start" else edge[::-1]

    @property
    def where(self) -> MaterialPoints:
        """The points: the particles themselves."""
        return fixed_points(single_points(self.particles), 0.0)

    @property
    def own_name(self) -> str:
        """Of the parameter that is the fluid's alone."""
        return f"{self.label}_pressure"

    @property
    def scalars(self) -> dict:
        """The pressure, and what decides how the profiles press."""
        found = {self.own_name: Scalar(self.pressure, "kPa", "Pressure of the fluid.")}
        for contact in self.contacts:
            found |= {name: contact.scalars[name] for name in closing_names(contact)}
        return found

    def with_parameters(self, values: dict) -> "FluidPressure":
        """The fluid with another pressure, or behind profiles with other parameters."""
        contacts = tuple(
            contact.with_parameters(
                {name: value for name, value in values.items() if name in contact.scalars}
            )
            for contact in self.contacts
        )
        pressure = values.get(self.own_name, self.pressure)
        return replace(self, pressure=pressure, contacts=contacts)

    def point_set(self):
        """The particles of the edge."""
        return self.where.points

    def pairs(self):
        """Every point with those before it, and its neighbours."""
        return np.argwhere(np.tri(len(self.edge), k=1, dtype=bool))

    def on(self, discretization, place) -> "FluidPressureTerm":
        """The term on one design."""
        return FluidPressureTerm(self, discretization, place)


class FluidPressureTerm(CoupledTerm):
    """``FluidPressure`` in one design; what it gives are at every point, from the wet end on, the
    fluid's weight and the contact pressure of the profiles, kPa."""

    output_names = ("weight", "closing")

    def __init__(self, definition: FluidPressure, discretization, place: int):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, place
        )
        k, size = len(self.where), float(np.abs(self.reference).max())
        self.pressure, self.ramp = definition.pressure, np.asarray(definition.ramp, float)
        self.share, self.output_places = definition.share, k
        self.rounding = self.pressure * float(self.ramp.max()) * size
        self.closings = [
            Closing(contact, definition.particles, self.names) for contact in definition.contacts
        ]
        # a_i = half a quarter turn of the way from the point before to the one after
        self._after, self._before = np.minimum(np.arange(1, k + 1), k - 1), np.maximum(
            np.arange(-1, k - 1), 0
        )
        self._turn = (0.5 if definition.end == "start" else -0.5) * np.array(
            [[0.0, -1.0], [1.0, 0.0]]
        )

    # ---- the state ----

    def pressure_at(self, fraction: float) -> float:
        """Of the fluid after ``fraction`` nominal steps, kPa."""
        return self.pressure * float(at_fraction(self.ramp, fraction))

    def _closing(self, x, fraction) -> np.ndarray:
        """Contact pressure of all profiles, shape (k,)."""
        return sum(
            (closing.pressure(x, fraction) for closing in self.closings), np.zeros(len(x))
        )

    def _closing_rates(self, x, fraction) -> ClosingRates:
        found = ClosingRates(np.zeros((len(x), 2)), np.zeros((len(x), len(self.names))))
        for closing in self.closings:
            found = ClosingRates(*map(np.add, found, closing.rates(x, fraction)))
        return found

    def _areas(self, x) -> np.ndarray:
        """a_i, shape (k, 2)."""
        return (x[self._after] - x[self._before]) @ self._turn.T

    # ---- what a coupled term gives ----

    def respond(self, x, fraction, history) -> CoupledResponse:
        pressure, closing = self.pressure_at(fraction), self._closing(x, fraction)
        weight, *slopes = wetting(closing, pressure, self.share)
        area = self._areas(x)
        pairs, tangent = self._turning(pressure * weight)
        front = np.flatnonzero(slopes[0])
        if front.size:
            on_closing, _ = accumulated(*slopes, front)
            by_place = self._closing_rates(x, fraction).by_place[front]
            i, j = np.nonzero(on_closing)
            own = -pressure * on_closing[i, j, None, None] * area[i, :, None] * by_place[j, None]
            pairs = np.concatenate([pairs, np.column_stack([i, front[j]])])
            tangent = np.concatenate([tangent, own])
        return CoupledResponse(
            x, -pressure * weight[:, None] * area, (weight > 0.0).astype(np.int64), pairs, tangent,
            np.empty((0, *x.shape)), np.empty(0), _NO_BRANCH, None,
            np.column_stack([weight, closing]),
        )  # fmt: skip

    def _turning(self, size):
        """Pairs of points and tangents of forces -size a_i, in which the sides turn."""
        at = np.flatnonzero(size)
        turn = -size[at, None, None] * self._turn
        pairs = [np.column_stack([at, other[at]]) for other in (self._after, self._before)]
        return np.concatenate(pairs), np.concatenate([turn, -turn])

    def linearize(self, response, fraction, history):
        x, k = response.x, len(self.where)
        at_x, _, _, at_parameters, at_reference = self.inputs
        pressure, (weight, closing) = self.pressure_at(fraction), response.outputs.T
        slopes = wetting(np.ascontiguousarray(closing), pressure, self.share)[1:]
        by_closing, by_pressure = accumulated(*slopes, np.arange(k))
        rates, area, grown = self._closing_rates(x, fraction), self._areas(x), np.zeros(k)
        of_closing = np.zeros((k, at_reference.stop))
        of_closing[np.arange(k)[:, None], at_x.start + 2 * np.arange(k)[:, None] + [0, 1]] = (
            rates.by_place
        )
        of_closing[:, at_parameters] = rates.by_parameter
        of_weight, share = by_closing @ of_closing, float(at_fraction(self.ramp, fraction))
        of_weight[:, at_parameters.start] += share * by_pressure
        grown = pressure * of_weight
        grown[:, at_parameters.start] += share * weight
        force = -(area[:, :, None] * grown[:, None]).reshape(2 * k, -1)
        pairs, turn = self._turning(pressure * weight)
        rows = 2 * pairs[:, 0, None, None] + np.arange(2)[:, None]
        columns = at_x.start + 2 * pairs[:, 1, None, None] + np.arange(2)[None, :]
        np.add.at(force, (rows, columns), turn)
        given = np.stack([of_weight, of_closing], axis=1).reshape(2 * k, -1)
        whole = np.concatenate([force, given])
        none = np.zeros((len(whole), 0)), np.zeros((0, at_reference.stop))
        return LocalMap(csr_array(whole), *none)

    # ---- the path ----

    def changes(self, step, response, target):
        """The pressure grows; the profiles move on under the fluid's weights as they are."""
        weight, closing = response.outputs.T
        share = float(at_fraction(self.ramp, target) - at_fraction(self.ramp, step.fraction))
        change = self.pressure * share
        if change == 0.0:
            return []
        pressure = self.pressure_at(step.fraction)
        slopes = wetting(np.ascontiguousarray(closing), pressure, self.share)[1:]
        _, by_pressure = accumulated(*slopes, _NO_BRANCH)
        size = change * (weight + pressure * by_pressure)
        force = np.zeros(self.discretization.layout.force_size)
        every = np.ones(len(weight), np.int64)
        self._add_force(-size[:, None] * self._areas(response.x), every, force)
        return [force]

    def describe(self, response, fraction):
        weight = response.outputs[:, 0]
        return (
            f"{self.label}: {self.pressure_at(fraction):.4g} kPa, {int(np.sum(weight > 0.5))} of "
            f"{len(weight)} points wetted"
        )
