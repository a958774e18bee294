"""Pressure of a fluid on an edge: on all of it, or from one of its ends up to the contact.

    R_m += -p int N_m w n ds,    x = sum_n N_n(s) x_n

along every side of the edge (``pressed_sides``): a cubic through its ends and the two Gauss points of
the consistent integration. A uniform pressure all round is therefore in equilibrium with a uniform
hydrostatic stress (with straight sides a pressure of 2.5 shear moduli wrinkles the body). In a body of
revolution a side is turned about the axis: ds becomes c r ds. The weights w_i at the particles are those
of ``fluid_law``, from the true contact pressures of the rigid profiles that may touch the edge
(``fluid_closing``), and linear between; they couple a point of the front and its neighbours with all
points behind it. Contact at a sharp corner closes only the side behind it: the side before it has the
weight of its first particle. n follows the deformed sides: a follower load.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from seal_mdao import values
from seal_mdao.loads.fluid_closing import Closing, ClosingRates, closing_names
from seal_mdao.loads.fluid_law import accumulated, wetting
from seal_mdao.loads.pressed_sides import INNER, POINTS, PressedSides
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.terms.coupled_term import CoupledResponse, CoupledTerm, LocalMap
from seal_mdao.terms.points import MaterialPoints, fixed_points
from seal_mdao.terms.ramp import at_ends, at_fraction
from seal_mdao.terms.term import Scalar, TermDefinition

SHARE = 0.05
"""Default fraction of the fluid pressure by which the contact pressure exceeds it at a dry point."""

ENDS = ("start", "end")

_NO_BRANCH = np.empty(0, int)


@dataclass(frozen=True, eq=False)
class FluidPressure(TermDefinition):
    """Fluid pressure at one end of an edge.

    Attributes
    ----------
    label : str
        Before the name of its parameter, ``label_pressure``.
    edge : ndarray of int, shape (k,)
        Particles along the edge, the body on the left.
    end : {"start", "end"}
        End of the edge from which the fluid comes.
    pressure : float
        Excess over the pressure at the other end, or on the rest of the boundary, kPa, at a ramp of 1.
    ramp : ndarray, shape (n_steps + 1,)
        Multiplier at the start and after every nominal step; linear between.
    contacts : tuple of RigidContact
        Profiles that close the edge; their points are particles. Their parameters are parameters of the
        fluid, too. Without any the pressure acts on the complete edge, which may be closed: its first
        particle is then its last one, too.
    share : float
        A point is dry where the true contact pressure exceeds 1 + share times the fluid pressure.
    corners : ndarray of bool, shape (k,), or None
        Which of the particles are sharp corners; None for none.

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
    corners: np.ndarray | None = None

    def __post_init__(self):
        values.real(f"pressure of {self.label!r}", self.pressure, 0.0)
        values.real(f"share of {self.label!r}", self.share, above=0.0, high=1.0)
        values.one_of(f"end of {self.label!r}", self.end, ENDS)
        ramp = values.numbers(f"ramp of {self.label!r}", self.ramp)
        if ramp.ndim != 1 or not (np.isfinite(ramp) & (ramp >= 0.0)).all():
            raise ValueError(
                f"the ramp of the fluid pressure {self.label!r} must be a list of finite numbers "
                "of at least 0, one per load step"
            )
        if len(self.edge) < 2:
            raise ValueError(
                f"the edge on which the fluid pressure {self.label!r} acts needs at least two "
                "particles"
            )
        for contact in self.contacts:
            contact.where.at_particles  # noqa: B018

    @property
    def particles(self) -> np.ndarray:
        """Particles of the edge, ordered from the wet end."""
        edge = np.asarray(self.edge, int)
        return edge if self.end == "start" else edge[::-1]

    @property
    def weighted_by(self) -> np.ndarray:
        """Indices of the particles whose weights every side has at its ends, shape (k - 1, 2)."""
        first = np.arange(len(self.edge) - 1)
        if self.corners is None:
            return np.column_stack([first, first + 1])
        # a side that ends at a corner has the weight of its first particle
        corners = self.corners if self.end == "start" else self.corners[::-1]
        return np.column_stack([first, np.where(corners[1:], first, first + 1)])

    @property
    def where(self) -> MaterialPoints:
        """Points from the wet end: particles, and the two Gauss points of the side between them."""
        first, last = self.particles[:-1].repeat(POINTS), self.particles[1:].repeat(POINTS)
        ends = np.column_stack([first, last])
        # s = 0, g, 1 - g of every side, and the last particle
        at = np.tile([0.0, INNER, 1.0 - INNER], len(self.particles) - 1)
        ends, at = np.vstack([ends, ends[-1]]), np.append(at, 1.0)
        return fixed_points(PointSet(ends, np.column_stack([1.0 - at, at]), 1), 0.0)

    @property
    def own_name(self) -> str:
        """Name of the pressure parameter."""
        return f"{self.label}_pressure"

    @property
    def scalars(self) -> dict:
        """Parameters: the pressure, and those of the contact pressure of the profiles."""
        found = {self.own_name: Scalar(self.pressure, "kPa", "Pressure of the fluid.")}
        for contact in self.contacts:
            found |= {name: contact.scalars[name] for name in closing_names(contact)}
        return found

    def among(self, definitions) -> "FluidPressure":
        """Return the fluid with the contacts of these definitions that have the labels of its own."""
        by_label = {own.label: own for own in definitions}
        return replace(self, contacts=tuple(by_label[own.label] for own in self.contacts))

    def with_parameters(self, values: dict) -> "FluidPressure":
        """Return the fluid with another pressure; the parameters of the profiles are those of
        ``among``."""
        return replace(self, pressure=values.get(self.own_name, self.pressure))

    def with_ends(self, ends) -> "FluidPressure":
        """Return the fluid with its ramp for other load steps."""
        return replace(self, ramp=at_ends(np.asarray(self.ramp, float), ends))

    def point_set(self):
        """Return the particles of the edge and the Gauss points of its sides."""
        return self.where.points

    def pairs(self):
        """List coupled points: every point with the particles before it and the next two, whose contact
        pressure its weights contain, and with the points of its sides."""
        if not self.contacts:
            # all weights are 1: every point with those of its sides
            side = POINTS * np.arange(len(self.edge) - 1)[:, None] + np.arange(POINTS + 1)
            row, column = np.broadcast_arrays(side[:, :, None], side[:, None])
            return np.unique(np.column_stack([row.ravel(), column.ravel()]), axis=0)
        # particles have the indices 0, 3, 6, ...; Gauss points couple with the points of their side only
        at = np.arange(POINTS * (len(self.edge) - 1) + 1)
        row, column = np.meshgrid(at, at, indexing="ij")
        first = column // POINTS * POINTS
        beside = (row >= first) & (row <= first + POINTS)
        return np.argwhere(np.where(column == first, column <= row + 2 * POINTS, beside))

    def on(self, discretization, index) -> "FluidPressureTerm":
        """Build the term for one design."""
        return FluidPressureTerm(self, discretization, index)


