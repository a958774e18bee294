"""Rungs of the ladder: a seal file each, its quantities, clouds, meshes and published values."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from time import process_time

import numpy as np

from seal_mdao.export.csv_tables import reaction_tables
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.profiles import leading_motion
from seal_mdao.seals.result import SealResult, analyze

HERE = Path(__file__).parent
REFERENCES = HERE.parents[1] / "verification" / "references"


@dataclass(frozen=True)
class Quantity:
    """A number that particles, elements and the literature give.

    Attributes
    ----------
    name : str
        With its unit.
    of : callable
        ``of(table)`` of rows with stage (from 1), travel in it (mm), Fx and Fy (N/m or N).
    published : tuple of (float, str)
        Values with their source.
    """

    name: str
    of: Callable
    published: tuple = ()


def force(stage: int, name: str, published=()) -> Quantity:
    """Vertical force at the end of a stage, counted from 1."""
    return Quantity(name, lambda table: abs(table[table[:, 0] == stage][-1, 3]), tuple(published))


def friction_ratio(stage: int, name: str, published=()) -> Quantity:
    """Horizontal over vertical force, the mean over the second half of a stage, counted from 1."""

    def mean(table):
        own = table[table[:, 0] == stage]
        fx, fy = own[own[:, 1] >= 0.5 * own[-1, 1], 2:].T
        return np.abs(fx / fy).mean()

    return Quantity(name, mean, tuple(published))


@dataclass(frozen=True)
class Rung:
    """One benchmark.

    Attributes
    ----------
    title, source : str
        In words, and where the problem comes from.
    file : Path
        Seal file.
    spacings : tuple of float
        Of the particles, mm, from coarse to fine.
    quantities : tuple of Quantity
    sizes : tuple of float
        Of the elements of FElupe, mm, from coarse to fine; empty without.
    triangles : tuple of float
        Sizes of the triangles of NGSolve, mm, from coarse to fine; empty without.
    thin : bool
        Whether its rubber is a thin wall, not a solid section.
    curve : bool
        Whether the forces along the path are stored.
    quick : bool
        Whether the coarsest cloud takes a few seconds.
    """

    title: str
    source: str
    file: Path
    spacings: tuple
    quantities: tuple
    sizes: tuple = ()
    triangles: tuple = ()
    thin: bool = False
    curve: bool = False
    quick: bool = True

    @property
    def digest(self) -> str:
        """Digest of the seal file."""
        return sha256(self.file.read_bytes()).hexdigest()[:16]

    def described(self, spacing: float) -> SealFile:
        """Read the file with another spacing; distances along single edges change in proportion."""
        file = read_seal_file(self.file)
        own = file.section
        scale = spacing / own.spacing
        edges = {edge: scale * size for edge, size in (own.edge_spacing or {}).items()}
        section = replace(own, spacing=spacing, edge_spacing=edges)
        return replace(file, section=section)

    def seal(self, spacing: float):
        """Build the seal with another spacing."""
        return build_seal(self.described(spacing))


def path_table(result: SealResult) -> np.ndarray:
    """Stage (from 1), travel in it (mm), Fx and Fy (N/m or N) of every load step, shape (n, 4)."""
    result.require_converged()
    return np.array(next(iter(reaction_tables(result).values())))


def values_of(rung: Rung, result: SealResult) -> list[float]:
    """Values of the quantities of a rung, in their order."""
    table = path_table(result)
    return [float(quantity.of(table)) for quantity in rung.quantities]


def load_path(seal) -> np.ndarray:
    """Travel of the leading profile or edge at every load step, mm, over all stages."""
    return leading_motion(seal).travels[1:]


def timed(seal) -> tuple[SealResult, float]:
    """Analyse a seal; its result and the processor time, s."""
    start = process_time()
    result = analyze(seal)
    return result, process_time() - start


def lindley(squeeze: float) -> float:
    """Force on the O-ring AS568-214 of hardness 70, N: 2 pi R E d (1.25 c^1.5 + 50 c^6).

    P. B. Lindley, J. Strain Anal. 1 (1966) 190, from experiments.
    """
    modulus, cord, radius = 5.521, 3.53, 14.26
    per_length = modulus * cord * (1.25 * squeeze**1.5 + 50.0 * squeeze**6)
    return 2.0 * np.pi * radius * per_length


IRONING = {
    "pressed": (
        (267.9e3, "Poulios and Renard 2015"), (289.7e3, "Yastrebov 2011"),
        (297.9e3, "Fischer and Wriggers 2006"), (319.5e3, "Hartmann et al. 2009"),
        (332.0e3, "Code_Aster"),
    ),
    "drawn": (
        (337.4e3, "Poulios and Renard 2015"), (359.5e3, "Yastrebov 2011"),
        (365.1e3, "Fischer and Wriggers 2006"), (408.4e3, "Hartmann et al. 2009"),
        (421.0e3, "Code_Aster"),
    ),
    "ratio": (
        (0.30, "Poulios and Renard 2015"), (0.47, "Yastrebov 2011"),
        (0.53, "Fischer and Wriggers 2006"), (0.38, "Hartmann et al. 2009"), (0.34, "Code_Aster"),
        (0.32, "Batistić, Cardiff and Tuković 2022"), (0.32, "Houssein 2022"),
    ),
}  # fmt: skip
"""Read from the figures of these works by the authors of solids4foam (its tutorial shallowIroning);
ratios after 5 mm of sliding."""
RUNGS = {
    "rubber_sealing": Rung(
        "Rubber sealing, top bonded to a plate",
        "U. Brink, E. Stein, Comput. Methods Appl. Mech. Engrg. 161 (1998) 77; all dimensions from A. "
        "Angoshtari et al., ibid. 313 (2017) 596",
        HERE / "rubber_sealing.toml",
        (0.6, 0.4, 0.25),
        (
            force(1, "force of the half section at 1.1 mm (N/m)"),
            force(2, "force of the half section at 1.65 mm (N/m)"),
        ),
        (1.0, 0.5, 0.25, 0.15),
        (2.0, 1.0, 0.5),
        thin=True,
    ),
    "urethane_ring": Rung(
        "Polyurethane ring between rough plates",
        "A. F. Saleeb, K. Chen, T. Y. P. Chang, Int. J. Numer. Methods Engrg. 37 (1994) 1297: radii and "
        "friction; law and squeeze are assumed",
        HERE / "urethane_ring.toml",
        (0.55, 0.45, 0.3),
        (
            force(1, "force at 2 mm of squeeze (N/m)"),
            force(2, "force at 4 mm of squeeze (N/m)"),
        ),
        (1.1, 0.55, 0.3, 0.2),
        thin=True,
    ),
    "half_ring": Rung(
        "Half ring on fixed feet under a plate",
        "page on the verification",
        REFERENCES / "half_ring.toml",
        (0.55, 0.4, 0.3),
        (
            force(1, "force at 1 mm (N/m)"),
            force(3, "force at 2 mm (N/m)"),
        ),
        (0.85, 0.43, 0.3, 0.2),
        thin=True,
    ),
    "o_ring": Rung(
        "Cord of 5.33 mm between plates, plane strain",
        "page on the verification",
        REFERENCES / "o_ring.toml",
        (0.6, 0.45, 0.3),
        (
            force(2, "force at 20 % squeeze (N/m)"),
            force(3, "force at 25 % squeeze (N/m)"),
        ),
        (0.6, 0.3, 0.2, 0.14),
    ),
    "as568_214": Rung(
        "O-ring AS568-214 of hardness 70 between plates",
        "AS568; Ogden's fit of L. R. G. Treloar's tests, scaled to the hardness",
        HERE / "as568_214.toml",
        (0.3, 0.2, 0.14),
        (
            force(1, "force of the ring at 10 % squeeze (N)", [(lindley(0.1), "Lindley's law")]),
            force(2, "force of the ring at 20 % squeeze (N)", [(lindley(0.2), "Lindley's law")]),
        ),
        (0.3, 0.16, 0.11),
    ),
    "bonded_disc": Rung(
        "Rubber disc bonded between plates, shape factor 1",
        "page on the verification",
        REFERENCES / "ring_disc_5.toml",
        (0.8, 0.5, 0.4),
        (
            force(1, "force at 0.1 % compression (N)"),
            force(2, "force at 10 % compression (N)"),
        ),
        (1.0, 0.5, 0.25),
    ),
    "ironing": Rung(
        "Shallow ironing, friction 0.3",
        "K. A. Fischer, P. Wriggers, Comput. Methods Appl. Mech. Engrg. 195 (2006) 5020; dimensions "
        "from V. A. Yastrebov, Numerical Methods in Contact Mechanics (2013)",
        HERE / "ironing.toml",
        (0.55, 0.45, 0.35),
        (
            force(1, "vertical force at 1 mm (N/m)", IRONING["pressed"]),
            force(2, "vertical force at 5 mm of sliding (N/m)", IRONING["drawn"]),
            friction_ratio(
                2, "horizontal over vertical force, mean from 2.5 to 5 mm", IRONING["ratio"]
            ),
        ),
        curve=True,
        quick=False,
    ),
}
"""By name, thin walls first."""
