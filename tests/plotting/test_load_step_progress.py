"""The progress bar counts load steps and analyses, and is silent without a terminal."""

import io
import sys
from types import SimpleNamespace

import pytest
import tqdm

import seal_mdao as sm
from seal_mdao.progress import LoadStepProgress


@pytest.fixture
def quick():
    return sm.door_seal(depth=1.0, n_steps=3)


def test_counts_analyses_and_stays_silent(quick, capsys):
    with LoadStepProgress(quick) as progress:
        sm.analyze(quick, callback=progress)
        sm.analyze(quick, callback=progress)
    assert progress.analyses == 2
    captured = capsys.readouterr()
    assert captured.err == captured.out == ""


def test_bar_reaches_the_last_step_and_starts_again(quick, monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    real = tqdm.tqdm
    monkeypatch.setattr(
        "seal_mdao.progress.tqdm", lambda **options: real(file=terminal, mininterval=0, **options)
    )
    with LoadStepProgress(quick, n_analyses=2) as progress:
        sm.analyze(quick, callback=progress)
        assert "3/3" in terminal.getvalue()
        assert "analysis 1/2" in terminal.getvalue()
        sm.analyze(quick, callback=progress)
        assert "analysis 2/2" in terminal.getvalue()


def test_bar_shows_in_jupyter(quick, monkeypatch, capsys):
    """Where standard error is no terminal."""

    class ZMQInteractiveShell:
        """What Jupyter's kernels have."""

    notebook = SimpleNamespace(get_ipython=ZMQInteractiveShell)
    monkeypatch.setitem(sys.modules, "IPython", notebook)
    with LoadStepProgress(quick) as progress:
        sm.analyze(quick, callback=progress)
        progress._bar.refresh()
    assert "analysis 1" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    with LoadStepProgress(quick) as progress:
        sm.analyze(quick, callback=progress)
    assert capsys.readouterr().err == ""
