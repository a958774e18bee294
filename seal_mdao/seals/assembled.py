"""A seal put together from a body, terms and a design: what users start from."""

import json
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.default_penalties import completed
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.measures.section_shape import cells_area
from seal_mdao.seals.seal import Seal


@dataclass(frozen=True, eq=False)
class AssembledSeal(Seal):
    """Any body under any terms.

    Attributes
    ----------
    drawn_particles : ndarray, shape (n, 2)
        mm.
    design_velocity : ndarray, shape (P, n, 2)
        How the design parameters (``boundary_offsets``) move the particles.
    body : Body
    definitions : tuple of TermDefinition
        An elastic body first.
    n_steps : int
        Nominal load steps.
    standard : tuple of Measure
        The measures that an OpenMDAO component has unless others are asked for.
    inputs : tuple of str
        Scalar parameters that are always inputs.
    imposed_displacements : ImposedDisplacements, optional
    newton : NewtonOptions
    changed : dict of str to float
        Scalar parameters with other values than the definitions have.

    Raises
    ------
    ValueError
        For arrays that do not fit each other, labels that repeat, inputs that no term knows.
    """

    drawn_particles: np.ndarray
    design_velocity: np.ndarray
    body: Body
    definitions: tuple
    n_steps: int
    standard: tuple = ()
    inputs: tuple = ()
    imposed_displacements: object = None
    newton: NewtonOptions = field(default_factory=NewtonOptions)
    changed: dict = field(default_factory=dict)

    def __post_init__(self):
        values.integer("n_steps", self.n_steps, 1)
        for name, kind in (("body", Body), ("newton", NewtonOptions)):
            if not isinstance(getattr(self, name), kind):
                raise ValueError(
                    f"{name} must be of class {kind.__name__}, got {type(getattr(self, name)).__name__}"
                )
        for name in ("drawn_particles", "design_velocity"):
            if not np.isfinite(values.numbers(name, getattr(self, name))).all():
                raise ValueError(f"{name} must be finite numbers")
        shape = (self.body.n_particles, 2)
        if np.shape(self.drawn_particles) != shape:
            raise ValueError(
                f"drawn_particles must have shape {shape}, got {np.shape(self.drawn_particles)}"
            )
        if np.ndim(self.design_velocity) != 3 or np.shape(self.design_velocity)[1:] != shape:
            raise ValueError(
                f"design_velocity must have shape (P, {shape[0]}, 2), got "
                f"{np.shape(self.design_velocity)}"
            )
        self._complete()
        labels = [definition.label for definition in self.definitions]
        if len(set(labels)) < len(labels):
            raise ValueError(f"labels of terms repeat: {labels}")
        unknown = [name for name in self.inputs if name not in self.scalars]
        if unknown:
            raise ValueError(
                f"no term has the input {unknown[0]!r}; known are {', '.join(self.scalars)}"
            )

    def _complete(self) -> None:
        """Give contacts with open penalties those that follow from the body."""
        elastic, *rest = self.definitions
        rest = (completed(own, elastic, self.body, self.drawn_particles) for own in rest)
        object.__setattr__(self, "definitions", (elastic, *rest))

    @cached_property
    def scalars(self) -> dict:
        found = {}
        for definition in (*self.definitions, self.imposed_displacements):
            found |= {} if definition is None else definition.scalars
        return {
            name: scalar._replace(value=self.changed.get(name, scalar.value))
            for name, scalar in found.items()
        }

    def _applied(self, definition):
        """A definition with what was changed of it."""
        own = {name: self.changed[name] for name in definition.scalars if name in self.changed}
        return definition.with_parameters(own) if own else definition

    @cached_property
    def _terms(self) -> tuple:
        return tuple(self._applied(definition) for definition in self.definitions)

    def terms(self) -> tuple:
        return self._terms

    def imposed(self):
        imposed = self.imposed_displacements
        return None if imposed is None else self._applied(imposed)

    def with_parameters(self, values: dict) -> "AssembledSeal":
        self.check_parameters(values)
        other = replace(self, changed=self.changed | dict(values))
        other.__dict__["_origin"] = self._origin
        other.__dict__["description"] = self.description
        other.terms()  # values that are not admissible are refused here
        return other

    def with_ends(self, ends) -> "AssembledSeal":
        imposed = self.imposed_displacements
        return replace(
            self, n_steps=len(ends),
            definitions=tuple(definition.with_ends(ends) for definition in self.definitions),
            imposed_displacements=None if imposed is None else imposed.with_ends(ends),
        )  # fmt: skip

    def with_rooms(self, rooms: dict) -> "AssembledSeal":
        other = replace(self, definitions=tuple(
            replace(own, motion=replace(own.motion, room=rooms[own.label]))
            if own.label in rooms else own
            for own in self.definitions
        ))  # fmt: skip
        rooms = {label: np.asarray(room, float).tolist() for label, room in rooms.items()}
        known = self.description.get("rooms", {})
        return other._made_as(self, rooms=known | rooms)

    def with_placements(self) -> "AssembledSeal":
        definitions = []
        for own in self.definitions:
            if isinstance(own, RigidContact):
                names = (f"{own.label}_{way}" for way in ("x", "y", "angle"))
                own = replace(own, motion=own.motion.with_placement(*names))
            definitions.append(own)
        return replace(self, definitions=tuple(definitions))._made_as(self, placements=True)

    def made_from(self, description: dict) -> "AssembledSeal":
        """Note what this seal can be made from again, as JSON holds it; two seals of one description are
        the same. What is made of this seal by ``dataclasses.replace`` has none."""
        self.__dict__["description"] = description
        if description:
            self.__dict__["_origin"] = json.dumps(description)
        return self

    def _made_as(self, seal: "AssembledSeal", **more) -> "AssembledSeal":
        """Note that this seal can be made as another one, and what is changed of that."""
        return self.made_from(seal.description and seal.description | more)

    def settings(self) -> str:
        if not self.description:
            return ""
        changed = {"parameters": {name: float(value) for name, value in self.changed.items()}}
        return json.dumps(self.description | (changed if self.changed else {}))

    @cached_property
    def description(self) -> dict:
        """What was given to ``made_from``; empty for a seal that nothing is known of."""
        return {}

    def area(self, offsets):
        value, by_particles = cells_area(self.body.cells, self.moved(offsets))
        return value, np.tensordot(self.design_velocity, by_particles, 2)

    @cached_property
    def _origin(self):
        return object()

    @property
    def key(self):
        return self._origin, tuple(scalar.value for scalar in self.scalars.values())