class FluidPressureTerm(CoupledTerm):
    """``FluidPressure`` in one design; what it gives are at every particle, from the wet end on, the
    fluid's weight and the true contact pressure of the profiles, kPa."""

    output_names = ("weight", "closing")

    def __init__(self, definition: FluidPressure, discretization, index: int):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, index
        )
        self.pressure, self.ramp = definition.pressure, np.asarray(definition.ramp, float)
        self.share, self.particles = definition.share, definition.particles
        self.output_indices = len(definition.edge)
        self.axisymmetric = discretization.body.axisymmetric
        self.rounding = self.pressure * float(self.ramp.max()) * float(np.abs(self.reference).max())
        self.rounding *= discretization.depth
        self.closings = [
            Closing(contact, definition.particles, self.reference[::POINTS], self.names)
            for contact in definition.contacts
        ]
        # directed away from the wet end: of an edge from its start, the body is on the left
        self._sides = PressedSides(
            definition.weighted_by, definition.end == "start", self.axisymmetric
        )

    # ---- the state ----

    def pressure_at(self, fraction: float) -> float:
        """Evaluate the pressure of the fluid after ``fraction`` nominal steps, kPa."""
        return self.pressure * self._ramp_at(fraction)

    def _ramp_at(self, fraction) -> float:
        return float(at_fraction(self.ramp, fraction))

    def _closing(self, x, fraction) -> np.ndarray:
        """Contact pressure of all profiles at the particles, shape (k,)."""
        own = np.ascontiguousarray(x[::POINTS])
        parts = (closing.pressure(own, fraction) for closing in self.closings)
        # c = sum over the profiles of w_n <-g_n> A / a
        return sum(parts, np.zeros(len(own)))

    def _closing_rates(self, x, fraction) -> ClosingRates:
        own, k = np.ascontiguousarray(x[::POINTS]), self.output_indices
        found = ClosingRates(*np.zeros((2, k, 3, 2)), np.zeros((k, len(self.names))))
        for closing in self.closings:
            found = ClosingRates(*map(np.add, found, closing.rates(own, fraction)))
        return found

    # ---- what a coupled term gives ----

    def respond(self, x, fraction, history) -> CoupledResponse:
        pressure, closing = self.pressure_at(fraction), self._closing(x, fraction)
        weight, *slopes = wetting(closing, pressure, self.share)
        # R = -p sum_i w_i f_i;  dR/dx = -p sum_i w_i df_i/dx - p sum_i f_i (dw_i/dx)
        per_weight = self._sides.forces(x)
        pairs, tangent = self._sides.tangents(x, -pressure * weight)
        front = np.flatnonzero(slopes[0])
        if front.size:
            # dw_i/dx_n = sum_j dw_i/dc_j dc_j/dx_n: a particle of the front and its neighbours act on
            # all points behind it
            on_closing, _ = accumulated(*slopes)
            by_place = self._closing_rates(x, fraction).by_place[front]
            moved = np.tensordot(on_closing[:, front], -pressure * per_weight, (0, 0))
            acting, near = moved.any(axis=2), by_place.any(axis=2)
            j, point, side = np.nonzero(acting[..., None] & near[:, None])
            own = moved[j, point, :, None] * by_place[j, side, None]
            particle = POINTS * (front[j] + side - 1)
            pairs = np.concatenate([pairs, np.column_stack([point, particle])])
            tangent = np.concatenate([tangent, own])
        # points of sides with any pressure
        loaded = np.zeros(len(x), np.int64)
        loaded[self._sides.points[self._sides.pressed(weight)]] = 1
        return CoupledResponse(
            x, np.tensordot(-pressure * weight, per_weight, 1), loaded, pairs, tangent,
            np.empty((0, *x.shape)), np.empty(0), _NO_BRANCH, None,
            np.column_stack([weight, closing]),
        )  # fmt: skip

    def linearize(self, response, fraction, history):
        x, k, (at_x, _, _, at_parameters, at_reference) = (
            response.x, self.output_indices, self.inputs
        )  # fmt: skip
        pressure, ramp, weight = (
            self.pressure_at(fraction), self._ramp_at(fraction), response.outputs[:, 0]
        )  # fmt: skip
        by_closing, by_pressure = accumulated(*self._slopes(response, pressure))
        rates = self._closing_rates(x, fraction)
        # dc_j of the deformed and undeformed places of a particle and its neighbours, and of the
        # parameters
        of_closing = np.zeros((k, at_reference.stop))
        for columns, near in ((at_x, rates.by_place), (at_reference, rates.by_reference)):
            row, side, axis = np.nonzero(near)
            column = columns.start + 2 * POINTS * (row + side - 1) + axis
            of_closing[row, column] = near[row, side, axis]
        of_closing[:, at_parameters] = rates.by_parameter
        # dw_i = sum_j (dw_i/dc_j) dc_j + (dw_i/dp) dp
        of_weight = by_closing @ of_closing
        of_weight[:, at_parameters.start] += ramp * by_pressure
        # d(p w_i) = p dw_i + w_i dp
        grown = pressure * of_weight
        grown[:, at_parameters.start] += ramp * weight
        # dR = -sum_i f_i d(p w_i) - sum_i p w_i df_i
        force = np.tensordot(-self._sides.forces(x), grown, (0, 0)).reshape(-1, grown.shape[1])
        pairs, turn = self._sides.tangents(x, -pressure * weight)
        rows = 2 * pairs[:, 0, None, None] + np.arange(2)[:, None]
        np.add.at(force, (rows, at_x.start + 2 * pairs[:, 1, None, None] + np.arange(2)), turn)
        given = np.stack([of_weight, of_closing], axis=1).reshape(2 * k, -1)
        whole = np.concatenate([force, given])
        none = np.zeros((len(whole), 0)), np.zeros((0, whole.shape[1]))
        return LocalMap(csr_array(whole), *none)

    def _slopes(self, response, pressure):
        """Derivatives of the weights as ``wetting`` gives them."""
        closing = np.ascontiguousarray(response.outputs[:, 1])
        return wetting(closing, pressure, self.share)[1:]

    # ---- the path ----

    def changes(self, step, response, target):
        """Compute the change of the residual with the pressure of the next step, profiles at rest."""
        # p(s) and its change to the next step
        pressure = self.pressure_at(step.fraction)
        change = self.pressure_at(target) - pressure
        if change == 0.0:
            return []
        _, by_pressure = accumulated(*self._slopes(response, pressure))
        # dR = -sum_i d(p w_i) f_i,  d(p w_i) = dp (w_i + p dw_i/dp)
        size = change * (response.outputs[:, 0] + pressure * by_pressure)
        moved = np.tensordot(-size, self._sides.forces(response.x), 1)
        force = np.zeros(self.discretization.layout.force_size)
        self._add_force(moved, np.ones(len(moved), np.int64), force)
        return [force]

    def describe(self, response, fraction):
        weight = response.outputs[:, 0]
        return (
            f"{self.label}: {self.pressure_at(fraction):.4g} kPa, {int(np.sum(weight > 0.5))} of "
            f"{len(weight)} points wetted"
        )
