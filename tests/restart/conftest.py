"""Temporary folders, and each driver in turn."""

import pytest

import seal_mdao as sm

DRIVERS = {"UNO": sm.UnoDriver, "IPOPT": sm.IpoptDriver}


@pytest.fixture(autouse=True)
def in_own_folder(tmp_path, monkeypatch):
    """OpenMDAO writes its folders here."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(params=sorted(DRIVERS))
def make_driver(request):
    """One driver class after the other, quiet."""
    return lambda **options: DRIVERS[request.param](disp=False, **options)
