"""The sensitivity page: Table 1 for all parameters, step study, cost, agreement of both methods.

Finite differences of Table 1 are stored by ``verification.accuracy_study``; the analytic derivatives
that are compared with them are computed here.
"""

import time
from pathlib import Path

import numpy as np
from verification.accuracy_study import (
    AWAY_PARAMETERS,
    AWAY_SEEDS,
    NOMINAL_PARAMETERS,
    stored,
)
from verification.difference_cases import Case, Estimated, at_step, away, case
from verification.differences import SCHEMES, measure_names, measure_rates, perturbed
from verification.estimates import error_scale
from verification.two_methods import DOORS, FRICTIONS, PATHS, analyze_case, method_difference

import seal_mdao as sm
from figures import straddling
from figures.drawing import DOOR_SEAL
from figures.tables import percent, power, table
from seal_mdao.plotting import save, sensitivity_errors, step_study
from seal_mdao.plotting.captions import captioned
from seal_mdao.seals.result import SealResult

TAU = 1e-6
"""Perturbation of the paper's Table 1, mm."""
STUDIED = (2, 3, 17)
KNOT_PARAMETER, KNOT_STEPS = 17, (1e-3, 1e-4, 1e-5)
STUDY_STEPS = np.array([3e-3, 1e-3, 1e-4, 1e-5, 3e-6, 1e-6])
SCALARS = {
    "friction": 1e-4, "c10": 1e-3, "c01": 1e-3, "bulk_modulus": 20.0, "depth": 1e-4,
    "normal_penalty": 5.0, "tangent_penalty": 1e-2,
}  # fmt: skip
"""Scalar parameters and the steps of their central differences."""


@captioned(DOOR_SEAL)
def make(out: Path, reduced: bool) -> dict:
    """Pictures, tables and numbers of the page."""
    nominal = case()
    parameters = NOMINAL_PARAMETERS
    estimates = {p: _known(p) for p in parameters}
    steps = STUDY_STEPS[2::3] if reduced else STUDY_STEPS
    study = _study(nominal, STUDIED[:1] if reduced else STUDIED, steps)
    save(step_study(steps, study), out / "step_study.png")
    save(error_map(nominal, estimates), out / "sensitivity_errors.png")
    fragments = out / "fragments"
    fragments.mkdir(parents=True, exist_ok=True)
    (fragments / "table_1.md").write_text(table_1(nominal, estimates), encoding="utf-8")
    numbers = (
        _accuracy(nominal, estimates) | _cost(nominal, 1 if reduced else 3) | _agreement(nominal)
    )
    numbers |= _away(reduced) | _two_methods(reduced)
    numbers["knot"] = knot_table(reduced)
    numbers["scalars"] = scalar_table(nominal, ("friction",) if reduced else SCALARS)
    return numbers | straddling.make(out, reduced)


def _known(parameter: int, seed: int | None = None) -> Estimated:
    """The stored finite differences of a parameter."""
    found = stored("difference", parameter=parameter, seed=seed)
    return Estimated(np.array(found["value"]), np.array(found["uncertainty"]), found["scheme"])


# ---- Table 1 ----


def _rows(names) -> list[int]:
    """Measures that Table 1 lists: all but the single gaps."""
    return [i for i, name in enumerate(names) if name == "gap_square_sum" or name[:4] != "gap_"]


def symbol(name: str) -> str:
    """A measure as the paper writes it."""
    if name.startswith("von_mises"):
        return f"$\\sigma_{{{name.split('_')[-1]}}}$"
    return {
        "area": "Area", "gap_square_sum": "$\\sum g_n^2$", "reaction_x": "$F_x$",
        "reaction_y": "$F_y$",
    }[name]  # fmt: skip


def table_1(nominal: Case, estimates: dict) -> str:
    """The paper's Table 1 for every parameter."""
    names, rows = measure_names(nominal.result), []
    for p, found in estimates.items():
        rows.append([f"**$u_{{{p + 1}}}$**", "", "", ""])
        for i in _rows(names):
            exact, value = nominal.analytic[i, p], found.value[i]
            ratio = "–" if exact == 0.0 else f"{100 * value / exact:.2f}"
            rows.append([symbol(names[i]), f"{TAU * value:.6e}", f"{TAU * exact:.6e}", ratio])
    head = ["$\\Psi$", "$\\Delta\\Psi$", "$\\Psi'$", "$(\\Delta\\Psi/\\Psi') \\times 100$"]
    return table(head, rows, "sensitivity")


