"""Designs that cannot be analysed, as OpenMDAO's drivers expect them: as ``AnalysisError``."""

from contextlib import contextmanager

import openmdao.api as om

from seal_mdao.errors import GeometryError, LoadPathError


@contextmanager
def analysis_errors():
    """Raise AnalysisError for a design that cannot be analysed or measured."""
    try:
        yield
    except (GeometryError, LoadPathError) as error:
        raise om.AnalysisError(str(error)) from error


@contextmanager
def admissible_design():
    """Raise AnalysisError for values that the seal does not admit, which are ValueError elsewhere.

    While a model runs they come from a driver or from a component upstream, so the driver has to step
    back; only the checks of values belong inside, for a ValueError of anything else is a fault.
    """
    try:
        yield
    except ValueError as error:
        raise om.AnalysisError(f"the design is not admissible: {error}") from error
