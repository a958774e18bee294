"""Materials of seal files that soften: the elastic law on its first loading, derivatives through both
histories, refusals."""

import numpy as np
import pytest
from block_files import (
    DESIGN,
    FIXED,
    LID,
    MOVED,
    exact_seal,
    foam,
    read,
    require_potentials,
    text,
    with_model,
)
from quotients import quotients
from ring_files import ring

import seal_mdao as sm
from seal_mdao.materials.ogden_roxburgh import step_potential
from seal_mdao.measures.work import ProfileWork
from seal_mdao.plotting.field import fine_grid
from seal_mdao.seals.penalty_error import SMALL

SOFTENING = "\nsoftening = { r = 2.0, m = 2.0, beta = 0.1 }\n"
MEASURES = """\
[[measure]]
type = "von_mises"
count = 2
[[measure]]
type = "profile_work"
[[measure]]
type = "profile_work"
name = "later_work"
stage = [1, 3]
"""
CYCLE = """
stage = [
  { translate = [0, -0.5], steps = 2 }, { translate = [0, 0.4], steps = 2 },
  { translate = [0, -0.6], steps = 2 }, { translate = [0, 0.2], steps = 1 },
]
"""


def softening(given: str, law: str = SOFTENING, stages: str = CYCLE, model: str = "") -> str:
    """A seal file whose only rubber softens, and whose lid presses, goes back and presses further."""
    head, section = given.split("[section]\n", 1)
    given = f"{head.rstrip()}{law}[section]\n{section}"
    given = given.replace("\nstage = [{ translate = [0, -0.5], steps = 3 }]\n", stages)
    given = given.replace(
        "[[profile.stage]]\ntranslate = [0.2, -0.5]\nsteps = 4\n",
        stages.replace("0, -0.5", "0.2, -0.5"),
    )
    return with_model(given, model) if model else given


BLOCK = softening(text(FIXED, LID, DESIGN, MEASURES))
HOT = SOFTENING + "modulus_over_temperature = [[0.0, 1.2], [100.0, 0.8]]\n"
AROUND = softening(
    ring(spacing=0.8) + '[[measure]]\ntype = "reaction"\n' + MEASURES,
    HOT, model="temperature = [40.0, 60.0, 70.0, 50.0]",
)  # fmt: skip
HELD = softening(
    text(FIXED, MOVED, DESIGN, '[[measure]]\ntype = "reaction"\ncomponent = "y"\n',
         MEASURES.split('[[measure]]\ntype = "profile_work"')[0],
         '[[measure]]\ntype = "reaction"\nedges = ["base"]\ncomponent = "x"\nname = "on_base"\n')
    .replace("stage = [{ translate = [0.3, -0.4], rotate = 4.0, steps = 4 }]\n",
             "stage = [{ translate = [0.3, -0.4], rotate = 4.0, steps = 2 },\n"
             "  { translate = [-0.2, 0.3], steps = 2 }, { translate = [0.2, -0.5], steps = 2 }]\n"),
    stages="\n",
)  # fmt: skip
CASES = {"block": BLOCK, "ring": AROUND, "held": HELD}
STEPS = {
    "block": {"softening_r": 1e-3, "softening_m": 1e-3, "softening_beta": 1e-4, "c10": 1e-2,
              "boundary_offsets[1]": 2e-5, "lid_friction": 1e-5},
    "ring": {"softening_m": 1e-3, "c01": 1e-2, "plate_friction": 1e-5, "temperature": 1e-2},
    "held": {"softening_beta": 1e-4, "boundary_offsets[1]": 2e-5},
}  # fmt: skip


@pytest.fixture(scope="module", params=CASES)
def case(request, tmp_path_factory):
    seal = exact_seal(tmp_path_factory.mktemp("softening"), CASES[request.param])
    result = sm.analyze(seal, keep_factors=True)
    result.require_converged()
    return request.param, seal, result


def test_direct_adjoint_and_difference_quotients(case):
    name, seal, result = case
    names = tuple(n for n in seal.scalars if not n.endswith(("penalty", "_y", "angle")))
    direct, adjoint = (
        sm.differentiate(result, names, None, method) for method in ("direct", "adjoint")
    )
    for measure in seal.standard:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        assert np.all(np.abs(one).max(axis=1) > 0.0)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10 * np.abs(one).max())
    for parameter, step in STEPS[name].items():
        column = direct.parameters.index(parameter)
        for measure, (quotient, bound) in quotients(seal, parameter, step).items():
            one = np.atleast_2d(direct[measure])[:, column]
            at = f"{measure} by {parameter}"
            assert np.all(np.abs(one - quotient) <= bound), (at, one, quotient, bound)
            # a quotient that says nothing proves nothing
            assert bound.max() <= 1e-4 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-2), at


