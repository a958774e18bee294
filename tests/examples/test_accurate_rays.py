"""Rays in a file have the scheme of the door seal of their accuracy."""

from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.seals.outline.cloud_file import read_cloud, write_cloud

PAPER = (Path(__file__).parents[2] / "examples" / "paper_seal.toml").read_text(encoding="utf-8")
RAYS = 'rays = { rays = 58, layers = 3, accuracy = "paper" }'
CONTACT = 'contact = ["seal"]'
AT_EDGES = f'{CONTACT}\ncontact_points = "edges"'
ENGINEERING = "rays = { rays = 58, layers = 4 }"
FIXED, STEPS = '[fixed]\nedges = ["base"]\n', "steps = 105\n"
FLUID = '[[fluid]]\nedge = "seal"\nfrom = "end"\npressure = 1.0\n'
WORK = '[[measure]]\ntype = "profile_work"\n'
ALL_WORK = WORK.replace("profile", "friction")


def file_with(folder, rays, *changes):
    text = PAPER
    for old, new in ((RAYS, rays), *changes):
        assert text.count(old) == 1
        text = text.replace(old, new)
    path = folder / "seal.toml"
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


@pytest.mark.parametrize("points", [None, "particles"])
@pytest.mark.parametrize("accuracy", [None, "fine"])
def test_its_path_is_that_of_the_accurate_door_seal(tmp_path, accuracy, points):
    own = "" if accuracy is None else f', accuracy = "{accuracy}"'
    places = CONTACT if points is None else f'{CONTACT}\ncontact_points = "{points}"'
    rays = f"rays = {{ rays = 58, layers = 4{own} }}"
    seal = sm.build_seal(file_with(tmp_path, rays, (CONTACT, places)))
    changes = {} if points is None else {"contact_points": points}
    door = sm.door_seal(accuracy or "engineering", rays=58, layers=4, n_steps=105, **changes)
    assert np.abs(seal.body.support_axes - door.body.support_axes).max() < 1e-13
    assert (seal.body.basis_order, seal.body.column) == (2, 3)
    assert seal.body.n_gauss == door.body.n_gauss
    mine, known = sm.analyze(seal), sm.analyze(door)
    # the particles of both differ in the last digit, of which tangents of condition 2e5 pass on as much
    rounding = 2e5 * np.finfo(float).eps
    assert np.abs(mine.displacement() - known.displacement()).max() < rounding * 10.0


def test_too_few_layers_are_refused_when_the_file_is_read(tmp_path):
    with pytest.raises(
        SealFileError, match=r"layers = 2 is too small: the accuracy 'engineering' needs at least 3"
    ):
        file_with(tmp_path, "rays = { rays = 58, layers = 2 }")
    with pytest.raises(SealFileError, match="accuracy"):
        file_with(tmp_path, 'rays = { rays = 58, layers = 4, accuracy = "best" }')
    assert file_with(tmp_path, 'rays = { rays = 58, layers = 2, accuracy = "paper" }')


@pytest.mark.parametrize(
    ("changes", "points"),
    [
        ([], "edges"),
        ([(STEPS, STEPS + "rotate = 1.0\n")], "edges"),
        ([(STEPS, STEPS + f"rotate = 1.0\n{WORK}")], "particles"),
        ([(STEPS, STEPS + f"rotate = 1.0\n{ALL_WORK}")], "particles"),
        ([(STEPS, STEPS + WORK)], "edges"),
        ([(FIXED, FIXED + FLUID)], "particles"),
        ([(FIXED, ""), ("start = [0.0, 10.0]", "start = [0.0, 9.5]")], "particles"),
        ([(CONTACT, f'{CONTACT}\ncontact_points = "particles"')], "particles"),
    ],
    ids=[
        "nothing else",
        "the door turns",
        "its work",
        "all work",
        "work of a door that does not turn",
        "a fluid",
        "the door holds the seal",
        "as given",
    ],
)
def test_where_the_door_touches_follows_from_what_needs_a_particle(tmp_path, changes, points):
    (door,) = file_with(tmp_path, ENGINEERING, *changes).profiles
    assert door.contact_points == points


