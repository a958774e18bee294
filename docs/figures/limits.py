"""The tolerances of the tests as the pages write them, beside the figures that were reached."""

from verification.tolerances import TOLERANCES

from figures.tables import power


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
