"""Options and inputs common to several components."""

import numpy as np

from seal_mdao import values
from seal_mdao.analysis_cache import MOST_MEMORY, AnalysisCache
from seal_mdao.components.failures import admissible_design
from seal_mdao.dsa.sensitivity import METHODS
from seal_mdao.measures.measure import Measure
from seal_mdao.openmdao_access import UnchangedByResiduals
from seal_mdao.seals.result import FACTOR_MEMORY
from seal_mdao.seals.seal import Seal

CONTACT_OPTIONS = (
    "seal", "measures", "parameters", "sensitivity", "factor_memory", "cache", "callback",
)  # fmt: skip
"""Options that a group passes to its contact component."""
OPTIONAL = {"default": None, "allow_none": True, "recordable": False}
CHECK_STEP = 1e-2
"""Step of ``check_partials`` in boundary offsets, mm. Particles are linear and the area is quadratic in
them: complex steps of any size are exact, and so are central differences, which OpenMDAO uses without
``setup(force_alloc_complex=True)``."""


def declare_seal(options) -> None:
    """Declare the option with the seal."""
    options.declare("seal", types=Seal, recordable=False, desc="The seal.")


def declare_seal_options(options) -> None:
    """Declare the options of an analysis."""
    declare_seal(options)
    declare_derivative_options(options)
    options.declare(
        "factor_memory",
        default=FACTOR_MEMORY,
        check_valid=_check_memory,
        desc="Memory (GiB) for stored factorisations of the converged tangent stiffness; those "
        "that do not fit are recomputed for the partial derivatives.",
    )
    text = (
        "Cache of results of earlier analyses (an AnalysisCache); by default only the last "
        "analysis is cached."
    )
    options.declare("cache", types=AnalysisCache, desc=text, **OPTIONAL)
    text = "Function that is called after every converged load step."
    options.declare("callback", check_valid=check_callable, desc=text, **OPTIONAL)


def declare_derivative_options(options) -> None:
    """Declare outputs, scalar inputs, and the method of the partials."""
    text = (
        "Outputs: measures, or names of measures of the seal; None: the standard measures of the "
        "seal."
    )
    options.declare("measures", check_valid=_check_measures, desc=text, **OPTIONAL)
    options.declare(
        "parameters",
        default=(),
        check_valid=_check_names,
        desc="Names of scalar parameters (such as material constants) that become inputs of the "
        "component, in addition to the standard inputs.",
    )
    options.declare(
        "sensitivity",
        default="auto",
        values=METHODS,
        desc="Method of the partial derivatives: direct, adjoint, or auto, which selects the "
        "method with fewer right-hand sides.",
    )


def add_boundary_offsets(component, seal: Seal) -> None:
    """Add the input ``boundary_offsets``, shape (P,), mm: the design parameters of the shape.

    A seal without design parameters has no such input: OpenMDAO has no partials of size zero.
    """
    if seal.n_offsets:
        component.add_input(
            "boundary_offsets",
            val=np.zeros(seal.n_offsets),
            units="mm",
            desc="Design parameters of the shape in mm: offsets of the boundary (control values of "
            "splines). Built-in door seal: along radial rows of particles, outer boundary "
            "first; seal files: along the normals of the nominal boundary, edge after edge.",
        )


def boundary_offsets(inputs, seal: Seal) -> np.ndarray:
    """Return the design parameters of the shape, shape (P,), mm; P may be zero."""
    return inputs["boundary_offsets"] if seal.n_offsets else np.zeros(0)


def add_parameters(component, seal: Seal, names) -> None:
    """Add scalar parameters of a seal as inputs."""
    for name in names:
        value, units, text = seal.scalars[name]
        component.add_input(name, val=value, units=units, desc=text)


def check_parameters_by_differences(component, seal: Seal, names, step: float) -> None:
    """Use central differences with a relative step for scalar parameters in ``check_partials``, and
    forward ones where the nominal value is the least admissible one, such as a friction of 0."""
    for name in names:
        # placements (mm, deg) are 0 in the nominal seal; a step relative to 0 is lost in rounding
        least = None if seal.scalars[name].value else step
        form = "central" if _may_decrease(seal, name, step) else "forward"
        component.set_check_partial_options(
            wrt=name,
            method="fd",
            form=form,
            step=step,
            step_calc="rel_avg",
            minimum_step=least,
        )


