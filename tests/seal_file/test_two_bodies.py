"""Two bodies in one file that press on each other, against one layered block and its exact solution."""

from pathlib import Path

import numpy as np
import pytest
from test_two_rubbers import block, exact_force, without_parts

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.errors import SealFileError
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.result import frozen_measures

BULB = Path(__file__).parent / "bulb.toml"
BLOCK = block("{spacing}")
GAP = 0.01
"""mm between both bodies at the start."""
STACK = (
    BLOCK.replace("line = [[0.0, 2.0], [6.0, 2.0]]\n", "")
    .replace("[[6.0, 0.0], [6.0, 2.0], [6.0, 4.0]]", "[[6.0, 0.0], [6.0, 2.0]]")
    .replace('edges = ["left", "right"]', 'edges = ["left", "right", "upper_left", "upper_right"]')
    .replace(
        '[[section.outer]]\nedge = "top"\nline = [[6.0, 4.0], [0.0, 4.0]]',
        '[[section.outer]]\nedge = "joint"\nline = [[6.0, 2.0], [0.0, 2.0]]',
    )
    .replace("[[0.0, 4.0], [0.0, 2.0], [0.0, 0.0]]", "[[0.0, 2.0], [0.0, 0.0]]")
    .replace("start = [0.0, 4.0]", f"start = [0.0, {4.0 + GAP}]")
    .replace("translate = [0.0, -0.4]", f"translate = [0.0, {-0.4 - GAP}]")
    .replace(
        '[fixed]',
        f"""[[section.outer]]
body = 2
edge = "under"
line = [[0.0, {2.0 + GAP}], [6.0, {2.0 + GAP}]]
[[section.outer]]
body = 2
edge = "upper_right"
line = [[6.0, {2.0 + GAP}], [6.0, {4.0 + GAP}]]
[[section.outer]]
body = 2
edge = "top"
line = [[6.0, {4.0 + GAP}], [0.0, {4.0 + GAP}]]
[[section.outer]]
body = 2
edge = "upper_left"
line = [[0.0, {4.0 + GAP}], [0.0, {2.0 + GAP}]]
[self_contact]
edges = ["joint", "under"]
friction = 0.0
normal_penalty = 1e6
[fixed]""",
    )
)  # fmt: skip


def read(folder, text):
    path = folder / "stack.toml"
    path.write_text(text)
    return sm.read_seal_file(path)


def test_a_body_between_others_needs_friction_at_the_plate(tmp_path):
    """It stays between plate and lower body, from which a gap separates it at the start."""
    text = STACK.format(spacing=1.0).replace(', "upper_left", "upper_right"]', "]")
    text = text.replace('"under"]\nfriction = 0.0', '"under"]\nfriction = 0.2')
    with pytest.raises(SealFileError, match=r"body 2 .* can slide along x without resistance"):
        read(tmp_path, text)
    text = text.replace('name = "plate"\nfriction = 0.0', 'name = "plate"\nfriction = 0.2')
    result = sm.analyze(sm.build_seal(read(tmp_path, text)))
    assert result.converged
    assert not [own for own in result.warnings if "nothing holds it" in own]


@pytest.fixture
def built(tmp_path):
    def build(spacing, text=STACK):
        return sm.build_seal(read(tmp_path, text.format(spacing=spacing)))

    return build


@pytest.mark.parametrize(("spacing", "spread"), [(0.7, 1e-9), (0.5, 1e-9), (0.35, 1e-4)])
def test_two_bodies_press_on_each_other_as_two_layers(built, spacing, spread):
    """With one pressure up to the corners of the joint (contact patch test): to the tolerance of
    Newton's method where the particles of both bodies face each other. Those of spacing 0.35 do not."""
    result = sm.analyze(built(spacing))
    assert result.converged, result.failure
    assert result.warnings == result.seal.warnings
    assert result.value(Reaction("plate"))[1] == pytest.approx(exact_force(joint=1e6), rel=1e-7)
    points, gap = result.term("self_contact").gaps(result.response("self_contact").x)
    assert np.ptp(gap) < spread * np.abs(gap).max()
    # two points at both ends of both edges, and those between
    own = result.seal.body.edges
    assert len(points) == sum(len(own[name].particles) for name in ("joint", "under"))


def test_no_particle_feels_the_other_body(built):
    """Supports are wider than the gap: neighbours of a particle are in its own body all the same."""
    seal = built(0.7)
    body, upper = seal.body, seal.nominal_particles[:, 1] > 2.0 + 0.5 * GAP
    assert body.support_radius.max() > 10.0 * GAP
    raw = discretize(body, seal.nominal_particles, seal.definitions).everywhere.raw
    for particle in range(body.n_particles):
        own = raw.neighbours[raw.start[particle] : raw.start[particle + 1]]
        assert (upper[own] == upper[particle]).all()


