"""Options and inputs that several components share."""

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
"""What a group hands to its contact component."""


def declare_seal_options(options) -> None:
    """Declare the options of an analysis."""
    options.declare("seal", types=Seal, recordable=False, desc="The seal.")
    declare_measures(options)
    declare_parameters(options)
    options.declare(
        "factor_memory",
        default=FACTOR_MEMORY,
        check_valid=_check_memory,
        desc="GiB for factors of converged tangents; those beyond are made again for the partials.",
    )
    options.declare(
        "kept",
        default=None,
        allow_none=True,
        types=KeptAnalyses,
        recordable=False,
        desc="Where analyses are looked up and kept; only the last one is when left out.",
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
    """Declare which outputs there are."""
    options.declare(
        "measures",
        default=None,
        allow_none=True,
        recordable=False,
        check_valid=_check_measures,
        desc="Outputs: measures, or names of those that the seal knows; its standard ones for None.",
    )


def declare_settings(options) -> None:
    """Declare what a group tells of its seal to recorder files."""
    options.declare(
        SETTINGS_OPTION,
        default="",
        types=str,
        desc="The seal's attributes as JSON, filled in by setup for recorder files.",
    )


def declare_parameters(options) -> None:
    """Declare which scalar parameters are inputs, and how partials are made."""
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
        desc="Method of the partials: auto takes the one with fewer right-hand sides.",
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
    """Raise ValueError where no measure has a value, or one has a name that is ``taken`` by an input or
    another output."""
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