def _errors(origin: Case, estimates: dict) -> np.ndarray:
    """Relative errors and relative uncertainties of the differences, (2, m, parameters)."""
    columns = list(estimates)
    value, uncertainty = (
        np.array([getattr(found, name) for found in estimates.values()]).T
        for name in ("value", "uncertainty")
    )
    scale = error_scale(origin.analytic)[:, columns]
    return np.array([np.abs(value - origin.analytic[:, columns]), uncertainty]) / scale


def _worst(errors: np.ndarray) -> str:
    """The largest of those that are known."""
    return power(np.max(errors[np.isfinite(errors)], initial=0.0))


def _accuracy(nominal: Case, estimates: dict) -> dict:
    error, uncertainty = _errors(nominal, estimates)
    gap = measure_names(nominal.result).index("gap_square_sum")
    central = np.array([found.scheme == "central" for found in estimates.values()])
    return {
        "worst": _worst(error),
        "uncertain": _worst(uncertainty),
        "worst_central": _worst(error[:, central]),
        "worst_gap": _worst(error[gap, central]),
        "uncertain_gap": _worst(uncertainty[gap, central]),
        "worst_gap_one_sided": _worst(error[gap, ~central]),
        "entries": str(error.size),
        "one_sided": str(np.sum(~central)),
    }


def error_map(nominal: Case, estimates: dict):
    """Relative errors of all derivatives as a picture."""
    one_sided = np.array([found.scheme != "central" for found in estimates.values()])
    names = [f"$u_{{{p + 1}}}$" for p in estimates]
    return sensitivity_errors(
        _errors(nominal, estimates)[0], measure_names(nominal.result), names, np.ones(len(names), bool),
        one_sided,
    )  # fmt: skip


def _away(reduced: bool) -> dict:
    """The largest errors at designs away from the nominal seal."""
    rows = []
    for seed in AWAY_SEEDS[:1] if reduced else AWAY_SEEDS:
        origin = away(seed)
        error, uncertainty = _errors(origin, {p: _known(p, seed) for p in AWAY_PARAMETERS})
        gap = measure_names(origin.result).index("gap_square_sum")
        square = f"{origin.result.gap_square_sum:.4f}"
        found = [_worst(e[row]) for row in (slice(None), gap) for e in (error, uncertainty)]
        rows.append([str(seed), square, str(error.size), *found])
    head = [
        "design", "$\\sum g_n^2$ (mm²)", "derivatives", "all measures", "uncertain to",
        "$\\sum g_n^2$", "uncertain to",
    ]  # fmt: skip
    return {"away_table": table(head, rows)}


def knot_table(reduced: bool) -> str:
    """Errors of one stress derivative with the kernel's knot on the neighbours and beside it."""
    rows = []
    for step in KNOT_STEPS[2:] if reduced else KNOT_STEPS:
        row = [power(step, 0)]
        for support in (2.0, 2.05):
            origin = case(support=support)
            names = measure_names(origin.result)
            i = names.index(KNOT_MEASURE) if KNOT_MEASURE in names else 1
            found = at_step(origin, KNOT_PARAMETER, "central", step)
            exact = origin.analytic[i, KNOT_PARAMETER]
            row.append(power(abs(found.value[i] / exact - 1.0)))
        rows.append(row)
    return table(["step (mm)", "`support=2.0`", "`support=2.05`"], rows)


KNOT_MEASURE = "von_mises_47"


def group_of(name: str) -> str:
    """Which curve of the step study a measure belongs to."""
    if name == KNOT_MEASURE:
        return "stress at 47"
    for start, group in (
        ("von_mises", "other stresses"), ("gap_square_sum", "sum of squared gaps"),
        ("gap", "gaps"), ("reaction", "reactions"),
    ):  # fmt: skip
        if name.startswith(start):
            return group
    return name


