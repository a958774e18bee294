"""Analysis of a seal: from design parameters to the load path and its measures, without OpenMDAO."""

from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.cost import Cost, analysis_cost, announce, require_means
from seal_mdao.analysis.load_path import PathState, solve_path
from seal_mdao.analysis.path_result import ConvergedStep, PathResult, Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.dsa.sensitivity import Sensitivities, sensitivities
from seal_mdao.equilibrium.discretization import Discretization, discretize
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.errors import GeometryError, LoadPathError
from seal_mdao.measures.contact_pressure import pressed_corners, unresolved_contacts
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.seals import penalty_error, profiles
from seal_mdao.seals.checks import findings, squeezed_corner
from seal_mdao.seals.chosen_path import take_path, without_factors
from seal_mdao.seals.clear_start import with_clear_starts
from seal_mdao.seals.creases import creases
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.instabilities import Instability, instabilities
from seal_mdao.seals.lost_bodies import lost_bodies
from seal_mdao.seals.missing_contact import missing_contact
from seal_mdao.seals.seal import Seal
from seal_mdao.structure.particle_stress import deformation_gradients, particle_stress

FACTOR_MEMORY = 2.0
"""Memory for the factors that are cached for sensitivities, GiB."""
UNUSABLE = 0.1
"""Largest error by chosen load steps with which results are used."""
KNOWN_PLACES = 256
"""Number of measures whose evaluation points are cached, the most recently used ones."""
ADVICE = (
    "Use more load steps (steps of a seal file, n_steps in Python), a shorter motion, a smaller normal "
    "penalty, or a design nearer to the nominal seal"
)
"""For a path that could not be completed, where its cause is not known."""
LAST = "At the last converged load step"
PRELIMINARY_ADVICE = (
    "This is a preliminary increment before the first load step, because a profile overlaps the "
    "undeformed section at its start. Start the profile where it does not overlap the section, with a "
    "first stage of many load steps to the present start, or use a smaller overlap or normal penalty"
)
"""For a path that ends before the first load step."""


