"""Axial stretch, temperature and swelling at a point of the load path, as stated with results."""

from collections.abc import Mapping

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.cost import duration
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.structure.environment import (
    AXIAL_STRETCH,
    DURATION,
    SWELLING,
    TEMPERATURE,
    TIME,
    Environment,
    Growth,
)

HOTTEST = 1000.0
"""Largest temperature, degrees Celsius."""
DEGREES = f"{TEMPERATURE}_degC"
SECONDS = f"{TIME}_s"


def conditions_of(
    environment: Environment | None, growths: Mapping[str, Growth], step: int | None = None
) -> dict:
    """Evaluate axial stretch, temperature and swelling of a body after a load step.

    Parameters
    ----------
    growths : mapping of str to Growth
        By the prefixes of the names of the materials' parameters.
    step : int, optional
        Number of the nominal load step, 0 at the start; the last one unless given.

    Returns
    -------
    dict of str to float
        Those that are given of ``axial_stretch``, ``temperature_degC``, ``time_s`` and, for every
        material, ``swelling`` with its prefix.
    """
    if environment is None:
        return {}
    ramps = {AXIAL_STRETCH: environment.axial_stretch, DEGREES: environment.temperature}
    ramps |= {prefix + SWELLING: growth.swelling for prefix, growth in growths.items()}
    found = {
        name: _after(ramp, len(ramp.shape) - 1 if step is None else step)
        for name, ramp in ramps.items()
        if ramp is not None
    }
    times = environment.time
    if times is not None:
        found[SECONDS] = _after(times, len(times.stages) - 1 if step is None else step)
    return found


def _after(ramp, step: int) -> float:
    return float(ramp.at([step])[0])


def check_conditions(environment: Environment | None, growths: Mapping[str, Growth]) -> None:
    """Check these values along the load path, and that tables of moduli contain its temperatures.

    Raises
    ------
    ValueError
    """
    if environment is None:
        return
    if environment.time is not None:
        values.real(TIME, environment.time.value, above=0.0)
        for number, given in enumerate(environment.time.given, 1):
            values.real(DURATION.format(number), float(given), above=0.0)
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
        # least and largest temperature of the path within the table
        (low, high), at = environment.temperature.extremes, growth.factors[:, 0]
        if low < at[0] or high > at[-1]:
            raise ValueError(
                f"{prefix}modulus_over_temperature goes from {at[0]:g} to {at[-1]:g} degrees "
                f"Celsius, but the temperature varies from {low:g} to {high:g}; add points to this "
                "table, or vary the temperature less"
            )


def table_points(
    environment: Environment | None, growths: Mapping[str, Growth], fractions
) -> list[str]:
    """Describe the temperatures at path parameters (K,) that are points of a table of moduli, where the
    derivatives with respect to the temperature are one-sided; those that do not change are left out."""
    if environment is None or environment.temperature is None:
        return []
    fractions = np.asarray(fractions, float)
    changing = fractions[environment.temperature.rates(fractions) != 0.0]
    at = environment.temperature.at(changing)
    return [
        f"{temperature:g} degrees Celsius of {prefix}modulus_over_temperature"
        for prefix, growth in growths.items()
        for temperature in np.unique(growth.corners(at))
    ]


def conditions_text(conditions: Mapping[str, float]) -> str:
    """Describe the ``conditions_of`` a body, such as ``axial stretch 1.05, 60 °C``; may be empty."""
    return ", ".join(_described(*own) for own in conditions.items())


def _described(name: str, value: float) -> str:
    if name == DEGREES:
        return f"{value:.6g} °C"
    if name == SECONDS:
        return f"after {duration(value)}"
    return f"{name.replace('_', ' ')} {value:.6g}"
