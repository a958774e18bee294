"""Analyse the seal of a seal file: figures, CSV of every curve, VTU series, summary.json."""

import argparse
import time
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.accuracy.error_estimate import estimate_errors
from seal_mdao.accuracy.force_error import force_error
from seal_mdao.analysis.cost import duration
from seal_mdao.cli.arguments import (
    NAME_OF_FILE,
    announce,
    critical_table,
    parser,
    penalty_table,
    print_critical_points,
    print_penalty_errors,
    print_warnings,
    write_summary,
)
from seal_mdao.cli.error_table import error_summary, print_errors
from seal_mdao.cli.force_table import print_forces
from seal_mdao.cli.seal_files import file_errors, file_of, seal_of
from seal_mdao.export import vtu
from seal_mdao.export.abaqus import require_exportable, write_abaqus
from seal_mdao.export.csv_tables import reaction_tables, write_contact, write_curves
from seal_mdao.measures.contact_pressure import ENOUGH, peak_points
from seal_mdao.mesh_files import library
from seal_mdao.progress import LoadStepProgress
from seal_mdao.seals.conditions import conditions_text
from seal_mdao.seals.gaps import largest_gap, largest_gaps
from seal_mdao.seals.local_states import stress_peak
from seal_mdao.seals.profiles import (
    ProfileHistory,
    contacts,
    moving_histories,
    path_stages,
)
from seal_mdao.seals.result import SealResult, frozen_measures, is_empty
from seal_mdao.structure.deformation import lowest_jacobian
from seal_mdao.values import place

END_KEYS = (
    "true_peak_pressure_kPa", "deformed_contact_width_mm", "nominal_peak_pressure_kPa",
    "nominal_contact_width_mm", "largest_gap_mm", "largest_von_mises_kPa", "largest_von_mises_at_mm",
    "largest_von_mises_singular_at", "largest_von_mises_elsewhere_kPa",
    "largest_von_mises_elsewhere_at_mm",
)  # fmt: skip
"""Keys of summary.json for all profiles together and for the section at the end of the path."""


def main(arguments) -> int:
    # an explicit --vtu without meshio fails before the analysis
    with file_errors(arguments.file):
        if arguments.vtu:
            library()
    file = file_of(arguments.file)
    # so does a material that Abaqus does not have
    if arguments.abaqus:
        require_exportable(file)
    clouds = []
    file, result, wall = analyzed(file, clouds.append)
    # forces are on the screen before derivatives are computed, which compiles for the first seal, and
    # warnings, which need derivatives, before figures are
    print_forces(result)
    result = differentiated(result)
    report_faults(result)
    # the summary is written first: drawing may still fail
    summary = summarize(result) | {"part": file.part or None, "wall_s": wall}
    if file.section.chosen:
        summary["filling"] = file.section.filling
    write_summary(arguments.out, summary)
    report(result, summary)
    estimates = None
    if (arguments.errors or file.section.chosen) and result.converged:
        # other analyses follow, unless the particles were chosen by them, and the summary again
        estimates = clouds[-1].estimates if clouds else errors_of(file, result)
        summary["errors"] = error_summary(estimates)
        # beside the value of every measure, too
        for name, found in summary["measures"].items():
            if found and name in estimates:
                found["error_bar"] = summary["errors"][name]["bar"]
        write_summary(arguments.out, summary)
        print_errors(estimates, result)
        plotting.save(plotting.error_parts(estimates), arguments.out / "errors.png")
    elif file.section.default_spacing and result.converged:
        # nobody has chosen these particles: print the size of the error
        report_force_error(file, result, summary)
        write_summary(arguments.out, summary)
    # figures need at least one converged load step
    if len(result.path.nominal_steps):
        write_curves(result, arguments.out)
        write_contact(result, arguments.out)
        draw(result, arguments.out, estimates)
    series = write_series(result, arguments)
    print(f"figures, CSV and summary.json in {arguments.out}{series}")
    if arguments.abaqus:
        export_to_abaqus(file, result.seal, arguments.out / "seal.inp")
    return 0 if result.trustworthy else 1


def analyzed(file, report: Callable | None = None) -> tuple[sm.SealFile, SealResult, float]:
    """Analyse the nominal seal of a file.

    Parameters
    ----------
    file : SealFile
    report : callable, optional
        As of ``seal_of``.

    Returns
    -------
    SealFile
        With the particles of the seal.
    SealResult
    float
        Seconds, the choice of particles, load steps and penalties included.
    """
    begun = time.perf_counter()
    try:
        file, seal = seal_of(file, report=report)
    except sm.LoadPathError as error:  # no load steps to be found; what was computed is shown
        return file, error.result, time.perf_counter() - begun
    # report or refuse analyses that take long
    announce(seal)
    with file_errors(file.path), LoadStepProgress(seal) as progress:
        # factors are reused by the adjoint gradients of the measures
        result = sm.analyze(seal, keep_factors=bool(seal.standard), callback=progress)
    return file, result, time.perf_counter() - begun