@dataclass(frozen=True, eq=False)
class SealResult:
    """Result of the analysis of one design of a seal.

    For a path that ended early, the converged steps are available, and results at its end raise
    ``LoadPathError``. The measures of the seal are attributes by their names: ``result.gap_square_sum``.

    Attributes
    ----------
    seal : Seal
        With the scalar parameters of this analysis.
    path : PathResult
    boundary_offsets : ndarray
        mm; None when the result was computed from particles.
    placed : tuple of Measure
        Measures with other evaluation points than those of this seal's nominal design (``at``).
    gradients : Sensitivities, or None
        Derivatives of the standard measures and of the force on every profile in the boundary offsets
        and all scalar parameters, where they were computed (``with_gradients``).
    """

    seal: Seal
    path: PathResult
    boundary_offsets: np.ndarray | None = None
    placed: tuple = ()
    gradients: Sensitivities | None = None

    def __repr__(self) -> str:
        # arrays would fill thousands of lines
        reached = f"{len(self.path.nominal_steps)} of {self.seal.n_steps} load steps"
        end = "converged" if self.converged else "not converged"
        return f"<{type(self).__name__}: {end}, {reached}, {self.seal!r}>"

    def __getattr__(self, name: str):
        # private names and half-built objects (copy, pickle) have no measures
        if name.startswith("_") or "seal" not in self.__dict__:
            raise AttributeError(name)
        try:
            self.seal.measures((name,))
        except ValueError as error:
            raise AttributeError(f"the result has no {name!r}: {error}") from None
        # scalar measures as numbers, others as arrays
        measure = self.measure(name)
        values = self.value(measure)
        return float(values[0]) if measure.scalar else values

    @property
    def converged(self) -> bool:
        return self.path.converged

    @property
    def status(self) -> Status:
        return self.path.status

    @property
    def newton_iterations(self) -> np.ndarray:
        """Newton iterations of every nominal step, shape (n_steps,)."""
        return self.path.newton_iterations

    @property
    def step_cuts(self) -> int:
        return self.path.step_cuts

    @property
    def particles(self) -> np.ndarray:
        """Undeformed particles, shape (n, 2), mm."""
        return self.path.discretization.particles

    def require_converged(self) -> None:
        """Raise ``LoadPathError`` for a path that was not completed."""
        if not self.converged:
            raise LoadPathError(self.failure, self)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings, one line each: faults at the end of a completed path (``seals.checks``),
        penalty errors, unresolved peaks of the contact pressure, pressed corners, and warnings
        about the seal.

        Empty for a path that was not completed.
        """
        if not self.converged:
            return ()
        # inadmissible states, penalty errors, warnings known before the analysis
        found = (finding.text for finding in findings(self.path))
        errors = (
            *penalty_error.warnings_of(self),
            *unresolved_contacts(self),
            *pressed_corners(self),
        )
        missing = (measure.missing(self) for measure in self.seal.standard)
        return (*found, *filter(None, missing), *errors, *self.seal.warnings)

    @property
    def trustworthy(self) -> bool:
        """Whether the path was completed and has no fault that makes the results unusable."""
        return self.converged and not self.faults

    @property
    def faults(self) -> tuple[str, ...]:
        """Faults of a completed path that make the results unusable, one line each: at its end
        (``seals.checks``), and an error by its load steps above ``UNUSABLE``; empty for a path that was
        not completed."""
        if not self.converged:
            return ()
        steps = self.seal.step_warnings if self.seal.step_error > UNUSABLE else ()
        ends = (own.text for own in findings(self.path) if own.impossible or own.meaningless)
        return (*steps, *ends)

    @cached_property
    def penalty_error(self) -> dict:
        """Estimated errors by the contact penalties, ``PenaltyError`` by the name of the measure: the
        standard measures and the force on every profile at the end of the path.

        Derivatives at the end of the path; with cached factors, a small fraction of the analysis time.
        """
        self.require_converged()
        return penalty_error.penalty_errors(self)

    def with_gradients(self) -> "SealResult":
        """Return this completed result with its ``gradients``, by the adjoint method; estimates of
        penalty errors follow from them without another sweep.

        Warns
        -----
        KinkWarning
            As ``differentiate``.
        """
        self.require_converged()
        measures = penalty_error.standard_measures(self)
        found = sensitivities(self, tuple(self.seal.scalars), measures, "adjoint")
        return replace(self, gradients=found)

    def up_to_each_step(self):
        """Yield the results of the paths that end with each of the nominal steps, in order."""
        # halved steps between two nominal ones end no partial path
        for count, step in enumerate(self.path.steps, 1):
            if step.nominal >= 0:
                path = replace(self.path, steps=self.path.steps[:count])
                yield replace(self, path=path, gradients=None)

    @cached_property
    def critical_points(self) -> tuple[Instability, ...]:
        """Critical points of the path, at which equilibrium lost its stability, in order."""
        return instabilities(self)

    @property
    def is_nominal(self) -> bool:
        """Whether this is the nominal seal, which determines the evaluation points of measures."""
        # same parameters and, bit for bit, same particles
        same = self.seal.key == self.seal.nominal().key
        return same and np.array_equal(self.particles, self.seal.nominal_particles)

    @property
    def reaction(self) -> np.ndarray:
        """Force of the seal on the leading profile [horizontal, vertical], shape (n_steps, 2), N/m."""
        return self.path.reaction(profiles.leading_contact(self.seal).label)

    @property
    def contact(self):
        """Response of the contact with the leading profile at the end of the path."""
        return self.response(profiles.leading_contact(self.seal).label)

    @property
    def max_penetration(self) -> float:
        """Deepest penetration of all profiles at the end of the path, mm."""
        # penetration of a contact is -min g_n
        gaps = [self.response(own.label).gap.min() for own in profiles.contacts(self.seal)]
        return float(max(0.0, -min(gaps, default=0.0)))

    @property
    def area(self) -> float:
        """Area of the section, mm^2.

        Raises
        ------
        ValueError
            For a result computed from particles, which may be of no design.
        """
        if self.boundary_offsets is None:
            raise ValueError(
                "this result was computed for given particle positions and has no boundary "
                "offsets, from which the area is computed; use path.discretization.weights.sum() "
                "for the area of the background cells"
            )
        return self.seal.area(self.boundary_offsets)[0]

    @property
    def travel(self) -> np.ndarray:
        """``travel_at`` of every completed nominal step, shape (n_steps,), mm."""
        return np.array([self.travel_at(step.fraction) for step in self.path.nominal_steps])

    def travel_at(self, fraction: float) -> float:
        """Travel of the first profile that moves since its stage began, in the first one counted from
        ``Seal.before_touch``, mm; NaN without profiles."""
        return profiles.stage_travel(self.seal, fraction)

    def steps_at(self, travels) -> list[int]:
        """Nominal steps whose travel is nearest to ``travels`` (mm), each once, in order."""
        return sorted({int(np.argmin(np.abs(self.travel - travel))) for travel in travels})

    def require_possible(self) -> None:
        """Raise ``LoadPathError`` for a path that was not completed, or whose end is not admissible."""
        self.require_converged()
        wrong = [found.text for found in findings(self.path) if found.impossible]
        if wrong:
            raise LoadPathError(
                f"the result at the end of the analysis must not be used: {'; '.join(wrong)}", self
            )

    def admissible_values(self, measures) -> dict:
        """Evaluate measures, by their names, at an admissible end of the path.

        Raises
        ------
        LoadPathError
            As ``require_possible``; and for a value that is not a number, such as the stress of inverted
            material at the end of a fixed edge.
        """
        self.require_possible()
        values = {measure.name: self.value(measure) for measure in measures}
        unknown = [name for name, value in values.items() if np.isnan(value).any()]
        if unknown:
            wrong = [own.missing(self) for own in measures if own.name in unknown]
            wrong = [*filter(None, wrong)]
            wrong += [found.text for found in findings(self.path) if found.meaningless]
            raise LoadPathError(
                f"the measures {', '.join(unknown)} cannot be evaluated: {'; '.join(wrong)}",
                self,
            )
        return values

    @property
    def failure(self) -> str:
        """Message on where and in what state a path ended, with advice; empty for a complete path."""
        if self.converged:
            return ""
        # number of converged steps, and a remark where damping was used
        done, damped = len(self.path.nominal_steps), self.path.damped
        # an instability before the end often explains the failure
        lost = f" Before, {self.critical_points[-1].text}." if self.critical_points else ""
        lost += f" The last converged load step was at {self.caption(done - 1)}." if done else ""
        if self.path.steps and (gone := next(lost_bodies(self.path), "")):
            # the equations are singular: other advice is of no use
            advice = f"{LAST} {gone}"
        elif done:
            advice = self._advice()
        else:
            advice = PRELIMINARY_ADVICE if self._begins_before() else ADVICE
        return (
            f"the analysis could not be completed at {self.path.failure}; {done} of "
            f"{self.seal.n_steps} load steps converged.{lost} "
            f"{damped + '. ' if damped else ''}{advice}"
        )

    def _begins_before(self) -> bool:
        """Return whether the last converged state lies before the first load step begins."""
        return [self.path.start, *self.path.steps][-1].fraction < 0.0

    def _advice(self) -> str:
        """Write what is remarkable at the last converged step of a path that failed, and what to do."""
        samples = EvaluationPoints(self.path)
        # a fold of a free surface ends the path whatever the load steps and penalties are
        folded = creases(samples)
        advice = f"{LAST} {folded}" if folded else ADVICE
        corner = squeezed_corner(samples)
        advice = f"{LAST} {corner}. {advice}" if corner else advice
        near = missing_contact(self.path)
        return f"{near}. {advice}" if near else advice

    @property
    def end(self) -> ConvergedStep:
        """Last step of a completed path."""
        self.require_converged()
        return self.path.steps[-1]

    def term(self, label: str):
        """Return a term of the equilibrium equations that were solved."""
        return self.path.problem.term(label)

    def response(self, label: str, step: ConvergedStep | None = None):
        """Return the response of a term at a converged step, by default the end of the path."""
        step = self.end if step is None else step
        return step.responses[self.path.index_of(label)]

    def displacement(self, step: int = -1) -> np.ndarray:
        """Displacements of the particles after a nominal step, shape (n, 2), mm."""
        return self.path.displacement(step)

    def deformed(self, step: int = -1) -> np.ndarray:
        """Deformed particles after a nominal step, shape (n, 2), mm."""
        return self.particles + self.displacement(step)

    def gap_profile(self, profile: str, step: int = -1) -> tuple[np.ndarray, np.ndarray]:
        """Return the normal gap along the edges that a profile may touch, after a nominal step.

        ``numpy.interp(stations, *result.gap_profile("door"))`` is the gap at given arc lengths.

        Returns
        -------
        arc_length, gap : ndarray, shape (k,)
            Undeformed arc length from the first contact point, and gaps (negative in penetration), mm.
        """
        return profiles.arc_length(self, profile), self.path.at_nominal(profile)[step].gap

    def gradient(self, step: int = -1) -> np.ndarray:
        """F at the particles after a nominal step, in the order 11, 12, 21, 22, shape (n, 4)."""
        # F = I + sum_I d_I (x) dPhi_I/dX at all particles
        table = self.path.discretization.everywhere.table
        return deformation_gradients(table, self.path.nominal_steps[step].d)[:, :4]

    def volume_ratio(self, step: int = -1) -> np.ndarray:
        """Deformed over undeformed volume at the particles after a nominal step: det F with the stretch
        across the section, shape (n,)."""
        path, table = self.path, self.path.discretization.everywhere.table
        own, body = path.nominal_steps[step], path.problem.term("structure").definition
        # column 4: J - 1, in a body of revolution with h = r / R
        change = deformation_gradients(table, own.d)[:, 4]
        return (1.0 + change) * body.axial_stretch(own.fraction)

    def stress_field(self, step: int = -1) -> np.ndarray:
        """Von Mises stress at all particles after a nominal step, shape (n,), kPa."""
        every = np.arange(len(self.particles))
        return particle_stress(self.path, every, self.path.nominal_steps[step]).value

    def section_stress(self, step: int = -1) -> tuple[np.ndarray, np.ndarray]:
        """Compute the von Mises stress over the section after a nominal step, at ``Body.samples``.

        Returns
        -------
        places : ndarray, shape (N, 2)
            Undeformed, mm.
        stress : ndarray, shape (N,)
            kPa.
        """
        samples = self.path.discretization.body.samples
        every = np.arange(len(samples.anchors))
        stress = particle_stress(self.path, every, self.path.nominal_steps[step]).value
        # undeformed sample points, linear in the particles
        return samples.at(self.particles), stress

    def key_steps(self) -> list[int]:
        """Select nominal steps, from 0, for pictures; the last converged one is among them."""
        return profiles.key_steps(self)

    def caption(self, step: int) -> str:
        """Describe the positions of the profiles after a nominal step."""
        return profiles.caption(self, step)

    def measures(self, measures=None) -> tuple:
        """Return measures with frozen evaluation points, as ``frozen_measures`` does.

        Measures that select their points on the nominal seal need its analysis, once per seal, unless
        this is the nominal seal or the points were given (``at``).
        """
        chosen = _chosen(self.seal, measures)
        # points given by ``at`` replace those of the nominal seal
        placed = {measure.name: measure for measure in self.placed}
        own = {name: self.seal.measures((name,))[0] for name in placed}
        chosen = [placed[m.name] if m == own.get(m.name) else m for m in chosen]
        return frozen_measures(self.seal, chosen, self._nominal)

    def _nominal(self, seal: Seal) -> "SealResult":
        return self if self.is_nominal else analyze(seal)

    def measure(self, name: str) -> Measure:
        """Return one of the seal's measures with its evaluation points."""
        return self.measures((name,))[0]

    def at(self, measures) -> "SealResult":
        """Return the same result with given measures at their evaluation points, such as those of
        another seal's nominal design, ``result.at(nominal.measures())``."""
        return replace(self, placed=tuple(measures))

    def value(self, measure: Measure | str) -> np.ndarray:
        """Evaluate a measure with frozen evaluation points, or one of the seal's measures by its name;
        shape (m,).

        Raises
        ------
        ValueError
            For a name that the seal does not know.
        LoadPathError
            For a path that was not completed and a measure that requires its end (``wants_end``).
        """
        if isinstance(measure, str):
            measure = self.measure(measure)
        if measure.wants_end:
            self.require_converged()
        # f(m) of a base measure m
        if isinstance(measure, Derived):
            return np.atleast_1d(measure.value(self.value(measure.base))[0])
        return measure.of(self)[0]


