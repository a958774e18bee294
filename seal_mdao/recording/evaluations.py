"""What an earlier run found out, by design, for a driver that goes through it again.

A gradient-based optimiser with a deterministic model takes the same steps every time. Given the
recorded values and derivatives at the recorded designs, it is at the last recorded point within
moments, with everything it has learnt on the way (the approximation of the Hessian, multipliers, the
state of the line search), and goes on from there. A design counts as recorded only when all its
bits agree; any other one is analysed.
"""

import itertools
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from openmdao.core.analysis_error import AnalysisError

from seal_mdao import openmdao_access as access
from seal_mdao.recording.plain_reading import PlainDatabase, fields, reading
from seal_mdao.recording.recorder_file import Case, read_driver_cases

UNFINISHED = "unfinished"
"""How the message of a case begins that Ctrl-C or an error cut off: it tells nothing of the design."""
AGREEMENT = 1e-6
"""Relative difference up to which the start, analysed again, counts as the recorded one."""


class RestartError(ValueError):
    """A recorder file from which this run cannot be continued."""


@dataclass(eq=False)
class RecordedCase(Case):
    """One recorded evaluation with its derivatives.

    Attributes
    ----------
    totals : dict of str to ndarray
        Total derivatives in driver scaling by ``"of!wrt"``; empty when they were not recorded.
    """

    totals: dict = field(default_factory=dict)

    def fits(self, model) -> bool:
        """Whether the recorded values have the sizes of the model's variables."""
        inputs, outputs, _ = model.get_nonlinear_vectors()
        pairs = [
            (access.find_value(vector, name), value)
            for vector, values in ((inputs, self.inputs), (outputs, self.outputs))
            for name, value in values.items()
        ]
        return all(here is None or here.size == value.size for here, value in pairs)

    def restore(self, model) -> None:
        """Put the recorded values into the model.

        Raises
        ------
        AnalysisError
            When the recorded analysis failed.
        """
        if self.failure:
            raise AnalysisError(self.failure)
        inputs, outputs, _ = model.get_nonlinear_vectors()
        for vector, values in ((inputs, self.inputs), (outputs, self.outputs)):
            for name, value in values.items():
                here = access.find_value(vector, name)
                if here is not None:
                    here[:] = value.ravel()

    def disagreement(self, model) -> str:
        """Name of the first output that is not what the model holds; empty when all agree."""
        outputs = model.get_nonlinear_vectors()[1]
        for name, value in self.outputs.items():
            here = access.find_value(outputs, name)
            if here is not None:
                scale = np.abs(value).max(initial=0.0)
                if not np.abs(here - value.ravel()).max(initial=0.0) <= AGREEMENT * scale:
                    return name
        return ""

    def jacobian(self, of, wrt) -> np.ndarray | None:
        """Rows of all ``of`` over columns of all ``wrt``; None when one was not recorded."""
        if not self.totals.keys() >= {f"{o}!{w}" for o in of for w in wrt}:
            return None
        return np.vstack([np.hstack([self.totals[f"{o}!{w}"] for w in wrt]) for o in of])


class RecordedEvaluations:
    """The cases of a driver in a recorder file, found by the design that is in the model.

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
        When the file cannot be read, or its cases lack variables of the driver.
    RuntimeError
        On several processes.
    """

    def __init__(self, path, driver):
        self._model = access.problem_of(driver).model
        if self._model.comm.size > 1:
            raise RuntimeError("a run can be continued (hotstart_file) on one process only")
        self.path = Path(path)
        cases = read_cases(self.path)
        self.next_iteration = 1 + max((number for number, _ in cases), default=-1)
        self._sources = _independent(driver, cases[0][1].outputs if cases else {})
        needed = {*access.sources(driver).values(), *self._sources}
        self._by_design = {}
        finished = [case for _, case in cases if not case.failure.startswith(UNFINISHED)]
        for case in finished:
            if case.outputs.keys() >= needed and case.fits(self._model):
                self._add(case)
        if finished and not self._by_design:
            raise RestartError(
                f"no case in {path} holds the design variables, objective and constraints of this "
                "problem"
            )

    def __len__(self) -> int:
        return len(self._by_design)

    def find(self) -> RecordedCase | None:
        """The recorded evaluation of the design that is in the model."""
        return self._by_design.get(_key(self._given()))

    def load_start(self) -> None:
        """Put the first recorded design into the model."""
        for case in itertools.islice(self._by_design.values(), 1):
            for name, here in zip(self._sources, self._given(), strict=True):
                here[:] = case.outputs[name].ravel()

    def check_start(self) -> None:
        """Check that the start, analysed again, is that of the recorded run.

        Raises
        ------
        RestartError
            When it is not in the file, or the model has found something else.
        """
        if not self._by_design:
            return
        recorded = self.find()
        if recorded is None:
            raise RestartError(
                f"the start of this run is not the start of the run in {self.path}; "
                "seal_mdao.restart(problem, path) takes it from the file"
            )
        different = recorded.disagreement(self._model)
        if different:
            raise RestartError(
                f"{self.path} was recorded with another model: at the start {different} is not "
                "what this model gives"
            )

    def _given(self) -> list[np.ndarray]:
        outputs = self._model.get_nonlinear_vectors()[1]
        return [access.find_value(outputs, name) for name in self._sources]

    def _add(self, case: RecordedCase) -> None:
        key = _key(case.outputs[name] for name in self._sources)
        known = self._by_design.setdefault(key, case)
        known.totals = known.totals or case.totals


def _independent(driver, recorded) -> list[str]:
    """Sources of the design variables, and what else the model takes as given and was recorded."""
    all_sources, designs = access.sources(driver), driver.get_design_var_values()
    given = access.independent_outputs(driver).intersection(recorded)
    return sorted(given.union(all_sources[name] for name in designs))


def _key(values) -> bytes:
    return b"".join(np.ascontiguousarray(value, float).tobytes() for value in values)


def read_cases(path) -> list[tuple[int, RecordedCase]]:
    """Driver iteration number and evaluation of every case of a driver, in order.

    Raises
    ------
    RestartError
        For a file that is not there, is no recorder file, or is damaged.
    """
    try:
        with reading(path), PlainDatabase(path) as database:
            return _cases(database)
    except ValueError as error:
        raise RestartError(str(error)) from error


def _cases(database: PlainDatabase) -> list[tuple[int, RecordedCase]]:
    totals = {}
    columns = {"counter": int, "derivatives": bytes}
    for counter, blob in database.numbered_rows("driver_derivatives", columns):
        totals.setdefault(counter, {}).update(fields(blob))
    return [
        (
            number,
            RecordedCase(
                case.counter, case.failure, case.inputs, case.outputs, totals.get(case.counter, {})
            ),
        )
        for number, case in read_driver_cases(database)
    ]
