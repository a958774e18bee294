"""Base class of measures: values of a load path and their partial derivatives with respect to its
results.

A measure is a small frozen object. It evaluates its values and fills in, through ``Partials``, their
partial derivatives in displacements and F at the particles, in forces and outputs of terms, in the
undeformed particles and in scalar parameters. ``seal_mdao.dsa`` computes the total derivatives, by the
direct or the adjoint method.
"""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True, eq=False)
class Seeds:
    """Partial derivatives of M measures in the results of one converged step.

    Attributes
    ----------
    displacement : ndarray, shape (M, s, 2)
        In the displacements of s particles.
    gradient : ndarray, shape (M, s, 4 or 5)
        In F at these particles, in the order 11, 12, 21, 22, and in h of a body of revolution.
    terms : dict of str to object
        By label, in the forces and outputs of a term (``PointSeeds``, ...).
    """

    displacement: np.ndarray
    gradient: np.ndarray
    terms: dict

    @property
    def used(self) -> np.ndarray:
        """Mask of the measures with partial derivatives that are not zero, shape (M,)."""
        found = self.displacement.any(axis=(1, 2)) | self.gradient.any(axis=(1, 2))
        for seeds in self.terms.values():
            found = found | seeds.used
        return found

    def at(self, particles: np.ndarray) -> "Seeds":
        """Restrict the seeds to some of the particles."""
        return replace(
            self, displacement=self.displacement[:, particles], gradient=self.gradient[:, particles]
        )

    @property
    def undefined(self) -> np.ndarray:
        """Mask of the measures with derivatives in displacements or F that are NaN, shape (M,)."""
        return np.isnan(self.displacement).any((1, 2)) | np.isnan(self.gradient).any((1, 2))

    def without(self, rows: np.ndarray) -> "Seeds":
        """Set the derivatives of some measures in displacements and F to zero; ``rows`` is a mask."""
        kept = ~rows[:, None, None]
        return replace(
            self, displacement=np.where(kept, self.displacement, 0.0),
            gradient=np.where(kept, self.gradient, 0.0),
        )  # fmt: skip


class Partials:
    """Partial derivatives of M measures, zero until they are filled in.

    Every array returned by a method is zero at first; add the derivatives to it.

    Parameters
    ----------
    path : PathResult
    n_measures : int

    Attributes
    ----------
    particles : ndarray, shape (M, n, 2)
        In the undeformed particles, at fixed displacements, F, forces and outputs.
    parameters : dict of str to ndarray, shape (M,)
        In scalar parameters, likewise.
    seeds : dict of int to Seeds
        By index in ``path.steps``.
    section : dict of int to ndarray, shape (M, N, 4 or 5)
        By index in ``path.steps``, in F at all N points of ``Body.samples``.
    """

    def __init__(self, path, n_measures: int):
        self.path, self.count = path, n_measures
        self.particles = np.zeros((n_measures, *path.discretization.particles.shape))
        self.parameters, self.seeds, self.section = {}, {}, {}

    def _index(self, step) -> int:
        return len(self.path.steps) - 1 if step is None else self.path.steps.index(step)

    def _at(self, step) -> Seeds:
        index = self._index(step)
        if index not in self.seeds:
            # created on first use: most measures depend on the last step only
            m, n = self.particles.shape[:2]
            strains = self.path.discretization.body.strains
            self.seeds[index] = Seeds(np.zeros((m, n, 2)), np.zeros((m, n, strains)), {})
        return self.seeds[index]

    def displacement(self, step=None) -> np.ndarray:
        """Return d/du at the particles at a converged step (default: the last), shape (M, n, 2)."""
        return self._at(step).displacement

    def gradient(self, step=None) -> np.ndarray:
        """Return d/dF at the particles, in the order 11, 12, 21, 22, and d/dh in a body of revolution,
        shape (M, n, 4 or 5)."""
        return self._at(step).gradient

    def section_gradient(self, step=None) -> np.ndarray:
        """Return d/dF at ``Body.samples``, points over the section with the particles first, in the
        order 11, 12, 21, 22, and d/dh in a body of revolution, shape (M, N, 4 or 5)."""
        self._at(step)
        body = self.path.discretization.body
        empty = np.zeros((self.count, len(body.samples.anchors), body.strains))
        return self.section.setdefault(self._index(step), empty)

    def of_term(self, label: str, step=None):
        """Return the derivatives in forces and outputs of a term, in the form of its ``no_seeds``."""
        terms = self._at(step).terms
        if label not in terms:
            terms[label] = self.path.problem.term(label).no_seeds(self.count)
        return terms[label]

    def force(self, label: str, step=None) -> np.ndarray:
        """Return the derivatives in the forces on the points of a term, shape (M, k, 2)."""
        return self.of_term(label, step).force

    def output(self, label: str, name: str, step=None) -> np.ndarray:
        """Return the derivatives in an output of a term, such as the gap, shape (M, k)."""
        names = self.path.problem.term(label).output_names
        return self.of_term(label, step).outputs[:, :, names.index(name)]

    def energy(self, step=None) -> np.ndarray:
        """Return the derivatives in the strain energy, shape (M,)."""
        return self.of_term("structure", step).energy

    def parameter(self, name: str) -> np.ndarray:
        """Return the derivatives in a scalar parameter, shape (M,)."""
        return self.parameters.setdefault(name, np.zeros(self.count))


