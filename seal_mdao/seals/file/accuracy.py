"""Key ``accuracy`` of ``[section]``: particles, load steps and penalties for an admissible error.

The particles are chosen by ``accuracy.chosen_spacing``. Open load steps and penalties are chosen with
tolerances of a fraction of the admissible error, so that nearly all of it is left to the particles.
"""

from dataclasses import replace

from seal_mdao import values
from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.described import keep_contents
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.schema import known

STEPS, PENALTIES = 0.25, 0.05
"""Tolerances of load steps and penalties over the admissible error of the measures."""


def admissible_errors(file: SealFile) -> dict[str, float]:
    """Return the largest relative errors of ``accuracy`` by the names of the measures."""
    accuracy = file.section.accuracy
    if isinstance(accuracy, dict):
        return accuracy
    return dict.fromkeys((measure.name for measure in file.measures), accuracy)


def with_tolerances(file: SealFile) -> SealFile:
    """Return a file with tolerances of load steps and penalties that fit its ``accuracy``.

    Raises
    ------
    SealFileError
        For unknown measures, and a file without any.
    """
    if file.section.accuracy is None:
        return file
    names = [measure.name for measure in file.measures]
    if not names:
        raise SealFileError(
            "[section]: accuracy limits the numerical error of measures, but the file has no "
            '[[measure]]; add one, such as type = "reaction"'
        )
    admissible = admissible_errors(file)
    for name in admissible:
        known("[section]", "accuracy", name, names, "measure")
    least, steps = min(admissible.values()), file.step_tolerance
    return replace(
        file,
        step_tolerance=None if steps is None else min(steps, STEPS * least),
        penalty_tolerance=min(file.penalty_tolerance, PENALTIES * least),
    )


def with_filling(file: SealFile, filling: dict) -> SealFile:
    """Return a file with particles that were chosen for its ``accuracy``.

    Parameters
    ----------
    file : SealFile
    filling : dict
        ``spacing`` and ``edge_spacing`` by the names of edges, mm, and ``layers``.

    Raises
    ------
    SealFileError
        For a file whose particles are given, and a filling with other keys.
    """
    if file.section.accuracy is None:
        raise SealFileError(
            f"{file.path}: the argument filling (chosen particles) cannot be given, because [section] "
            "has no accuracy; leave out filling"
        )
    if not isinstance(filling, dict) or set(filling) != {"spacing", "layers", "edge_spacing"}:
        raise SealFileError(
            f"{file.path}: the argument filling must be a dict with spacing, layers and "
            f"edge_spacing, got {filling!r}"
        )
    section = replace(
        file.section, spacing=values.real("spacing", filling["spacing"], above=0.0),
        layers=filling["layers"], edge_spacing=dict(filling["edge_spacing"]), chosen=True,
    )  # fmt: skip
    return keep_contents(replace(file, section=section), file)
