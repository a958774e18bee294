"""The contract of a seal: what is designed, and what the engine needs to know of it."""

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.equilibrium.discretization import Body

SETTINGS_OPTION = "seal_settings"
"""Option of a ``SealGroup`` that holds what ``Seal.settings`` gives, for recorder files."""


class Seal:
    """Base class of seals. A subclass is a frozen object that decides everything but the design.

    Particles are linear in the design parameters, X = X0 + sum_p offset_p V_p, so the design velocity V
    of Eq. (48) is constant.

    Attributes
    ----------
    drawn_particles : ndarray, shape (n, 2)
        X0, mm.
    design_velocity : ndarray, shape (P, n, 2)
        V.
    body : Body
        Cells, supports, fixed components, named edges.
    n_steps : int
        Nominal load steps.
    newton : NewtonOptions
    scalars : dict of str to Scalar
        Parameters that ``with_parameters`` takes and that can be differentiated.
    inputs : tuple of str
        Those of the scalars that are always inputs of an OpenMDAO component.
    before_touch : float
        Travel of the leading profile from which pictures and curves count, that of the first touch of
        the nominal seal where it is known, mm.
    standard, further : tuple of Measure
        Measures that an OpenMDAO component has unless others are asked for, and others that the seal
        knows by their names.
    """

    drawn_particles: np.ndarray
    design_velocity: np.ndarray
    body: Body
    n_steps: int
    newton: NewtonOptions
    scalars: dict
    inputs: tuple = ()
    before_touch: float = 0.0
    standard: tuple = ()
    further: tuple = ()

    def terms(self) -> tuple:
        """Definitions of all terms of equilibrium, in the order in which they are summed."""
        raise NotImplementedError

    def imposed(self):
        """``ImposedDisplacements`` of the fixed components, or None."""

    def with_parameters(self, values: dict) -> "Seal":
        """A copy with some of the ``scalars`` changed.

        Raises
        ------
        ValueError
            For a value that is not admissible.
        """
        raise NotImplementedError

    def with_ends(self, ends) -> "Seal":
        """The same seal with load steps that end elsewhere.

        Parameters
        ----------
        ends : sequence of float
            Increasing, in nominal steps of this seal, the ends of all stages of motions among them.

        Raises
        ------
        ValueError
            For ends that leave out the end of a stage.
        """
        raise NotImplementedError

    def with_rooms(self, rooms: dict) -> "Seal":
        """The same seal with profiles whose first load step begins farther back (``Motion.room``).

        Parameters
        ----------
        rooms : dict of str to ndarray, shape (2,)
            Where it begins, from the first waypoint, by the label of the profile, mm.
        """
        raise NotImplementedError

    def with_placements(self) -> "Seal":
        """The seal with parameters that place every profile: ``<label>_x``, ``<label>_y`` (mm) and
        ``<label>_angle`` (degrees about its pivot), zero where they are drawn.

        They move a profile along its whole path; a sample whose profile would begin inside of the seal
        begins farther back (``seals.clear_start``). A seal that has parameters of its own for that, as
        the door seal has ``door_shift``, ``door_angle`` and ``depth``, stays as it is.
        """
        return self

    def area(self, offsets: np.ndarray) -> tuple[float, np.ndarray]:
        """Area of the section, mm^2, and its gradient with respect to the offsets.

        The offsets have been checked. They are complex under OpenMDAO's complex step, and then so are
        area and gradient.
        """
        raise NotImplementedError

    def measures(self, names=()) -> tuple:
        """The standard measures, or those of ``names``; without the places that they take from the
        nominal seal.

        Raises
        ------
        ValueError
            For a name that the seal does not know.
        """
        if not names:
            return self.standard
        known = {measure.name: measure for measure in (*self.standard, *self.further)}
        _check_known("measure", names, known)
        return tuple(known[name] for name in names)

    def check_parameters(self, names) -> None:
        """Raise ValueError for a scalar parameter that the seal does not have."""
        _check_known("parameter", names, self.scalars)

    def settings(self) -> str:
        """The seal as JSON, from which it can be made again; empty where that is not possible."""
        return ""

    @property
    def key(self):
        """What makes two seals the same: hashable, equal for equal inputs."""
        raise NotImplementedError

    def as_drawn(self) -> "Seal":
        """The same seal under the drawn profile, where places of measures are chosen."""
        return self

    @property
    def cautions(self) -> tuple[str, ...]:
        """What is known to make the results of this seal inaccurate, a line each."""
        return ()

    @property
    def n_offsets(self) -> int:
        return len(self.design_velocity)

    def particles(self, offsets=None) -> np.ndarray:
        """Particles of a design, shape (n, 2), mm.

        Raises
        ------
        ValueError
            For offsets of a wrong number, or not finite.
        """
        return self.moved(self.check_offsets(offsets))

    def moved(self, offsets: np.ndarray) -> np.ndarray:
        """Particles of offsets that have been checked, real or complex, shape (n, 2), mm."""
        return self.drawn_particles + np.tensordot(offsets, self.design_velocity, 1)

    def check_offsets(self, offsets) -> np.ndarray:
        """Offsets as an array of the right shape; zeros for None."""
        if offsets is None:
            return np.zeros(self.n_offsets)
        offsets = values.numbers("boundary_offsets", offsets)
        if offsets.shape != (self.n_offsets,):
            raise ValueError(
                f"boundary_offsets must have shape ({self.n_offsets},), got {offsets.shape}"
            )
        bad = np.flatnonzero(~np.isfinite(offsets))
        if bad.size:
            raise ValueError(f"boundary_offsets[{bad[0]}] is not a finite number")
        return offsets


def _check_known(what: str, names, known) -> None:
    """Raise ValueError for a name of a measure or parameter that is not known."""
    unknown = [name for name in names if name not in known]
    if unknown:
        raise ValueError(f"unknown {what} {unknown[0]!r}; known are {', '.join(known) or 'none'}")