class Measure:
    """Base class of measures; a subclass is a frozen dataclass that defines ``size`` and ``evaluate``.

    Attributes
    ----------
    name : str
        Name of the output.
    units : str or None
        Units in the notation of OpenMDAO.
    text : str
        One line for documentation.
    wants_end : bool
        Whether it requires a completed path.
    needs_points : bool
        Whether its value is that of single contact points of ``profile``, such as a peak or the ends of
        a contact, which a few points in contact do not resolve.
    needs_all_steps : bool
        Whether its error may come from load steps in which displacements hardly change, so that the
        choice of load steps divides all of them.
    from_start : bool
        Whether its value depends on the force at the start of the path.
    """

    name = ""
    units: str | None = None
    text = ""
    scalar = False
    wants_end = True
    needs_points = False
    needs_all_steps = False
    from_start = False

    @property
    def scalars(self) -> dict:
        """Parameters of the measure itself, ``Scalar`` by name."""
        return {}

    def with_parameters(self, changes: dict) -> "Measure":
        """Return the measure with some of its ``scalars`` changed; names of others are ignored."""
        return self

    def least_scale(self, result) -> float | None:
        """Compute the size below which its value counts as zero, in its unit; None if it does not
        define one."""

    def missing(self, result) -> str:
        """Describe in one line why its value in a completed path is not a number, or is only a bound;
        empty if it is the value of the measure."""
        return ""

    def check(self, seal) -> None:
        """Raise ValueError for a seal for which the measure cannot be evaluated."""

    @property
    def selects_points(self) -> bool:
        """Whether its points are selected on the nominal seal, which costs an analysis."""
        return False

    def frozen(self, nominal) -> "Measure":
        """Select the points of the measure on the path of the nominal seal; called only if
        ``selects_points``."""
        return self

    def on_refined(self, fine, particles: np.ndarray) -> "Measure | None":
        """Return the measure on a finer cloud of the same section; None if its value depends on the
        number of particles, such as a sum over them.

        Parameters
        ----------
        fine : SealResult
            Completed analysis of the finer cloud, on which other points are selected.
        particles : ndarray of int, shape (n,)
            Index there of every particle of this measure's cloud.
        """
        return self.frozen(fine) if self.selects_points else self

    def between_steps(self, result) -> np.ndarray:
        """Return the fractions of a path, in nominal steps, at which the value is interpolated between
        two of them, shape (k,); none for most measures."""
        return np.empty(0)

    @property
    def at_end(self) -> bool:
        """Whether its value at the end of a shorter part of the path is the value there; not so for a
        value at given stages, travels or times."""
        return self.wants_end

    def size(self, seal) -> int:
        """Number of values."""
        return 1

    def place(self, result) -> np.ndarray | None:
        """Return the undeformed point at which the value is taken, shape (2,), if there is a single
        one."""
        return None

    def evaluate(self, result, partials: Partials) -> np.ndarray:
        """Evaluate the values (M,), and add their partial derivatives to ``partials``.

        Parameters
        ----------
        result : SealResult
            A completed path.
        """
        raise NotImplementedError

    def of(self, result) -> tuple[np.ndarray, Partials]:
        """Evaluate values (M,) and partial derivatives, which are NaN for values that are NaN."""
        # m and its partial derivatives in u, F, forces, outputs, X and parameters
        partials = Partials(result.path, self.size(result.seal))
        values = np.atleast_1d(np.asarray(self.evaluate(result, partials), float))
        # of a value that does not exist, such as a time that is not reached: 0 would be wrong
        partials.particles[np.isnan(values)] = np.nan
        return values, partials


