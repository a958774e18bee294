"""Axial stretch, temperature and swelling at one point of the path, as results are named by them."""

from collections.abc import Mapping

from seal_mdao import values
from seal_mdao.structure.environment import (
    ABSOLUTE_ZERO,
    AXIAL_STRETCH,
    SWELLING,
    TEMPERATURE,
    Environment,
    Growth,
)

HOTTEST = 1000.0
"""Largest temperature, degrees Celsius."""
DEGREES = f"{TEMPERATURE}_degC"


def conditions_of(
    environment: Environment | None, growths: Mapping[str, Growth], step: int | None = None
) -> dict:
    """Evaluate what the environment of a body is after a load step.

    Parameters
    ----------
    growths : mapping of str to Growth
        By the prefixes of the names of the materials' parameters.
    step : int, optional
        Number of the nominal load step, 0 at the start; the last one unless given.

    Returns
    -------
    dict of str to float
        Those that are given of ``axial_stretch``, ``temperature_degC`` and, for every material,
        ``swelling`` with its prefix.
    """
    if environment is None:
        return {}
    ramps = {AXIAL_STRETCH: environment.axial_stretch, DEGREES: environment.temperature}
    ramps |= {prefix + SWELLING: growth.swelling for prefix, growth in growths.items()}
    return {name: _after(ramp, step) for name, ramp in ramps.items() if ramp is not None}


def _after(ramp, step: int | None) -> float:
    last = len(ramp.shape) - 1
    return float(ramp.at([last if step is None else step])[0])


def check_conditions(environment: Environment | None, growths: Mapping[str, Growth]) -> None:
    """Check the values along the path, and that tables of moduli reach its temperatures.

    Raises
    ------
    ValueError
    """
    if environment is None:
        return
    for ramp, name, bounds in (
        (environment.axial_stretch, AXIAL_STRETCH, {"low": 0.5, "high": 2.0}),
        (environment.temperature, TEMPERATURE, {"above": ABSOLUTE_ZERO, "high": HOTTEST}),
        *(
            (own.swelling, prefix + SWELLING, {"above": 0.0, "high": 10.0})
            for prefix, own in growths.items()
        ),
    ):
        for value in () if ramp is None else ramp.extremes:
            values.real(name, value, **bounds)
    for prefix, growth in growths.items():
        if environment.temperature is None or growth.factors is None:
            continue
        (low, high), at = environment.temperature.extremes, growth.factors[:, 0]
        if low < at[0] or high > at[-1]:
            raise ValueError(
                f"temperature: {prefix}modulus_over_temperature goes from {at[0]:g} to {at[-1]:g}, "
                f"but the temperatures from {low:g} to {high:g} degrees Celsius; add points to the "
                "table, or vary the temperature less"
            )


def conditions_text(conditions: Mapping[str, float]) -> str:
    """Describe the ``conditions_of`` a body, such as ``axial stretch 1.05, 60 degC``; may be empty."""
    return ", ".join(
        f"{value:.6g} degC" if name == DEGREES else f"{name.replace('_', ' ')} {value:.6g}"
        for name, value in conditions.items()
    )
