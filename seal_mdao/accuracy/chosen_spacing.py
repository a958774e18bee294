"""Choose the particles of a seal file so that estimated errors are below the admissible ones.

Once, for the nominal seal. Errors fall with the square of the spacing h. The particles may cause the
part of the admissible error e that load steps and penalties do not cause. So the next cloud has

    h_new = 0.9 h sqrt((e - e_steps - e_penalties) / e_particles),

with as many more layers across thin walls and as much smaller spacings along edges. Load steps and
penalties that the file leaves open are chosen for every cloud with tolerances of a fraction of e
(``seals.file.accuracy``).

Two clouds may agree by chance where only few contact points are pressed. So peak pressures and contact
widths need at least n_0 points in contact, n_0 = ``contact_pressure.ENOUGH``. With n < n_0 points at the
distance h_c, the next cloud has 0.9 h_c n / n_0 along the edges in contact.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.accuracy.error_estimate import ORDER, ErrorEstimate, estimate_errors
from seal_mdao.measures.contact_pressure import ENOUGH, peak_points
from seal_mdao.measures.measure import Derived
from seal_mdao.seals.chosen_path import store_path
from seal_mdao.seals.creases import creases
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.file.accuracy import admissible_errors, with_filling
from seal_mdao.seals.file.build import built
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.section_table import check_section
from seal_mdao.seals.penalty_error import NORMAL, TANGENT
from seal_mdao.seals.result import SealResult, analyze

ROUNDS = 5
"""Largest number of clouds."""
MARGIN = 0.9
"""Factor on the spacing that the order of the error gives."""
SMALLEST = 0.3
"""Smallest factor on the spacing from one cloud to the next."""
LEAST_ORDER = 0.5
"""Least order of the error in the spacing; with a smaller one twice, no further cloud is tried."""
CLEAR = 0.7
"""Largest factor on the spacing from which this order is computed."""
CAUTIOUS = 0.6
"""Smallest factor on the spacing after a cloud that did not reduce the error."""


class FewPoints(NamedTuple):
    """Contact with too few points for the estimated error of a measure.

    Attributes
    ----------
    measure, profile : str
    count : int
        Points in contact around the largest pressure.
    edges : dict of str to float
        Edges of these points, with distances for the next cloud, mm.
    """

    measure: str
    profile: str
    count: int
    edges: dict[str, float]

    def __str__(self):
        points = "1 point" if self.count == 1 else f"{self.count} points"
        return f"{self.measure} has only {points} in contact with {self.profile}"


class WorstError(NamedTuple):
    """Error bar of a measure that is the largest multiple of its admissible error.

    Attributes
    ----------
    name : str
    error, particles : float
        Error bar and the part of it by the particles, relative.
    admissible : float
    """

    name: str
    error: float
    particles: float
    admissible: float

    @property
    def factor(self) -> float:
        """Factor on the spacing with which the error becomes admissible; 0 where none does."""
        left = self.admissible - (self.error - self.particles)
        # e_particles = C h^2, with a margin
        return MARGIN * math.sqrt(left / self.particles) if left > 0.0 else 0.0


@dataclass(frozen=True, eq=False)
class Cloud:
    """Cloud that was analysed during the choice of the particles.

    Attributes
    ----------
    file : SealFile
        With the spacing of this cloud.
    result : SealResult
    estimates : dict of str to ErrorEstimate
        By the name of the measure; without measures that have no points, such as a gap of a seal that
        has none.
    """

    file: SealFile
    result: SealResult
    estimates: dict[str, ErrorEstimate]

    @property
    def worst(self) -> WorstError:
        """Measure whose error bar is the largest multiple of its admissible error.

        Raises
        ------
        ValueError
            When no measure has an estimate, or one that the file names; the message gives the reasons.
        """
        missing, found = self.not_estimated, []
        for name, most in admissible_errors(self.file).items():
            if name not in missing:
                own, relative = self.estimates[name], self.estimates[name].relative
                at = int(relative.argmax())
                particles = own.particle_bar[at] / own.scale
                found.append(WorstError(name, float(relative[at]), float(particles), most))
        # measures that the file names need an estimate, of all together some may have none
        if not found or (missing and isinstance(self.file.section.accuracy, dict)):
            reasons = "; ".join(dict.fromkeys(missing.values()))
            raise ValueError(
                f"the numerical error of {', '.join(missing)} cannot be estimated: {reasons}; name "
                'other measures in accuracy of [section], such as accuracy = { reaction = "1 %" }, or '
                "give spacing without accuracy"
            )
        return max(found, key=lambda own: own.error / own.admissible)

    @property
    def few_points(self) -> FewPoints | None:
        """First measure of ``accuracy`` whose contact has fewer points than ``ENOUGH``; None where all
        have enough."""
        admissible = admissible_errors(self.file)
        for measure in self.result.measures(tuple(admissible)):
            own = measure.base if isinstance(measure, Derived) else measure
            if own.needs_points:
                points = peak_points(self.result, own.profile)
                if 0 < len(points) < ENOUGH:
                    edges = _finer_edges(self.result, own.profile, points)
                    return FewPoints(measure.name, own.profile, len(points), edges)
        return None

    @property
    def not_estimated(self) -> dict[str, str]:
        """Why measures of ``accuracy`` have no error bar, by their names."""
        found = {}
        for name in admissible_errors(self.file):
            own = self.estimates.get(name)
            if own is None:
                found[name] = f"the nominal seal has no point at which {name} is evaluated"
            elif own.relative is None:
                found[name] = own.unknown or "the value is zero"
        return found


def refine(
    file: SealFile,
    report: Callable[[Cloud], None] | None = None,
    callback: Callable | None = None,
) -> Cloud:
    """Choose the particles of a file for the errors that its ``accuracy`` admits.

    The first analysis of the seal of the returned cloud is not computed again.

    Parameters
    ----------
    file : SealFile
        With ``accuracy`` in ``[section]``.
    report : callable, optional
        Called with every cloud that was tried.
    callback : callable, optional
        As of ``estimate_errors``. Its method ``begin``, where it has one, is called before the analyses
        of every cloud with a text.

    Returns
    -------
    Cloud
        The first one whose errors are admissible, with a file whose particles are chosen.

    Raises
    ------
    ValueError
        When the errors are not reached with ``ROUNDS`` clouds, or cannot be estimated.
    LoadPathError
        For a path that cannot be completed.
    """
    begin = getattr(callback, "begin", lambda text: None)
    filling, before, slow = file.section.filling, None, ""
    for _ in range(ROUNDS):
        file = with_filling(file, filling)
        check_section(file)
        begin(f"spacing {filling['spacing']:g} mm")
        # factors are used again by the estimate
        result = analyze(built(file, callback), keep_factors=True, callback=callback)
        result.require_converged()
        _require_limit(result)
        begin(f"spacing {filling['spacing']:g} mm, error estimate")
        cloud = Cloud(file, result, estimate_errors(file, result, callback))
        if report is not None:
            report(cloud)
        worst, few = cloud.worst, cloud.few_points
        admissible = worst.error <= worst.admissible
        if admissible and few is None:
            # the analysis of the seal, which is not computed again
            store_path(result.seal, result.path)
            return cloud
        if not admissible:
            _require_attainable(worst, file)
            order = _order(cloud, before)
            # errors of coarse clouds may be small by chance, so a single comparison decides nothing
            if order < LEAST_ORDER and slow == worst.name:
                raise _no_decrease(cloud, before)
            slow = worst.name if order < LEAST_ORDER else ""
        before = cloud
        if few is None:
            smallest = CAUTIOUS if slow else SMALLEST
            filling = with_factor(filling, max(smallest, worst.factor))
        else:
            filling = filling | {"edge_spacing": filling["edge_spacing"] | few.edges}
    if few is not None:
        raise ValueError(
            f"the numerical error of {few.measure} cannot be estimated: {few} with a spacing of "
            f"{', '.join(f'{h:g} mm along {edge}' for edge, h in few.edges.items())}, at least "
            f"{ENOUGH} are needed; begin with a smaller edge_spacing in [section], or leave "
            f"{few.measure} out of accuracy"
        )
    raise ValueError(
        f"the estimated numerical error of {worst.name} is still {worst.error:.2%} with a spacing of "
        f"{cloud.file.section.spacing:g} mm and {len(result.particles)} particles; admit a larger "
        "error in accuracy of [section], or name fewer measures there"
    )


def _require_limit(result: SealResult) -> None:
    """Raise ValueError for a free surface with creases, where refinement has no limit."""
    text = creases(EvaluationPoints(result.path))
    if text:
        raise ValueError(
            f"numerical errors cannot be estimated, because {text}, or give spacing without accuracy"
        )


def _require_attainable(worst: WorstError, file: SealFile) -> None:
    """Raise ValueError where load steps and penalties cause more than the admissible error."""
    if worst.factor > 0.0:
        return
    # keys that are in the file; what is chosen automatically cannot be left out
    given = ["steps"] if file.step_tolerance is None else []
    given += [
        key
        for key in (NORMAL, TANGENT)
        if any(getattr(own, key) is not None for own in file.profiles)
    ]
    cure = (
        f"leave {', '.join(given)} out of the file, to have them chosen automatically"
        if given
        else f"admit a larger error of {worst.name} in accuracy of [section], or leave it out there"
    )
    raise ValueError(
        f"the load steps and penalties alone cause a numerical error of {worst.name} of "
        f"{worst.error - worst.particles:.2g} times its value, more than the admissible "
        f"{worst.admissible:.2%}; {cure}"
    )


def _order(cloud: Cloud, before: Cloud | None) -> float:
    """Compute the order of the worst error in the spacing from two clouds; ``ORDER`` where their
    spacings are too close to each other, or where that of the first is not known or zero, as of a
    contact that only the second one has."""
    if before is None:
        return ORDER
    spacings = [own.file.section.spacing for own in (before, cloud)]
    error = _particle_error(before, cloud.worst.name)
    if spacings[1] > CLEAR * spacings[0] or not error:
        return ORDER
    # p = log(e_before / e) / log(h_before / h)
    return math.log(error / cloud.worst.particles) / math.log(spacings[0] / spacings[1])


def _particle_error(cloud: Cloud, name: str) -> float | None:
    """Relative error bar of a measure by the particles; None where it is not known."""
    own = cloud.estimates.get(name)
    if own is None or own.particle_bar is None:
        return None
    return float(own.particle_bar.max() / own.scale)


def _no_decrease(cloud: Cloud, before: Cloud) -> ValueError:
    """Make the error of a measure that does not converge."""
    worst = cloud.worst
    return ValueError(
        f"the estimated numerical error of {worst.name} does not decrease with the spacing: "
        f"{_particle_error(before, worst.name):.2%} with {before.file.section.spacing:g} mm, "
        f"{worst.particles:.2%} with {cloud.file.section.spacing:g} mm; "
        "stresses and pressures at sharp corners and at ends of fixed edges and of interfaces between "
        "materials do not converge; "
        "exclude these points (away_from_singular of [[measure]]), or name other measures in "
        "accuracy of [section]"
    )


def _finer_edges(result: SealResult, profile: str, points: np.ndarray) -> dict[str, float]:
    """Compute the distance with which about ``ENOUGH`` points of a contact are pressed, mm, by the
    edges on which ``points`` (k,) lie."""
    where = result.term(profile).where
    # 0.9 h_c n / n_0
    factor = max(SMALLEST, MARGIN * len(points) / ENOUGH)
    h = _rounded(factor * float(where.lengths(result.particles)[points].max()))
    pressed, edges = where.points.anchors[points], result.path.discretization.body.edges
    return {name: h for name, edge in edges.items() if np.isin(edge.particles, pressed).any()}


def with_factor(filling: dict, factor: float) -> dict:
    """Multiply all distances of particles by a factor, rounded to three digits.

    ``filling`` is as of ``seals.file.accuracy.with_filling``, and so is the result.
    """
    edges = filling["edge_spacing"].items()
    return {
        "spacing": _rounded(factor * filling["spacing"]),
        # cells across a wall: layers - 1
        "layers": 1 + math.ceil((filling["layers"] - 1) / factor - 1e-9),
        "edge_spacing": {name: _rounded(factor * h) for name, h in edges},
    }


def _rounded(size: float) -> float:
    """Three digits, for whoever reads them."""
    return float(np.format_float_positional(size, precision=3, fractional=False))