class Derived(Measure):
    """Measure that is a function of another one, ``base``, and reuses its derivatives."""

    base: Measure

    scalar = True

    def value(self, values: np.ndarray) -> tuple[float, np.ndarray]:
        """Compute value and gradient (m,) from the values (m,) of the base."""
        raise NotImplementedError

    @property
    def selects_points(self):
        return self.base.selects_points

    def between_steps(self, result):
        return self.base.between_steps(result)

    def missing(self, result):
        text = self.base.missing(result)
        return text and f"{self.name}: {text}"

    @property
    def at_end(self):
        return self.base.at_end

    def frozen(self, nominal):
        return replace(self, base=self.base.frozen(nominal))

    def on_refined(self, fine, particles):
        base = self.base.on_refined(fine, particles)
        return None if base is None else replace(self, base=base)


@dataclass(frozen=True, eq=False)
class Stack:
    """Partial derivatives of several measures in succession, as input of the sensitivity analysis.

    Attributes
    ----------
    count : int
        M.
    at : ndarray of int
        Points of ``Body.samples`` with derivatives in displacement or F that are not all zero.
    seeds : dict of int to Seeds
        By index in ``path.steps``, at those points.
    particles : ndarray, shape (M, n, 2)
    parameters : dict of str to ndarray, shape (M,)
    """

    count: int
    at: np.ndarray
    seeds: dict
    particles: np.ndarray
    parameters: dict

    @property
    def undefined(self) -> np.ndarray:
        """Mask of the measures with partial derivatives that are NaN, such as a stress of inverted
        material, shape (M,)."""
        found = np.isnan(self.particles).any((1, 2))
        return np.any([found, *(own.undefined for own in self.seeds.values())], axis=0)


def stacked(parts: list[Partials]) -> Stack:
    """Stack the partial derivatives of several measures of one path."""
    path = parts[0].path
    total = Partials(path, sum(part.count for part in parts))
    first = 0
    for part in parts:
        # every measure fills its own rows
        rows = slice(first, first + part.count)
        total.particles[rows] = part.particles
        for name, own in part.parameters.items():
            total.parameter(name)[rows] += own
        for index, own in part.seeds.items():
            step = path.steps[index]
            total.displacement(step)[rows] = own.displacement
            total.gradient(step)[rows] = own.gradient
            for label, seeds in own.terms.items():
                total.of_term(label, step).put(rows, seeds)
        for index, own in part.section.items():
            total.section_gradient(path.steps[index])[rows] = own
        first += part.count
    seeds = total.seeds
    for index, section in total.section.items():
        # the particles are the first of the samples: F at a particle may have seeds of both kinds
        every = _padded(seeds[index], section.shape[1])
        seeds[index] = replace(every, gradient=every.gradient + section)
    n_samples = max((own.gradient.shape[1] for own in seeds.values()), default=0)
    # only points with derivatives that are not zero take part in the sweeps
    used = np.zeros(n_samples, bool)
    for own in seeds.values():
        some = own.displacement.any(axis=(0, 2)) | own.gradient.any(axis=(0, 2))
        used[: some.size] |= some
    at = np.flatnonzero(used)
    seeds = {index: _padded(own, n_samples).at(at) for index, own in seeds.items()}
    return Stack(total.count, at, seeds, total.particles, total.parameters)


def _padded(own: Seeds, count: int) -> Seeds:
    """Pad seeds with zeros from the particles to ``count`` points."""
    more = ((0, 0), (0, count - own.gradient.shape[1]), (0, 0))
    if more[1][1] == 0:
        return own
    return replace(
        own, displacement=np.pad(own.displacement, more), gradient=np.pad(own.gradient, more)
    )
