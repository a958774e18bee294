"""Fixtures for the component tests: a directory of their own, a shorter path."""

import openmdao.api as om
import pytest

import seal_mdao as sm


@pytest.fixture(autouse=True)
def _own_directory(tmp_path, monkeypatch):
    """Run every test in a directory of its own, so that no output files are left behind."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_WORKDIR", str(tmp_path))


@pytest.fixture(scope="session")
def short():
    """A path of 25 larger steps with open points between two patches at its end."""
    newton = sm.NewtonOptions(tolerance=1e-11)
    return sm.door_seal(depth=7.0, n_steps=25, start=10.03, newton=newton)


@pytest.fixture
def problem():
    """A function that makes a set-up problem of one system with everything promoted."""

    def make(system, **values):
        made = om.Problem(reports=None)
        made.model.add_subsystem("seal", system, promotes=["*"])
        made.setup()
        for name, value in values.items():
            made.set_val(name, value)
        return made

    return make