def frozen_measures(seal: Seal, measures=None, analysis: Callable | None = None) -> tuple:
    """Return measures with frozen evaluation points.

    Parameters
    ----------
    measures : sequence of Measure or str, optional
        The seal's standard ones when left out; names are those that the seal knows.
    analysis : callable, optional
        ``analysis(seal)`` returns the result of the nominal seal, on which a measure selects its
        points; ``analyze`` when left out. Cached points are not selected again.

    Raises
    ------
    ValueError
        For a name that the seal does not know.
    LoadPathError
        When the path of the nominal seal cannot be completed, and a measure selects points on it.
    """
    # measures without selected points need no nominal analysis
    chosen = _chosen(seal, measures)
    if not any(measure.selects_points for measure in chosen):
        return chosen
    # evaluation points depend on the nominal seal only
    nominal_seal = seal.nominal()
    wanted = {measure: (nominal_seal.key, measure) for measure in chosen if measure.selects_points}
    if any(key not in _places for key in wanted.values()):
        # select the points on the deformed nominal seal
        nominal = (analyze if analysis is None else analysis)(nominal_seal)
        if not nominal.converged:
            names = ", ".join(repr(measure.name) for measure in wanted)
            raise LoadPathError(
                f"the measures {names} are evaluated at points that an analysis of the nominal "
                "seal determines, but this analysis failed; correct the nominal seal until "
                "sm.analyze(seal.nominal()) converges, or leave out these measures: "
                f"{nominal.failure}",
                nominal,
            )
        for measure in (*wanted, *seal.measures()):  # those of always are asked for next
            if measure.selects_points:
                # frozen points: the measure is a smooth function of the design
                _places[nominal_seal.key, measure] = measure.frozen(nominal)
    for key in wanted.values():
        # least recently used entries are dropped
        _places.move_to_end(key)
    found = tuple(_places[wanted[m]] if m.selects_points else m for m in chosen)
    while len(_places) > KNOWN_PLACES:
        _places.popitem(last=False)
    return found


