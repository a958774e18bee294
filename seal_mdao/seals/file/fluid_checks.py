"""Whether the fluids of a seal file fit its section and its profiles."""

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.checks import known
from seal_mdao.seals.file.edges import check_edges, contour_of, stretch_order
from seal_mdao.seals.file.tables import SealFile


def check_fluids(file: SealFile) -> None:
    """Refuse fluids that have no edge to go along, nothing to hold them back, or no time to grow.

    Raises
    ------
    SealFileError
        With the first contradiction.
    """
    for number, fluid in enumerate(file.fluids, 1):
        where = f"[[fluid]] {number}"
        _check_edges(where, fluid.edges, file)
        if fluid.steps is None:
            continue
        if file.step_tolerance is not None:
            raise SealFileError(
                f"{where}: steps = {fluid.steps}, but load steps are chosen where stages have none; "
                "leave it out, and the pressure grows in the last stage"
            )
        if fluid.steps > file.n_steps:
            raise SealFileError(
                f"{where}: steps = {fluid.steps}, but the stages of the profiles have {file.n_steps} "
                "steps in all; give them a last stage that only has steps, in which the pressure grows"
            )
    _check_measures(file)


def _check_edges(where, edges, file) -> None:
    outline, shown = file.section.outline, ", ".join(edges)
    check_edges(where, "edge", edges, outline)
    if contour_of(edges, outline) is None:
        raise SealFileError(f"{where}: edge = {shown} is not one stretch of the boundary")
    if stretch_order(edges, outline)[1]:
        raise SealFileError(
            f"{where}: edge = {shown} goes all round and has no ends; divide it where the fluid comes "
            "in and where it must not come out"
        )
    touching = dict.fromkeys(name for profile in file.profiles for name in profile.contact)
    if not any(name in touching for name in edges):
        raise SealFileError(
            f"{where}: edge = {shown}, which no profile may touch, so nothing would hold the fluid "
            f"back; edges that profiles may touch: {', '.join(touching)}"
        )


def _check_measures(file) -> None:
    fluids = [fluid.name for fluid in file.fluids]
    for number, measure in enumerate(file.measures, 1):
        if measure.type == "blow_off_pressure":
            name = measure.arguments["fluid"]
            known(f"[[measure]] {number}", "fluid", name, fluids, "[[fluid]]")
