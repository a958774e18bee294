"""Sizes of sections: particles by default; sizes and travels that indicate a wrong unit of length."""

import numpy as np

USUAL = (0.5, 300.0)
"""Least and largest extent of the section of a seal, mm."""
FAR = 20.0
"""Usual largest displacement of a profile in a stage, over the larger extent of the section."""
ACROSS = 12
"""Particles across the smaller extent of a section, by default and where a choice of them starts."""
DEFAULT_LAYERS = 5
"""Particles across a wall by default."""


def start_spacing(extent) -> float:
    """Choose a spacing by default, or to start with, mm, by the width and height of the section, mm."""
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


def unusual_stages(label: str, motion, extent) -> tuple[str, ...]:
    """Describe the stages of a ``Motion`` in which a profile is displaced farther than ``FAR`` times the
    larger extent of the section, with a remedy; ``extent`` are its width and height, mm."""
    lengths, size = np.hypot(*np.diff(motion.positions, axis=0).T), max(extent)
    return tuple(
        f"the profile {label!r} is displaced by {length:.4g} mm in stage {stage}, {length / size:.0f} "
        f"times the size of the section; translate is in mm"
        for stage, length in enumerate(lengths, 1)
        if length > FAR * size
    )