def test_bodies_of_a_mesh_without_parts_have_their_materials(tmp_path):
    text = STACK.format(spacing=0.8)
    seal = sm.build_seal(read(tmp_path, text))
    given = sm.build_seal(without_parts(seal, text, tmp_path))
    regions, others = (own.definitions[0].regions for own in (given, seal))
    assert [region.name for region in regions] == [region.name for region in others]
    for region, other in zip(regions, others, strict=True):
        np.testing.assert_array_equal(np.sort(region.cells), np.sort(other.cells))


def test_materials_and_holes_of_bodies(built):
    seal = built(0.7)
    soft, stiff = seal.definitions[0].regions
    height = seal.nominal_particles[seal.body.cells, 1]
    assert height[soft.cells].min() > 2.0
    assert height[stiff.cells].max() == 2.0
    assert {"soft_c10", "stiff_c10"} <= set(seal.scalars)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            f"start = [0.0, {4.0 + GAP}]",
            "start = [0.0, 5.0]",
            r"must support body 2 \(edge 'under'\)",
        ),
        ("body = 2", "body = 0", "body = 0, but it must be"),
        (f"{2.0 + GAP}", "1.5", "body 2"),
        (
            "at = [1.0, 0.5]",
            "at = [1.0, -0.5]",
            r"\) of a region is outside of the section; give a",
        ),
    ],
)
def test_what_cannot_be_meant_is_refused(built, old, new, words):
    text = STACK.replace(old, new)
    assert text != STACK
    with pytest.raises(sm.SealFileError, match=words):
        built(0.7, text)


def test_a_region_of_one_body_needs_its_line(built):
    text = BLOCK.replace("line = [[0.0, 2.0], [6.0, 2.0]]\n", "")
    with pytest.raises(sm.SealFileError, match="the key 'line' is missing"):
        built(0.7, text)


@pytest.mark.long
def test_a_design_of_two_bodies_is_written_and_read(tmp_path):
    design = '[[design]]\nedges = ["joint"]\nparameters = 5\nbound = 0.3\n'
    file = read(tmp_path, STACK.format(spacing=0.7) + design)
    seal = sm.build_seal(file)
    offsets = np.full(seal.n_offsets, -0.03)
    path = write_design(file, seal, offsets, frozen_measures(seal), tmp_path, "new")[0]
    again = sm.build_seal(sm.read_seal_file(path))
    assert len(sm.read_seal_file(path).section.outline.others) == 1
    one, other = sm.analyze(seal, offsets), sm.analyze(again)
    assert other.value(Reaction("plate")) == pytest.approx(one.value(Reaction("plate")), rel=1e-6)


def test_a_body_below_the_base_of_another_one_has_not_sunk(tmp_path):
    text = BULB.read_text().replace("spacing = 0.9", "spacing = 1.6")
    text = text.replace("translate = [0.0, -6.0]\nsteps = 60", "translate = [0.0, -0.6]\nsteps = 2")
    text = text.replace('edges = ["base"]', 'edges = ["base", "low"]').replace(
        "[fixed]",
        """[[section.outer]]
body = 2
edge = "low"
line = [[6.0, -6.0], [12.0, -6.0]]
[[section.outer]]
body = 2
edge = "round"
line = [[12.0, -6.0], [12.0, -2.0], [6.0, -2.0], [6.0, -6.0]]
[fixed]""",
    )
    text = text.replace("translate = [2.0, 0.0]\nrotate = 0.0\nsteps = 20", "steps = 1")
    result = sm.analyze(sm.build_seal(read(tmp_path, text)))
    assert result.converged, result.failure
    assert not [text for text in result.warnings if "below" in text]


def test_penalties_of_bodies_that_moved_edges_press_on_each_other(tmp_path):
    """Their error is that of the force on the moved edge, as there is no profile and no measure."""
    text = STACK.format(spacing=0.7).replace("normal_penalty = 1e6\n", "")
    # the profile and the measure come last
    text = text.partition("[[profile]]")[0]
    text += '[[moved]]\nname = "lid"\nedges = ["top"]\ndirections = ["y"]\n'
    text += f"stage = [{{ translate = [0.0, {-0.4 - GAP}], steps = 4 }}]\n"
    seal = sm.build_seal(read(tmp_path, text))
    result = sm.analyze(seal)
    assert result.converged, result.failure
    (error,) = result.penalty_error.values()
    assert abs(error.relative) <= 0.01
    stack = sm.analyze(sm.build_seal(read(tmp_path, STACK.format(spacing=0.7))))
    ratio = result.value(Reaction("lid"))[1] / stack.value(Reaction("plate"))[1]
    assert ratio == pytest.approx(1.0, abs=0.01)
