"""Clouds with all cells divided into four, and iterations on them that begin at a coarse solution."""

from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from cord_files import cord

import seal_mdao as sm
from seal_mdao.accuracy.error_estimate import some_ends
from seal_mdao.accuracy.prolongation import Prolongation
from seal_mdao.accuracy.refined_file import refined_file
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.gap import GapSquareIntegral
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.retention import CompressionSet
from seal_mdao.measures.section_shape import Displacement
from seal_mdao.measures.stress import VonMises
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.outline.section_cloud import OutlineCloud
from seal_mdao.seals.result import Known, analyze, analyze_particles
from seal_mdao.structure.structural_term import StructuralTerm

EXAMPLES = Path(__file__).parents[2] / "examples"


def both(path):
    """The seal of a file, that on smaller cells, and their connection."""
    file = sm.read_seal_file(path)
    seal = sm.build_seal(file)
    finer = refined_file(file, seal)
    return seal, unchosen_seal(finer.file), finer


def check(seal, fine, finer):
    # old particles are among the new ones, in the same places
    np.testing.assert_array_equal(fine.nominal_particles[finer.particles], seal.nominal_particles)
    assert len(fine.body.cells) == len(finer.parents)
    # the centre of a new cell lies in its parent
    old, new = seal.nominal_particles[seal.body.cells], fine.nominal_particles[fine.body.cells]
    centre = new.mean(axis=1)[:, None]
    corners = old[finer.parents]
    side = np.roll(corners, -1, axis=1) - corners
    to = centre - corners
    assert (side[..., 0] * to[..., 1] - side[..., 1] * to[..., 0] >= -1e-12).all()
    # the same edges, with twice as many sides, and the same components are fixed
    for name, edge in seal.body.edges.items():
        assert len(fine.body.edge(name).sides) == 2 * len(edge.sides)
    np.testing.assert_array_equal(fine.body.fixed[finer.particles], seal.body.fixed)


def test_round_section(tmp_path):
    seal, fine, finer = both(cord(tmp_path))
    check(seal, fine, finer)
    # new particles of the arc lie on it, not on its chords
    side = fine.nominal_particles[fine.body.edge("side").particles]
    np.testing.assert_allclose(np.hypot(side[:, 0], side[:, 1] - 3.0), 3.0, rtol=0, atol=1e-12)


def test_triangles_are_divided_into_three(tmp_path):
    """Every third cell of a section is two triangles, as in meshes of other programs."""
    file = sm.read_seal_file(cord(tmp_path))
    seal = unchosen_seal(file)
    cells = []
    for number, (a, b, c, d) in enumerate(seal.body.cells.tolist()):
        cells += [[a, b, c, d]] if number % 3 else [[a, b, c, c], [a, c, d, d]]
    cloud = OutlineCloud(
        seal.nominal_particles, np.array(cells), tuple(seal.loops), np.zeros(len(cells), int),
        boundaries=seal.boundaries, kernels=seal.kernels,
    )  # fmt: skip
    file = replace(file, section=replace(file.section, spacing=cloud), designs=())
    mixed = unchosen_seal(file)
    finer = refined_file(file, mixed)
    fine = unchosen_seal(finer.file)
    check(mixed, fine, finer)
    triangles = int((mixed.body.cells[:, 2] == mixed.body.cells[:, 3]).sum())
    assert 0 < triangles < len(cells)
    assert len(finer.parents) == 4 * len(cells) - triangles


@pytest.mark.parametrize("name", ["paper_seal", "weatherstrip", "two_seals"])
def test_examples(name):
    """Rays through a wall, a drawing of two materials, two bodies with self-contact."""
    file = sm.read_seal_file(EXAMPLES / f"{name}.toml")
    seal = unchosen_seal(file)
    finer = refined_file(file, seal)
    fine = unchosen_seal(finer.file)
    check(seal, fine, finer)
    np.testing.assert_array_equal(fine.parts, seal.parts[finer.parents])


def test_iterations_begin_at_the_coarse_solution(tmp_path):
    """They lead to the solution of the ordinary path, in fewer iterations."""
    seal, fine, finer = both(cord(tmp_path))
    ends = some_ends(seal, 4)
    few = fine.with_ends(ends)
    ordinary = analyze(few)
    coarse = analyze(seal.with_ends(ends))
    body = discretize(few.body, few.nominal_particles, few.terms())
    steps = dict(enumerate(coarse.path.nominal_steps, 1))
    near = Prolongation(coarse.path, steps, body, finer.parents)
    found = analyze_particles(few, few.nominal_particles, known=Known(body, near=near))
    np.testing.assert_allclose(found.displacement(), ordinary.displacement(), rtol=0, atol=1e-8)
    assert (found.newton_iterations <= 8).all()
    assert found.newton_iterations.sum() < 0.8 * ordinary.newton_iterations.sum()


