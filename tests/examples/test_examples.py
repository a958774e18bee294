"""The worked examples: coarse ones quickly, the files themselves as long tests."""

import re
from pathlib import Path

import numpy as np
import pytest
from verification.example_optima import optimum, stored

import seal_mdao as sm
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.result import frozen_measures

EXAMPLES = Path(__file__).parents[2] / "examples"
FILES = sorted(EXAMPLES.glob("*.toml"))
NAMES = [path.stem for path in FILES]
TEXTS = {path: path.read_text(encoding="utf-8") for path in FILES}
OPTIMISED = [path for path in FILES if "[optimize]" in TEXTS[path]]
QUICK = ("d_bulb", "lip", "two_holes")
LARGEST = "car_door_seal"
OPTIMISED_AGAIN = ("d_bulb", "lip", "paper_seal", "sealed_bulb", "vented_bulb")
"""Of the optima those that do not wait for a release."""
AGAIN = "d_bulb"
"""Optimised once more from its nominal section; the others take ten minutes to half an hour."""
RELAXING = "aged_o_ring"
"""At rest, friction and pressure relax in one proportion, so points stay at the limit of sliding to the
last bits. Derivatives for stick and for slip are the same there."""


def marks(name: str) -> list:
    """Marks of a coarse example."""
    kink = pytest.mark.filterwarnings("ignore::seal_mdao.errors.KinkWarning")
    return [pytest.mark.long] * (name not in QUICK) + [kink] * (name == RELAXING)


# the others that are optimised are tested as they are
COARSE = [
    pytest.param(path, id=path.stem, marks=marks(path.stem))
    for path in FILES
    if path.stem in (*QUICK, LARGEST) or path not in OPTIMISED
]
SHARE = 8
"""Of the load steps and of the travel that a coarse example has."""
STEPS = (4e-4, 1e-4, 2e-5, 5e-6)
"""Of quotients of fourth order: relative to constants; the last three in mm along design parameters,
over which measures are less linear. The largest with the same contact states is taken, and a smaller
one where its error of truncation is too large: it falls with the fourth power of the step (the contact
width of ``d_bulb``: 2.5e-5 of the derivative at 1e-4 mm, 7e-8 at 2e-5 mm)."""