def _may_decrease(seal: Seal, name: str, step: float) -> bool:
    """Return whether a parameter may be less than its nominal value by a relative step."""
    value = float(seal.scalars[name].value)
    try:
        seal.with_parameters({name: value - step * (abs(value) or 1.0)})
    except ValueError:
        return False
    return True


class OffsetsComp(UnchangedByResiduals):
    """Base class of components whose only input is ``boundary_offsets``; complex step works as well.

    Without design parameters there is no input, and the outputs are constant. Inadmissible offsets
    raise ``AnalysisError``.
    """

    def initialize(self):
        declare_seal(self.options)

    def setup(self):
        add_boundary_offsets(self, self.options["seal"])

    def setup_partials(self):
        self.set_check_partial_options(wrt="*", method="cs", form="central", step=CHECK_STEP)

    def checked_offsets(self, inputs) -> np.ndarray:
        """Return the offsets (P,), mm, after a check."""
        offsets = boundary_offsets(inputs, self.options["seal"])
        with admissible_design():
            # limits apply to the real part; the imaginary part carries the complex step
            self.options["seal"].check_offsets(offsets.real)
        return offsets


def check_parameters(seal: Seal, names) -> None:
    """Raise ValueError for parameters that the seal does not have."""
    # before inputs are added: the message lists the known ones
    unknown = [name for name in names if name not in seal.scalars]
    if unknown:
        raise ValueError(
            f"option 'parameters': unknown parameter {unknown[0]!r}; the parameters of the seal "
            f"are {', '.join(seal.scalars)}"
        )


def check_outputs(seal: Seal, measures, taken=()) -> None:
    """Raise ValueError if no measure has a value, or the name of one is ``taken`` by a variable."""
    # measures may be empty, as gaps of a closed contact; OpenMDAO needs at least one output
    if not any(measure.size(seal) for measure in measures):
        raise ValueError(
            "option 'measures': none of the measures has a value for this seal, so the component "
            "would have no output; name at least one measure in this option, or add a [[measure]] "
            "to the seal file"
        )
    # promoted outputs and inputs of one name would collide
    for measure in measures:
        if measure.name in taken:
            raise ValueError(
                f"option 'measures': the measure {measure.name!r} has the name of another variable "
                "of the component; rename it with dataclasses.replace(measure, name=...) or name "
                "in [[measure]]"
            )


def _check_names(name, value):
    # a string is a sequence of one-letter names: refuse it with a clear message
    if isinstance(value, str):
        raise ValueError(
            f"option {name!r} must be a sequence of names, got the string {value!r}; write "
            f"({value!r},)"
        )
    if len(set(value)) < len(value):
        raise ValueError(
            f"option {name!r} names a parameter twice: {tuple(value)}; remove the second name"
        )


def _check_measures(name, value):
    if value is None:
        return
    if isinstance(value, str | Measure):
        raise ValueError(
            f"option {name!r} must be a sequence of measures, got a single one, {value!r}; write "
            f"[{value!r}]"
        )
    # names and measures may be mixed
    wrong = [item for item in value if not isinstance(item, str | Measure)]
    if wrong:
        raise ValueError(
            f"option {name!r} contains {wrong[0]!r}, which is neither a measure nor the name of one"
        )
    # names of measures become names of outputs, so they must differ
    names = [item if isinstance(item, str) else item.name for item in value]
    twice = {item for item in names if names.count(item) > 1}
    if twice:
        raise ValueError(
            f"option {name!r} has two measures named {sorted(twice)[0]!r}; rename one with "
            "dataclasses.replace(measure, name=...)"
        )


def _check_memory(name, value):
    values.real(f"option {name!r}", value, 0.0, MOST_MEMORY)


def check_callable(name, value):
    """Raise ValueError for an option that cannot be called."""
    values.callback(f"option {name!r}", value)