def test_prolongation_has_the_coarse_displacements(tmp_path):
    seal, fine, finer = both(cord(tmp_path))
    coarse = analyze(seal)
    body = discretize(fine.body, fine.nominal_particles, fine.terms())
    step = coarse.path.nominal_steps[-1]
    near = Prolongation(coarse.path, {1: step}, body, finer.parents)
    d = near._prolongated(step)
    table = body.everywhere.table
    sums = np.add.reduceat(table.phi[:, None] * d[table.neighbours], table.start[:-1])
    np.testing.assert_allclose(sums[finer.particles], coarse.displacement(), rtol=0, atol=1e-12)


def test_prolongation_is_exact_for_linear_displacements(tmp_path):
    """At new particles of a curved boundary, too, which lie beside the middle of the old side."""
    seal, fine, finer = both(cord(tmp_path))
    coarse = analyze(seal)
    body = discretize(fine.body, fine.nominal_particles, fine.terms())
    rates = np.array([0.3, -0.2])
    step = replace(coarse.path.nominal_steps[-1], d=rates * seal.nominal_particles)
    d = Prolongation(coarse.path, {1: step}, body, finer.parents)._prolongated(step)
    # the linear field has these coefficients on both clouds
    np.testing.assert_allclose(d, rates * fine.nominal_particles, rtol=0, atol=1e-12)


def test_prolongation_has_the_gaps_and_volume_changes_of_the_coarse_cloud(tmp_path):
    """Gaps in proportion to x stay so, but for the difference of chords and arcs (h^2 / 8 R)."""
    seal, fine, finer = both(cord(tmp_path))
    coarse = analyze(seal)
    body = discretize(fine.body, fine.nominal_particles, fine.terms())
    step = coarse.path.nominal_steps[-1]
    near = Prolongation(coarse.path, {1: step}, body, finer.parents)
    kinds = set()
    for term, own in zip(
        PathProblem(body, fine.terms()).terms, coarse.path.problem.terms, strict=True
    ):
        kinds.add(type(own))
        if isinstance(own, ContactTerm):
            old, new = (
                one.where.points.at(at.particles)[:, 0]
                for one, at in ((own, coarse.path.discretization), (term, body))
            )
            found = near._known(term, own, SimpleNamespace(gap=old), step)
            np.testing.assert_allclose(found, new, rtol=0, atol=0.05)
            # points of both clouds
            same = np.isin(new, old)
            assert same.any()
            np.testing.assert_array_equal(found[same], new[same])
        elif isinstance(own, StructuralTerm):
            exact = own.volume_strain_at(step.d, step.fraction)[finer.parents]
            np.testing.assert_array_equal(near._known(term, own, None, step), exact)
            assert np.ptp(exact) > 0.0
    assert {ContactTerm, StructuralTerm} <= kinds


INDICES = {"point", "points", "patches", "nominal"}
"""Fields of measures that are indices of particles or contact points; ``nominal`` may also be a flag."""


def every_measure(base=Measure):
    for own in base.__subclasses__():
        yield own
        yield from every_measure(own)


def test_measures_with_indices_say_what_they_are_on_smaller_cells():
    """Indices of a coarse cloud are those of other particles on a finer one."""
    wrong = [
        own.__name__
        for own in every_measure()
        if is_dataclass(own)
        and INDICES & {field.name for field in fields(own)}
        and own.on_refined in (Measure.on_refined, Derived.on_refined)
        and getattr(own, "nominal", None) is not False
    ]
    assert not wrong


def test_measures_at_the_same_places(tmp_path):
    """Values on smaller cells are those at the same particles and on the same part of the contact."""
    seal, fine, finer = both(cord(tmp_path))
    results = [analyze(own.with_ends(some_ends(seal, 8))) for own in (seal, fine)]
    top = int(seal.body.edge("side").particles[len(seal.body.edge("side").particles) // 2])
    for measure in (
        Displacement(top), CompressionSet(top, component=0), VonMises(count=2),
        ContactPressure("lid"), GapSquareIntegral("lid"),
    ):  # fmt: skip
        own = measure.frozen(results[0])
        other = own.on_refined(results[1], finer.particles)
        if hasattr(own, "point"):
            assert other.point == finer.particles[own.point]
        values = results[0].value(own), results[1].value(other)
        np.testing.assert_allclose(values[1], values[0], rtol=0.1, atol=1e-3)
