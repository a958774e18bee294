"""Fixtures for the driver tests: a fresh working directory, and the drivers."""

from __future__ import annotations

import pytest

import seal_mdao as sm

DRIVERS = {"uno": sm.UnoDriver, "ipopt": sm.IpoptDriver}


@pytest.fixture(autouse=True)
def _own_directory(tmp_path, monkeypatch):
    """Run every test in a directory of its own, so that no output files are left behind."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_WORKDIR", str(tmp_path))


@pytest.fixture(params=DRIVERS)
def make_driver(request):
    """Return a function that makes one of the two drivers with tight tolerances and long steps."""
    defaults = {"tol": 1e-8, "feas_tol": 1e-8}
    if request.param == "uno":
        defaults["trust_radius"] = 10.0
    return lambda **options: DRIVERS[request.param](**{**defaults, **options})
