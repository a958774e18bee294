"""The laws and the published forms of ``tests/materials`` are used here, too."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[1] / "materials"))


@pytest.fixture(scope="session")
def treloar():
    from seal_mdao.calibration.treloar import treloar_tests

    return treloar_tests()