def test_forces_are_those_of_the_potential_of_the_step(case, rng):
    """Also of the ring, whose moduli depend on its temperature."""
    require_potentials(case[-1], rng)


def test_pictures_show_the_stress_of_the_measures(case):
    """At the particles, after the first press, below it, and at the end of the path."""
    *_, result = case
    grid = fine_grid(result, divisions=1)
    for step in (1, 3, -1):
        shown, exact = np.sort(grid.von_mises(step)), np.sort(result.stress_field(step))
        np.testing.assert_allclose(shown, exact, rtol=1e-9, atol=1e-9 * exact.max())


def test_works_of_parts_of_the_path_add_up(case):
    name, _, result = case
    if name == "held":
        pytest.skip("no profile")
    profile = {"block": "lid", "ring": "plate"}[name]
    total, *parts = (
        result.value(ProfileWork(profile, stages=stages))[0]
        for stages in (None, (0, 1), (1, 3), (3, 4))
    )
    assert sum(parts) == pytest.approx(total, rel=1e-13)
    assert min(map(abs, parts)) > 0.01 * total


def test_the_first_loading_is_elastic_and_the_way_back_is_not(tmp_path):
    """To the bit where nothing has unloaded; every force of the release is smaller, and so is that of
    the next press up to its largest travel."""
    smooth = LID.replace("friction = 0.3", "friction = 0.0")
    stages = (
        "\nstage = [{ translate = [0, -0.5], steps = 5 }, { translate = [0, 0.3], steps = 3 },\n"
    )
    stages += "  { translate = [0, -0.5], steps = 5 }]\n"
    paths = [
        sm.analyze(exact_seal(tmp_path, softening(text(FIXED, smooth), law, stages))).path
        for law in (SOFTENING, "\n")
    ]
    soft, elastic = (np.array([path.reaction("lid")[:, 1]])[0] for path in paths)
    np.testing.assert_array_equal(soft[:5], elastic[:5])
    np.testing.assert_array_equal(paths[0].steps[4].d, paths[1].steps[4].d)
    # down again, up to the largest travel, and beyond
    assert np.all(soft[5:8] < 0.9 * elastic[5:8])
    np.testing.assert_allclose(soft[8:10], soft[[6, 5]], rtol=1e-9)
    np.testing.assert_allclose(soft[10:], elastic[10:], rtol=1e-9)


def test_work_of_stages_where_the_lid_turns_back(tmp_path):
    """At the turn half of the increments before and after cancel: the force there does no work, and has
    no seed in the adjoint method. The work has a scale for its errors, though the path is longer."""
    stages = (
        "\nstage = [{ translate = [0, -0.5], steps = 2 }, { translate = [0, 0.5], steps = 2 }]\n"
    )
    loss = '[[measure]]\ntype = "profile_work"\nstage = {}\n'
    # inclined: some points never touch
    lid = LID.replace("[[-9, 0], [9, 0]]", "[[-9, -0.9], [9, 0.9]]").replace("4.02", "4.45")
    for ends in ([0, 2], [1, 2]):
        given = softening(text(FIXED, lid, DESIGN, loss.format(ends)), stages=stages)
        result = sm.analyze(exact_seal(tmp_path, given), keep_factors=True)
        measure = next(own for own in result.measures() if own.name == "profile_work")
        direct, adjoint = (
            sm.differentiate(result, ("c10", "lid_friction"), [measure], method)[measure.name]
            for method in ("direct", "adjoint")
        )
        np.testing.assert_allclose(direct, adjoint, rtol=0.0, atol=1e-10 * np.abs(direct).max())
        # 1 % of the largest work since the first of the stages
        works = [abs(part.value(measure)[0]) for part in result.up_to_each_step()]
        assert len(works) == 4
        error = result.penalty_error[measure.name]
        assert error.scale == max(works[-1], SMALL * max(works))


def test_hysteresis_loss(tmp_path):
    """Of a first cycle the energy dissipated at all points, phi(0, W_max), with an error of order two in
    the steps; of a second cycle nothing."""
    smooth = LID.replace("friction = 0.3", "friction = 0.0").split("[[measure]]")[0]
    losses = '[[measure]]\ntype = "profile_work"\nname = "{}"\nstage = {}\n'
    errors = []
    for steps in (4, 8):
        stages = ", ".join(
            f"{{ translate = [0, {travel}], steps = {steps} }}" for travel in (-0.6, 0.6, -0.6, 0.6)
        )
        given = text(FIXED, smooth, losses.format("one", [0, 2]), losses.format("two", [2, 4]))
        result = sm.analyze(
            exact_seal(tmp_path, softening(given, SOFTENING, f"\nstage = [{stages}]\n"))
        )
        term = result.term("structure")
        largest = result.path.steps[-1].responses[term.index].history
        dissipated = step_potential(0.0 * largest, largest, *term.material_history.constants)
        dissipated = (term.cells.column_weights * dissipated).sum()
        assert abs(result.value("two")[0]) < 1e-9 * dissipated
        errors.append(abs(result.value("one")[0] / dissipated - 1.0))
    assert errors[1] < 0.35 * errors[0] < 0.05