def _study(nominal: Case, parameters, steps) -> dict:
    """Relative errors of plain central quotients, (derivatives, steps), by group of measures."""
    scale, groups = error_scale(nominal.analytic), {}
    for p in parameters:
        found = [at_step(nominal, p, "central", step) for step in steps]
        value = np.array([np.where(f.changed, np.nan, f.value) for f in found])
        error = np.abs(value - nominal.analytic[:, p]) / scale[:, p]
        for name, column in zip(measure_names(nominal.result), error.T, strict=True):
            if name != "area":
                groups.setdefault(group_of(name), []).append(column)
    return {name: np.array(rows) for name, rows in groups.items()}


# ---- cost and agreement ----


def _cost(nominal: Case, repeats: int) -> dict:
    """Median times of both methods for 26 parameters over that of the analysis."""
    times = []
    for _ in range(repeats):
        stamps = [time.perf_counter()]
        result = nominal.design.analyze(keep_factors=True)
        stamps.append(time.perf_counter())
        for method in ("direct", "adjoint"):
            sm.differentiate(result, method=method)
            stamps.append(time.perf_counter())
        times.append(np.diff(stamps))
    analysis, direct, adjoint = np.median(times, axis=0)
    return {
        "direct_cost": percent(direct / analysis, 0),
        "each_cost": percent(direct / analysis / 26, 1),
        "adjoint_cost": percent(adjoint / analysis, 0),
    }


def _agreement(nominal: Case) -> dict:
    adjoint = measure_rates(nominal.result, sm.differentiate(nominal.result, method="adjoint"))
    difference = np.abs(adjoint - nominal.analytic) / error_scale(nominal.analytic)
    return {"direct_adjoint": power(difference.max())}


def _two_methods(reduced: bool) -> dict:
    """Largest differences of both methods over all friction and door cases."""
    frictions = ("accumulated",) if reduced else FRICTIONS
    doors = ("flat",) if reduced else DOORS
    rows, worst = [], 0.0
    for friction in frictions:
        for path in PATHS:
            results = [analyze_case(friction, door, path) for door in doors]
            found = [method_difference(result) for result in results]
            cuts = ", ".join(str(result.step_cuts) for result in results)
            rows.append([friction, path, cuts, *(power(value) for value in found)])
            worst = max(worst, *found)
    head = ["friction", "path", "cuts", *doors]
    return {"two_methods_table": table(head, rows), "two_methods": power(worst)}


# ---- parameters beyond shape ----


def scalar_table(nominal: Case, names) -> str:
    """Differences beside analytic derivatives with respect to the scalar parameters."""
    rates = sm.differentiate(nominal.result, tuple(names), method="direct")
    rows = []
    for name in names:
        scheme, value = _scalar_quotient(nominal, name)
        column = rates.parameters.index(name)
        exact = np.array([
            rates.gap_square_sum[column], rates.reaction[1, column], rates.von_mises[0, column],
        ])  # fmt: skip
        for i, measure in enumerate(("$\\sum g_n^2$", "$F_y$", "largest stress")):
            label = f"`{name}`" + (f" ({scheme})" if scheme != "central" else "")
            ratio = f"{100 * value[i] / exact[i]:.4f}"
            rows.append([
                "" if i else label, measure, f"{value[i]:.6e}", f"{exact[i]:.6e}", ratio,
            ])  # fmt: skip
    head = ["parameter", "measure", "difference", "analytic", "ratio, %"]
    return table(head, rows, "sensitivity")


def _scalar_quotient(nominal: Case, name: str):
    """The first scheme that keeps the contact sequence, and its quotients of three measures.

    Without a number where none does.
    """
    for scheme, places in SCHEMES.items():
        results = [perturbed(nominal.result, name, place * SCALARS[name]) for place, _ in places]
        if all(nominal.differences_in_state(result) == 0 for result in results):
            weights = [weight / SCALARS[name] for _, weight in places]
            return scheme, np.array(weights) @ [_three_measures(result) for result in results]
    return "contact sequence changes", np.full(3, np.nan)


def _three_measures(result: SealResult) -> list:
    return [result.gap_square_sum, result.reaction[-1, 1], result.von_mises[0]]
