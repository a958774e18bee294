"""Progress bar over the load steps of an analysis, fed by its callback."""

import sys

from tqdm import tqdm

from seal_mdao.analysis.result import ConvergedStep
from seal_mdao.seals.seal import Seal


def hidden() -> bool | None:
    """What tqdm takes as ``disable``: None, which shows a bar on terminals only, but in Jupyter; True
    where standard error is closed."""
    if sys.stderr is None:
        return True
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return False if type(shell).__name__ == "ZMQInteractiveShell" else None


class LoadStepProgress:
    """A tqdm bar that counts load steps; hand it to ``analyze`` or ``SealGroup`` as ``callback``.

    The bar starts again with every new analysis and numbers them. It shows on a terminal and in
    Jupyter. Elsewhere it is silent, but for a line for every analysis that is announced by
    ``begin_analysis``.

    Parameters
    ----------
    seal : Seal or None
        Gives the number of load steps; None where that is not the same in all analyses.
    label : str
        What the bar says before the number of the analysis.
    n_analyses : int, optional
        How many analyses there will be, when that is known.

    Attributes
    ----------
    analyses : int
        Analyses that have begun.
    """

    def __init__(self, seal: Seal | None, label: str = "analysis", n_analyses: int | None = None):
        self.analyses = 0
        self._label, self._of = label, "" if n_analyses is None else f"/{n_analyses}"
        total = None if seal is None else seal.n_steps
        self._bar = tqdm(total=total, unit="step", disable=hidden(), leave=False)
        self._last, self._damped = None, False

    def __call__(self, step: ConvergedStep) -> None:
        """Note one completed load step."""
        if self._last is None or step.nominal <= self._last:
            self.analyses += 1
            self._bar.reset()
            self._bar.set_description(f"{self._label} {self.analyses}{self._of}", refresh=False)
        if self._damped:
            self._damped = False
            self._bar.set_postfix_str("", refresh=False)
        self._last = step.nominal
        self._bar.update(step.nominal + 1 - self._bar.n)

    def begin_analysis(self, number: int, of: int, n_steps: int) -> None:
        """Announce an analysis of a row that has at least ``of`` of them, in ``n_steps`` load steps."""
        self._of, self._bar.total = f" of {of}", n_steps
        if self._bar.disable:
            print(f"{self._label}, {number} of {of} ...", file=sys.stderr, flush=True)

    def damped(self, iteration: int, residual: float) -> None:
        """Note an iteration of damped motion, which may take thousands of them within a step."""
        if iteration % 50 == 0:
            self._damped = True
            self._bar.set_postfix_str(f"damped motion {iteration}, residual {residual:.1e}")

    def close(self) -> None:
        """Remove the bar."""
        self._bar.close()

    def __enter__(self) -> "LoadStepProgress":
        return self

    def __exit__(self, *exception) -> None:
        self.close()
