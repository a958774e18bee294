"""Fixtures for the driver tests: a fresh working directory, and both drivers."""

from __future__ import annotations

import pytest

from seal_mdao.drivers.ipopt_driver import IpoptDriver
from seal_mdao.drivers.slsqp_driver import ResilientSLSQPDriver


@pytest.fixture(autouse=True)
def _own_directory(tmp_path, monkeypatch):
    """Run every test in a directory of its own, so that no output files are left behind."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_WORKDIR", str(tmp_path))


@pytest.fixture(params=["ipopt", "slsqp"])
def make_driver(request):
    """Return a function that makes one of the two drivers with tight tolerances."""
    if request.param == "ipopt":
        pytest.importorskip("ipyopt")
        return lambda **options: IpoptDriver(**{"tol": 1e-8, **options})
    return lambda **options: ResilientSLSQPDriver(**{"tol": 1e-10, "disp": False, **options})