def differentiated(result: SealResult) -> SealResult:
    """Return a result with the gradients of its measures, where it is completed and has measures."""
    if not result.converged or not result.seal.standard or result.gradients is not None:
        return result
    with warnings.catch_warnings():
        # one-sided derivatives concern those who change the design
        if result.seal.n_offsets == 0:
            warnings.simplefilter("ignore", sm.KinkWarning)
        return result.with_gradients()


def errors_of(file, result: SealResult) -> dict:
    """Estimate the errors of all measures, with progress."""
    with LoadStepProgress(None, "error estimate") as progress:
        return estimate_errors(file, result, progress)


def report_force_error(file, result: SealResult, summary: dict) -> None:
    """Print the estimated error of the forces due to the particle spacing, and add it to the summary; a
    large one is a warning."""
    with LoadStepProgress(None, "error of the forces") as progress:
        found = force_error(file, result, progress)
    summary["force_error_by_spacing"] = found.relative
    if found.warning:
        summary["warnings"] = (*summary["warnings"], found.warning)
        print(f"WARNING: {found.warning}")
    elif found.relative is None:
        print(f"error of the forces due to the particle spacing: not estimated ({found.unknown})")
    else:
        print(
            "estimated error of the forces due to the particle spacing: "
            f"{100.0 * found.relative:.2g} %"
        )


def summarize(result: SealResult) -> dict:
    """Collect summary.json; results at the end of the path are None when it was not completed."""
    result = differentiated(result)
    # state of every profile after every load step
    every, steps, profiles = (
        moving_histories(result), result.path.nominal_steps, len(contacts(result.seal))
    )  # fmt: skip
    histories, edges = every[:profiles], every[profiles:]
    summary = {
        "converged": result.converged,
        "trustworthy": result.trustworthy,
        "failure": result.failure or None,
        "warnings": result.warnings if result.converged else None,
        "n_particles": len(result.particles),
        "n_steps": len(steps),
        "conditions": result.seal.conditions(len(steps)),
        **stage_times(result.seal),
        "area_mm2": result.seal.area(result.boundary_offsets)[0],
        f"reaction_{result.seal.units.force_key}": reaction_tables(result),
        **({"mean_radius_mm": result.seal.units.radius} if result.seal.body.axisymmetric else {}),
        **dict.fromkeys(END_KEYS),
        "max_penetration_mm": None,
        "min_det_F": lowest_jacobian(result.path),
        "newton_iterations": result.newton_iterations,
        "step_cuts": result.step_cuts,
        "critical_points": critical_table(result),
        "penalty_error": penalty_table(result),
        "profiles": {history.label: at_profile(result, history) for history in histories},
        **({"moved_edges": {own.label: force_of(result, own) for own in edges}} if edges else {}),
    }
    # results at the end of the path
    if result.converged:
        # profiles that take part up to the end
        ends = [history for history in histories if len(history.stage)]
        # gaps of all contact points at the end
        gaps = [result.response(history.label).gap.min() for history in ends]
        # von Mises stress over the section at the end, and away from singular points
        peak = stress_peak(result)
        # in the order of END_KEYS: largest over profiles, contact widths summed
        values = (
            max([0.0, *(history.peak[-1] for history in ends)]),
            sum(history.width[-1] for history in ends),
            max([0.0, *(history.nominal_peak[-1] for history in ends)]),
            sum(history.nominal_width[-1] for history in ends),
            max([0.0, *largest_gaps(result).values()]), peak.stress, peak.place,
            peak.singular or None, *(peak.elsewhere or (None, None)),
        )  # fmt: skip
        summary |= dict(zip(END_KEYS, values, strict=True))
        # penetration is -g_n where g_n < 0
        summary["max_penetration_mm"] = max([0.0, *(-gap for gap in gaps)])
    return summary | measured(result)


def stage_times(seal) -> dict:
    """List the stages with their durations, times at their ends, and whether nothing moves, heats or
    presses in them, as ``stage_times``; nothing for stages that take no time."""
    found = path_stages(seal)
    if found is None:
        return {}
    rows = zip(found.durations, found.times[1:], found.dwells, strict=True)
    return {
        "stage_times": [
            {
                "stage": number, "duration_s": taken, "end_s": end, "duration": duration(taken),
                "end": duration(end), "dwell": bool(dwell),
            }
            for number, (taken, end, dwell) in enumerate(rows, 1)
        ]
    }  # fmt: skip


