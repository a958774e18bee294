"""Choose the particle spacing of a seal file so that estimated errors are below the allowed error.

Once, for the nominal seal. Errors fall with the square of the spacing h, so the next cloud has

    h_new = 0.9 h sqrt(tolerance / error),

with as many more layers across thin walls and as much smaller spacings along edges. Load steps and
penalties that the file leaves open are chosen with tolerances of a fraction of this one.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seal_mdao import values
from seal_mdao.accuracy.error_estimate import ErrorEstimate, estimate_errors
from seal_mdao.seals.file.build import build_seal
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.result import SealResult, analyze

ROUNDS = 5
"""Largest number of clouds."""
MARGIN = 0.9
"""Factor on the spacing that the order of the error gives."""
SMALLEST = 0.4
"""Smallest factor on the spacing from one cloud to the next."""
STEPS, PENALTIES = 0.25, 0.05
"""Tolerances of load steps and penalties over that of the measures."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """Cloud that was analysed during the choice of the spacing.

    Attributes
    ----------
    file : SealFile
        With its spacing.
    result : SealResult
    estimates : dict of str to ErrorEstimate
    """

    file: SealFile
    result: SealResult
    estimates: dict[str, ErrorEstimate]

    def worst(self, names) -> tuple[str, float]:
        """Find the measure of ``names`` with the largest relative error bar, and this error bar.

        Raises
        ------
        ValueError
            When none of them has an estimate; the message gives the reasons.
        """
        found = {name: self.estimates[name] for name in names}
        known = {
            name: float(own.bar.max() / own.scale)
            for name, own in found.items()
            if own.bar is not None and own.bar.size and own.scale > 0.0
        }
        if not known:
            reasons = "; ".join(dict.fromkeys(own.unknown for own in found.values() if own.unknown))
            raise ValueError(
                "the discretisation error of the results cannot be estimated: "
                f"{reasons or 'all measures are zero'}"
            )
        return max(known.items(), key=lambda item: item[1])


def refine(
    file: SealFile,
    tolerance: float,
    names=None,
    report: Callable[[Cloud], None] | None = None,
    callback: Callable | None = None,
) -> Cloud:
    """Choose the spacing of a file so that the error bars of its measures are below a tolerance.

    Parameters
    ----------
    file : SealFile
        With a ``spacing`` of ``[section]``.
    tolerance : float
        Relative, in (0, 0.5].
    names : sequence of str, optional
        Measures of the file; all of them when left out.
    report : callable, optional
        Called with every cloud that was tried.
    callback : callable, optional
        As of ``estimate_errors``.

    Returns
    -------
    Cloud
        The first one within the tolerance.

    Raises
    ------
    ValueError
        For a section that no spacing fills, a file without measures, an unknown name, a tolerance that
        is not reached with ``ROUNDS`` clouds, or errors that cannot be estimated.
    LoadPathError
        For a path that cannot be completed.
    """
    tolerance = values.real("tolerance", tolerance, above=0.0, high=0.5)
    if not isinstance(file.section.spacing, float):
        raise ValueError(
            "a particle spacing can be chosen only for a section with the key spacing, but "
            "[section] of the seal file has rays or cloud; replace this key by spacing"
        )
    known = [measure.name for measure in file.measures]
    names = known if names is None else list(names)
    unknown = [name for name in names if name not in known]
    if unknown or not names:
        raise ValueError(
            f"unknown measure {unknown[0]!r}; known are {', '.join(known)}" if unknown
            else "the seal file has no measure whose numerical error could be estimated; add a "
            "[[measure]]"
        )  # fmt: skip
    file = _with_tolerances(file, tolerance)
    for _ in range(ROUNDS):
        # factors are used again by the estimate
        result = analyze(build_seal(file), keep_factors=True)
        cloud = Cloud(file, result, estimate_errors(file, result, callback))
        if report is not None:
            report(cloud)
        name, error = cloud.worst(names)
        if error <= tolerance:
            return cloud
        # error = C h^2: h times sqrt(tolerance / error), with a margin
        file = with_factor(file, max(SMALLEST, MARGIN * math.sqrt(tolerance / error)))
    raise ValueError(
        f"the estimated numerical error of {name} is still {100.0 * error:.2g} % with a particle "
        f"spacing of {cloud.file.section.spacing:g} mm and {len(result.particles)} particles; "
        "allow a larger error (--to of the command), or name fewer measures"
    )


def _with_tolerances(file: SealFile, tolerance: float) -> SealFile:
    """Choose load steps and penalties with tolerances that fit to that of the measures."""
    steps = file.step_tolerance
    return replace(
        file,
        step_tolerance=None if steps is None else min(steps, STEPS * tolerance),
        penalty_tolerance=min(file.penalty_tolerance, PENALTIES * tolerance),
    )


def with_factor(file: SealFile, factor: float) -> SealFile:
    """Multiply all distances of the particles of a file by a factor; round to three digits."""
    section = file.section
    # cells across a wall: layers - 1
    layers = 1 + math.ceil((section.layers - 1) / factor - 1e-9)
    return replace(
        file,
        section=replace(
            section, spacing=_rounded(factor * section.spacing), layers=layers,
            edge_spacing={name: _rounded(factor * h) for name, h in section.edge_spacing.items()},
        ),
    )  # fmt: skip


def _rounded(size: float) -> float:
    """Three digits, for whoever reads them."""
    return float(np.format_float_positional(size, precision=3, fractional=False))
