"""Recorded evaluations by design, for a driver that repeats an earlier run.

A gradient-based optimiser with a deterministic model takes the same steps every time. Given the
recorded values and derivatives at the recorded designs, it reaches the last recorded point at once, with
its full state (approximation of the Hessian, multipliers, line search), and continues from there. A
design counts as recorded only if all its bits agree; any other one is analysed.
"""

import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from openmdao.core.analysis_error import AnalysisError

from seal_mdao import openmdao_access as access
from seal_mdao.recording.plain_reading import reading
from seal_mdao.recording.recorder_file import Case, read_driver_cases, read_totals

UNFINISHED = "unfinished"
"""Start of the message of a case that Ctrl-C or an error interrupted; it has no result."""
AGREEMENT = 1e-6
"""Relative difference up to which the start, analysed again, agrees with the recorded one."""


class RestartError(ValueError):
    """A recorder file from which this run cannot be continued."""


class RecordedEvaluations:
    """Cases of the last run of a driver in a recorder file, found by the design that is in the model.

    Parameters
    ----------
    path : str or Path
    driver : Driver
        After its final setup.

    Attributes
    ----------
    next_iteration : int
        Number after that of the last recorded driver iteration.

    Raises
    ------
    RestartError
        If the file cannot be read, or its cases lack variables of the driver.
    RuntimeError
        On several processes.
    """

    def __init__(self, path, driver):
        self._model = access.problem_of(driver).model
        if self._model.comm.size > 1:
            raise RuntimeError(
                "hotstart_file: an optimisation can be continued on a single process only, not "
                f"under MPI with {self._model.comm.size}"
            )
        self.path = Path(path)
        self._afterwards = access.run_afterwards(driver)
        cases = read_cases(self.path)
        # a continued run numbers its iterations from here
        self.next_iteration = 1 + max((number for number, _ in cases), default=-1)
        cases = _of_last_run(cases)
        # the design: design variables, and all other recorded values that the model takes as given
        sources = access.sources(driver)
        given = access.independent_outputs(driver).intersection(
            cases[0][1].outputs if cases else ()
        )
        self._sources = sorted(
            given.union(sources[name] for name in driver.get_design_var_values())
        )
        # only cases with all variables of the driver replace an analysis
        needed = {*sources.values(), *self._sources}
        finished = [case for _, case in cases if not case.failure.startswith(UNFINISHED)]
        self._by_design: dict[bytes, Case] = {}
        self._last = b""
        for case in finished:
            if case.outputs.keys() >= needed and _fits(case, self._model):
                # the first case of a design, with the first derivatives recorded there
                key = _key(case.outputs[name] for name in self._sources)
                known = self._by_design.setdefault(key, case)
                known.totals = known.totals or case.totals
                if not case.failure:
                    self._last = key
        if finished and not self._by_design:
            raise RestartError(
                f"no case in {path} contains all design variables, the objective and the "
                "constraints of this problem; give the recorder file of this problem"
            )

    def __len__(self) -> int:
        return len(self._by_design)

    def find(self) -> Case | None:
        """Return the recorded evaluation of the design that is in the model."""
        return self._by_design.get(_key(self._design()))

    def cases(self) -> list[Case]:
        """Return the recorded evaluations that did not fail, one for each design."""
        return [case for case in self._by_design.values() if not case.failure]

    def note_recorded(self) -> None:
        """Note that the design in the model has been recorded after all others."""
        self._last = _key(self._design())

    def ends_here(self) -> bool:
        """Return whether the last recorded design with values is the one in the model."""
        return _key(self._design()) == self._last

    def restore(self, case: Case) -> None:
        """Set the recorded values in the model.

        Raises
        ------
        AnalysisError
            If the recorded analysis failed.
        """
        if case.failure:
            raise AnalysisError(case.failure)
        for _, here, value in _recorded_and_present(case, self._model):
            here[:] = value

    def load_start(self) -> None:
        """Set the first recorded design in the model."""
        for case in itertools.islice(self._by_design.values(), 1):
            self.load_design(case)

    def load_design(self, case: Case) -> None:
        """Set the recorded design of a case in the model, bit by bit."""
        for name, here in zip(self._sources, self._design(), strict=True):
            here[:] = case.outputs[name].ravel()

    def check_start(self) -> None:
        """Check that the start, analysed again, is that of the recorded run.

        Raises
        ------
        RestartError
            If it is not in the file, or the model has other outputs there.
        """
        if not self._by_design:
            return
        recorded = self.find()
        if recorded is None:
            raise RestartError(
                "the initial values of the design variables differ from those recorded in "
                f"{self.path}; set the recorded initial values with seal_mdao.restart(problem, "
                "path)"
            )
        for name, here, value in _recorded_and_present(recorded, self._model):
            # components that run only after an optimisation may have been run before one of the two
            if name not in recorded.outputs or name.rpartition(".")[0] in self._afterwards:
                continue
            # max |y - y_recorded| <= 1e-6 max |y_recorded|, false for NaN
            scale = np.abs(value).max(initial=0.0)
            if not np.abs(here - value).max(initial=0.0) <= AGREEMENT * scale:
                raise RestartError(
                    f"{self.path} was recorded with another model: at the initial design, this "
                    f"model gives another value of {name}; restart with the recorded model, or "
                    "begin a new run"
                )

    def _design(self) -> list[np.ndarray]:
        outputs = self._model.get_nonlinear_vectors()[1]
        return [access.find_value(outputs, name) for name in self._sources]


def recorded_jacobian(case: Case, of, wrt) -> np.ndarray | None:
    """Assemble rows of all ``of`` over columns of all ``wrt``; None if one was not recorded."""
    # J = [d of / d wrt] in blocks
    if not case.totals.keys() >= {f"{o}!{w}" for o in of for w in wrt}:
        return None
    return np.vstack([np.hstack([case.totals[f"{o}!{w}"] for w in wrt]) for o in of])


def _recorded_and_present(case: Case, model) -> Iterator[tuple]:
    """Yield name, view in the model and recorded value, both flat, of variables that are in both."""
    inputs, outputs, _ = model.get_nonlinear_vectors()
    for vector, values in ((inputs, case.inputs), (outputs, case.outputs)):
        for name, value in values.items():
            here = access.find_value(vector, name)
            if here is not None:
                yield name, here, value.ravel()


def _fits(case: Case, model) -> bool:
    """Return whether the recorded values have the sizes of the model's variables."""
    return all(here.size == value.size for _, here, value in _recorded_and_present(case, model))


def _key(values) -> bytes:
    # the bits of all values in a fixed order
    return b"".join(np.ascontiguousarray(value, float).tobytes() for value in values)


def _of_last_run(cases: list[tuple[int, Case]]) -> list[tuple[int, Case]]:
    """Return the cases of the last run: every call of ``run_driver`` begins with iteration 0, but the
    first new iteration of a continued run has the number after the last one."""
    starts = [index for index, (number, _) in enumerate(cases) if number == 0]
    return cases[starts[-1] :] if starts else cases


def read_cases(path) -> list[tuple[int, Case]]:
    """Read driver iteration number and evaluation of every case of a driver, with its derivatives.

    Raises
    ------
    RestartError
        For a file that does not exist, is no recorder file, or is damaged.
    """
    try:
        with reading(path) as database:
            # derivatives and cases are in different tables
            totals, cases = read_totals(database), read_driver_cases(database)
    except ValueError as error:
        raise RestartError(str(error)) from error
    for _, case in cases:
        case.totals = totals.get(case.counter, {})
    return cases
