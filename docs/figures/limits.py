"""The tolerances of the tests: a page cannot be made when a benchmark misses its own."""

from figures.tables import power
from seal_mdao.verification.tolerances import TOLERANCES


def within(name: str, value: float) -> float:
    """The value, if it is within the tolerance of the benchmark.

    Raises
    ------
    RuntimeError
        When it is not.
    """
    if not value <= TOLERANCES[name]:
        raise RuntimeError(f"{name}: {value:.2e} exceeds the tolerance {TOLERANCES[name]:.0e}")
    return value


def text(name: str) -> str:
    """The tolerance as the pages write it."""
    value = TOLERANCES[name]
    if name == "slope":
        return f"{value:g}"
    if name.endswith("_mm"):
        return f"{power(value, 0) if value < 1e-4 else format(value, 'g')} mm"
    return power(value, 0) if value < 1e-4 else f"{100 * value:g} %"


def texts() -> dict[str, str]:
    """All of them, for ``{{ tolerances.name }}``."""
    return {name: text(name) for name in TOLERANCES}