_places = OrderedDict()
"""Cache of measures with evaluation points, by key of the nominal seal and measure without points."""


def _chosen(seal: Seal, measures) -> tuple:
    """Look up measures that are given by name."""
    chosen = []
    for measure in seal.measures() if measures is None else measures:
        # by name, or a measure itself
        chosen += seal.measures((measure,)) if isinstance(measure, str) else [measure]
        values.instance("a measure", chosen[-1], Measure)
    return tuple(chosen)


def is_empty(measure: Measure, seal: Seal) -> bool:
    """Whether a measure has no evaluation points because the nominal seal has no gap region."""
    base = measure.base if isinstance(measure, Derived) else measure
    return base.size(seal) == 0


@one_blas_thread
def analyze(
    seal: Seal,
    boundary_offsets: np.ndarray | None = None,
    parameters: dict | None = None,
    *,
    keep_factors: bool = False,
    callback: Callable | None = None,
) -> SealResult:
    """Analyse one design of a seal.

    Parameters
    ----------
    seal : Seal
    boundary_offsets : ndarray, shape (seal.n_offsets,), optional
        mm; zeros, the nominal seal, when left out.
    parameters : dict of str to float, optional
        Scalar parameters to change, by their names in ``seal.scalars``.
    keep_factors : bool
        Keep the factors of the converged tangents for sensitivities, as far as ``FACTOR_MEMORY``
        (GiB) goes.
    callback : callable, optional
        Called with each ``ConvergedStep`` that completes a nominal step.

    Returns
    -------
    SealResult
        Look at ``converged``: a path that ends early is returned, not raised.

    Raises
    ------
    ValueError
        Wrong sizes, unknown parameters, values that are not finite, a folded section, too small a
        support, an analysis that does not fit into the machine's memory or takes longer than 24 hours
        by its estimate (``TooLargeError``; ``analysis.cost``).
    """
    values.instance("seal", seal, Seal)
    return analyzed_with(
        analyze_particles, seal, boundary_offsets, parameters, keep_factors, callback
    )