def force_of(result: SealResult, history: ProfileHistory) -> dict:
    """Collect the force on a profile or moved edges at the last converged step; empty without one."""
    if not len(history.stage):
        return {}
    units, force = result.seal.units, history.force[-1]
    return {
        f"force_{units.force_key}": force,
        "force_N_per_100mm": units.per_100_mm * force,
        **({"force_N_per_mm": units.per_mm * force} if units.radius else {}),
    }


def at_profile(result: SealResult, history: ProfileHistory) -> dict:
    """Collect the results of one profile: at its last converged step, and the largest on the path."""
    if not len(history.stage):
        return {}
    return {
        **force_of(result, history),
        "true_peak_pressure_kPa": history.peak[-1],
        "deformed_contact_width_mm": history.width[-1],
        "nominal_peak_pressure_kPa": history.nominal_peak[-1],
        "nominal_contact_width_mm": history.nominal_width[-1],
        "largest_gap_mm": largest_gap(result, history.label).size,
        "highest_true_pressure_kPa": history.peak.max(),
        "largest_deformed_width_mm": history.width.max(),
    }


def measured(result: SealResult) -> dict:
    """Evaluate every measure of the file: value, unit, and gradient of a result that has them.

    The norm is that of the derivatives in the design parameters (per mm); those in material constants,
    friction and penalties are named one by one.
    """
    seal = result.seal
    # without the end of the path there is nothing to evaluate
    if not result.converged or not seal.standard:
        return {"measures": dict.fromkeys(measure.name for measure in seal.standard)}
    # evaluation points of the measures from this result
    chosen = frozen_measures(seal, None, lambda nominal: result)
    chosen = tuple(measure for measure in chosen if not is_empty(measure, seal))
    found = dict.fromkeys(measure.name for measure in seal.standard)
    for measure in chosen:
        value, rows = result.value(measure), np.atleast_2d(result.gradients[measure.name])
        # one norm per row over the boundary offsets
        norms = np.linalg.norm(rows[:, : seal.n_offsets], axis=1)
        one = value.size == 1
        found[measure.name] = {
            "value": value[0] if one else value,
            "unit": seal.units.of(measure.units),
            "gradient_norm": (norms[0] if one else norms) if seal.n_offsets else None,
            # scalar parameters (material constants, friction, penalties) follow the offsets in a row
            "derivatives": {
                name: rows[0, seal.n_offsets + i] if one else rows[:, seal.n_offsets + i]
                for i, name in enumerate(seal.scalars)
            },
        }
        if seal.units.is_ring_force(measure.units):
            found[measure.name]["N_per_mm"] = seal.units.per_mm * (value[0] if one else value)
        point = measure.place(result)
        if point is not None:
            found[measure.name]["at_mm"] = point
    return {"measures": found}


def draw(result: SealResult, out: Path, estimates: dict | None = None) -> None:
    """Draw all figures; that of the particles has the estimated errors, where there are any."""
    figures = {
        "section": partial(plotting.section_cloud, estimates=estimates),
        "deformed_shapes": plotting.deformed_shapes,
        "load_deflection": plotting.load_deflection,
    }
    # materials relax, or stages have durations
    if path_stages(result.seal) is not None:
        figures["force_over_time"] = plotting.force_over_time
    # moved edges are in no contact
    if contacts(result.seal):
        figures["contact_pressure"] = plotting.contact_pressure
        figures["contact_width"] = plotting.contact_width
    # buckling modes where stability was lost
    if result.critical_points:
        figures["critical_modes"] = plotting.critical_modes
    if result.seal.body.axisymmetric:
        figures["ring_view"] = plotting.ring_view
    for name, figure in figures.items():
        plotting.save(figure(result), out / f"{name}.png")


def write_series(result: SealResult, arguments) -> str:
    """Write the VTU series unless it was declined; return a text about it for the last line."""
    # --no-vtu
    if arguments.vtu is False:
        return ""
    try:
        return f", {vtu.write_vtu_series(result, arguments.out / 'vtu').relative_to(arguments.out)}"
    except ImportError:
        # meshio is optional: say how to install it
        return "; no VTU files: pip install seal_mdao[vtk]"


def export_to_abaqus(file, seal, path: Path) -> None:
    """Write the input file of Abaqus, and print what it does not contain."""
    for text in write_abaqus(file, seal, path):
        print(f"WARNING: not exported to {path.name}: {text}")
    force = "mN" if seal.body.axisymmetric else "N/m"
    print(f"{path}: section, contact and motion for Abaqus (mm, kPa; forces in {force})")


def report_faults(result: SealResult) -> None:
    """Print warnings, and faults that make the results unusable."""
    # a boundary that crosses itself explains a loss of stability, so warnings are first
    print_warnings(result)
    print_critical_points(result)
    if not result.converged:
        print(f"NOT CONVERGED: {result.failure}")


