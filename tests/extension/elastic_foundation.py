"""A term: springs along a boundary, each pulling back to where it was fastened."""

from dataclasses import dataclass, replace

import numpy as np

import seal_mdao as sm
from seal_mdao.terms.point_term import PointResponse, PointTerm
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.term import Scalar, TermDefinition


@sm.register("terms", "elastic_foundation")
@dataclass(frozen=True, eq=False)
class ElasticFoundation(TermDefinition):
    label: str
    where: MaterialPoints
    stiffness: float  # kPa/mm: force per length of boundary and displacement

    @property
    def scalars(self):
        return {f"{self.label}_stiffness": Scalar(self.stiffness, "kPa/mm", "Foundation.")}

    def with_parameters(self, values):
        return replace(self, stiffness=values[f"{self.label}_stiffness"])

    def point_set(self):
        return self.where.points

    def on(self, discretization, place):
        return ElasticFoundationTerm(self, discretization, place)


class ElasticFoundationTerm(PointTerm):
    """Force k l (x - X) at every point, l the length it stands for."""

    uses_reference = True  # the force depends on X, so ``linearize`` has columns for it

    def __init__(self, definition, discretization, place):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, place
        )
        self.stiffness = definition.stiffness
        self.tangent = self.stiffness * self.length[:, None, None] * np.eye(2)

    def respond(self, x, fraction, history):
        force = self.stiffness * self.length[:, None] * (x - self.reference)
        every, none = np.ones(len(x), int), np.empty((len(x), 0))
        return PointResponse(x, force, self.tangent, every, None, none)

    def linearize(self, response, fraction, history, points):
        out = np.zeros((points.size, *self.local_shape))
        pulled = response.x[points] - self.reference[points]
        out[:, :, :2] = self.tangent[points]  # by x
        out[:, :, 2] = self.stiffness * pulled  # by the length
        out[:, :, 3] = self.length[points, None] * pulled  # by the stiffness
        out[:, :, 4:] = -self.tangent[points]  # by X
        return out
