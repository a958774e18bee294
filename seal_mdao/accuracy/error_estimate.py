"""Estimate the errors of all measures of a seal caused by its particles, load steps and penalties.

    particles   4/3 (m_h - m_(h/2)), both in the same few load steps: the error falls with the square of
                the spacing h of the particles, so m_h - m = 4/3 (m_h - m_(h/2))
    load steps  (m_n - m_N) / (N/n - 1), with n of the N load steps: first order in the step
    penalties   -w dm/dw (``seals.penalty_error``)

m_(h/2) is the measure on a cloud with all cells divided into four. The error of few load steps is nearly
the same on both clouds and drops out of the difference. Iterations begin at the solution of the coarse
cloud (``prolongation``), so that three to six of them lead to equilibrium of the finer one.

Where contact points come into contact one after another, the difference oscillates along the path and
may be zero at its end by chance. So an error bar is no shorter than the root mean square of the
difference over the second half of the load steps.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seal_mdao.accuracy.prolongation import Prolongation
from seal_mdao.accuracy.refined_file import refined_file
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.errors import GeometryError, LoadPathError
from seal_mdao.measures.measure import Measure
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.chosen import chosen_ends
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.penalty_error import scale_of, standard_measures
from seal_mdao.seals.profiles import motions
from seal_mdao.seals.refined_steps import force_difference
from seal_mdao.seals.result import Known, SealResult, analyze_particles
from seal_mdao.seals.seal import Seal

FEW = 8
"""Load steps in which both clouds are solved, at most half of those of the seal."""
MORE = 3
"""Factor on their number where that fails, once."""
MOST_CUTS = 2
"""How often a load step of these paths may be halved."""
ORDER = 2
"""Order of the error in the spacing of the particles."""
TOLERANCE = 1e-5
"""Relative residual of paths that are compared only with each other."""


@dataclass(frozen=True, eq=False)
class ErrorEstimate:
    """Estimated errors of a measure, value minus exact value, in its unit.

    Attributes
    ----------
    value : ndarray, shape (m,)
        Of the measure in the analysis whose errors these are.
    particles, load_steps, penalties : ndarray, shape (m,), or None
        Parts of the error; None where a part is not known.
    scale : float
        Reference value of relative errors (``seals.penalty_error.scale_of``).
    unknown : str
        Why parts are not known; empty where all are.
    fluctuation : ndarray, shape (m,), or float
        Root mean square of the part of the particles over the second half of the load steps.
    """

    value: np.ndarray
    particles: np.ndarray | None
    load_steps: np.ndarray | None
    penalties: np.ndarray | None
    scale: float
    unknown: str = ""
    fluctuation: np.ndarray | float = 0.0

    @property
    def parts(self) -> dict:
        """Parts of the error by their names; None for parts that are not known."""
        return {
            "particles": self.particles, "load_steps": self.load_steps, "penalties": self.penalties
        }  # fmt: skip

    @property
    def error(self) -> np.ndarray | None:
        """Sum of all parts with their signs, shape (m,); None if one is not known."""
        parts = list(self.parts.values())
        return None if any(part is None for part in parts) else np.sum(parts, axis=0)

    @property
    def particle_bar(self) -> np.ndarray | None:
        """Part of the error bar by the particles, shape (m,): no less than ``fluctuation``."""
        if self.particles is None:
            return None
        return np.maximum(np.abs(self.particles), self.fluctuation)

    @property
    def bar(self) -> np.ndarray | None:
        """Sum of the absolute values of all parts, the half-width of an error bar, shape (m,); None
        if one is not known."""
        # parts of opposite sign do not make an error bar shorter
        parts = [self.particle_bar, self.load_steps, self.penalties]
        return None if any(part is None for part in parts) else np.abs(parts).sum(axis=0)

    @property
    def relative(self) -> np.ndarray | None:
        """``bar`` over ``scale``, shape (m,); None for a bar that is not known, a measure without
        values and a scale of zero."""
        bar = self.bar
        return bar / self.scale if bar is not None and bar.size and self.scale > 0.0 else None


def estimate_errors(
    file: SealFile, result: SealResult, callback: Callable | None = None
) -> dict[str, ErrorEstimate]:
    """Estimate the errors of the standard measures of a seal, and of the force on every profile.

    Solves the path in a few load steps on the cloud of the file and on one with all cells divided into
    four, which takes about as long as choosing load steps and penalties and the analysis together.

    Parameters
    ----------
    file : SealFile
    result : SealResult
        Completed analysis of its nominal seal, possibly with other parameters.
    callback : callable, optional
        As of ``seals.steps_and_penalties.choose``.

    Returns
    -------
    dict of str to ErrorEstimate
        By the name of the measure.

    Raises
    ------
    LoadPathError
        For a path that was not completed.
    ValueError
        For a changed design; write it to a file of its own (``seals.file.export``).
    """
    result.require_converged()
    if np.any(result.boundary_offsets):
        raise ValueError(
            "numerical errors can be estimated for the nominal section only, but this result has "
            "boundary offsets; export the design as a seal file and analyse that file"
        )
    # errors by the penalties by the direct method: the same bits with and without known gradients
    result = replace(result, gradients=None)
    paths = ComparedPaths(file, result, callback)
    found = {}
    for measure in standard_measures(result):
        value, scale = result.value(measure), scale_of(measure, result)
        # m_h - m at the last load steps, at the end in the last row
        along, fluctuation = _by_particles(measure, paths, scale), 0.0
        if not isinstance(along, str):
            fluctuation, along = np.sqrt(np.mean(along**2, axis=0)), along[-1]
        parts = (along, _by_steps(measure, value, paths), _by_penalties(measure, value, result))
        # a part is its value, or the reason why there is none
        unknown = dict.fromkeys(part for part in parts if isinstance(part, str))
        parts = (None if isinstance(part, str) else part for part in parts)
        found[measure.name] = ErrorEstimate(value, *parts, scale, "; ".join(unknown), fluctuation)
    return found


class ComparedPaths:
    """Load paths with few load steps that are compared with each other and with that of a result.

    Parameters
    ----------
    file, result, callback
        As of ``estimate_errors``.
    choices : sequence of (ndarray, int), optional
        Ends of the load steps, as ``some_ends`` returns them, and how often one may be halved, tried in
        this order until both paths are complete; by default about ``FEW`` load steps, then ``MORE``
        times as many, with ``MOST_CUTS``.
    apart : float, optional
        Largest relative difference of the forces in few load steps from those of the result at the
        same ends; otherwise the path is taken to be another one.

    Attributes
    ----------
    coarse : SealResult or None
        On the cloud of the result; None where it fails.
    fine : SealResult or None
        On the finer cloud.
    kept : ndarray of int, shape (n,)
        Index in the finer cloud of every particle.
    ends : ndarray
        Ends of the load steps, in those of ``unchosen_seal``, for ``Seal.with_ends``.
    failure : str
        Why a path is missing.
    """

    def __init__(
        self, file: SealFile, result: SealResult, callback: Callable | None, choices=None,
        apart: float = np.inf,
    ):  # fmt: skip
        self.result, self.callback, self.number, self._apart = result, callback, 0, apart
        self.coarse = self.fine = self.kept = None
        self.failure = ""
        seal = result.seal
        try:
            finer, self.kept, parents = refined_file(file, seal)
            fine_seal = alike(unchosen_seal(finer), seal)
            # there are no other designs for which equations would be numbered
            fine_seal = replace(fine_seal, body=replace(fine_seal.body, nominal=None))
            fine = discretize(fine_seal.body, fine_seal.nominal_particles, fine_seal.terms())
        except (GeometryError, ValueError) as error:
            self.failure = (
                "the error due to the particle spacing cannot be estimated, because the section "
                f"cannot be filled with particles at half of the spacing: {error}"
            )
            return
        # ends of the load steps of the seal in those of the unchosen one
        given = np.arange(1.0, seal.n_steps + 1.0)
        if file.step_tolerance is not None:
            # steps of the seal were chosen: their ends in steps of the file
            given = np.array(chosen_ends(seal))
        if choices is None:
            choices = [(ends, MOST_CUTS) for ends in few_ends(seal)]
        for ends, most_cuts in choices:
            self.ends = given[ends.astype(int) - 1]
            own, other = seal.with_ends(ends), fine_seal.with_ends(self.ends)
            if self._solve(own, other, ends, most_cuts, fine, parents):
                break

    def _solve(self, seal: Seal, fine_seal: Seal, ends, most_cuts: int, fine, parents) -> bool:
        """Analyse both clouds in the load steps that end at ``ends``; return whether both paths are
        complete."""
        # iterations begin at the path of the result, then at that in few load steps
        path = self.result.path
        steps = {k: path.nominal_steps[int(end) - 1] for k, end in enumerate(ends, 1)}
        coarse = self.near(seal, Prolongation(path, steps, path.discretization), most_cuts)
        if not coarse.converged:
            self.failure = f"an analysis in {seal.n_steps} load steps {_end_of(coarse)}"
            return False
        if force_difference(coarse, self.result, ends.astype(int) - 1) > self._apart:
            self.failure = "in few load steps the seal takes another path"
            return False
        self.coarse = coarse
        steps = dict(enumerate(coarse.path.nominal_steps, 1))
        found = self.near(fine_seal, Prolongation(coarse.path, steps, fine, parents), most_cuts)
        if not found.converged:
            why = _end_of(found) + _error_before(coarse, found)
            self.failure = f"an analysis with half of the spacing {why}"
            return False
        self.fine, self.failure = found, ""
        return True

    @cached_property
    def before_end(self) -> list[tuple[SealResult, SealResult]]:
        """Results of both paths up to each load step of the second half but the last one."""
        both = zip(self.coarse.up_to_each_step(), self.fine.up_to_each_step(), strict=True)
        pairs = list(both)
        return pairs[len(pairs) // 2 : -1]

    def near(self, seal: Seal, near: Prolongation, most_cuts: int = MOST_CUTS) -> SealResult:
        """Analyse a seal with iterations that start from the states of another path; its own path
        may end early."""
        self.number += 1
        report = getattr(self.callback, "begin_analysis", None)
        if report is not None:
            report(self.number, max(2, self.number), seal.n_steps)
        # where iterations fail beside a known solution, long searches for another one are of no use
        newton = replace(
            seal.newton, tolerance=max(seal.newton.tolerance, TOLERANCE), max_cuts=most_cuts,
            damped_iterations=0,
        )  # fmt: skip
        return analyze_particles(
            replace(seal, newton=newton), seal.nominal_particles, callback=self.callback,
            known=Known(near.fine, near=near),
        )  # fmt: skip


def _end_of(result: SealResult) -> str:
    """Describe where and why a path that is only compared has ended, without advice."""
    done = len(result.path.nominal_steps)
    where = f"beyond {result.caption(done - 1)}" if done else "in its first load step"
    return f"could not be completed {where}: {result.path.status.value}"


def _error_before(coarse: SealResult, fine: SealResult) -> str:
    """Describe the error of the forces due to the particles, up to the last load step of a finer path
    that failed; empty without load steps."""
    count = len(fine.path.nominal_steps)
    if not count:
        return ""
    # |F_h - F_(h/2)| / (1 - 2^-p) / max |F_h|
    error = force_difference(fine, coarse, np.arange(count)) / (1.0 - 0.5**ORDER)
    return (
        ". Up to that load step the estimated error of the forces due to the particles is at most "
        f"{100.0 * error:.2g} % of the largest force"
    )


def some_ends(seal: Seal, count: int) -> np.ndarray:
    """Select about ``count`` evenly distributed load steps of a seal, and the ends of its stages.

    Returns
    -------
    ndarray
        Ends in nominal steps, for ``Seal.with_ends``.
    """
    # every k-th end, counted from the last, and the ends of stages
    every = -(-seal.n_steps // max(count, 1))
    stages = [np.cumsum(motion.steps) for motion in motions(seal)]
    ends = np.unique(np.concatenate([*stages, np.arange(seal.n_steps, 0, -every)]))
    return ends[ends > 0].astype(float)


def few_ends(seal: Seal) -> list[np.ndarray]:
    """Select about ``FEW`` of the load steps, at most half; then ``MORE`` times as many."""
    fewest = min(FEW, seal.n_steps // 2)
    return [some_ends(seal, fewest), some_ends(seal, MORE * fewest)]


def alike(fine: Seal, seal: Seal) -> Seal:
    """Return the refined seal with the parameters of the other seal, chosen penalties included."""
    known = fine.scalars
    # penalties, motion, materials: all that both seals know
    same = {name: own.value for name, own in seal.scalars.items() if name in known}
    return fine.with_parameters(same)


def _by_particles(measure: Measure, paths: ComparedPaths, scale: float) -> np.ndarray | str:
    """Compute 4/3 (m_h - m_(h/2)), or the reason why it is not known.

    Returns
    -------
    ndarray, shape (k, m), or str
        In the second half of the load steps, at the end in the last row; only at the end for a measure
        that has no value before it. Errors of values that are larger than ``scale`` are reduced to it.
    """
    if paths.fine is None:
        return paths.failure
    finer = measure.on_refined(paths.fine, paths.kept)
    if finer is None:
        return f"the value of {measure.name} depends on the number of particles"
    try:
        values = paths.coarse.value(measure), paths.fine.value(finer)
    except LoadPathError as error:
        return str(error)
    if values[0].shape != values[1].shape:
        return (
            f"the measure {measure.name} is evaluated at a different number of points if the "
            "particle spacing is halved"
        )
    # m_h - m = (m_h - m_(h/2)) / (1 - 2^-p)
    error = (values[0] - values[1]) / (1.0 - 0.5**ORDER)
    if not np.isfinite(error).all():
        return (
            f"the measure {measure.name} is not a finite number if the particle spacing is halved"
        )
    # a value that is zero on both clouds, such as the force after a release, has no error
    rows, zero = [], (values[0] == 0.0) & (values[1] == 0.0)
    for coarse, fine in paths.before_end if measure.at_end else ():
        own = coarse.value(measure)
        earlier = (own - fine.value(finer)) / (1.0 - 0.5**ORDER)
        if np.isfinite(earlier).all():
            # relative errors are comparable where the value decreases towards the end
            largest = max(scale, np.abs(own).max(initial=0.0))
            earlier = earlier * (scale / largest if largest > 0.0 else 1.0)
            rows.append(np.where(zero, 0.0, earlier))
    return np.array([*rows, error])


def _by_steps(measure: Measure, value, paths: ComparedPaths) -> np.ndarray | str:
    """Compute m_N - m from a path in n of N load steps, or the reason why it is not known."""
    if paths.coarse is None:
        return paths.failure
    if paths.coarse.seal.n_steps == paths.result.seal.n_steps:
        return "the analysis has too few load steps for a comparison with fewer load steps"
    # m_N - m = (m_n - m_N) / (N/n - 1)
    ratio = paths.result.seal.n_steps / paths.coarse.seal.n_steps
    return (paths.coarse.value(measure) - value) / (ratio - 1.0)


def _by_penalties(measure: Measure, value, result: SealResult) -> np.ndarray | str:
    """Look up the error by the penalties, zero without contact, or the reason why it is not known."""
    errors = result.penalty_error
    if not errors:
        return np.zeros_like(value)
    found = errors[measure.name]
    return found.error if found.estimable else "contact is about to separate"
