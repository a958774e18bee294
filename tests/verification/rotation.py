"""Frame indifference: a rigid rotation by a large angle must not stress the body."""

from typing import NamedTuple

import numpy as np

from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body, scattered
from verification.fields import piola_stresses
from verification.solving import solve, tight


class Rotation(NamedTuple):
    """A body turned in steps.

    Attributes
    ----------
    angle : ndarray, shape (n_steps,)
        Radians.
    stress : ndarray, shape (n_steps,)
        Largest component of the first Piola-Kirchhoff stress over the shear modulus.
    misplacement : ndarray, shape (n_steps,)
        Largest distance of a particle from its rotated place, over the side of the body.
    """

    angle: np.ndarray
    stress: np.ndarray
    misplacement: np.ndarray


def rotation_matrix(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def rotate_body(degrees: float = 170.0, n_steps: int = 17, seed: int = 5) -> Rotation:
    """One side of a square block is turned by ``degrees``; the rest is free and must follow.

    Exact: x = Q X, P = 0.
    """
    grid = Grid(6, 6)
    X = scattered(grid, 0.3, seed)
    fixed = fixed_components(len(X), x=grid.left, y=grid.left)
    material = MooneyRivlin()
    angle = np.linspace(0.0, np.radians(degrees), n_steps + 1)
    places = np.array([X @ rotation_matrix(a).T for a in angle])
    body, imposed = grid_body(grid, X, fixed), ImposedDisplacements(places - X)
    path = solve(body, X, (elastic_body(material),), n_steps, imposed, tight(material))
    stress, away = [], []
    for k, step in enumerate(path.nominal_steps):
        stress.append(np.abs(piola_stresses(path, step)).max())
        away.append(np.abs(X + path.displacement(k) - places[k + 1]).max())
    return Rotation(angle[1:], np.array(stress) / material.shear_modulus, np.array(away))
