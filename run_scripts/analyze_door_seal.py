"""Analyse the door seal: deformed shapes, reaction, gap profile, summary.json."""

import sys
import time
from pathlib import Path

import numpy as np

from seal_mdao import plotting
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import (
    add_seal_arguments,
    announce,
    checked_arguments,
    critical_table,
    design_from,
    parser,
    penalty_table,
    print_critical_points,
    print_warnings,
    run,
    seal_from,
    travel,
    write_summary,
)
from seal_mdao.export.csv_tables import travel_table
from seal_mdao.measures.selection import open_points
from seal_mdao.progress import LoadStepProgress
from seal_mdao.seals.door.door_seal import DOOR
from seal_mdao.seals.gaps import gaps_unmeasured_by, largest_gap
from seal_mdao.seals.profiles import contact_counts
from seal_mdao.seals.result import SealResult


def main(arguments) -> int:
    seal = seal_from(arguments)
    if arguments.design is not None:
        offsets, parameters = design_from(arguments.design, seal)
    else:
        offsets, parameters = None, {}
        if arguments.door_radius is not None:
            with checked_arguments():
                parameters["door_radius"] = arguments.door_radius
                seal.with_parameters(parameters)  # refuses a wrong radius
    announce(seal)
    begun = time.perf_counter()
    with LoadStepProgress(seal) as progress:
        result = AnalysisCache().analyze(seal, offsets, parameters, callback=progress)
    wall = time.perf_counter() - begun
    summary = summarize(result, wall)
    write_summary(arguments.out, summary)
    draw(result, arguments)
    report(result, summary, arguments.out)
    return 0 if result.converged else 1


def summarize(result: SealResult, wall: float) -> dict:
    """summary.json; the end measures are None for a path that was not completed."""
    summary = {
        "converged": result.converged,
        "n_particles": len(result.particles),
        "n_steps": len(result.reaction),
        "newton_iterations": result.newton_iterations,
        "step_cuts": result.step_cuts,
        "wall_s": wall,
        "area_mm2": result.area,
        "reaction_N_per_m": travel_table(result),
        "critical_points": critical_table(result),
        "failure": result.path.failure or None,
        "warnings": result.warnings,
        "penalty_error": penalty_table(result),
        "unmeasured_gaps": (),
    }
    end_keys = (
        "gap_square_sum_mm2", "max_gap_mm", "max_penetration_mm", "von_mises_kPa", "n_open_points",
        "n_stick", "n_contact", "n_slip", "stress_particles",
    )  # fmt: skip
    summary |= dict.fromkeys(end_keys)
    if result.converged:
        opened, counts = open_points(result.contact.state), contact_counts(result.contact)
        summary |= {
            "unmeasured_gaps": gaps_unmeasured_by(result, "gap_square_sum"),
            "gap_square_sum_mm2": result.gap_square_sum,
            "max_gap_mm": largest_gap(result, DOOR).size,
            "max_penetration_mm": result.max_penetration,
            "von_mises_kPa": result.von_mises,
            "n_open_points": opened.size,
            "n_stick": counts["stick"],
            "n_contact": counts["contact"],
            "n_slip": counts["slip"],
            "stress_particles": result.measure("von_mises").points,
        }
    return summary


def draw(result: SealResult, arguments) -> None:
    if len(result.reaction) == 0:
        return
    steps = None if arguments.depths is None else result.steps_at(arguments.depths)
    figures = {
        "deformed_shapes": plotting.deformed_shapes(result, steps),
        "reaction": plotting.load_deflection(result),
        "gap_profile": plotting.gap_profile(result, result.travel[-1] * np.array([0.5, 0.75])),
    }
    if result.critical_points:
        figures["critical_modes"] = plotting.critical_modes(result)
    for name, figure in figures.items():
        plotting.save(figure, arguments.out / f"{name}.png")


def report(result: SealResult, summary: dict, out: Path) -> None:
    steps, iterations = summary["n_steps"], int(np.sum(summary["newton_iterations"]))
    print(
        f"{summary['n_particles']} particles, {steps} load steps, {iterations} Newton iterations, "
        f"{summary['step_cuts']} cuts, {summary['wall_s']:.2f} s"
    )
    if steps:
        travel, horizontal, vertical = summary["reaction_N_per_m"][-1]
        print(f"force at {travel:.1f} mm: {vertical:.2f} N/m down, {horizontal:.2f} N/m across")
    print_critical_points(result)
    if result.converged:
        print(
            f"{summary['n_contact']} points in contact ({summary['n_stick']} stick), "
            f"{summary['n_open_points']} open between them, largest gap "
            f"{summary['max_gap_mm']:.4f} mm, sum of squares {summary['gap_square_sum_mm2']:.3g} mm2"
        )
        print(f"highest of the seven stresses {max(summary['von_mises_kPa']):.1f} kPa")
        print_warnings(result, summary["unmeasured_gaps"])
    else:
        print(f"NOT CONVERGED at {summary['failure']}")
    print(f"figures and summary.json in {out}")


def arguments_parser():
    made = parser(__doc__, "out/analysis")
    add_seal_arguments(made)
    made.add_argument("--door-radius", type=float, metavar="MM", help="corner radius of the door")
    made.add_argument(
        "--design", type=Path, metavar="SUMMARY",
        help="analyse the design in the summary.json of optimize_door_seal.py",
    )  # fmt: skip
    made.add_argument(
        "--depths", type=travel, nargs="+", metavar="MM",
        help="door travel at which deformed shapes are drawn; default: four equal parts",
    )  # fmt: skip
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