def coarse(path):
    """The text of an example with few particles and the first part of every stage."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"spacing = ([\d.]+)", lambda m: f"spacing = {1.4 * float(m[1]):.3f}", text)
    # measures at a travel: at the same fraction of it
    text = re.sub(r"(?m)^travel = ([\d.]+)$", lambda m: f"travel = {float(m[1]) / SHARE!r}", text)

    def stage(match):
        x, y, steps = float(match[1]), float(match[2]), match[3] and float(match[3])
        few = max(1, round(steps / SHARE)) if steps else None
        share = few / steps if steps else 1.0 / SHARE
        short = f"translate = [{x * share!r}, {y * share!r}]"
        return f"{short}\nsteps = {few}" if steps else short

    return beside(re.sub(r"(?m)^translate = \[(.*), (.*)\]$(?:\nsteps = (\d+))?", stage, text))


def beside(text):
    """With the files beside the examples by their whole paths.

    The paper's door touches the top of its seal at the very end of a step, where a point is neither open
    nor closed: there is no derivative in the shape of the top. It starts a little higher.
    """
    text = text.replace("start = [0.0, 10.0]", "start = [0.0, 10.003]")
    return re.sub(r'"([\w]+\.(?:dxf|csv))"', lambda m: f'"{EXAMPLES.as_posix()}/{m[1]}"', text)


def states(result):
    """Stick, slip and open points of all profiles at all steps."""
    return np.hstack([
        [response.branch for response in result.path.responses(term.label)]
        for term in result.seal.terms()[1:]
    ])  # fmt: skip


def gradients_agree(seal, base=0.0, limit=1e-6):
    """Every measure's derivative along the design parameters together, and along the constants.

    Apart, since along both an error in a constant would be small beside what the shape does.
    """
    names, base = tuple(seal.scalars), np.broadcast_to(base, seal.n_offsets)
    result = sm.analyze(seal, base, keep_factors=True)
    assert result.converged, result.failure
    assert states(result).any(axis=0).sum() > 0, "nothing is touched"
    measures = result.measures()
    sensitivities = sm.differentiate(result, names, measures, "adjoint")
    values = np.array([scalar.value for scalar in seal.scalars.values()])
    # gaps are known to eps times the coordinates, forces to the penalty times that
    problem = result.path.problem
    acting = max(
        np.linalg.norm(response.total)
        for step in result.path.steps
        for response in step.responses[1:]
    )
    relative = max(10.0 * np.finfo(float).eps, problem.rounding / acting)
    rng = np.random.default_rng(1)
    for offsets in {0.0, 1.0 if seal.n_offsets else 0.0}:
        way = rng.uniform(-1.0, 1.0, seal.n_offsets + len(names))
        way[: seal.n_offsets] *= offsets
        way[seal.n_offsets :] *= values * (offsets == 0.0)

        def at(distance, way=way):
            return sm.analyze(
                seal, base + distance * way[: seal.n_offsets],
                dict(zip(names, values + distance * way[seal.n_offsets :], strict=True)),
            )  # fmt: skip

        left = list(measures)
        for step in STEPS[1:] if offsets else STEPS:
            # the outer two first: where they have other contacts the inner two are of no use
            outer = [at(side * 2.0 * step) for side in (-1, 1)]
            if not all(np.array_equal(states(m), states(result)) for m in outer):
                continue
            moved = [outer[0], at(-step), at(step), outer[1]]
            assert all(np.array_equal(states(m), states(result)) for m in moved)
            wrong = []
            for measure in left:
                found = np.array([m.value(measure) for m in moved])
                quotient = np.array([1.0, -8.0, 8.0, -1.0]) @ found / (12.0 * step)
                exact = np.atleast_2d(sensitivities[measure.name])
                size = np.abs(exact * np.where(way == 0.0, 0.0, np.abs(way))).sum(axis=1).max()
                # the weights of the quotient, 1, 8, 8, 1 twelfths, add up to 1.5
                rounding = 1.5 * relative * np.abs(found).max() / step
                if not np.abs(quotient - exact @ way).max() <= limit * size + rounding:
                    wrong.append(measure)
            # a smaller step for those whose error of truncation may be too large
            left = wrong
            if not left:
                break
        assert not left, [measure.name for measure in left]


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_examples_are_short_and_say_what_they_are(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 60
    assert lines[0].startswith("# ")
    file = sm.read_seal_file(path)
    assert file.measures
    assert file.designs


@pytest.mark.parametrize("path", COARSE)
def test_gradients_of_coarse_examples(path, tmp_path):
    (tmp_path / path.name).write_text(coarse(path), encoding="utf-8")
    gradients_agree(sm.build_seal(sm.read_seal_file(tmp_path / path.name)))


def test_the_lip_that_slips_off_releases_what_it_stored():
    """All of it, in one jump; the load step with it is cut to its 32nd part, so the bound is 1 %."""
    result = sm.analyze(sm.build_seal(sm.read_seal_file(EXAMPLES / "slipping_lip.toml")))
    assert result.converged, result.failure
    (jump,) = result.critical_points
    assert jump.kind == "limit"
    before = max(
        (s for s in result.path.steps if s.fraction <= jump.fraction), key=lambda s: s.fraction
    )
    assert jump.fraction - before.fraction <= 1.0 / 32.0
    rod = result.term("rod")
    inside = np.minimum(result.response("rod", before).gap, 0.0)
    stored = result.term("structure").energy(before.d, before.fraction)
    stored += 0.5 * rod.law.normal_penalty * float(rod.length @ inside**2)
    assert jump.released == pytest.approx(stored, rel=1e-2)
    assert stored > 10.0
    assert np.abs(result.displacement()).max() < 1e-8
    assert np.abs(result.path.reaction("rod")[-1]).max() == 0.0


@pytest.mark.long
@pytest.mark.parametrize(
    "path", [path for path in OPTIMISED if path.stem != LARGEST], ids=lambda path: path.stem
)
def test_gradients_of_the_examples(path, tmp_path):
    """Beside the nominal sections: where one is symmetric, a point may stand between stick and slip."""
    (tmp_path / path.name).write_text(beside(path.read_text(encoding="utf-8")), encoding="utf-8")
    seal = sm.build_seal(sm.read_seal_file(tmp_path / path.name))
    gradients_agree(seal, np.random.default_rng(2).uniform(-0.02, 0.02, seal.n_offsets))


@pytest.mark.filterwarnings("ignore::seal_mdao.errors.KinkWarning")
@pytest.mark.parametrize(
    "path",
    [
        pytest.param(
            path,
            id=path.stem,
            marks=pytest.mark.long if path.stem in OPTIMISED_AGAIN else pytest.mark.release,
        )
        for path in OPTIMISED
    ],
)
def test_optima_of_the_examples(path, tmp_path):
    """Feasible KKT points as the page shows them, the same when read from their own files; designs on
    the way there may be at a kink of contact."""
    file = sm.read_seal_file(path)
    seal, known = sm.build_seal(file), stored()[path.stem]
    offsets = np.array(known["offsets"])
    # begun at the stored design, an optimiser finds a better one unless that is an optimum
    found = optimum(path.stem, None if path.stem == AGAIN else offsets)
    # the page shows four digits of the objective
    assert found["before"] == pytest.approx(known["before"], rel=5e-5)
    assert found["after"] == pytest.approx(known["after"], rel=5e-4, abs=1e-4 * known["before"])
    nominal, best = sm.analyze(seal), sm.analyze(seal, offsets)
    measures = {measure.name: measure for measure in frozen_measures(seal)}
    aim = measures[file.optimize.minimize]
    value = best.value(aim)[0]
    assert value == pytest.approx(known["after"], rel=1e-6, abs=1e-9 * known["before"])
    assert value < nominal.value(aim)[0]
    # examples whose walls are coarse say so, and paths with creases, a contact about to part or few
    # points in contact that
    others = "penalties", "creases", "peak pressure", "contact width"
    warned = tuple(text for text in best.warnings if not any(word in text for word in others))
    assert warned == seal.warnings
    written = write_design(file, seal, offsets, measures.values(), tmp_path, "optimum")[0]
    again = sm.analyze(sm.build_seal(sm.read_seal_file(written)))
    for measure in again.measures():
        old = measures[measure.name]
        assert again.value(measure) == pytest.approx(best.value(old), rel=1e-6)
