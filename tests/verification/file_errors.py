"""Errors of the seals of files with their own cloud, against clouds of half the spacing."""

from dataclasses import replace

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.file_seal import build_seal
from seal_mdao.measures.singular_points import singular_points
from seal_mdao.rkpm.cells import kernel_supports
from seal_mdao.rkpm.visibility import hidden_pairs
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.section_cloud import Kernels
from seal_mdao.seals.result import SealResult, analyze

LINEAR, QUADRATIC = Kernels(), Kernels(2.6, 2)
"""What files have, and what they might have."""


def with_kernels(seal: OutlineSeal, kernels: Kernels) -> OutlineSeal:
    """The seal with other kernels on the same cloud."""
    cells, places = seal.body.cells, seal.body.nominal
    radius, axes = kernel_supports(cells, places, kernels.support)
    body = replace(
        seal.body, support_radius=radius, support_axes=axes, basis_order=kernels.basis_order,
        n_gauss=kernels.n_gauss, hidden_pairs=hidden_pairs(cells, places, radius),
    )  # fmt: skip
    return replace(seal, body=body, kernels=kernels)


def touched_at(file: SealFile, points: str) -> SealFile:
    """The file with other contact points, of ``terms.points.CONTACT_POINTS``."""
    profiles = tuple(replace(profile, contact_points=points) for profile in file.profiles)
    return replace(file, profiles=profiles)


def refined(file: SealFile) -> OutlineSeal:
    """The seal of a file with half its spacing, and twice as many cells across its walls."""
    own = file.section
    section = replace(own, spacing=0.5 * own.spacing, layers=2 * own.layers - 1)
    return build_seal(replace(file, section=section))


def forces(seal: OutlineSeal) -> list:
    """Force on every profile along the load path, (n_steps, 2) each, N/mm."""
    result = analyze(seal)
    result.require_converged()
    labels = [term.label for term in seal.definitions if isinstance(term, RigidContact)]
    return [result.path.reaction(label) for label in labels]


def fine_forces(file: SealFile) -> list:
    """Mean of both kinds of kernels on the cloud of half the spacing: they differ by some 0.1 %."""
    fine = refined(file)
    both = [forces(with_kernels(fine, kernels)) for kernels in (LINEAR, QUADRATIC)]
    return [0.5 * (one + other) for one, other in zip(*both, strict=True)]


def force_error(found: list, reference: list) -> float:
    """Largest difference along the path, of any profile, over the largest force of that profile."""
    return max(
        float(np.abs(own - exact).max() / np.abs(exact).max())
        for own, exact in zip(found, reference, strict=True)
    )


def stress_error(result: SealResult, fine: SealResult, away: float) -> float:
    """Compute the error of the von Mises stress at the end of a path against that of a finer cloud.

    It is the root mean square of the difference over that of the stress, at all sample points of the
    section farther than ``away`` (mm) from its singular points.
    """
    places, stress = result.section_stress()
    exact = LinearNDInterpolator(*fine.section_stress())(places)
    seal = result.seal
    singular = singular_points(seal.body, seal.nominal_particles, seal.definitions[0])
    # outside of the triangles of the finer samples there is no value
    used = np.isfinite(exact)
    if singular:
        used &= cKDTree([point.place for point in singular]).query(places)[0] > away
    # sqrt(sum (s - s_fine)^2 / sum s^2)
    return float(np.linalg.norm((stress - exact)[used]) / np.linalg.norm(stress[used]))
