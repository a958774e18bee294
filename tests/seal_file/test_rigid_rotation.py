"""Rubber with a history is turned as a whole: displacements and forces turn with it, and no more."""

from dataclasses import replace

import numpy as np
import pytest
from block_files import seal_of

import seal_mdao as sm

HISTORIES = {
    "relaxation": "[material.rubber.viscoelastic]\ng = [0.3, 0.2]\ntau = [0.5, 5.0]\n",
    "softening": "[material.rubber.softening]\nr = 2.0\nm = 0.3\nbeta = 0.1\n",
}
ANGLES = 20.0, 150.0
"""Of two turns; a body at rest would have other times, those of a dwell."""
TIGHT = sm.NewtonOptions(tolerance=1e-13)


def moved(edge, pivot, angle, down, time):
    """A table of an edge that moves down, is turned, and comes half of the way back, turned too."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    # the way back up, in the turned directions
    back = (-0.5 * down * np.array([-s, c])).tolist()
    duration = f", duration = {time}" if time else ""
    stages = (
        f"{{ translate = [0.0, {down}], steps = 3{duration} }}",
        f"{{ rotate = {angle}, steps = 5{duration} }}",
        f"{{ translate = [{back[0]!r}, {back[1]!r}], steps = 3{duration} }}",
    )
    head = f'[[moved]]\nedges = ["{edge}"]\nname = "{edge}"\npivot = {pivot}\n'
    return f"{head}stage = [{', '.join(stages)}]\n"


@pytest.fixture(params=HISTORIES)
def turned(request, tmp_path):
    """Results of both turns."""
    time = 1.0 if request.param == "relaxation" else None
    found = []
    for angle in ANGLES:
        # the pivot of an edge moves with it: both are turned about (0, 0)
        tables = (
            moved("base", [0.0, 0.0], angle, 0.0, time),
            moved("top", [0.0, 0.8], angle, -0.8, None),  # the times are those of the first edge
        )
        folder = tmp_path / str(angle)
        folder.mkdir()
        seal = seal_of(folder, HISTORIES[request.param], *tables)
        found.append(sm.analyze(replace(seal, newton=TIGHT)))
    return found


def test_results_turn_with_the_body(turned):
    little, much = turned
    for result in turned:
        result.require_converged()
    angle = np.radians(np.diff(ANGLES)[0])
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    assert len(little.path.steps) == len(much.path.steps) == 11
    top, turned_top = (result.path.reaction("top") for result in (little, much))
    size = np.abs(top).max()
    # at the end of the turn, and on the way back, with the history of both
    for step in (7, 9, 10):
        apart = np.abs(much.deformed(step) - little.deformed(step) @ Q.T).max()
        assert apart < 1e-12, step
        assert np.abs(turned_top[step] - top[step] @ Q.T).max() < 1e-12 * size, step
    # the history acts: at the same place the force is another one than on the way in
    force = np.hypot(*top.T)
    assert force[9] < 0.95 * force[1]
