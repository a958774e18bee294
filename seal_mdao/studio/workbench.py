"""The open seal of the live section: analysis, first-order changes, optimisation, files.

All of it runs in the worker process (``studio.worker``).
"""

import tomllib
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np

from seal_mdao.accuracy.error_estimate import estimate_errors
from seal_mdao.errors import LoadPathError
from seal_mdao.file_seal import file_and_seal
from seal_mdao.input_files import read_text
from seal_mdao.plotting.field import FineGrid, fine_grid
from seal_mdao.report.picture_data import POINTS
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.described import description
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.result import SealResult, analyze, frozen_measures, is_empty
from seal_mdao.stored_choice import store_choice, stored_choice
from seal_mdao.studio import pictures
from seal_mdao.studio.adjustable import adjustables, with_handles
from seal_mdao.studio.preview import path_rates
from seal_mdao.tolerances.file import tolerances_of


class StoppedError(Exception):
    """Raised inside a calculation that was stopped."""


class Progress:
    """Callback that reports the progress of the choice of load steps and penalties.

    Parameters
    ----------
    report : callable
        Called with one line.
    watch : callable
        Called at every load step; raises ``StoppedError`` to end the choice.
    what : str
        What is being done.
    """

    def __init__(self, report: Callable, watch: Callable, what: str = "choosing load steps"):
        self._report, self._watch, self._what = report, watch, what
        self._head, self._total = what, 0

    def begin(self, what: str) -> None:
        """Note what is being done from now on."""
        self._what = what

    def begin_analysis(self, number: int, of: int, n_steps: int) -> None:
        """Note analysis ``number`` of at least ``of``, with ``n_steps`` load steps."""
        self._head, self._total = f"{self._what}: analysis {number} of {of}", n_steps

    def __call__(self, step) -> None:
        """Report a load step."""
        self._watch()
        of = f" of {self._total}" if self._total else ""
        self._report(f"{self._head}, load step {step.nominal + 1}{of}")


