"""A look at what the scripts draw, and an optimisation that several tests look at."""

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from script_runs import CHEAP

from seal_mdao.seals import result as analyses


@pytest.fixture(scope="session")
def assert_drawn():
    """Assert that PNG files exist and show something."""

    def check(folder, *names):
        for name in names:
            picture = matplotlib.image.imread(Path(folder) / f"{name}.png")[..., :3]
            assert min(picture.shape[:2]) > 300
            looked_at = picture[::3, ::3].reshape(-1, 3)
            assert 0.01 < np.mean(np.any(looked_at < 0.97, axis=1)) < 0.9
            assert len({*map(bytes, (255.0 * looked_at).astype(np.uint8))}) > 20

    return check


@pytest.fixture(scope="session")
def counted_optimisation(run_script, tmp_path_factory):
    """One optimisation of the cheap variant, and the bodies and doors of which a path was solved."""
    out, solved, real = tmp_path_factory.mktemp("optimised"), [], analyses.solve_path

    def solve_path(problem, *more):
        door = problem.term("door")
        solved.append((problem.discretization.particles.tobytes(), repr(door.profile)))
        return real(problem, *more)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(analyses, "solve_path", solve_path)
        ended = run_script("optimize_door_seal", out, *CHEAP)
    return (out, *ended), solved


@pytest.fixture(scope="session")
def optimised(counted_optimisation):
    """One optimisation of the cheap variant: folder, exit code, summary."""
    return counted_optimisation[0]
