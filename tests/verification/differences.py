"""Finite differences of the seal's measures with respect to its parameters, at several steps."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.dsa.sensitivity import Sensitivities
from seal_mdao.seals.door.door_seal import DOOR, options_of
from seal_mdao.seals.result import SealResult, analyze, analyze_particles
from seal_mdao.seals.seal import Seal
from verification.estimates import Estimate, fitted, most_certain, nothing, plateau

STEPS = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
# second-order quotients: the places of their analyses in steps, and the weights over the step
SCHEMES = {
    "central": ((1, 0.5), (-1, -0.5)),
    "forward": ((0, -1.5), (1, 2.0), (2, -0.5)),
    "backward": ((0, 1.5), (-1, -2.0), (-2, 0.5)),
}
SHORT_RANGE = 1e-4
"""A one-sided quotient confined to smaller steps is replaced by a fit, mm."""
FIT_POINTS = 64


@dataclass(frozen=True)
class Design:
    """Boundary offsets followed by the door radius, mm."""

    model: Seal
    values: np.ndarray

    def moved(self, parameter: int, change: float) -> "Design":
        """The design with one parameter changed."""
        values = self.values.copy()
        values[parameter] += change
        return Design(self.model, values)

    def analyze(self, **options) -> SealResult:
        radius = {"door_radius": self.values[-1]}
        return analyze(self.model, self.values[:-1], radius, **options)


def beside(result: SealResult, offsets, parameters=None) -> SealResult:
    """The analysis of another design, with the measures at the places of ``result``."""
    seal = result.seal.with_parameters(parameters or {})
    return analyze_particles(seal, seal.particles(offsets), offsets).at(result.measures())


def perturbed(result: SealResult, name: str, step: float) -> SealResult:
    """The analysis with one parameter, by its name, changed by ``step``; measures at the same places.

    Parameters
    ----------
    result : SealResult
        Computed from boundary offsets.
    name : str
        ``boundary_offsets[i]`` or a scalar of the seal.
    """
    offsets = result.boundary_offsets.copy()
    if name.startswith("boundary_offsets["):
        offsets[int(name[17:-1])] += step
        return beside(result, offsets)
    return beside(result, offsets, {name: result.seal.scalars[name].value + step})


def contact_states(result: SealResult) -> np.ndarray:
    """Stick, slip and open points at all steps of a path, cut ones included, shape (steps, k)."""
    return np.array([response.state for response in result.path.responses(DOOR)])


def same_sequence(a: SealResult, b: SealResult) -> bool:
    """Whether two paths have the same stick, slip and open points at all their steps."""
    return np.array_equal(contact_states(a), contact_states(b))


def measure_names(result: SealResult) -> list[str]:
    """Names of the measures in the order of ``measure_values``; particles in the names."""
    gaps = result.term(DOOR).where.points.anchors[list(result.measure("gap").points)]
    return [
        "area",
        *(f"von_mises_{p}" for p in result.measure("von_mises").points),
        "gap_square_sum",
        "reaction_x",
        "reaction_y",
        *("_".join(map(str, ["gap", *particles])) for particles in gaps),
    ]


def measure_values(result: SealResult) -> np.ndarray:
    """All measures of a converged result, shape (m,)."""
    parts = (
        result.area, result.von_mises, result.gap_square_sum, result.reaction[-1], result.gap,
    )  # fmt: skip
    return np.concatenate([np.atleast_1d(part) for part in parts])


def measure_rates(result: SealResult, sensitivities: Sensitivities) -> np.ndarray:
    """Their derivatives with respect to offsets and door radius, shape (m, P)."""
    area = np.append(result.seal.area(result.boundary_offsets)[1], 0.0)
    names = "von_mises", "gap_square_sum", "reaction", "gap"
    return np.vstack([area, *(sensitivities[name] for name in names)])


def evaluation_noise(design: Design, step: float = 5e-7) -> np.ndarray:
    """Noise of the measures (m,): rounding, and what Newton's iterations leave.

    From fourth differences along a change of the inner boundary, which alters all numbers but
    leaves the first touch where it is; doubled, for they are few.
    """
    shape = options_of(design.model).splines
    direction = np.zeros(shape.count + 1)
    direction[shape.outer_parameters : -1] = np.cos(np.arange(shape.inner_parameters))
    values = [
        measure_values(Design(design.model, design.values + k * step * direction).analyze())
        for k in range(-5, 6)
    ]
    return 2.0 * np.sqrt(np.mean(np.diff(values, 4, axis=0) ** 2, axis=0) / 70.0)


class Differences:
    """Difference quotients of all measures with respect to one parameter.

    A quotient counts when all of its analyses go through the contact sequence of the design
    itself. Where central quotients do not, because any change one way makes a point touch a load
    step earlier, the one-sided second-order quotient of the other side is taken.

    Parameters
    ----------
    design : Design
    base : SealResult
        Its analysis.
    parameter : int
    noise : ndarray, shape (m,)
        Noise of the measures.
    steps : sequence of float
        Largest first, mm.
    tick : callable, optional
        Called after every analysis.

    Attributes
    ----------
    scheme : str
        A name out of ``SCHEMES``.
    steps : ndarray, shape (n,)
        Steps of the quotients, refined towards the largest one that keeps the contact sequence.
    quotient : ndarray, shape (n, m)
    same : ndarray of bool, shape (n,)
    """

    def __init__(self, design, base, parameter, noise, steps=STEPS, tick=None):
        self._design, self._base, self._parameter = design, base, parameter
        self._noise, self._tick = noise, tick
        self._seen = {0.0: (measure_values(base), True)}
        self.steps = np.sort(np.asarray(steps, float))[::-1]
        table = self._table("central")
        if table[2].sum() < min(2, len(steps)):
            other = [self._table(name) for name in ("forward", "backward")]
            table = max([table, *other], key=lambda candidate: candidate[2].sum())
        self.scheme, self.quotient, self.same = table
        if self.same.any() and not self.same[0]:
            self._refine()

    def _table(self, scheme: str):
        """Scheme, quotients (n, m), and whether each kept the contact sequence (n,)."""
        rows = [self._quotient(scheme, step) for step in self.steps]
        return scheme, np.array([row[0] for row in rows]), np.array([row[1] for row in rows])

    def _quotient(self, scheme: str, step: float):
        points = [(self._at(k * step), weight / step) for k, weight in SCHEMES[scheme]]
        value = sum(weight * values for (values, _), weight in points)
        return value, all(kept for (_, kept), _ in points)

    def _at(self, change: float):
        """Measures at a changed parameter, and whether the contact sequence is still the same."""
        if change not in self._seen:
            result = self._design.moved(self._parameter, change).analyze()
            same = result.converged and same_sequence(result, self._base)
            values = measure_values(result) if result.converged else np.nan
            self._seen[change] = values + np.zeros(self._noise.size), same
            if self._tick is not None:
                self._tick()
        return self._seen[change]

    def _refine(self, bisections: int = 3) -> None:
        """Look for the largest step that keeps the sequence, and add it and its half."""
        first = int(np.argmax(self.same))
        keeps, changes = self.steps[first], self.steps[first - 1]
        added = []
        for _ in range(bisections):
            middle = np.sqrt(keeps * changes)
            added.append(middle)
            if self._quotient(self.scheme, middle)[1]:
                keeps = middle
            else:
                changes = middle
        self.steps = np.sort(np.concatenate([self.steps, added, [0.5 * keeps]]))[::-1]
        _, self.quotient, self.same = self._table(self.scheme)

    def estimate(self) -> Estimate:
        """The most certain derivative of every measure; one of equal sequence if there is any."""
        usable = self.same if self.same.any() else np.isfinite(self.quotient).all(axis=1)
        if not usable.any():
            return nothing(self._noise.size)
        weights = np.array([weight for _, weight in SCHEMES[self.scheme]])
        noise = np.linalg.norm(weights) * self._noise
        found = [plateau(self.quotient[usable], self.steps[usable], noise)]
        reach = self.steps[usable][0]
        if self.same.any() and self.scheme != "central" and reach < SHORT_RANGE:
            found.append(self._fit(2.0 * reach))
        return most_certain(found)

    def _fit(self, reach: float) -> Estimate:
        sign = 1.0 if self.scheme == "forward" else -1.0
        changes = sign * np.linspace(0.0, reach, FIT_POINTS)
        values, same = zip(*[self._at(float(change)) for change in changes], strict=True)
        return fitted(changes[list(same)], np.array(values)[list(same)], self._noise)
