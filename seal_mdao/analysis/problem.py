"""Residual and tangent of the incremental equation (44), and the tangent predictor."""

import numpy as np

from seal_mdao.analysis.body import Discretization
from seal_mdao.analysis.equations import Scatter
from seal_mdao.analysis.internal_force import assemble_internal
from seal_mdao.analysis.loading import LoadPoint
from seal_mdao.analysis.result import ConvergedStep
from seal_mdao.contact.assembly import assemble_points, interpolate
from seal_mdao.contact.friction import ContactLaw, contact_points
from seal_mdao.geometry.profile import RigidProfile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin


class PathProblem:
    """Residual and tangent of one discretised body against one moving profile.

    The buffers are reused between iterations; nothing in them outlives a call. ``factor`` is that of
    the tangent factorised last, or None.
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
        self.internal, self.contact = np.empty(layout.force_size), np.empty(layout.force_size)
        self.external = np.zeros(layout.n_equations)
        self.values, self.factor = np.empty(layout.size), None
        self.x, self.force, self.tangent = np.empty((k, 2)), np.empty((k, 2)), np.empty((k, 2, 2))
        self.state, self.kept, self.gap = np.empty(k, np.int64), np.empty((k, 3)), np.empty(k)
        self.direction, self.made_to_stick, self.held = np.zeros(k, np.int64), 0, 0.0
        # what rounding leaves of a residual: large moduli multiply differences of order one
        size = float(np.abs(discretization.particles).max())
        stiff = material.bulk_modulus * discretization.body.support_radius.max()
        self.rounding = 10 * np.finfo(float).eps * (stiff + law.normal_penalty * size)

    def assemble(self, d, point: LoadPoint, history) -> bool:
        """Fill forces and tangent at displacements ``d``; False where a point is inverted."""
        self.values[:] = 0.0
        upright = self._add_to(self.values, d, point, history)
        if upright:
            self.discretization.layout.condense_tangent(self.values)
        return upright

    def assemble_forces(self, d, point: LoadPoint, history) -> bool:
        """Fill the forces as ``assemble`` does, and leave the tangent as it is."""
        return self._add_to(np.empty(0), d, point, history)

    def _add_to(self, values, d, point, history) -> bool:
        """Fill the forces and, where ``values`` is not empty, add the tangent to it."""
        disc = self.discretization
        cells, points = disc.layout.scatter
        self.internal[:] = 0.0
        self.contact[:] = 0.0
        raw = disc.transformation.coefficients(d)
        bad = assemble_internal(
            disc.cells.raw, disc.weights, self.constants, raw, cells, self.internal, values
        )
        if bad >= 0:
            return False
        interpolate(disc.contact.raw, raw, self.x)
        self.x += disc.particles[disc.body.contact]
        self.made_to_stick = contact_points(
            self.profile, self.law, point.position, self.x, disc.contact_length, history,
            self.direction, self.force, self.tangent, self.state, self.kept, self.gap,
        )  # fmt: skip
        assemble_points(
            disc.contact.raw, self.force, self.tangent, self.state, points, self.contact, values
        )
        disc.layout.condense_force(self.internal)
        disc.layout.condense_force(self.contact)
        self.external[:] = disc.layout.reduce(point.force)
        self.held = 0.0 if point.imposed is None else self._held_force(d)
        return True

    def factorize(self):
        """Factor of the assembled tangent; the one before is let go first, to save its memory.

        Raises
        ------
        LinAlgError
            The tangent is singular.
        """
        self.factor = None
        self.factor = self.discretization.layout.factorize(self.values)
        return self.factor

    def factorize_at(self, step: ConvergedStep):
        """Assemble and factorise the tangent at a converged step."""
        self.assemble_at(step)
        return self.factorize()

    def contact_load(self, force: np.ndarray, state: np.ndarray) -> np.ndarray:
        """Load (n_equations,) of forces (k, 2) on the contact points whose ``state`` is not OPEN."""
        layout = self.discretization.layout
        load = np.zeros_like(self.contact)
        assemble_points(
            self.discretization.contact.raw, force, self.tangent, state, layout.scatter[1], load,
            np.empty(0),
        )  # fmt: skip
        layout.condense_force(load)
        return load[: layout.n_equations]

    def _held_force(self, d) -> float:
        """Norm of the internal forces of all components: what imposed displacements are held with."""
        disc = self.discretization
        n = d.size
        every = Scatter(np.arange(n).reshape(d.shape), np.empty(0, int), np.empty(0, np.int32))
        force = np.zeros(n + 1)
        assemble_internal(
            disc.cells.table, disc.weights, self.constants, d, every, force, np.empty(0)
        )
        return float(np.linalg.norm(force))

    def assemble_at(self, step: ConvergedStep) -> None:
        """Fill forces and tangent at a converged step."""
        self.direction[:] = 0
        self.assemble(step.d, step.loading, step.before)

    def residual(self):
        """Residual vector, its norm relative to the acting forces, and whether it is mere rounding."""
        n = self.discretization.layout.n_equations
        forces = self.internal[:n], self.contact[:n], self.external
        residual = forces[0] + forces[1] - forces[2]
        size = float(np.linalg.norm(residual))
        scale = max(self.held, *(np.linalg.norm(force) for force in forces))
        return residual, size / scale if scale > 0.0 else 0.0, size <= self.rounding

    def predict(self, step: ConvergedStep, factor, target: LoadPoint) -> np.ndarray:
        """Euler predictors (1 or 2, n, 2) from a converged step, reusing its factorisation.

        The contact force depends on x minus the profile's position only, so its rate with the
        motion is minus its tangent. With the incremental history slip starts again from zero. Where
        a point slides on, its friction is back at once; where it does not, the force jumps to that
        at the old position with the new history. Both are predicted then.
        """
        rate = -np.einsum("kij,j->ki", self.tangent, target.position - step.position)
        if self.law.accumulated:
            return self._euler(step, factor, target, rate)[np.newaxis]
        jump = self.contact_at(step, step.after)[0] - step.force
        return np.stack([self._euler(step, factor, target, force) for force in (rate + jump, rate)])

    def closest(self, guesses, target: LoadPoint, history) -> np.ndarray:
        """Those of the displacements that leave the smallest residual."""
        if len(guesses) == 1:
            return guesses[0]
        sizes = []
        for d in guesses:
            self.direction[:] = 0
            sizes.append(self.residual()[1] if self.assemble_forces(d, target, history) else np.inf)
        return guesses[int(np.argmin(sizes))]

    def _euler(self, step: ConvergedStep, factor, target: LoadPoint, rate) -> np.ndarray:
        """Displacements after the contact forces (k, 2) have changed by ``rate`` at fixed x."""
        layout, now = self.discretization.layout, step.loading
        load, d = self.contact_load(rate, self.state), step.d
        if target.imposed is not None:
            increment = np.where(layout.equations < 0, target.imposed - now.imposed, 0.0)
            load += self._internal_rate(d, increment)
            d = d + increment
        if target.force is not None:
            load -= layout.reduce(target.force - now.force)
        return d - layout.gather(factor.solve(load))

    def contact_at(self, step: ConvergedStep, history) -> tuple[np.ndarray, np.ndarray]:
        """Contact forces (k, 2) and tangents (k, 2, 2) at a converged step with any history."""
        force, tangent = np.empty_like(self.force), np.empty_like(self.tangent)
        contact_points(
            self.profile, self.law, step.position, step.contact_x,
            self.discretization.contact_length, history, np.zeros_like(self.direction), force,
            tangent, np.empty_like(self.state), np.empty_like(self.kept), np.empty_like(self.gap),
        )  # fmt: skip
        return force, tangent

    def _internal_rate(self, d, increment, share=1e-6) -> np.ndarray:
        """Change of the internal force with imposed displacements; only the predictor uses it."""
        disc = self.discretization
        ends = np.zeros((2, disc.layout.n_equations + 1))
        for end, at in zip(ends, (d, d + share * increment), strict=True):
            assemble_internal(
                disc.cells.table, disc.weights, self.constants, at, disc.layout.force_scatter, end,
                np.empty(0),
            )  # fmt: skip
        return (ends[1] - ends[0])[:-1] / share
