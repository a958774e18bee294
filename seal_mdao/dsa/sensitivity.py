"""Sensitivities of measures by the direct or the adjoint method."""

import warnings
from dataclasses import dataclass

import numpy as np

from seal_mdao.dsa.adjoint import AdjointGradient, AdjointSweep
from seal_mdao.dsa.contact_kinks import warn_of_kinks
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.parameters import ParameterRates, parameter_rates
from seal_mdao.dsa.probe import Probe
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.errors import KinkWarning
from seal_mdao.measures.measure import Derived, stacked
from seal_mdao.structure.environment import TEMPERATURE

METHODS = ("auto", "direct", "adjoint")


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of measures with respect to P parameters; a measure's rows by its name.

    Attributes
    ----------
    parameters : tuple of str
        The boundary offsets, then the scalar parameters.
    rows : dict of str to ndarray, shape (m, P)
        By the names of the measures; (P,) for those with a single value.
    """

    parameters: tuple
    rows: dict

    def __getitem__(self, name: str) -> np.ndarray:
        return self.rows[name]

    def __getattr__(self, name: str) -> np.ndarray:
        try:
            return self.__dict__["rows"][name]
        except KeyError:
            raise AttributeError(
                f"derivatives of the measure {name!r} were not requested; add it to the "
                "argument measures of differentiate"
            ) from None


@one_blas_thread
def differentiate(result, parameters=None, measures=None, method: str = "auto") -> Sensitivities:
    """Compute the exact derivatives of measures with respect to boundary offsets and scalar
    parameters.

    Parameters
    ----------
    result : SealResult
        A converged analysis; with ``keep_factors`` its factors are used again.
    parameters : sequence of str, optional
        Scalar parameters, out of ``result.seal.scalars``; the seal's ``inputs`` when left out.
    measures : sequence of Measure or str, optional
        The seal's standard ones when left out; names are those that the seal knows. Where a measure
        selects its points on the nominal seal, that is analysed, unless the result knows them.
    method : {"auto", "direct", "adjoint"}
        "auto" takes the method with fewer right-hand sides.

    Returns
    -------
    Sensitivities

    Raises
    ------
    ValueError
        Unknown method, parameter or measure.
    LoadPathError
        For a path that was not completed, where a measure is taken at its end.

    Warns
    -----
    KinkWarning
        Where a contact point has zero gap or zero slip margin at the end of a step, and derivatives
        of the two sides differ.
    """
    _check_method(method)
    if not hasattr(result, "require_converged"):
        raise TypeError(
            "the first argument (result) must be a result of seal_mdao.analyze, got a "
            f"{type(result).__name__}"
        )
    seal = result.seal
    if isinstance(parameters, str):
        raise ValueError(
            f"the argument parameters must be a sequence of names, got the string {parameters!r}; "
            f"write ({parameters!r},)"
        )
    names = seal.inputs if parameters is None else tuple(parameters)
    _check_names(result, names)
    measures = result.measures(measures)
    if any(measure.wants_end for measure in measures):
        result.require_converged()
    return sensitivities(result, names, measures, method)


@one_blas_thread
def sensitivities(result, names, measures, method: str = "auto") -> Sensitivities:
    """As ``differentiate``, for measures with selected points and checked parameters."""
    velocity = result.seal.design_velocity
    offsets = tuple(f"boundary_offsets[{i}]" for i in range(len(velocity)))
    if not measures:
        return Sensitivities(offsets + names, {})
    wanted = Wanted(result, measures)
    wanted.warn_of_kinks(names)
    count = len(velocity) + len(names)
    # fewer right-hand sides: measures or parameters
    if method == "auto":
        method = "adjoint" if wanted.count < count else "direct"
    if method == "direct":
        # one column a parameter, one row a measure
        table = direct_rates(result, wanted, parameter_rates(velocity, names))
    else:
        gradient = adjoint_gradient(result, wanted, names)
        # dm/db = dm/dX . V
        by_shape = np.tensordot(gradient.particles, velocity, ((1, 2), (1, 2)))
        table = np.hstack([by_shape, gradient.of(names)])
    rows = {
        name: own[0] if single else own for (name, own), single in
        zip(wanted.by_name(table).items(), wanted.single, strict=True)
    }  # fmt: skip
    return Sensitivities(offsets + names, rows)


@one_blas_thread
def particle_gradient(result, parameters, measures, method: str = "auto") -> dict:
    """Compute derivatives of measures with respect to every particle and scalar parameters.

    Parameters
    ----------
    result : SealResult
    parameters : sequence of str
    measures : sequence of Measure
    method : {"auto", "direct", "adjoint"}
        "auto" takes the method with fewer right-hand sides.

    Returns
    -------
    dict of str to dict of str to ndarray
        By input ("particles" and the parameters), then by the measure's name: shape (m, n, 2) for the
        particles, (m, 1) for a scalar.
    """
    _check_method(method)
    n, wanted = len(result.particles), Wanted(result, measures)
    wanted.warn_of_kinks(parameters)
    if method == "auto":
        method = "adjoint" if wanted.count < 2 * n + len(parameters) else "direct"
    if method == "adjoint":
        gradient = adjoint_gradient(result, wanted, parameters)
        # dm/dX and dm/dp from one adjoint sweep
        rows, columns = gradient.particles, gradient.of(parameters)
    else:
        # V = unit vectors: every coordinate of every particle
        unit = np.eye(2 * n).reshape(2 * n, n, 2)
        table = direct_rates(result, wanted, parameter_rates(unit, parameters))
        rows, columns = table[:, : 2 * n].reshape(-1, n, 2), table[:, 2 * n :]
    by_input = {"particles": wanted.by_name(rows)}
    for index, name in enumerate(parameters):
        by_input[name] = wanted.by_name(columns[:, index : index + 1])
    return by_input


def _check_method(method):
    if method not in METHODS:
        raise ValueError(
            f"the method of sensitivity analysis must be one of {METHODS}, got {method!r}"
        )


def _check_names(result, names):
    known = result.seal.scalars
    unknown = [name for name in names if name not in known]
    if unknown:
        raise ValueError(
            f"the seal has no parameter {unknown[0]!r}; its parameters are {', '.join(known)}"
        )


class Wanted:
    """Measures to differentiate: the independent ones, and those derived from them.

    Parameters
    ----------
    result : SealResult
    measures : sequence of Measure
        With selected points.
    """

    def __init__(self, result, measures):
        self.result, self.measures = result, measures
        self.bases = list(dict.fromkeys(_base(measure) for measure in measures))
        # values and partial derivatives of every independent measure
        self.values, partials = zip(*(base.of(result) for base in self.bases), strict=True)
        self.stack = stacked(partials)
        self.probe = result.path.discretization.table_at(self.stack.at)

    def warn_of_kinks(self, parameters) -> None:
        """Issue a ``KinkWarning`` where the derivatives in the designs or ``parameters`` are
        one-sided."""
        path, seal = self.result.path, self.result.seal
        from_start = any(base.from_start for base in self.bases)
        warn_of_kinks(path, self.stack.seeds, seal.design_velocity, from_start)
        if TEMPERATURE not in parameters:
            return
        # dm/dT of a table of moduli jumps at its points
        points = seal.table_points([path.steps[index].fraction for index in self.stack.seeds])
        if points:
            warnings.warn(
                "the derivatives with respect to the temperature are one-sided, those of higher "
                f"temperatures, because the temperature is a point of a table: {'; '.join(points)}. "
                "They differ from central finite differences; change this point of the table, or "
                "the temperature, slightly",
                KinkWarning,
                stacklevel=2,
            )

    @property
    def count(self) -> int:
        """Number of right-hand sides of the adjoint method."""
        return self.stack.count

    @property
    def single(self) -> list:
        """Whether a measure is a single value."""
        return [measure.scalar for measure in self.measures]

    def by_name(self, rows) -> dict:
        """Rows (M, ...) of the independent measures as those of all measures, by name."""
        ends = np.cumsum([len(values) for values in self.values])[:-1]
        parts, out = np.split(rows, ends), {}
        for measure in self.measures:
            index = self.bases.index(_base(measure))
            out[measure.name] = parts[index]
            if isinstance(measure, Derived):
                # m' = (dg/dvalues) values' of a measure of measures
                gradient = measure.value(self.values[index])[1]
                out[measure.name] = np.tensordot(gradient, parts[index], 1)[None]
        return out


def _base(measure):
    return measure.base if isinstance(measure, Derived) else measure


def direct_rates(result, wanted: Wanted, rates: ParameterRates) -> np.ndarray:
    """Rates of all wanted measures, (M, P), by the direct method."""
    sweep = DirectSweep(result.path, rates)
    return rates_by_sweep(result, wanted, sweep, sweep.run(wanted.stack.seeds))


def rates_by_sweep(result, wanted: Wanted, sweep: DirectSweep, by_index: dict) -> np.ndarray:
    """Rates of all wanted measures, (M, P), from the ``StepRates`` of a sweep at their steps."""
    stack, terms, rates = wanted.stack, result.path.problem.terms, sweep.rates
    # what measures take of X and of parameters directly
    out = np.einsum("mni,pni->mp", stack.particles, rates.velocity, optimize=True)
    for name, own in stack.parameters.items():
        out += np.outer(own, rates.of((name,))[0])
    if stack.at.size:
        probe = Probe(result.path.discretization, wanted.probe)
        shape = wanted.probe.rates(rates.velocity, sweep.shape.matrix)
    for index, seeds in stack.seeds.items():
        here, step = by_index[index], result.path.steps[index]
        for term, found in zip(terms, here.terms, strict=True):
            if term.label in seeds.terms:
                # of forces and outputs of terms
                out += seeds.terms[term.label].times(found)
        if stack.at.size:
            # of displacements and F at points
            moved, f_rate = probe.rates(shape, step, here.solution, sweep.prescribed(step))
            out += np.tensordot(seeds.displacement, moved, 2)
            out += np.tensordot(seeds.gradient, f_rate, 2)
    return out


def adjoint_gradient(result, wanted: Wanted, names) -> AdjointGradient:
    """Gradients of all wanted measures in the particles and the parameters ``names``, by the adjoint
    method; NaN for measures with partial derivatives that are NaN."""
    stack = wanted.stack
    # the sweep multiplies the seeds of all measures with zeros, too, and 0 * NaN = NaN would reach the
    # others
    undefined, seeds = stack.undefined, stack.seeds
    if undefined.any():
        seeds = {index: own.without(undefined) for index, own in seeds.items()}
    gradient = AdjointSweep(result.path, wanted.probe, stack.count, names).run(seeds)
    # parameters of measures alone follow those of the terms
    names = (*gradient.names, *(own for own in stack.parameters if own not in gradient.names))
    scalars = np.zeros((len(names), stack.count))
    scalars[: len(gradient.names)] = gradient.scalars
    for name, own in stack.parameters.items():
        # direct part in the parameters
        scalars[names.index(name)] += own
    particles = gradient.particles + stack.particles
    particles[undefined], scalars[:, undefined] = np.nan, np.nan
    return AdjointGradient(particles, names, scalars)
