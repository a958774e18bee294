"""The contract of a measure: a few values of a path, with partial derivatives in what the path delivers.

A measure is a small frozen object. It gives its values and fills in, through ``Partials``, how they
depend on displacements and F at the particles, on the forces and outputs of terms, on the undeformed
particles and on scalar parameters. The sweeps of ``seal_mdao.dsa`` do the rest, by either method.
"""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True, eq=False)
class Seeds:
    """What M measures take from one converged step.

    Attributes
    ----------
    displacement : ndarray, shape (M, s, 2)
        On the displacements of s particles.
    gradient : ndarray, shape (M, s, 4)
        On F at these particles, in the order 11, 12, 21, 22.
    terms : dict of str to object
        By label, on what a term gives (``PointSeeds``, ...).
    """

    displacement: np.ndarray
    gradient: np.ndarray
    terms: dict

    @property
    def used(self) -> np.ndarray:
        """Which measures take something, shape (M,)."""
        found = self.displacement.any(axis=(1, 2)) | self.gradient.any(axis=(1, 2))
        for seeds in self.terms.values():
            found = found | seeds.used
        return found

    def at(self, particles: np.ndarray) -> "Seeds":
        """The same with only some of the particles."""
        return replace(
            self, displacement=self.displacement[:, particles], gradient=self.gradient[:, particles]
        )


class Partials:
    """Partial derivatives of M measures, zero until they are filled in.

    Every array handed out is zero when it is asked for the first time, and is to be added to.

    Parameters
    ----------
    path : PathResult
    n_measures : int

    Attributes
    ----------
    particles : ndarray, shape (M, n, 2)
        On the undeformed particles, at fixed displacements, F, forces and outputs.
    parameters : dict of str to ndarray, shape (M,)
        On scalar parameters, likewise.
    seeds : dict of int to Seeds
        By place in ``path.steps``.
    section : dict of int to ndarray, shape (M, N, 4)
        By place, on F at all N points of ``Body.samples``.
    """

    def __init__(self, path, n_measures: int):
        self.path, self.count = path, n_measures
        self.particles = np.zeros((n_measures, *path.discretization.particles.shape))
        self.parameters, self.seeds, self.section = {}, {}, {}

    def _place(self, step) -> int:
        return len(self.path.steps) - 1 if step is None else self.path.steps.index(step)

    def _at(self, step) -> Seeds:
        place = self._place(step)
        if place not in self.seeds:
            m, n = self.particles.shape[:2]
            self.seeds[place] = Seeds(np.zeros((m, n, 2)), np.zeros((m, n, 4)), {})
        return self.seeds[place]

    def displacement(self, step=None) -> np.ndarray:
        """On the displacements of the particles at a converged step (the last), shape (M, n, 2)."""
        return self._at(step).displacement

    def gradient(self, step=None) -> np.ndarray:
        """On F at the particles, in the order 11, 12, 21, 22, shape (M, n, 4)."""
        return self._at(step).gradient

    def section_gradient(self, step=None) -> np.ndarray:
        """On F at ``Body.samples``, points all over the section with the particles first, in the order
        11, 12, 21, 22, shape (M, N, 4)."""
        self._at(step)
        n_samples = len(self.path.discretization.body.samples.anchors)
        empty = np.zeros((self.count, n_samples, 4))
        return self.section.setdefault(self._place(step), empty)

    def of_term(self, label: str, step=None):
        """On what a term gives, in the form of its ``no_seeds``."""
        terms = self._at(step).terms
        if label not in terms:
            terms[label] = self.path.problem.term(label).no_seeds(self.count)
        return terms[label]

    def force(self, label: str, step=None) -> np.ndarray:
        """On the forces of a term's points, shape (M, k, 2)."""
        return self.of_term(label, step).force

    def output(self, label: str, name: str, step=None) -> np.ndarray:
        """On an output of a term's points, such as the gap, shape (M, k)."""
        names = self.path.problem.term(label).output_names
        return self.of_term(label, step).outputs[:, :, names.index(name)]

    def energy(self, step=None) -> np.ndarray:
        """On the strain energy, shape (M,)."""
        return self.of_term("structure", step).energy

    def parameter(self, name: str) -> np.ndarray:
        """On a scalar parameter, shape (M,)."""
        return self.parameters.setdefault(name, np.zeros(self.count))


