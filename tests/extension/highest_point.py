"""A measure: height of the highest particle of the deformed section."""

from dataclasses import dataclass

import numpy as np

import seal_mdao as sm
from seal_mdao.measures.measure import Measure


@sm.register("measures", "highest_point")
@dataclass(frozen=True)
class HighestPoint(Measure):
    """Its derivatives are those of the particle that is highest: it has a kink where another one
    takes over."""

    name: str = "highest_point"
    units = "mm"
    text = "Height of the highest particle at the end of the path."

    def evaluate(self, result, partials):
        height = result.deformed()[:, 1]
        highest = int(np.argmax(height))
        partials.displacement()[0, highest, 1] += 1.0
        partials.particles[0, highest, 1] += 1.0
        return height[highest]
