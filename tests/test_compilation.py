"""What a user sees while the kernels are compiled."""

import os
import subprocess
import sys

from seal_mdao.compilation import MESSAGE

ANALYSIS = "import seal_mdao as sm; print(sm.analyze(sm.door_seal(depth=0.2, n_steps=4)).converged)"


def test_the_first_analysis_says_once_that_it_compiles_and_a_later_one_does_not(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    said = []
    for _ in range(2):
        run = subprocess.run(
            [sys.executable, "-c", ANALYSIS], env=environment, capture_output=True, text=True,
            check=True,
        )  # fmt: skip
        assert run.stdout.split() == ["True"]
        said.append(run.stderr.count(MESSAGE))
    assert said == [1, 0]
