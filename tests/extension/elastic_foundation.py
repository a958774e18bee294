"""A term: springs along a boundary, each pulling back to where it was fastened."""

from dataclasses import dataclass
from typing import ClassVar

import seal_mdao as sm
from seal_mdao.terms.point_law import PointLaw
from seal_mdao.terms.points import MaterialPoints


@sm.register("terms", "elastic_foundation")
@dataclass(frozen=True, eq=False)
class ElasticFoundation(PointLaw):
    label: str
    where: MaterialPoints
    stiffness: float  # force per length of boundary and displacement
    parameters: ClassVar = {"stiffness": "kPa/mm"}

    def evaluate(self, given, fraction):
        """Force k l (x - X) at every point, l the length it stands for."""
        stiffness = given.parameters.stiffness * given.measure
        return stiffness * (given.x - given.reference)
