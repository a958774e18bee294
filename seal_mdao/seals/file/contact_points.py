"""Where profiles touch the section of a seal file: at its particles, or in the middle between them."""

from dataclasses import replace

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.edges import check_edges, contour_of
from seal_mdao.seals.file.profiles import ProfileTable
from seal_mdao.seals.file.section_table import SectionTable
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.wall_grid import SCHEMES


def with_contact_points(profiles, section: SectionTable, fixed, fluids) -> tuple:
    """The profiles with contact points, where the file leaves them open.

    On rays those of their scheme, unless something needs a particle where a profile touches: a fluid, a
    body that only profiles hold, the work of a profile that turns. Else the particles, which are at the
    corners of the section.
    """
    chosen = "particles"
    if isinstance(section.spacing, Rays) and fixed is not None and not fluids:
        chosen = SCHEMES[section.spacing.accuracy].contact_points
    return tuple(
        replace(profile, contact_points="particles" if _turns(profile) else chosen)
        if profile.contact_points is None
        else profile
        for profile in profiles
    )


def check_contact(where: str, profile: ProfileTable, file) -> None:
    """Refuse edges that there are not, that are held, or that are not one stretch of the boundary.

    Parameters
    ----------
    where : str
        The profile's place in the file.

    Raises
    ------
    SealFileError
    """
    check_edges(where, "contact", profile.contact, file.section.outline)
    for name in profile.contact:
        if name in file.held:
            raise SealFileError(f"{where}: contact = {name!r}, but [fixed] holds this edge")
    contour = contour_of(profile.contact, file.section.outline)
    if contour is None:
        raise SealFileError(
            f"{where}: contact = {', '.join(profile.contact)} is not one stretch of the boundary; give "
            "the others a profile of their own with the same motion"
        )


def check_contact_points(where: str, profile: ProfileTable, file) -> None:
    """Refuse contact between the particles where something needs one at the contact.

    Parameters
    ----------
    where : str
        The profile's place in the file.

    Raises
    ------
    SealFileError
    """
    if profile.contact_points == "particles":
        return
    if file.fluids:
        raise SealFileError(
            f'{where}: contact_points = "edges", but a [[fluid]] needs contact at the particles; leave '
            "contact_points out"
        )
    for number, measure in enumerate(file.measures, 1):
        of = getattr(measure, "profile", None)
        if measure.type == "profile_work" and of == profile.name and _turns(profile):
            raise SealFileError(
                f'{where}: contact_points = "edges", but the profile_work ([[measure]] {number}) of a '
                "profile that turns needs contact at the particles; leave contact_points or the measure "
                "out"
            )


def _turns(profile: ProfileTable) -> bool:
    return any(stage.rotate for stage in profile.stages)