def analyzed_with(
    analysis: Callable, seal: Seal, boundary_offsets, parameters, keep_factors, callback
) -> SealResult:
    """Convert a design and parameters to particles and a seal, and call ``analysis`` with them."""
    # X = X_0 + sum_p b_p V_p, with checked offsets b
    offsets = seal.check_offsets(boundary_offsets)
    if parameters is not None:
        values.instance("parameters", parameters, Mapping)
    values.callback("callback", callback)
    keep_factors = values.flag("keep_factors", keep_factors)
    return analysis(
        seal.with_parameters(parameters or {}), seal.particles(offsets), offsets,
        factor_memory=FACTOR_MEMORY if keep_factors else 0.0, callback=callback,
    )  # fmt: skip


def estimate(seal: Seal, n_steps: int | None = None) -> Cost:
    """Estimate time and memory of one analysis of a seal (``analysis.cost``), in its own load steps or
    in ``n_steps``; preliminary increments (``Motion.retraction``) are added to them."""
    values.instance("seal", seal, Seal)
    n_steps = seal.n_steps if n_steps is None else values.integer("n_steps", n_steps, 0)
    before = max((len(own.motion.retraction) for own in profiles.contacts(seal)), default=0)
    touching = bool(profiles.self_contacts(seal))
    return analysis_cost(seal.body, seal.nominal_particles, n_steps + before, touching)


