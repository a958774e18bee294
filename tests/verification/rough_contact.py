"""Direct simulation of a rough surface pressed on a half space, and of the flow between them.

The reference of the leak rate by Persson's theory: the same elasticity and thin-film flow, but
solved for surfaces themselves, without any theory of roughness. A unit square is periodic, E* = 1:

    g = u(p) - h + c >= 0,  p >= 0,  g p = 0,  u_q = 2 p_q / (E* |q|),
    div (g^3 grad p_f) = 0 between contacts,  p_f = 1 and 0 on two opposite sides.

The contact is solved by conjugate gradients on the points in contact (Polonsky and Keer, Wear 231
(1999) 206), the flow by finite volumes with the harmonic mean of g^3 between two cells.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import spsolve

TOLERANCE = 1e-6
MOST_ITERATIONS = 2000


class Interface(NamedTuple):
    """What a simulation gives.

    Attributes
    ----------
    area : float
        Relative contact area.
    separation : float
        Mean gap.
    slit : float
        Height of the slit with parallel walls that conducts as much; 0 without an open path.
    """

    area: float
    separation: float
    slit: float


def wavenumbers(n: int) -> np.ndarray:
    """Return |q| of the Fourier modes of n x n points on a unit square."""
    along = 2.0 * np.pi * np.fft.fftfreq(n, 1.0 / n)
    return np.hypot(*np.meshgrid(along, along, indexing="ij"))


def surface(rough, n: int, seed: int) -> np.ndarray:
    """Draw a Gaussian surface with the power spectrum of a ``Roughness`` whose wavelengths are those
    of a unit square, shape (n, n)."""
    q = wavenumbers(n)
    first, _, last = rough.wavenumbers
    inside = (q >= first * (1.0 - 1e-9)) & (q <= last)
    # <|a_q|^2> = (2 pi)^2 C(q) for h = sum_q a_q exp(i q x)
    size = 2.0 * np.pi * np.sqrt(np.where(inside, rough.spectrum(q), 0.0))
    white = np.fft.fft2(np.random.default_rng(seed).standard_normal((n, n)))
    return np.fft.ifft2(n * white * size).real


def pressed(heights: np.ndarray, pressure: float) -> tuple[np.ndarray, np.ndarray]:
    """Press an elastic half space on a surface; return local pressures and gaps, shape (n, n)."""
    q = wavenumbers(len(heights))
    compliance = np.where(q > 0.0, 2.0 / np.where(q > 0.0, q, 1.0), 0.0)

    def displaced(p):
        return np.fft.ifft2(np.fft.fft2(p) * compliance).real

    p, direction, before = np.full(heights.shape, pressure), np.zeros(heights.shape), np.inf
    for _ in range(MOST_ITERATIONS):
        touching, gap = p > 0.0, displaced(p) - heights
        gap -= gap[touching].mean()
        # conjugate direction on the points in contact
        square = (gap[touching] ** 2).sum()
        direction = np.where(touching, gap + square / before * direction, 0.0)
        change = displaced(direction)
        change -= change[touching].mean()
        step = (gap * direction)[touching].sum() / (change * direction)[touching].sum()
        last, p = p, np.maximum(p - step * direction, 0.0)
        # points that penetrate come into contact, and the directions start again
        again = (p == 0.0) & (gap < 0.0)
        p, before = np.where(again, p - step * gap, p), np.inf if again.any() else square
        p *= pressure / p.mean()
        if np.abs(p - last).sum() <= TOLERANCE * p.sum():
            gap = displaced(p) - heights
            gap -= gap[p > 0.0].mean()
            return p, np.where(p > 0.0, 0.0, np.maximum(gap, 0.0))
    raise RuntimeError("the contact has not converged")


def slit(gap: np.ndarray) -> float:
    """Compute the height of the slit that conducts as a field of gaps from the first row to the last."""
    number, conducts = np.arange(gap.size).reshape(gap.shape), gap**3
    pairs = [
        (number[:-1], number[1:], conducts[:-1], conducts[1:]),
        (number, np.roll(number, -1, axis=1), conducts, np.roll(conducts, -1, axis=1)),
    ]
    one, other, a, b = (
        np.concatenate([own.ravel() for own in part]) for part in zip(*pairs, strict=True)
    )
    open_ = (a > 0.0) & (b > 0.0)
    one, other, a, b = (part[open_] for part in (one, other, a, b))
    graph = coo_array((np.ones(one.size), (one, other)), shape=(gap.size, gap.size))
    part_of = connected_components(graph, directed=False)[1].reshape(gap.shape)
    # parts that reach from the first row to the last
    through = np.intersect1d(part_of[0][gap[0] > 0.0], part_of[-1][gap[-1] > 0.0])
    inside = np.isin(part_of, through).ravel()
    if not inside.any():
        return 0.0
    index = np.cumsum(inside) - 1
    mean = 2.0 * a * b / (a + b)
    used = inside[one]
    one, other, mean = index[one[used]], index[other[used]], mean[used]
    # half a cell to both sides, where the pressures are 1 and 0
    ends = [row[inside[row]] for row in (number[0], number[-1])]
    diagonal = sum(np.bincount(at, mean, inside.sum()) for at in (one, other))
    sides = [np.bincount(index[row], 2.0 * conducts.ravel()[row], inside.sum()) for row in ends]
    diagonal = diagonal + sides[0] + sides[1]
    every = np.arange(inside.sum())
    matrix = coo_array(
        (np.concatenate([diagonal, -mean, -mean]),
         (np.concatenate([every, one, other]), np.concatenate([every, other, one]))),
    ).tocsc()  # fmt: skip
    fluid = spsolve(matrix, sides[0])
    # u^3 = flux through the last row, over the length of the rows and times the distance of the ends
    rows, columns = gap.shape
    return float(np.cbrt((sides[1] * fluid).sum() * rows / columns))


def simulated(rough, n: int, seed: int, ratios) -> list[Interface]:
    """Simulate a surface under several pressures over E*."""
    heights, found = surface(rough, n, seed), []
    for ratio in ratios:
        p, gap = pressed(heights, ratio)
        found.append(Interface((p > 0.0).mean(), gap.mean(), slit(gap)))
    return found
