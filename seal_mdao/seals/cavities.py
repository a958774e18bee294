"""Pressure of the air in the cavities of an analysed seal, load step by load step."""

import numpy as np

from seal_mdao.loads.trapped_air import TrappedAir


def cavity_pressures(result) -> dict[str, np.ndarray]:
    """Return the excess pressure in every sealed or vented cavity after every nominal step, shape
    (n_steps,), kPa, by the label of its air; up to where the path ended."""
    cavities = [own.label for own in result.seal.terms() if isinstance(own, TrappedAir)]
    # outputs of the air: excess pressure, area
    return {
        label: np.array([own.outputs[0, 0] for own in result.path.at_nominal(label)])
        for label in cavities
    }