def unloaded(seal: Seal) -> SealResult:
    """Build the nominal seal without load steps, for pictures of its section."""
    # undeformed state: a path of zero steps counts as completed
    terms = seal.terms()
    problem = PathProblem(
        discretize(seal.body, seal.nominal_particles, terms), terms, seal.imposed()
    )
    return SealResult(seal, PathResult(problem, None, [], Status.CONVERGED, 0))


class Known(NamedTuple):
    """Data of a seal that other analyses have computed already.

    Attributes
    ----------
    discretization : Discretization or None
        Of a seal with the same particles and points of its terms, in other load steps and with other
        penalties.
    resume, states, near
        As of ``load_path.solve_path``.
    """

    discretization: Discretization | None = None
    resume: PathState | None = None
    states: dict | None = None
    near: Callable | None = None


NOTHING_KNOWN = Known()


def analyze_particles(
    seal: Seal,
    particles,
    boundary_offsets=None,
    *,
    factor_memory=0.0,
    callback=None,
    known: Known = NOTHING_KNOWN,
) -> SealResult:
    """Analyse a seal with given particles (n, 2), mm; otherwise as ``analyze``.

    Factors of converged tangents are cached up to ``factor_memory`` (GiB). A profile inside of which the
    particles of a changed design, or of a seal with changed parameters, would begin starts farther back
    where the seal has ``clear_designs``; ``SealResult.seal`` is then that with the other start.
    """
    # the choice of steps and penalties has solved this path already
    path = take_path(seal, particles)
    if path is not None:
        # report its steps as if they were computed now
        for step in path.nominal_steps if callback is not None else ():
            callback(step)
        path = path if factor_memory >= FACTOR_MEMORY else without_factors(path)
        return SealResult(seal, path, boundary_offsets)
    # refuse analyses beyond the memory, report long ones
    cost = estimate(seal)
    require_means(cost, seal.body, seal.n_steps)
    announce(cost, seal.body, seal.n_steps)
    terms = seal.terms()
    # r(d, lambda) = 0 of all terms, solved along lambda
    discretization = known.discretization
    if discretization is None:
        with _folds_explained(seal, particles):
            discretization = discretize(seal.body, particles, terms)
    problem = PathProblem(discretization, terms, seal.imposed())
    try:
        # a + b = l at this design, at every step   Eq. (45), for the nominal one (43)
        path = solve_path(
            problem, seal.n_steps, seal.newton, factor_memory, callback, known.resume, known.states,
            known.near,
        )  # fmt: skip
    except GeometryError:
        # a design that has grown into a profile, or a profile placed inside: it begins farther back
        changed = bool(seal.changed) or not np.array_equal(particles, seal.nominal_particles)
        clear = with_clear_starts(seal, particles) if seal.clear_designs and changed else seal
        if clear is seal:
            raise
        return analyze_particles(
            clear, particles, boundary_offsets, factor_memory=factor_memory, callback=callback,
            known=Known(discretization, states=known.states),
        )  # fmt: skip
    return SealResult(seal, path, boundary_offsets)


@contextmanager
def _folds_explained(seal: Seal, particles):
    """Add to the error of a folded section which design parameter moves it most at that place."""
    try:
        yield
    except GeometryError as error:
        if not (error.cell and seal.n_offsets):
            raise
        # offsets of these particles: X - X_0 = sum_p b_p V_p
        velocity = seal.design_velocity.reshape(seal.n_offsets, -1).T
        moved = np.ravel(particles - seal.nominal_particles)
        offsets = np.linalg.lstsq(velocity, moved, rcond=None)[0]
        # largest |b_p V_p| of the particles of the folded cell
        speeds = np.linalg.norm(seal.design_velocity[:, list(error.cell)], axis=2).max(axis=1)
        shares = np.abs(offsets) * speeds
        most = int(shares.argmax())
        raise GeometryError(
            f"{error}. boundary_offsets[{most}] = {offsets[most]:.4g} moves the section most there, by "
            f"{shares[most]:.3g} mm; a boundary that moves farther than the wall is thick folds the "
            "section, so limit the wall thickness (measure wall_thickness)",
            error.cell,
        ) from error
