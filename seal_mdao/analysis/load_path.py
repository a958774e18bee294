"""The load path: displacement-driven steps, Newton (44), a tangent predictor, and step cutting.

Always from the undeformed state and with a fixed step sequence, so that the same inputs give the
same bits whatever was computed before.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.body import Discretization
from seal_mdao.analysis.internal_force import assemble_internal
from seal_mdao.analysis.result import ConvergedStep, PathResult, Status
from seal_mdao.contact.assembly import assemble_points, interpolate
from seal_mdao.contact.friction import (
    OPEN,
    SLIP,
    ContactHistory,
    ContactLaw,
    contact_points,
    no_history,
)
from seal_mdao.geometry.profile import RigidProfile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin


@dataclass(frozen=True)
class NewtonOptions:
    """Convergence control.

    Attributes
    ----------
    tolerance : float
        Residual norm over the norm of the contact and internal forces.
    max_iterations : int
        Iterations before a step is cut.
    max_cuts : int
        How often a step may be halved.
    """

    tolerance: float = 1e-10
    max_iterations: int = 15
    max_cuts: int = 8


class PathProblem:
    """Residual and tangent of one discretised body against one moving profile.

    The buffers are reused between iterations; nothing in them outlives a call.
    """

    def __init__(
        self,
        discretization: Discretization,
        material: MooneyRivlin,
        profile: RigidProfile,
        law: ContactLaw,
    ):
        self.discretization = discretization
        self.constants = (material.c10, material.c01, material.bulk_modulus)
        self.profile, self.law = profile, law
        layout, k = discretization.layout, len(discretization.body.contact)
        self.internal = np.empty(layout.n_equations + 1)
        self.contact = np.empty(layout.n_equations + 1)
        self.values = np.empty(layout.size)
        self.x, self.force, self.tangent = np.empty((k, 2)), np.empty((k, 2)), np.empty((k, 2, 2))
        self.state, self.kept, self.gap = np.empty(k, np.int64), np.empty((k, 3)), np.empty(k)
        # what rounding leaves of a residual: large moduli multiply differences of order one
        size = float(np.abs(discretization.particles).max())
        stiff = material.bulk_modulus * discretization.body.support_radius.max()
        self.rounding = 10 * np.finfo(float).eps * (stiff + law.normal_penalty * size)

    def assemble(self, d, position, history) -> bool:
        """Fill forces and tangent at displacements ``d``; False where a point is inverted."""
        disc = self.discretization
        cells, points = disc.layout.scatter
        self.internal[:] = 0.0
        self.contact[:] = 0.0
        self.values[:] = 0.0
        bad = assemble_internal(
            disc.cells.table, disc.weights, self.constants, d, cells, self.internal, self.values
        )
        if bad >= 0:
            return False
        interpolate(disc.contact.table, d, self.x)
        self.x += disc.particles[disc.body.contact]
        contact_points(
            self.profile, self.law, position, self.x, disc.contact_length, history, self.force,
            self.tangent, self.state, self.kept, self.gap,
        )  # fmt: skip
        assemble_points(
            disc.contact.table, self.force, self.tangent, self.state, points, self.contact,
            self.values,
        )  # fmt: skip
        return True

    def residual(self):
        """Residual vector, its norm relative to the acting forces, and whether it is mere rounding."""
        residual = self.internal[:-1] + self.contact[:-1]
        size = float(np.linalg.norm(residual))
        scale = max(np.linalg.norm(self.contact[:-1]), np.linalg.norm(self.internal[:-1]))
        return residual, size / scale if scale > 0.0 else 0.0, size <= self.rounding

    def predict(self, step: ConvergedStep, factor, position) -> np.ndarray:
        """Euler predictor from a converged step, reusing its factorisation.

        The contact force depends on x minus the profile's position only, so its rate with the
        motion is minus its tangent. With the incremental history the force at the old position
        is not the converged one (slip starts again from zero); that jump is predicted too.
        """
        disc = self.discretization
        rate = -np.einsum("kij,j->ki", self.tangent, position - step.position)
        if not self.law.accumulated:
            again = np.empty_like(self.force)
            contact_points(
                self.profile, self.law, step.position, step.contact_x, disc.contact_length,
                step.after, again, np.empty_like(self.tangent), np.empty_like(self.state),
                np.empty_like(self.kept), np.empty_like(self.gap),
            )  # fmt: skip
            rate += again - step.force
        load = np.zeros_like(self.contact)
        assemble_points(
            disc.contact.table, rate, self.tangent, self.state, disc.layout.scatter[1], load,
            np.empty(0),
        )  # fmt: skip
        return step.d - disc.layout.gather(factor.solve(load[:-1]))


def newton(problem: PathProblem, d, position, history, options: NewtonOptions):
    """Newton iterations (44) at a fixed profile position.

    Returns
    -------
    status : Status
    d : ndarray, shape (n, 2)
    residuals : tuple of float
    factor : object or None
        Factor of the tangent at the converged configuration.
    """
    layout = problem.discretization.layout
    residuals = []
    for _ in range(options.max_iterations + 1):
        if not problem.assemble(d, position, history):
            return Status.INVERTED, d, tuple(residuals), None
        residual, size, rounding = problem.residual()
        residuals.append(size)
        if not np.isfinite(size):
            return Status.DIVERGED, d, tuple(residuals), None
        try:
            factor = layout.factorize(problem.values)
        except np.linalg.LinAlgError:
            return Status.SINGULAR, d, tuple(residuals), None
        if size <= options.tolerance or rounding:
            return Status.CONVERGED, d, tuple(residuals), factor
        if len(residuals) <= options.max_iterations:
            d = d - layout.gather(factor.solve(residual))
    return Status.NOT_CONVERGED, d, tuple(residuals), None


def _initial_step(problem: PathProblem, position) -> tuple[ConvergedStep, object]:
    """The undeformed state, with its factor."""
    disc = problem.discretization
    d, history = np.zeros_like(disc.particles), no_history(len(disc.body.contact))
    problem.assemble(d, position, history)
    factor = disc.layout.factorize(problem.values)
    return _record(problem, -1, 0.0, position, d, history, (0.0,), None), factor


def _record(problem, nominal, fraction, position, d, history, residuals, factor) -> ConvergedStep:
    after = ContactHistory(problem.state.copy(), problem.kept.copy())
    return ConvergedStep(
        nominal, fraction, position, d, history, after, problem.x.copy(), problem.force.copy(),
        problem.gap.copy(), len(residuals) - 1, residuals, factor,
    )  # fmt: skip


def solve_path(
    discretization: Discretization,
    material: MooneyRivlin,
    profile: RigidProfile,
    law: ContactLaw,
    positions: np.ndarray,
    options: NewtonOptions | None = None,
    keep_factors: bool = False,
    callback: Callable[[ConvergedStep], None] | None = None,
) -> PathResult:
    """Follow the profile through its positions.

    Parameters
    ----------
    positions : ndarray, shape (n_steps + 1, 2)
        Rigid translation of the profile, the start (undeformed body) first.
    keep_factors : bool
        Keep the factor of every converged tangent, for the sensitivities.
    callback : callable, optional
        Called with every ``ConvergedStep`` that completes a nominal step.

    Returns
    -------
    PathResult
        Complete, or up to the step that failed; no exception is raised for a failed path.
    """
    options = NewtonOptions() if options is None else options
    problem = PathProblem(discretization, material, profile, law)
    last, factor = _initial_step(problem, positions[0])
    if np.any(last.after.state != OPEN):
        deepest = -float(last.gap.min())
        raise ValueError(
            f"the undeformed body starts {deepest:.3g} inside the rigid profile; start it farther away"
        )
    steps, cuts = [], 0
    for nominal in range(len(positions) - 1):
        pending = [1.0]
        while pending:
            share = pending.pop()
            end = nominal + 1.0 if not pending else last.fraction + share
            position = positions[nominal] + (end - nominal) * (
                positions[nominal + 1] - positions[nominal]
            )
            guess = problem.predict(last, factor, position)
            status, d, residuals, new_factor = newton(problem, guess, position, last.after, options)
            if status is not Status.CONVERGED:
                if share * 0.5 < 0.5**options.max_cuts:
                    failure = _describe(problem, status, nominal, end, position, residuals)
                    return PathResult(discretization, steps, status, cuts, failure)
                cuts += 1
                pending += [0.5 * share, 0.5 * share]
                # the tangent of the last converged step is needed again for the predictor
                problem.assemble(last.d, last.position, last.before)
                continue
            factor = new_factor
            last = _record(
                problem, -1 if pending else nominal, end, position, d, last.after, residuals,
                factor if keep_factors else None,
            )  # fmt: skip
            steps.append(last)
        if callback is not None:
            callback(last)
    return PathResult(discretization, steps, Status.CONVERGED, cuts)


def _describe(problem, status, nominal, end, position, residuals) -> str:
    state = problem.state
    return (
        f"load step {nominal + 1} (path parameter {end:.4f}, profile at x = {position[0]:.4g}, "
        f"y = {position[1]:.4g}): {status.value}; relative residual "
        f"{residuals[-1] if residuals else np.nan:.2e} after {max(len(residuals) - 1, 0)} iterations; "
        f"{int(np.sum(state != OPEN))} points in contact, {int(np.sum(state == SLIP))} slipping"
    )
