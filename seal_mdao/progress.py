"""Progress bar over the load steps of an analysis, fed by its callback."""

import sys
import threading
import time

from tqdm import tqdm

from seal_mdao.analysis.cost import duration
from seal_mdao.analysis.path_result import ConvergedStep
from seal_mdao.seals.seal import Seal
from seal_mdao.values import without_numbers


def hidden() -> bool | None:
    """Return the option ``disable`` of tqdm: None (a bar on terminals only), False in Jupyter, True
    where standard error is closed."""
    if sys.stderr is None:
        return True
    # IPython is looked up, not imported: without it there is no notebook
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return False if type(shell).__name__ == "ZMQInteractiveShell" else None


INTERVAL = 10.0
"""Seconds between two lines of progress where no bar is shown."""


BAR = "{l_bar}{bar}| {n_fmt}/{total_fmt} [{elapsed}{postfix}]"
"""Bar of load steps; the time left is in its postfix."""


class Waiting:
    """Print a line every ten seconds on standard error during work without countable steps.

    A context manager; its lines give the time since it was entered.

    Parameters
    ----------
    text : str
        What is being done.
    """

    def __init__(self, text: str):
        self._text, self._ended, self._thread = text, threading.Event(), None

    def __enter__(self) -> "Waiting":
        if sys.stderr is not None:
            # a thread: the work itself is one call
            self._thread = threading.Thread(target=self._lines, daemon=True)
            self._thread.start()
        return self

    def _lines(self) -> None:
        begun = time.monotonic()
        while not self._ended.wait(INTERVAL):
            line = f"{self._text}: {time.monotonic() - begun:.0f} s ..."
            # above a bar, where there is one
            tqdm.write(line, file=sys.stderr)

    def end(self) -> None:
        """End the lines; a second call does nothing."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def __exit__(self, *exception) -> None:
        self.end()


class LoadStepProgress:
    """Progress bar (tqdm) over load steps; pass it to ``analyze`` or ``SealGroup`` as ``callback``.

    The bar restarts with every analysis and counts them. It is shown on a terminal and in Jupyter;
    elsewhere a line is printed every ten seconds, and by ``begin_analysis``. The time left is that
    used so far, multiplied by the ratio of the load steps left to those completed.

    Parameters
    ----------
    seal : Seal or None
        Gives the number of load steps; None where that differs between analyses.
    label : str
        Text before the number of the analysis.
    n_analyses : int, optional
        Number of analyses, if known.

    Attributes
    ----------
    analyses : int
        Number of analyses begun.
    """

    def __init__(self, seal: Seal | None, label: str = "analysis", n_analyses: int | None = None):
        self.analyses, self._told = 0, set()
        self._label, self._of = label, "" if n_analyses is None else f"/{n_analyses}"
        total = None if seal is None else seal.n_steps
        self._bar = tqdm(
            total=total, unit="step", disable=hidden(), leave=False, bar_format=BAR
        )  # fmt: skip
        self._last, self._printed, self._announced = None, time.monotonic(), False
        # start of the time that is measured, load steps of the analyses since, analyses left
        self._begun, self._steps_before, self._left = self._printed, 0, 0
        # shape functions are made before the first load step
        self._before = Waiting(f"{label}: computing shape functions")

    def __call__(self, step: ConvergedStep) -> None:
        """Advance the bar by one completed load step."""
        self._before.end()
        # step numbers that do not increase begin a new analysis
        if self._announced or self._last is None or step.nominal <= self._last:
            if self._left and not self._announced:
                # the load steps of an analysis that follows the announced ones are not known
                self._of, self._bar.total, self._left = "", None, 0
            self._announced = False
            self.analyses += 1
            self._bar.reset()
            self._bar.set_description(f"{self._label} {self.analyses}{self._of}", refresh=False)
            if not self._left:
                # an analysis that was not announced is measured from the end of its first step on
                self._begun, self._steps_before = time.monotonic(), -(step.nominal + 1)
        self._last = step.nominal
        left = self._time_left(step.nominal + 1)
        self._bar.set_postfix_str(left, refresh=False)
        # nominal steps count from 0; the bar advances by the difference to what it shows
        self._bar.update(step.nominal + 1 - self._bar.n)
        self._print_line(step.nominal + 1, left)

    def halved(self, fraction: float) -> None:
        """Estimate the time left again where a load step is halved after ``fraction`` load steps."""
        begun = self._last is not None and fraction > self._last
        left = self._time_left(fraction) if begun else ""
        self._bar.set_postfix_str(left)
        if begun:
            self._print_line(int(fraction) + 1, left)

    def _time_left(self, fraction: float) -> str:
        """Write the time left after ``fraction`` load steps of an analysis; empty where unknown."""
        done, steps = self._steps_before + fraction, self._bar.total
        if not steps or done <= 0.0:
            return ""
        # t_left = t / n_done n_left, with n steps of every analysis that is left
        left = steps * max(self._left, 1) - fraction
        return f"about {duration((time.monotonic() - self._begun) / done * left)} left"

    def _print_line(self, number: int, left: str) -> None:
        """Print a line for load step ``number`` every ten seconds where no bar is shown."""
        if self._bar.disable and sys.stderr and time.monotonic() - self._printed >= INTERVAL:
            self._printed = time.monotonic()
            of = f" of {self._bar.total}" if self._bar.total else ""
            name = f"{self._label} {self.analyses}{self._of}"
            ending = f", {left}" if left else ""
            print(f"{name}: load step {number}{of}{ending}", file=sys.stderr, flush=True)

    def begin(self, label: str) -> None:
        """Change the text before the number of the analysis; analyses and times are counted anew."""
        self._label, self._of = label, ""
        self.analyses, self._steps_before, self._left, self._last = 0, 0, 0, None
        self._announced = False

    def begin_analysis(self, number: int, of: int, n_steps: int) -> None:
        """Announce analysis ``number`` of at least ``of``, with ``n_steps`` load steps, and the time
        left by the measured time of those before."""
        if self._left:
            self._steps_before += self._bar.total
        else:
            self._begun, self._steps_before = time.monotonic(), 0
        self._of, self._bar.total, self._left = f" of {of}", n_steps, of - number + 1
        self._announced = True
        left = self._time_left(0)
        if self._bar.disable:
            ending = f", {left}" if left else ""
            print(f"{self._label}, {number} of {of}{ending} ...", file=sys.stderr, flush=True)
        else:
            self._bar.set_postfix_str(left)

    def faults(self, messages: list[str]) -> None:
        """Print what is impossible in the last result, each message once."""
        for text in messages:
            # numbers in the messages differ between analyses
            kind = without_numbers(text)
            if kind not in self._told:
                self._told.add(kind)
                tqdm.write(f"{self._label}, first results: {text}", file=sys.stderr)

    def damped(self, iteration: int, residual: float) -> None:
        """Show an iteration of damped motion, which may take thousands of them within a step."""
        if iteration % 50 == 0:
            self._bar.set_postfix_str(f"damped motion {iteration}, residual {residual:.1e}")

    def close(self) -> None:
        """Remove the bar."""
        self._before.end()
        self._bar.close()

    def __enter__(self) -> "LoadStepProgress":
        self._before.__enter__()
        return self

    def __exit__(self, *exception) -> None:
        self.close()


class SampleProgress:
    """Progress over samples or scenarios; pass it as ``callback`` of a study or of ``ScenarioGroup``.

    A bar with the time left on a terminal and in Jupyter; elsewhere a line every ten seconds. It starts
    again when all have finished: the next evaluation of the same scenarios.

    Parameters
    ----------
    total : int
        Number of samples.
    label : str
    finished : int
        Samples with results of an earlier run.
    """

    def __init__(self, total: int, label: str, finished: int = 0):
        self._total, self._label, self._runs = total, label, 0
        self._bar = tqdm(
            total=total, desc=label, initial=finished, unit="sample", disable=hidden(), leave=False
        )
        self._done, self._printed = finished, time.monotonic()
        self._begin(finished)

    def __call__(self, number: int, outcome) -> None:
        """Count one finished sample; a ``failure`` of its outcome is counted, too."""
        if self._done == self._total:
            self._done, self._runs = 0, self._runs + 1
            self._bar.reset()
            # the first sample of the next evaluation has finished already
            self._begin(1)
        self._done, self._failed = self._done + 1, self._failed + bool(outcome.failure)
        self._bar.update()
        now = time.monotonic()
        if self._bar.disable and sys.stderr and now - self._printed >= INTERVAL:
            self._printed = now
            print(self._line(now), file=sys.stderr, flush=True)

    def _begin(self, first: int) -> None:
        self._first, self._failed, self._begun = first, 0, time.monotonic()

    def _line(self, now: float) -> str:
        """Write the line: samples done, failures, time left."""
        # t_left = t / n (N - n_done)
        counted = self._done - self._first
        left = (now - self._begun) / counted * (self._total - self._done) if counted else None
        label = f"{self._label}, evaluation {self._runs + 1}" if self._runs else self._label
        failed = f", {self._failed} failed" if self._failed else ""
        ending = "" if left is None else f", {left / 60.0:.1f} min left"
        return f"{label}: {self._done} of {self._total} samples{failed}{ending}"

    def close(self) -> None:
        """Remove the bar."""
        self._bar.close()

    def __enter__(self) -> "SampleProgress":
        return self

    def __exit__(self, *exception) -> None:
        self.close()