class Workbench:
    """Open seal file: its seal with fixed load steps and penalties, and the last result.

    Parameters
    ----------
    path : str or Path
    report : callable
        Called with one line of progress.
    watch : callable
        Called often; raises ``StoppedError`` when the calculation is no longer wanted.
    chosen : dict, optional
        Particles, load steps and penalties chosen before (``chosen_for``).

    Raises
    ------
    SealFileError, LoadPathError
    """

    def __init__(self, path, report: Callable, watch: Callable, chosen: dict | None = None):
        self.path, self.watch = Path(path), watch
        report("reading the file, placing particles")
        read = read_seal_file(self.path)
        self.tables = tomllib.loads(read_text(self.path))
        progress = Progress(report, watch)
        # in this session, or by an earlier command
        known = chosen or stored_choice(read)
        self.file, built = file_and_seal(read, progress, **(known or {}))
        if known is None:
            store_choice(self.file, built)
        self.chosen, self._plain, self._report = chosen_for(self.file, built), built, report
        self.seal = with_handles(built, self.file)
        self.seal.made_from(description(self.file, built) | {"handles": True})
        self.numbers = adjustables(self.file, self.tables, self.seal)
        # what scatters between parts, and the parameters that do
        written = self.file.tolerance
        self.tolerances = None if written is None else tolerances_of(written)
        self._scattered = [] if written is None else [
            name for own in self.tolerances.variations for name in own.parameters
        ]  # fmt: skip
        report("analysing the seal of the file")
        self.nominal = analyze(self.seal, keep_factors=True, callback=lambda step: watch())
        self.nominal.require_converged()
        # the measures keep the points that they have on the seal of the file
        self.measures = tuple(
            own
            for own in frozen_measures(self.seal, None, lambda seal: self.nominal)
            if not is_empty(own, self.seal)
        )
        self.result = self.nominal
        self.fine, self.rates = self._grid(self.nominal), None

    def scene(self) -> dict:
        """Return the data that are the same for all designs of the file."""
        found = pictures.scene(self.nominal, self._grid(self.nominal), self.numbers)
        limits = self.file.optimize.constraints if self.file.optimize else ()
        return found | {
            "file": self.path.name,
            "edges": list(self.file.section.outline.edge_names),
            "minimize": self.file.optimize.minimize if self.file.optimize else None,
            "limits": [
                {"measure": own.measure, "lower": own.lower, "upper": own.upper} for own in limits
            ],
            "measures": [
                {"name": own.name, "unit": self.seal.units.of(own.units) or "", "text": own.text}
                for own in self.measures
            ],
        }

    # ---- designs ----

    def start(self) -> list[float]:
        """Return the numbers in the file."""
        return [own.value for own in self.numbers]

    def split(self, design) -> tuple[np.ndarray, dict]:
        """Return the offsets and the changed parameters of a design, the values of all numbers.

        Raises
        ------
        ValueError
            For a wrong count, or values out of their ranges.
        """
        if len(design) != len(self.numbers):
            raise ValueError(
                f"a design must have {len(self.numbers)} numbers, one per handle of the page, got "
                f"{len(design)}"
            )
        count, parameters = self.seal.n_offsets, {}
        for own, value in zip(self.numbers, design, strict=True):
            if not own.low <= value <= own.high:
                raise ValueError(
                    f"{own.text} = {value:g} is outside its range {own.low:g} to {own.high:g}"
                )
        for own, value in zip(self.numbers[count:], design[count:], strict=True):
            if value != own.value:
                parameters[own.name] = value - own.zero
        return np.array(design[:count], float), parameters

    def write_numbers(self, tables: dict, design) -> None:
        """Write the changed numbers of a design, except its offsets, into the tables of a seal
        file."""
        for own, value in zip(self.numbers, design, strict=True):
            if own.path and value != own.value:
                own.write(tables, value)

    def placed(self, design) -> SealFile:
        """Return the file with the profiles where a design places them."""
        tables = deepcopy(self.tables)
        self.write_numbers(tables, design)
        rows = zip(self.file.profiles, tables.get("profile", ()), strict=True)
        profiles = tuple(
            replace(
                own, start=tuple(row.get("start", own.start)), angle=row.get("angle", own.angle)
            )
            for own, row in rows
        )
        return replace(self.file, profiles=profiles)

    def analyze(self, design, step: int | None = None) -> dict:
        """Analyse a design and return the data of its pictures.

        A path that was not completed is returned with its last converged step.
        """
        offsets, parameters = self.split(design)
        result = analyze(
            self.seal, offsets, parameters, keep_factors=True, callback=lambda step: self.watch()
        )
        return self.shown(result, design, step)

    def shown(self, result: SealResult, design, step: int | None = None) -> dict:
        """Store an analysed design as the last result and return the data of its pictures.

        Raises
        ------
        LoadPathError, ValueError
            For a path without a load step, or a measure without a value; the last result remains then.
        """
        if not result.path.nominal_steps:
            raise LoadPathError(result.failure, result)
        before = self.result, self.rates, self.fine
        self.result, self.rates, self.fine = result, None, self._grid(result)
        try:
            return self._state(step) | {"design": list(map(float, design))}
        except (LoadPathError, ValueError):
            # the page keeps the pictures of the last result
            self.result, self.rates, self.fine = before
            raise

    def first_order(self, step: int | None = None) -> dict | None:
        """Differentiate the last result; None for a path that was not completed."""
        if not self.result.converged:
            return None
        numbers, tolerances = self.numbers[self.seal.n_offsets :], self.tolerances
        names = list(dict.fromkeys([own.name for own in numbers] + self._scattered))
        if self.rates is None:
            measures = self._measures(self.result)
            self.rates = path_rates(self.result, names, measures, self.watch)
        found = pictures.rates(self.fine, self.rates, self._step(step), len(self.numbers))
        if tolerances is not None:
            found["scatter"] = pictures.scatter(self.result, self.rates, tolerances, names)
        return found

    def checks(self) -> dict:
        """Return the warnings of the last result, and whether it can be used."""
        return {"warnings": list(self.result.warnings), "trustworthy": self.result.trustworthy}

    def errors(self) -> dict:
        """Estimate the errors of all measures at the section of the file: half-widths of error bars by
        name, in their units; those that are not known are left out."""
        result = analyze(self._plain, keep_factors=True, callback=lambda step: self.watch())
        progress = Progress(self._report, self.watch, "estimating errors")
        found = estimate_errors(self.file, result, progress)
        return {name: pictures.plain(own.bar) for name, own in found.items() if own.bar is not None}

    def view(self, step: int) -> dict:
        """Return the last result after another load step."""
        return pictures.frame(self.fine, self._step(step))

    def _grid(self, result: SealResult) -> FineGrid:
        # about as many points whatever the refinement, one at every particle at least
        cells = len(result.seal.body.cells)
        return fine_grid(result, max(1, round(np.sqrt(POINTS / cells))))

    def _step(self, step: int | None) -> int:
        last = len(self.result.path.nominal_steps) - 1
        return last if step is None else min(max(step, 0), last)

    def _measures(self, result: SealResult) -> tuple:
        return tuple(own.with_parameters(result.seal.changed) for own in self.measures)

    def _state(self, step: int | None) -> dict:
        result = self.result
        found = {
            "converged": result.converged, "failure": result.failure,
            "warnings": [], "measures": {}, "curves": pictures.curves(result),
            "frame": pictures.frame(self.fine, self._step(step)),
            "captions": [result.caption(k) for k in range(len(result.path.nominal_steps))],
        }  # fmt: skip
        if result.converged:
            found["measures"] = self.values(result)
            found["warnings"] = list(result.seal.warnings)
        return found

    def values(self, result: SealResult) -> dict:
        """Evaluate all measures of a completed path, by their names."""
        return {own.name: pictures.plain(result.value(own)) for own in self._measures(result)}
