"""Read a seal file, fill its section with particles, draw it, and estimate the time of an analysis.

The command runs no analysis, so particles, load steps and penalties that the file does not give are not
chosen: with accuracy in [section] the particles are those with which their choice starts.
The time of their choice is estimated as that of one analysis with ``COARSE`` load steps, and, if load
steps are chosen, of another one with twice as many. The estimate does not include cut steps, losses of
stability and further analyses. Measured times of choice and last analysis are 0.2 to 3 times the
estimate in half of the examples, and up to 7 times in the others. While load steps and penalties are
chosen, `analyze` shows the remaining time from the second analysis on.
"""

from pathlib import Path

from seal_mdao import plotting
from seal_mdao.analysis.cost import duration
from seal_mdao.cli.arguments import NAME_OF_FILE, checked_arguments, parser, write_summary
from seal_mdao.cli.design_table import design_lines
from seal_mdao.cli.seal_files import file_of, filled, notices
from seal_mdao.file_optimization import design_warnings
from seal_mdao.progress import Waiting
from seal_mdao.seals.outline.design_parameters import design_parameters
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import estimate, unloaded
from seal_mdao.seals.steps_and_penalties import COARSE

USUAL_STEPS = 40
"""Load steps for the estimate where the file leaves them open."""
COARSE_TIME = 3.0
"""Time of a coarse load step over that of a usual one, which needs fewer iterations: 2.3 to 4 in most
examples. The path of twice as many steps takes about as long as the coarse one."""
LONGEST = 10
"""Largest time of an analysis over the estimate: in the examples 7 for the choice of ``folded_lip`` and
``o_ring_in_gland``, 5 for that of ``car_door_seal``."""
OUTPUT_TIME = 4.0
"""Seconds of ``seal-mdao analyze`` for its start, tables and figures: 3.5 to 5 in the examples."""


def main(arguments) -> int:
    file = file_of(arguments.file)
    # section and particles only; no trial analyses
    seal = filled(file)
    # undeformed particles, edges and profiles
    with Waiting("making shape functions"):
        start = unloaded(seal)
    picture = plotting.save(plotting.section_cloud(start), arguments.out / "section.png")
    # settings that an analysis would choose automatically
    open_choices = [
        *(["particles"] if file.leaves_particles_open else []),
        *(["load steps"] if file.step_tolerance is not None else []),
        *file.open_penalties,
    ]
    steps = USUAL_STEPS if file.step_tolerance is not None else seal.n_steps
    with checked_arguments():
        cost, choice = estimate(seal, steps), choice_seconds(file, seal)
    parameters = design_parameters(seal)
    summary = {
        "n_particles": len(seal.nominal_particles),
        "n_cells": len(seal.body.cells),
        "area_mm2": seal.area(seal.check_offsets(None))[0],
        "edges": {name: len(edge.particles) for name, edge in seal.body.edges.items()},
        "materials": [own.name for own in seal.definitions[0].regions if own.name],
        "left_out": file.section.notice,
        "profiles": [contact.label for contact in contacts(seal)],
        "measures": [measure.name for measure in seal.standard],
        "design_parameters": seal.n_offsets,
        "design_parameter_table": [own._asdict() for own in parameters],
        "to_be_chosen": open_choices,
        "estimated_seconds": cost.seconds,
        "estimated_seconds_of_choice": choice,
        "estimated_seconds_of_output": OUTPUT_TIME,
        "estimated_memory_GiB": cost.memory,
        "warnings": [*seal.warnings, *design_warnings(file, seal)],
    }
    # the same content as printed
    write_summary(arguments.out, summary)
    report(summary, notices(file), design_lines(parameters), steps, picture)
    return 0


def choice_seconds(file, seal) -> float:
    """Estimate the time of the choice of load steps and penalties, beyond that of the analysis with
    which it ends."""
    if file.step_tolerance is None and not file.open_penalties:
        return 0.0
    # coarse path: of chosen steps COARSE and 2 COARSE, of given ones at most as many
    paths, steps = (
        (2, COARSE) if file.step_tolerance is not None else (1, min(COARSE, seal.n_steps))
    )
    per_step = estimate(seal, 1).seconds - estimate(seal, 0).seconds
    return COARSE_TIME * paths * steps * per_step


def report(summary: dict, about: list[str], design: list[str], steps: int, picture: Path) -> None:
    """Print what the file describes; ``about`` and ``design`` are lines of the section and its design
    parameters."""
    edges = ", ".join(f"{name} ({count} particles)" for name, count in summary["edges"].items())
    for line in about:
        print(line)
    print(
        f"{summary['n_particles']} particles, {summary['n_cells']} cells, area "
        f"{summary['area_mm2']:.4g} mm²\nedges: {edges}"
    )
    # empty lists are not printed
    for key in ("materials", "profiles", "measures", "to_be_chosen"):
        if summary[key]:
            print(f"{key.replace('_', ' ')}: {', '.join(map(str, summary[key]))}")
    for line in design:
        print(line)
    choice = summary["estimated_seconds_of_choice"]
    output = summary["estimated_seconds_of_output"]
    total = duration(summary["estimated_seconds"] + choice + output)
    # what is chosen: load steps, penalties, or both
    named = ("particles", "load steps")
    chosen = " and ".join(
        ["load steps"] * ("load steps" in summary["to_be_chosen"])
        + ["penalties"] * any(own not in named for own in summary["to_be_chosen"])
    )
    choosing = f"{duration(choice)} for the choice of {chosen} and " if chosen else ""
    print(
        f"seal-mdao analyze with {steps} load steps takes about {total}, of which "
        f"{choosing}{duration(output)} for start-up and figures, and "
        f"{summary['estimated_memory_GiB']:.2g} GiB; if load steps have to be halved or the seal "
        f"buckles, up to {LONGEST} times as long"
    )
    if "particles" in summary["to_be_chosen"]:
        print(
            "the choice of particles for accuracy of [section] starts with this spacing: it repeats the "
            "analysis and the error estimate with smaller spacings until the errors are admissible"
        )
    for text in summary["warnings"]:
        print(f"WARNING: {text}")
    print(picture)


def arguments_parser():
    made = parser(__doc__, f"out/{NAME_OF_FILE}_check", "FILE", "seal-mdao check bulb.toml")
    made.add_argument("file", type=Path, metavar="FILE", help="seal file (TOML)")
    return made
