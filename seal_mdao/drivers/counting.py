"""Honest numbers of evaluations."""

from __future__ import annotations

import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from openmdao.core.driver import DriverResult


@contextmanager
def counting_failures(result: DriverResult, kind: str) -> Iterator[None]:
    """Count and time an evaluation that raises; OpenMDAO counts only those that return.

    Parameters
    ----------
    result : DriverResult
        Where to count.
    kind : str
        "model" or "deriv".
    """
    begun = time.perf_counter()
    try:
        yield
    except BaseException:
        evaluations, seconds = f"{kind}_evals", f"{kind}_time"
        setattr(result, evaluations, getattr(result, evaluations) + 1)
        setattr(result, seconds, getattr(result, seconds) + time.perf_counter() - begun)
        raise