def report(result: SealResult, summary: dict) -> None:
    """Print the results of the end of the path."""
    # size of the model and cost of the path
    print(
        f"{summary['n_particles']} particles, {summary['n_steps']} load steps, "
        f"{int(np.sum(summary['newton_iterations']))} Newton iterations, {summary['step_cuts']} cuts, "
        f"{summary['wall_s']:.2f} s"
    )
    if summary["conditions"]:
        print(
            "prescribed conditions at the end of the analysis: "
            f"{conditions_text(summary['conditions'])}"
        )
    units = result.seal.units
    if units.radius:
        print(f"N/mm: N {units.along}")
    # one line for each profile, and for moved edges
    for label, end in (summary["profiles"] | summary.get("moved_edges", {})).items():
        if end:
            across, up = end[f"force_{units.force_key}"]
            force = f"{label}: force {across:.2f}, {up:.2f} {units.force} (x, y)"
            force += ", {:.4g}, {:.4g} N/mm".format(*end["force_N_per_mm"]) if units.radius else ""
            if label not in summary["profiles"]:
                print(force)
                continue
            print(
                f"{force}, {end['deformed_contact_width_mm']:.2f} mm contact width (undeformed "
                f"{end['nominal_contact_width_mm']:.2f}), peak contact pressure "
                f"{end['true_peak_pressure_kPa']:.1f} kPa (nominal "
                f"{end['nominal_peak_pressure_kPa']:.1f}{_few_points(result, label)}), largest gap "
                "between contacts "
                f"{end['largest_gap_mm']:.4f} mm"
            )
    if summary.get("part"):
        print(summary["part"])
    # stress, with its location in the undeformed section
    if summary["largest_von_mises_kPa"] is not None:
        print(stress_line(summary))
    # one line for each measure
    for name, found in summary["measures"].items():
        if found:
            value = ", ".join(f"{v:.6g}" for v in np.atleast_1d(found["value"]))
            around = [f"{v:.6g}" for v in np.atleast_1d(found.get("N_per_mm", []))]
            around = f" ({', '.join(around)} N/mm)" if around else ""
            if found["unit"] == "s" and np.all(np.asarray(found["value"]) >= 120.0):
                around = f" ({', '.join(map(duration, np.atleast_1d(found['value'])))})"
            at = (
                f", at {place(found['at_mm'])} (undeformed coordinates)" if "at_mm" in found else ""
            )
            print(f"{name} = {value} {found['unit'] or ''}".rstrip() + around + at)
    if result.converged:
        print_penalty_errors(result)


def _few_points(result: SealResult, profile: str) -> str:
    """Say how few contact points resolve a peak after the last load step, measured or not; empty for
    ``ENOUGH`` and for none."""
    count = len(peak_points(result, profile, result.path.nominal_steps[-1]))
    if not 0 < count < ENOUGH:
        return ""
    return f", of only {count} adjacent contact point{'s' * (count > 1)}: reduce edge_spacing there"


def stress_line(summary: dict) -> str:
    """Describe the largest stress and its position; if it is singular, also the largest
    elsewhere."""
    largest = summary["largest_von_mises_kPa"]
    # inverted material, det F <= 0, has no stress
    amount = "is not defined" if np.isnan(largest) else f"{largest:.1f} kPa"
    text = (
        f"largest von Mises stress {amount}, at {place(summary['largest_von_mises_at_mm'])} "
        "(undeformed coordinates)"
    )
    where = summary["largest_von_mises_singular_at"]
    if where is None:
        return text
    text += (
        f": {where}, where the exact stress is infinite and the computed stress grows with "
        "refinement (away_from_singular of von_mises excludes this point)"
    )
    if summary["largest_von_mises_elsewhere_kPa"] is not None:
        text += (
            f"; elsewhere {summary['largest_von_mises_elsewhere_kPa']:.1f} kPa, at "
            f"{place(summary['largest_von_mises_elsewhere_at_mm'])}"
        )
    return text


def arguments_parser():
    made = parser(
        __doc__,
        f"out/{NAME_OF_FILE}",
        "FILE",
        "seal-mdao analyze examples/d_bulb.toml --out out/d_bulb",
    )
    made.add_argument("file", type=Path, metavar="FILE", help="seal file (TOML)")
    made.add_argument(
        "--vtu", action=argparse.BooleanOptionalAction, default=None,
        help="write VTU files of all load steps for ParaView; default: written if meshio is "
        "installed",
    )  # fmt: skip
    made.add_argument(
        "--errors", action="store_true",
        help="estimate the errors of all measures caused by particles, load steps and penalties; "
        "this takes one to three times as long as the analysis",
    )  # fmt: skip
    made.add_argument(
        "--abaqus",
        action="store_true",
        help="write seal.inp, an input file for Abaqus/Standard with section, contact and motion",
    )
    return made