def test_other_clouds_are_touched_at_averages_unless_the_file_says_otherwise(tmp_path):
    (door,) = file_with(tmp_path, RAYS).profiles
    assert door.contact_points == "particles"
    (door,) = file_with(tmp_path, "spacing = 0.9").profiles
    assert door.contact_points == "averages"
    (door,) = file_with(tmp_path, "spacing = 0.9", (FIXED, FIXED + FLUID)).profiles
    assert door.contact_points == "particles"
    file = file_with(tmp_path, "spacing = 1.2", (CONTACT, AT_EDGES))
    (contact,) = (
        term for term in sm.build_seal(file).definitions if isinstance(term, RigidContact)
    )
    assert contact.where.points.anchors.shape[1] == 2


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([(FIXED, FIXED + FLUID)], r"a \[\[fluid\]\] with the key from needs contact points"),
        (
            [(STEPS, STEPS + f"rotate = 1.0\n{WORK}")],
            r"profile_work \(\[\[measure\]\] 1\) of a rotating profile",
        ),
        (
            [(STEPS, STEPS + f"rotate = 1.0\n{WORK.replace('profile', 'friction')}")],
            r"friction_work \(\[\[measure\]\] 1\) of a rotating profile",
        ),
        (
            [(FIXED, ""), ("start = [0.0, 10.0]", "start = [0.0, 9.5]")],
            "no profile may touch it at a part",
        ),
        ([(AT_EDGES, AT_EDGES.replace("edges", "corners"))], "must be one of particles, edges"),
    ],
)
def test_contact_between_the_particles_is_refused_where_one_is_needed(tmp_path, changes, words):
    with pytest.raises(SealFileError, match=words):
        file_with(tmp_path, ENGINEERING, (CONTACT, AT_EDGES), *changes)


def test_a_wall_on_rays_needs_no_design(tmp_path):
    designs = PAPER[PAPER.index("[[design]]") : PAPER.index("[[measure]]")]
    seal = sm.build_seal(file_with(tmp_path, ENGINEERING, (designs, "")))
    assert (seal.n_offsets, len(seal.nominal_particles)) == (0, 232)


def test_derivatives_with_contact_between_the_particles(tmp_path):
    file = file_with(tmp_path, ENGINEERING, (STEPS, "steps = 20\n"))
    result = sm.analyze(sm.build_seal(file), keep_factors=True)
    direct, adjoint = (sm.differentiate(result, method=way) for way in ("direct", "adjoint"))
    for name, one in direct.rows.items():
        assert np.abs(one - adjoint.rows[name]).max() <= 1e-9 * np.abs(one).max()


@pytest.mark.parametrize(
    ("name", "change", "match"),
    [
        ("basis_order", lambda values: values + 3, "basis_order"),
        ("basis_order", lambda values: values - np.arange(values.size) % 2, "basis_order"),
        ("column", lambda values: values % 5, "column"),
        ("n_gauss", lambda values: values - 1, "n_gauss .* from 2 to 10"),
        (
            "n_gauss",
            lambda values: values + np.arange(len(values))[:, None] % 2,
            "the same for all",
        ),
    ],
)
def test_cells_without_common_kernels_are_refused(tmp_path, name, change, match):
    meshio = pytest.importorskip("meshio")
    file = file_with(tmp_path, 'rays = { rays = 58, layers = 4, accuracy = "fine" }')
    seal = sm.build_seal(file)
    path = write_cloud(seal, np.zeros(seal.n_offsets), tmp_path / "cloud.vtu")
    kernels = read_cloud(path, file.section.outline).kernels
    assert (kernels.basis_order, kernels.column, kernels.n_gauss) == (2, 3, seal.body.n_gauss)
    assert seal.body.n_gauss == (3, 2)
    mesh = meshio.read(path)
    mesh.cell_data[name] = [change(values) for values in mesh.cell_data[name]]
    mesh.write(path)
    with pytest.raises(GeometryError, match=match):
        read_cloud(path, file.section.outline)
