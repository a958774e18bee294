"""Options and inputs common to several components."""

import numpy as np

from seal_mdao import values
from seal_mdao.dsa.sensitivity import METHODS
from seal_mdao.kept_analyses import MOST_MEMORY, KeptAnalyses
from seal_mdao.measures.measure import Measure
from seal_mdao.seals.result import FACTOR_MEMORY
from seal_mdao.seals.seal import SETTINGS_OPTION, Seal

CONTACT_OPTIONS = (
    "seal", "measures", "parameters", "sensitivity", "factor_memory", "kept", "callback",
)  # fmt: skip
"""Options that a group passes to its contact component."""


def declare_seal_options(options) -> None:
    """Declare the options of an analysis."""
    options.declare("seal", types=Seal, recordable=False, desc="The seal.")
    declare_measures(options)
    declare_parameters(options)
    options.declare(
        "factor_memory",
        default=FACTOR_MEMORY,
        check_valid=_check_memory,
        desc="GiB for factors of converged tangents; those beyond are computed again for the partials.",
    )
    options.declare(
        "kept",
        default=None,
        allow_none=True,
        types=KeptAnalyses,
        recordable=False,
        desc="Cache of analyses; by default the last one only.",
    )
    options.declare(
        "callback",
        default=None,
        allow_none=True,
        recordable=False,
        check_valid=_check_callable,
        desc="Called with every converged load step.",
    )


def declare_measures(options) -> None:
    """Declare the option that selects the outputs."""
    options.declare(
        "measures",
        default=None,
        allow_none=True,
        recordable=False,
        check_valid=_check_measures,
        desc="Outputs: measures, or names of measures of the seal; its standard ones for None.",
    )


def declare_settings(options) -> None:
    """Declare the option with which a group records the settings of its seal."""
    options.declare(
        SETTINGS_OPTION,
        default="",
        types=str,
        desc="The seal's attributes as JSON, filled in by setup for recorder files.",
    )


def declare_parameters(options) -> None:
    """Declare the scalar parameters that are inputs, and the method of the partials."""
    options.declare(
        "parameters",
        default=(),
        check_valid=_check_names,
        desc="Scalar parameters that become inputs beside those that the seal always has.",
    )
    options.declare(
        "sensitivity",
        default="auto",
        values=METHODS,
        desc="Method of the partials: auto selects the one with fewer right-hand sides.",
    )


def add_boundary_offsets(component, seal: Seal) -> None:
    """Add the input ``boundary_offsets``, shape (P,), mm: the design parameters of the shape."""
    component.add_input(
        "boundary_offsets",
        val=np.zeros(seal.n_offsets),
        units="mm",
        desc="Design parameters of the shape. Door seal: spline control values along the rays, outer "
        "boundary first; sections from outlines: along the nominal normals, edge after edge.",
    )


def check_parameters(seal: Seal, names) -> None:
    """Raise ValueError for parameters that the seal does not have."""
    unknown = [name for name in names if name not in seal.scalars]
    if unknown:
        raise ValueError(
            f"option 'parameters': unknown parameter {unknown[0]!r}; known are "
            f"{', '.join(seal.scalars)}"
        )


def check_outputs(seal: Seal, measures, taken=()) -> None:
    """Raise ValueError where no measure has a value, or where the name of one is ``taken`` by another
    variable."""
    # measures may be empty, as gaps of a closed contact; OpenMDAO needs at least one output
    if not any(measure.size(seal) for measure in measures):
        raise ValueError(
            "option 'measures': there is no measure with a value, so no output; name at least one (None "
            "stands for the seal's standard ones, of which a seal file has those of its [[measure]])"
        )
    for measure in measures:
        if measure.name in taken:
            raise ValueError(
                f"option 'measures': {measure.name!r} is the name of another variable; give the measure "
                "a name of its own, dataclasses.replace(measure, name=...) or name in [[measure]]"
            )


def _check_names(name, value):
    # a string is a sequence of one-letter names: refuse it with a clear message
    if isinstance(value, str):
        raise ValueError(f"option {name!r} must be a sequence of names, got the string {value!r}")
    if len(set(value)) < len(value):
        raise ValueError(f"option {name!r} names a parameter twice: {tuple(value)}")


def _check_measures(name, value):
    if value is None:
        return
    if isinstance(value, str | Measure):
        raise ValueError(f"option {name!r} must be a sequence of measures, got {value!r}")
    wrong = [item for item in value if not isinstance(item, str | Measure)]
    if wrong:
        raise ValueError(f"option {name!r} holds {wrong[0]!r}, which is no measure")
    # names of measures become names of outputs, so they must differ
    names = [item if isinstance(item, str) else item.name for item in value]
    twice = {item for item in names if names.count(item) > 1}
    if twice:
        raise ValueError(
            f"option {name!r} has two measures named {sorted(twice)[0]!r}; give one a name of its own"
        )


def _check_memory(name, value):
    values.real(f"option {name!r}", value, 0.0, MOST_MEMORY)


def _check_callable(name, value):
    values.callback(f"option {name!r}", value)
