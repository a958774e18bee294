"""Sizes of sections: a spacing to start with, and sizes that indicate a wrong unit of length."""

USUAL = (0.5, 300.0)
"""Least and largest extent of the section of a seal, mm."""


ACROSS = 12
"""Particles across the smaller extent of a section, of which a choice of the spacing starts."""


def start_spacing(extent) -> float:
    """Choose a spacing of particles to start with, mm, by the width and height of the section, mm."""
    # h = min(w, h) / 12
    return min(extent) / ACROSS


def unusual_size(extent) -> str:
    """Describe a section whose larger extent is outside of ``USUAL``, with a remedy; else return an
    empty text.

    ``extent`` are its width and height, mm.
    """
    width, height = extent
    if USUAL[0] <= max(extent) <= USUAL[1]:
        return ""
    compared = "larger" if max(extent) > USUAL[1] else "smaller"
    return (
        f"the section is {width:.4g} mm wide and {height:.4g} mm high, {compared} than usual "
        "seals; lengths in a seal file are in mm, and a drawing in other units needs units in "
        "[section]"
    )
