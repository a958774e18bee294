"""``[[moved]]``: edges that follow a given rigid motion, as those bonded to a plate do."""

from typing import Annotated

import numpy as np
from pydantic import WrapValidator, model_validator

from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.loads.moved_edges import MovedEdges
from seal_mdao.seals.file.forms import Name, Names, many, one_of, unfit_edge_name
from seal_mdao.seals.file.profile_table import Place, Staged, StageTable, made_stage
from seal_mdao.seals.file.schema import Table, key, rows, table
from seal_mdao.seals.outline.section_body import SectionBody


@table
class MovedTable(Staged, Table):
    """Edges whose displacements are prescribed along the load path."""

    edges: Names = key("edges that are moved")
    name: Name | None = key(
        "prefix of the names of its parameters, such as top_x; default: the name of its first edge",
        None,
    )
    directions: many(one_of("x", "y"), 'a list of "x", "y" or both') = key(
        "directions in which the edges are moved; in the others they are free", ("x", "y")
    )
    pivot: Place = key("centre of rotation", (0.0, 0.0))
    stages: rows(Annotated[StageTable, WrapValidator(made_stage)]) = key(
        "stages of the motion; without stages the edges have zero displacement", (), alias="stage"
    )

    @model_validator(mode="after")
    def _possible(self):
        # parameters have the name before theirs
        if self.name is None:
            unfit = unfit_edge_name(self.edges[0])
            if unfit:
                raise ValueError(f"edges: {unfit}, or add the key 'name' to this [[moved]]")
            object.__setattr__(self, "name", self.edges[0])
        for number, stage in enumerate(self.stages, 1):
            # a free direction cannot be moved, and a turn moves both
            for axis, travel in zip("xy", stage.translate, strict=True):
                if travel and axis not in self.directions:
                    raise ValueError(
                        f"[[moved.stage]] {number} translates the edges along {axis}, but the list "
                        f"directions contains only {', '.join(self.directions)}; add {axis!r} to "
                        "directions"
                    )
            if stage.rotate and len(self.components) < 2:
                raise ValueError(
                    f"[[moved.stage]] {number} rotates the edges, which needs both directions, but "
                    f"the list directions contains only {self.directions[0]}; use directions = "
                    '["x", "y"]'
                )
        return self

    @property
    def components(self) -> tuple:
        """Prescribed components: 0 for x, 1 for y."""
        return tuple(sorted(set(map("xy".index, self.directions))))

    def on(self, section: SectionBody) -> MovedEdges:
        """Bind the motion to the particles of the edges."""
        # without stages the edges stand still for all steps
        motion = staged_motion(self.stages or (Stage(section.n_steps),), pivot=self.pivot)
        particles = section.particles(self.edges)
        return MovedEdges(self.name, particles, self.components, motion, np.zeros(3))