def test_a_dwell_changes_nothing(tmp_path):
    """Neither forces nor derivatives, whichever branch rounding puts a point on."""
    moved = text(FIXED, MOVED, '[[measure]]\ntype = "reaction"\ncomponent = "y"\n')
    head = "stage = [{ translate = [0.3, -0.4], steps = 2 }, { translate = [-0.1, 0.2], steps = 2 }"
    found = []
    for more in ("", ", { translate = [0.0, 0.0], steps = 2 }, { translate = [0.1, -0.2], steps = 2 },"
                 " { translate = [-0.1, 0.2], steps = 2 }"):  # fmt: skip
        before, after = moved.split("stage = [", 1)
        given = softening(f"{before}{head}{more}]\n{after.split(']', 2)[2]}", stages="\n")
        result = sm.analyze(exact_seal(tmp_path, given), keep_factors=True)
        names = ("c10", "softening_r", "softening_m")
        found.append((result.value("reaction"), *(
            np.atleast_2d(sm.differentiate(result, names, None, method)["reaction"])
            for method in ("direct", "adjoint")
        )))  # fmt: skip
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-8)
    # measured at the end alone
    np.testing.assert_allclose(found[1][1], found[1][2], rtol=1e-10)


def test_heat_alone_does_not_soften(tmp_path):
    """The energy that counts has the moduli of the reference temperature: a held block that becomes
    softer by heat keeps its factor, but for the points whose strain changes by its compressibility."""
    moved = text(FIXED, MOVED, bulk=4e4).replace(
        "steps = 4 }", "steps = 2 }, { translate = [0.0, 0.0], steps = 2 }"
    )
    forces = [
        sm.analyze(
            exact_seal(
                tmp_path,
                softening(
                    moved, law + HOT.removeprefix(SOFTENING), "\n", "temperature = [23.0, 100.0]"
                ),
            )
        ).path.reaction("top")[:, 1]
        for law in (SOFTENING, "\n")
    ]
    assert forces[1][3] < 0.75 * forces[1][1]
    np.testing.assert_allclose(*forces, rtol=5e-3)


REFUSED = [
    (BLOCK, "r = 2.0", "r = 1.0", "softening: r = 1.0, but it must be a number above 1"),
    (BLOCK, "m = 2.0", "m = -2.0", "softening: m = -2.0, but it must be a number of at least 0"),
    (BLOCK, "beta = 0.1", "beta = -1", "softening: beta = -1, but it must be a number of at least 0"),
    (BLOCK, "m = 2.0, beta = 0.1", "m = 0.0", "both zero"),
    (BLOCK, "m = 2.0, beta = 0.1", "beta = 0.1",  "the key 'm' is missing"),
    (BLOCK, "m = 2.0", "m = 2.0, eta = 0.1", "eta"),
    (BLOCK, '"profile_work"\n[', '"strain_energy"\n[', "strain_energy is not available with softening"),
    (BLOCK, '"profile_work"\n[', '"friction_work"\n[', "profile_work over a closed cycle includes both"),
    (BLOCK, "beta = 0.1 }", "beta = 0.1 }\nviscoelastic = { g = [0.3], tau = [1.0] }",
     "Mullins softening cannot be combined with"),
    (BLOCK, "stage = [1, 3]", "stage = [1, 5]", r"stage = \[1, 5\], but the motion has only 4 stages"),
    (BLOCK, "stage = [1, 3]", "stage = [3, 1]", "the second after the first"),
    (foam(BLOCK), "beta", "beta", "this law is compressible"),
    (with_model(BLOCK, 'kinematics = "generalised_plane_strain"\naxial_stretch = 1.02'), "beta", "beta",
     "softening cannot be combined with axial_stretch"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "old", "new", "words"), REFUSED, ids=[own[3] for own in REFUSED])
def test_what_does_not_fit_is_refused(tmp_path, given, old, new, words):
    changed = given.replace(old, new)
    if "viscoelastic" in new:
        changed = changed.replace(", steps", ", duration = 1.0, steps")
    with pytest.raises(sm.SealFileError, match=words):
        read(tmp_path, changed)
