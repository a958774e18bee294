"""Definition of a seal: particles and their design, terms of equilibrium, load steps, measures."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.default_penalties import completed
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.loads.moved_edges import ImposedMotions
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.measures.section_shape import cells_area
from seal_mdao.registry import replacements
from seal_mdao.seals.conditions import check_conditions, conditions_of, table_points
from seal_mdao.seals.result_units import ResultUnits, result_units
from seal_mdao.terms.term import Scalar

SETTINGS_OPTION = "seal_settings"
"""Option of a ``SealGroup`` with the JSON text of ``Seal.settings``, for recorder files."""


class Parameter(NamedTuple):
    """Public description of a scalar parameter of the terms.

    Attributes
    ----------
    units, text : str
        Units (None without) and description.
    zero : float
        Its value where the parameter of the terms is zero; without such a term its nominal value.
    bounds : mapping
        Keyword arguments of ``values.real``.
    """

    units: str | None
    text: str
    zero: float = 0.0
    bounds: Mapping = {}


@dataclass(frozen=True, eq=False)
class Seal:
    """Seal: particles and their design parameters, terms of the equilibrium equations, load steps
    and measures.

    Particles are linear in the design parameters, X = X0 + sum_p offset_p V_p, so the design velocity V
    is constant.

    Attributes
    ----------
    nominal_particles : ndarray, shape (n, 2)
        X0, mm.
    design_velocity : ndarray, shape (P, n, 2)
        V: how the design parameters (``boundary_offsets``) move the particles.
    body : Body
        Cells, supports, fixed components, named edges.
    definitions : tuple of TermDefinition
        An elastic body first.
    n_steps : int
        Nominal load steps.
    standard : tuple of Measure
        The measures that an OpenMDAO component has unless others are asked for.
    inputs : tuple of str
        Scalar parameters that are always inputs of an OpenMDAO component. They are design parameters:
        the nominal seal has their nominal values.
    imposed_displacements : ImposedDisplacements or ImposedMotions, optional
    newton : NewtonOptions
    changed : dict of str to float
        Scalar parameters with other values than the definitions have.
    further : tuple of Measure
        Other measures that the seal knows by their names.
    parameters : dict of str to Parameter
        Units, description, zero and bounds of scalar parameters, where they are not those of the terms.
    before_touch : float
        Travel of the leading profile from which travels are counted, that of the first touch of the
        nominal seal where it is known, mm.
    section_area : callable, optional
        ``section_area(offsets)`` gives the area of the section, mm^2, and its gradient with respect to
        the offsets, both complex for complex offsets; the area of the cells when left out.
    offset_limit : float
        Largest offset, mm.
    step_error : float
        Estimated relative error by load steps that were chosen, where it is above their tolerance.
    clear_designs : bool
        Whether a profile inside of which a changed design, or a seal with changed parameters, would
        begin starts farther back (``seals.clear_start``); of the class. Otherwise the design is refused.

    Raises
    ------
    ValueError
        For arrays that do not fit each other, labels that repeat, inputs that no term knows.
    """

    clear_designs: ClassVar[bool] = False

    nominal_particles: np.ndarray
    design_velocity: np.ndarray
    body: Body
    definitions: tuple
    n_steps: int
    standard: tuple = ()
    inputs: tuple = ()
    imposed_displacements: object = None
    newton: NewtonOptions = field(default_factory=NewtonOptions)
    changed: dict = field(default_factory=dict)
    further: tuple = ()
    parameters: dict = field(default_factory=dict)
    before_touch: float = 0.0
    section_area: Callable | None = None
    offset_limit: float = np.inf
    step_error: float = 0.0

    def __post_init__(self):
        # sizes and kinds of all parts
        values.integer("n_steps", self.n_steps, 1)
        for name, kind in (("body", Body), ("newton", NewtonOptions)):
            if not isinstance(getattr(self, name), kind):
                raise ValueError(
                    f"{name} must be of class {kind.__name__}, got {type(getattr(self, name)).__name__}"
                )
        for name in ("nominal_particles", "design_velocity"):
            if not np.isfinite(values.numbers(name, getattr(self, name))).all():
                raise ValueError(f"{name} must be finite")
        # X_0 (n, 2) and V (P, n, 2) for the n particles of the body
        shape = (self.body.n_particles, 2)
        if np.shape(self.nominal_particles) != shape:
            raise ValueError(
                f"the positions nominal_particles of a seal must have shape {shape}, got "
                f"{np.shape(self.nominal_particles)}"
            )
        if np.ndim(self.design_velocity) != 3 or np.shape(self.design_velocity)[1:] != shape:
            raise ValueError(
                f"the array design_velocity of a seal must have shape (P, {shape[0]}, 2), got "
                f"{np.shape(self.design_velocity)}"
            )
        self._complete()
        # a label is how measures, sensitivities and figures find a term
        labels = [definition.label for definition in self.definitions]
        if len(set(labels)) < len(labels):
            raise ValueError(
                f"the loads and contacts (terms) of a seal must have different labels, got {labels}"
            )
        unknown = [name for name in self.inputs if name not in self.scalars]
        if unknown:
            raise ValueError(
                f"the seal has no parameter {unknown[0]!r}; its parameters are "
                f"{', '.join(self.scalars)}"
            )

    def __repr__(self) -> str:
        # arrays would fill thousands of lines
        profiles = [own.label for own in self.definitions if isinstance(own, RigidContact)]
        return (
            f"<{type(self).__name__}: {self.body.n_particles} particles, "
            f"profiles: {', '.join(profiles) or 'none'}, {self.n_steps} load steps>"
        )

    def _complete(self) -> None:
        """Set open penalties of contacts from the stiffness of the body; let terms that depend on
        contacts depend on these."""
        # penalties scale with E/h of the elastic body
        elastic, *rest = self.definitions
        rest = [completed(own, elastic, self.body, self.nominal_particles) for own in rest]
        rest = [own.among(rest) for own in rest]
        object.__setattr__(self, "definitions", (elastic, *rest))

    @cached_property
    def units(self) -> ResultUnits:
        """Units of forces and energies: per metre, or of the complete ring."""
        return result_units(self.body, self.nominal_particles)

    # ---- scalar parameters ----

    @cached_property
    def scalars(self) -> dict:
        """``Scalar`` by name: the parameters of ``with_parameters`` and of sensitivities."""
        # p_0, for parameters that no term has
        found = {
            name: Scalar(own.zero, own.units, own.text) for name, own in self.parameters.items()
        }
        for definition in (*self.definitions, self.imposed_displacements):
            for name, own in ({} if definition is None else definition.scalars).items():
                shown = self.parameters.get(name)
                # p = p_0 + p of the term
                found[name] = own if shown is None else Scalar(shown.zero + own.value, *shown[:2])
        for measure in (*self.standard, *self.further):
            found |= measure.scalars
        return {
            name: scalar._replace(value=self.changed.get(name, scalar.value))
            for name, scalar in found.items()
        }

    def _applied(self, definition):
        """Return a definition with the changed parameters applied."""
        # parameter of the term = p - p_0
        own = {
            name: self.changed[name] - self.parameters[name].zero
            if name in self.parameters
            else self.changed[name]
            for name in definition.scalars
            if name in self.changed
        }
        return definition.with_parameters(own) if own else definition

    def with_parameters(self, changes: Mapping) -> "Seal":
        """Return a copy with some of the ``scalars`` changed.

        Raises
        ------
        ValueError
            For an unknown name, or a value that is not admissible.
        """
        self.check_parameters(changes)
        if not changes:
            return self
        # checked before any term is built
        checked = {name: self._checked_value(name, value) for name, value in changes.items()}
        other = self._with_changed(self.changed | checked)
        # values that are not admissible are refused here
        other.terms()
        check_conditions(*other._environment)
        for measure in (*other.standard, *other.further):
            measure.with_parameters(other.changed)
        return other

    def _checked_value(self, name: str, value) -> float:
        # a scalar or an array of one number, within the bounds of the parameter
        found = values.numbers(name, value).reshape(-1)
        values.require(found.size == 1, f"{name} must be one number, got {found.size}")
        bounds = self.parameters[name].bounds if name in self.parameters else {}
        return values.real(name, float(found[0]), **bounds)

    def _with_changed(self, changed: dict) -> "Seal":
        """Return the seal with other changed parameters and the same description."""
        other = replace(self, changed=changed)
        other.__dict__["_origin"] = self._origin
        other.__dict__["description"] = self.description
        return other

    def nominal(self) -> "Seal":
        """Return the nominal seal, on which measures select their points: its ``inputs`` are
        unchanged."""
        # changed material or friction remain: only the design returns to nominal
        rest = {name: own for name, own in self.changed.items() if name not in self.inputs}
        return self if len(rest) == len(self.changed) else self._with_changed(rest)

    def check_parameters(self, names) -> None:
        """Raise ValueError for a scalar parameter that the seal does not have."""
        _check_known("parameter", names, self.scalars)

    # ---- terms and load steps ----

    @cached_property
    def _terms(self) -> tuple:
        applied = tuple(self._applied(definition) for definition in self.definitions)
        return tuple(own.among(applied) for own in applied)

    def terms(self) -> tuple:
        """Definitions of all terms of equilibrium, in the order in which they are summed."""
        return self._terms

    def imposed(self):
        """``ImposedDisplacements`` of the fixed components, or None."""
        imposed = self.imposed_displacements
        return None if imposed is None else self._applied(imposed)

    def with_ends(self, ends) -> "Seal":
        """Return the same seal with other ends of the load steps.

        Parameters
        ----------
        ends : sequence of float
            Increasing, in nominal steps of this seal, the ends of all stages of motions among them.

        Raises
        ------
        ValueError
            For ends that leave out the end of a stage.
        """
        imposed = self.imposed_displacements
        return replace(
            self, n_steps=len(ends),
            definitions=tuple(definition.with_ends(ends) for definition in self.definitions),
            imposed_displacements=None if imposed is None else imposed.with_ends(ends),
        )  # fmt: skip

    def with_clearances(self, clearances: dict) -> "Seal":
        """Return the same seal with profiles that start farther back (``Motion.clearance``).

        Parameters
        ----------
        clearances : dict of str to ndarray, shape (2,)
            Start relative to the first waypoint, by the label of the profile, mm.
        """
        return self._started("clearance", clearances)

    def with_retractions(self, retractions: dict) -> "Seal":
        """Return the same seal with profiles that move to where the first load step begins in
        preliminary increments (``Motion.retraction``, shape (n, 2), by the label of the profile)."""
        return self._started("retraction", retractions)

    def _started(self, what: str, changes: dict) -> "Seal":
        """Set the clearance or the retraction of motions, by the labels of profiles."""
        other = replace(self, definitions=tuple(
            replace(own, motion=replace(own.motion, **{what: changes[own.label]}))
            if own.label in changes else own
            for own in self.definitions
        ))  # fmt: skip
        # profiles moved back before stay so
        changes = {label: np.asarray(own, float).tolist() for label, own in changes.items()}
        known = self.description.get(f"{what}s", {})
        return other._made_as(self, **{f"{what}s": known | changes})

    def with_placements(self) -> "Seal":
        """Return the seal with placement parameters of every profile and of moved edges: ``<label>_x``,
        ``<label>_y`` (mm) and ``<label>_angle`` (degrees about its pivot), zero at the nominal position.

        They move a profile along its whole path; a profile that would begin inside of the seal begins
        farther back (``seals.clear_start``). A profile with parameters of its own that move its
        start, as the door of the door seal has ``door_shift`` and ``door_angle``, stays as it is.
        """
        definitions = tuple(map(_placed, self.definitions))
        imposed = self.imposed_displacements
        if isinstance(imposed, ImposedMotions):
            imposed = imposed.with_placements()
        elif all(map(lambda new, old: new is old, definitions, self.definitions)):
            return self
        other = replace(self, definitions=definitions, imposed_displacements=imposed)
        return other._made_as(self, placements=True)

    def placed(self, names) -> "Seal":
        """Return the seal with placement parameters (``with_placements``) if it does not have one of the
        scalar parameters ``names``, such as ``lid_y``; the seal itself otherwise."""
        known = all(name in self.scalars for name in names)
        return self if known else self.with_placements()

    # ---- description, from which the seal can be rebuilt ----

    def made_from(self, description: dict) -> "Seal":
        """Set the description (JSON values) from which this seal can be rebuilt; seals with equal
        descriptions are the same. A copy by ``dataclasses.replace`` has no description.
        """
        self.__dict__["description"] = description
        if description:
            # the same text after an extension was registered anew describes another seal
            self.__dict__["_origin"] = replacements(), json.dumps(description)
        return self

    def _made_as(self, seal: "Seal", **more) -> "Seal":
        """Set the description of another seal, with changes, as that of this one."""
        self.made_from(seal.description and seal.description | more)
        if self.description:
            # made of the extensions of that seal
            self.__dict__["_origin"] = seal._origin[0], self._origin[1]
        return self

    def settings(self) -> str:
        """Return the seal as JSON, from which it can be rebuilt; empty where that is not possible."""
        if not self.description:
            return ""
        changed = {"parameters": {name: float(value) for name, value in self.changed.items()}}
        return json.dumps(self.description | (changed if self.changed else {}))

    @cached_property
    def description(self) -> dict:
        """Description given to ``made_from``; empty without one."""
        return {}

    @cached_property
    def _origin(self):
        return object()

    @property
    def key(self):
        """Hashable key of the seal, equal for equal inputs."""
        return self._origin, tuple(scalar.value for scalar in self.scalars.values())

    # ---- measures ----

    def measures(self, names=()) -> tuple:
        """Return the standard measures, or those of ``names``, without points selected on the nominal
        seal.

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

    @property
    def warnings(self) -> tuple[str, ...]:
        """Known causes of inaccurate results of this seal, one line each."""
        return self.step_warnings

    @property
    def step_warnings(self) -> tuple[str, ...]:
        """Warning of an error by load steps above the tolerance for which they were chosen."""
        if not self.step_error:
            return ()
        return (
            f"{self.n_steps} load steps cause an estimated error of {self.step_error:.1%} of the "
            "largest force or measure, which more load steps do not reduce: the other warnings "
            "name the cause, often a loss of stability, or walls that meet without [self_contact]; "
            "change the section, or reduce the travel",
        )

    # ---- design ----

    @property
    def materials(self) -> dict[str, Isotropic]:
        """Materials of the body by their names; the only one of a seal is ``rubber``."""
        return {own.name or "rubber": own.material for own in self.definitions[0].regions}

    def conditions(self, step: int | None = None) -> dict:
        """Evaluate axial stretch, temperature and swelling of the body, see ``conditions_of``."""
        return conditions_of(*self._environment, step)

    def table_points(self, fractions) -> list[str]:
        """Describe the temperatures that are points of tables of moduli, see
        ``conditions.table_points``."""
        return table_points(*self._environment, fractions)

    @property
    def _environment(self) -> tuple:
        # with the changed parameters
        body = self._terms[0]
        return body.environment, {own.prefix: own.growth for own in body.regions}

    @property
    def n_offsets(self) -> int:
        return len(self.design_velocity)

    def area(self, offsets: np.ndarray) -> tuple[float, np.ndarray]:
        """Compute the area of the section, mm^2, and its gradient with respect to the offsets.

        The offsets have been checked. They are complex under OpenMDAO's complex step, and then so are
        area and gradient.
        """
        if self.section_area is not None:
            return self.section_area(offsets)
        # A = A(X(b)),  dA/db_p = sum_i dA/dX_i . V_pi
        value, by_particles = cells_area(self.body.cells, self.moved(offsets))
        return value, np.tensordot(self.design_velocity, by_particles, 2)

    def particles(self, offsets=None) -> np.ndarray:
        """Compute the particles of a design, shape (n, 2), mm.

        Raises
        ------
        ValueError
            For offsets of a wrong number, or not finite.
        """
        return self.moved(self.check_offsets(offsets))

    def moved(self, offsets: np.ndarray) -> np.ndarray:
        """Compute the particles for offsets that are already checked, real or complex, shape (n,
        2), mm."""
        # X = X_0 + sum_p b_p V_p
        return self.nominal_particles + np.tensordot(offsets, self.design_velocity, 1)

    def check_offsets(self, offsets) -> np.ndarray:
        """Check offsets and return them as an array; zeros for None."""
        if offsets is None:
            return np.zeros(self.n_offsets)
        offsets = values.numbers("boundary_offsets", offsets)
        if offsets.shape != (self.n_offsets,):
            raise ValueError(
                f"boundary_offsets must have shape ({self.n_offsets},), got {offsets.shape}"
            )
        bad = np.flatnonzero(~np.isfinite(offsets))
        if bad.size:
            raise ValueError(f"boundary_offsets[{bad[0]}] is not finite")
        far = np.flatnonzero(np.abs(offsets) > self.offset_limit)
        if far.size:
            raise ValueError(
                f"boundary_offsets[{far[0]}] = {offsets[far[0]]:.4g} exceeds {self.offset_limit:.4g}, "
                "the thickness of the wall; offsets are in mm"
            )
        return offsets


def _placed(definition):
    """Add placement parameters to a contact, unless a parameter moves its start already."""
    if not isinstance(definition, RigidContact) or definition.motion.rates[:, 0].any():
        return definition
    # two shifts and a rotation about the pivot
    names = (f"{definition.label}_{axis}" for axis in ("x", "y", "angle"))
    return replace(definition, motion=definition.motion.with_placement(*names))


def _check_known(what: str, names, known) -> None:
    """Raise ValueError for a name of a measure or parameter that is not known."""
    unknown = [name for name in names if name not in known]
    if unknown:
        raise ValueError(
            f"the seal has no {what} {unknown[0]!r}; it has {', '.join(known) or 'none'}"
        )
