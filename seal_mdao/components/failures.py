"""Translate failures of designs to OpenMDAO's ``AnalysisError``, which drivers can handle, and faults of
completed analyses to warnings."""

from collections.abc import Iterable
from contextlib import contextmanager

import openmdao.api as om

from seal_mdao.errors import GeometryError, LoadPathError
from seal_mdao.values import without_numbers


class UntrustworthyResultWarning(om.OpenMDAOWarning):
    """A completed analysis whose result is not trustworthy, such as the stress of inverted material."""

    name = "warn_untrustworthy_result"
    filter = "always"


def warn_of_faults(where: str, faults: Iterable[str], reported: set[str]) -> None:
    """Issue an ``UntrustworthyResultWarning`` for every fault that was not reported before.

    Texts that differ in numbers only are the same fault, which an optimisation would repeat in every
    design.

    Parameters
    ----------
    where : str
        Component or driver, the beginning of the message.
    faults : iterable of str
        As of ``SealResult.faults``.
    reported : set of str
        Faults reported before, without their numbers; new ones are added.
    """
    for text in faults:
        kind = without_numbers(text)
        if kind not in reported:
            message = f"the result is not trustworthy: {text}"
            om.issue_warning(message, prefix=where, category=UntrustworthyResultWarning)
            # a warning that a filter raises as an error is raised by the next run, too
            reported.add(kind)


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
        raise om.AnalysisError(f"the analysis rejects this design: {error}") from error