@dataclass(frozen=True, eq=False)
class Functional:
    """Values of M measures and their partial derivatives.

    Attributes
    ----------
    values : ndarray, shape (M,)
    partials : Partials
    """

    values: np.ndarray
    partials: Partials


class Measure:
    """Base class of measures; a subclass is a frozen dataclass and gives ``size`` and ``evaluate``.

    Attributes
    ----------
    name : str
        Of the output.
    units : str or None
        As OpenMDAO writes them.
    text : str
        One line for documentation.
    wants_end : bool
        Whether it needs a path that was completed.
    """

    name = ""
    units: str | None = None
    text = ""
    scalar = False
    wants_end = True

    @property
    def takes_places(self) -> bool:
        """Whether it takes its places from the drawn seal's path, which costs an analysis."""
        return False

    def frozen(self, drawn) -> "Measure":
        """The measure with its places taken from the path of the drawn seal; asked only of those that
        take places."""
        return self

    def size(self, seal) -> int:
        """Number of values."""
        return 1

    def evaluate(self, result, partials: Partials) -> np.ndarray:
        """Values (M,), and their partial derivatives added to ``partials``.

        Parameters
        ----------
        result : SealResult
            A completed path.
        """
        raise NotImplementedError

    def of(self, result) -> Functional:
        """Values and partial derivatives."""
        partials = Partials(result.path, self.size(result.seal))
        values = np.atleast_1d(np.asarray(self.evaluate(result, partials), float))
        return Functional(values, partials)


class Derived(Measure):
    """A measure that is a function of another one, ``base``, whose derivatives it shares."""

    base: Measure

    scalar = True

    def value(self, values: np.ndarray) -> tuple[float, np.ndarray]:
        """Its value and gradient (m,) from the values (m,) of the base."""
        raise NotImplementedError

    @property
    def takes_places(self):
        return self.base.takes_places

    def frozen(self, drawn):
        return replace(self, base=self.base.frozen(drawn))


@dataclass(frozen=True, eq=False)
class Stack:
    """All measures of several functionals one after the other, ready for the sweeps.

    Attributes
    ----------
    count : int
        M.
    at : ndarray of int
        Points of ``Body.samples`` whose displacement or F any measure takes.
    seeds : dict of int to Seeds
        By place in ``path.steps``, on those points.
    particles : ndarray, shape (M, n, 2)
    parameters : dict of str to ndarray, shape (M,)
    """

    count: int
    at: np.ndarray
    seeds: dict
    particles: np.ndarray
    parameters: dict


def stacked(functionals) -> Stack:
    """Several functionals of one path as one."""
    parts = [functional.partials for functional in functionals]
    path = parts[0].path
    whole = Partials(path, sum(part.count for part in parts))
    first = 0
    for part in parts:
        rows = slice(first, first + part.count)
        whole.particles[rows] = part.particles
        for name, own in part.parameters.items():
            whole.parameter(name)[rows] += own
        for place, own in part.seeds.items():
            step = path.steps[place]
            whole.displacement(step)[rows] = own.displacement
            whole.gradient(step)[rows] = own.gradient
            for label, seeds in own.terms.items():
                whole.of_term(label, step).put(rows, seeds)
        for place, own in part.section.items():
            whole.section_gradient(path.steps[place])[rows] = own
        first += part.count
    seeds = {
        place: _on_samples(own, whole.section.get(place)) for place, own in whole.seeds.items()
    }
    n_samples = max((own.gradient.shape[1] for own in seeds.values()), default=0)
    used = np.zeros(n_samples, bool)
    for own in seeds.values():
        some = own.displacement.any(axis=(0, 2)) | own.gradient.any(axis=(0, 2))
        used[: some.size] |= some
    at = np.flatnonzero(used)
    seeds = {place: _padded(own, n_samples).at(at) for place, own in seeds.items()}
    return Stack(whole.count, at, seeds, whole.particles, whole.parameters)


def _on_samples(own: Seeds, section: np.ndarray | None) -> Seeds:
    """Seeds on the particles with those on F all over the section."""
    if section is None:
        return own
    every = _padded(own, section.shape[1])
    return replace(every, gradient=every.gradient + section)


def _padded(own: Seeds, count: int) -> Seeds:
    """The same on ``count`` points, those beyond the particles with nothing."""
    more = ((0, 0), (0, count - own.gradient.shape[1]), (0, 0))
    if more[1][1] == 0:
        return own
    return replace(
        own, displacement=np.pad(own.displacement, more), gradient=np.pad(own.gradient, more)
    )
