"""Translate failures of designs to OpenMDAO's ``AnalysisError``, which drivers can handle."""

from contextlib import contextmanager

import openmdao.api as om

from seal_mdao.errors import GeometryError, LoadPathError


@contextmanager
def analysis_errors():
    """Raise AnalysisError for a design that cannot be analysed or measured."""
    try:
        yield
    # only failures of the design; anything else is a fault and stops the run
    except (GeometryError, LoadPathError) as error:
        raise om.AnalysisError(str(error)) from error


@contextmanager
def admissible_design():
    """Raise AnalysisError for inadmissible values, which raise ValueError elsewhere.

    While a model runs they come from a driver or from a component upstream, so the driver has to reduce
    its step; use it around checks of values only, for any other ValueError is a fault.
    """
    try:
        yield
    # outside a running model the same ValueError reaches the user unchanged
    except ValueError as error:
        raise om.AnalysisError(f"the design is not admissible: {error}") from error
