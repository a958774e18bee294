"""State of the live section: the design, its history, designs to compare, and the jobs of the
worker."""

import math
from collections.abc import Callable

from seal_mdao.studio.project import Project
from seal_mdao.studio.shared_page import shared_page
from seal_mdao.studio.worker import Worker

MOST_HISTORY = 200
"""Designs that can be taken back."""
MOST_KEPT = 4
"""Designs that are compared."""
MOST_JOBS = 8
"""Jobs that wait for the worker."""
RESTARTS = 3
"""Times in a row that a worker is replaced without a result between."""


MOST_PARAMETERS = 40
"""Parameters of an edge that the form of the page takes."""
MOST_LIMITS = 12
"""Limits that it takes."""


class RequestError(ValueError):
    """Raised for a message of a page that cannot be executed; the page shows its text."""


def _is_number(given) -> bool:
    """Whether a value of a message is a finite number."""
    return isinstance(given, int | float) and not isinstance(given, bool) and math.isfinite(given)


class Session:
    """One open seal file, with all data that its pages share.

    Parameters
    ----------
    project : Project
    broadcast : callable
        ``broadcast(kind, content)`` sends a message to all pages.
    """

    def __init__(self, project: Project, broadcast: Callable):
        self.project, self._broadcast = project, broadcast
        self.worker = Worker(self._received)
        self.file: str | None = None
        self._forget()

    def _forget(self) -> None:
        """Forget all of the last file."""
        self.scene: dict | None = None
        self.failure, self.progress, self._chosen = "", "", None
        self.design: list[float] = []
        self._history: list[list[float]] = []
        self._at = 0
        self.step: int | None = None
        self.last: dict = {}
        # job that runs; those that wait; whether the design has to be analysed again
        self.job: str | None = None
        self._waiting: list[tuple[str, dict]] = []
        self._again = self._look = False
        self._fallen = 0
        self.kept: list[dict] = []
        self.errors: dict | None = None

    # ---- what pages ask for ----

    def open(self, name: str) -> None:
        """Open a seal file of the project."""
        path = self.project.path(name)
        if not path.is_file() or path.suffix != ".toml":
            raise RequestError(f"{name} is not a seal file in the project folder")
        self._forget()
        self.file = name
        self.worker.start()
        self._begin("open", path=str(path), chosen=None)
        self._broadcast("status", self.status())

    def status(self) -> dict:
        """Return the open file and the running jobs."""
        return {
            "file": self.file, "files": self.project.seal_files(), "job": self.job,
            "failure": self.failure, "progress": self.progress, "ready": self.scene is not None,
            "undo": self._at > 0, "redo": self._at + 1 < len(self._history), "step": self.step,
        }  # fmt: skip

    def handle(self, message) -> None:
        """Execute a message of a page.

        Raises
        ------
        RequestError, ProjectError
            For one that cannot be followed; nothing has changed then.
        """
        if not isinstance(message, dict):
            raise RequestError("a message from the page must be a JSON object with the key 'do'")
        does = message.get("do")
        known = {
            "drag": self._drag, "commit": self._commit, "undo": self._undo, "redo": self._redo,
            "view": self._view, "improve": self._improve, "stop": self._stop, "keep": self._keep,
            "drop": self._drop, "take": self._take, "save": self._save, "open": self._open,
            "problem": self._problem, "share": self._share,
            "errors": self._errors,
        }  # fmt: skip
        if not isinstance(does, str) or does not in known:
            raise RequestError(f"unknown message {str(does)[:40]!r}")
        if does != "open" and self.scene is None:
            raise RequestError("no seal file is open; open a seal file first")
        known[does](message)

    def _numbers(self, message) -> list[float]:
        """Return the design of a message within the ranges of its numbers."""
        given, numbers = message.get("design"), self.scene["numbers"]
        if not isinstance(given, list) or len(given) != len(numbers):
            raise RequestError(
                f"a design must have {len(numbers)} numbers, one per handle of the page"
            )
        if not all(map(_is_number, given)):
            raise RequestError("the numbers of a design (positions of handles) must be finite")
        return [
            min(max(float(value), own["low"]), own["high"])
            for own, value in zip(numbers, given, strict=True)
        ]

    def _drag(self, message) -> None:
        self._set(self._numbers(message))

    def _set(self, design: list[float]) -> None:
        if design == self.design:
            return
        self.design = design
        self._broadcast("design", {"design": design})
        self._want()

    def _commit(self, message) -> None:
        self._drag(message)
        self._remember()

    def _remember(self) -> None:
        """Add the design to those that can be taken back, unless it is there."""
        if self._history and self.design == self._history[self._at]:
            return
        self._history = [*self._history[: self._at + 1], self.design][-MOST_HISTORY:]
        self._at = len(self._history) - 1
        self._broadcast("status", self.status())

    def _undo(self, message) -> None:
        # an unfinished drag is taken back first
        if self.design == self._history[self._at]:
            self._at = max(self._at - 1, 0)
        self._set(self._history[self._at])
        self._broadcast("status", self.status())

    def _redo(self, message) -> None:
        self._at = min(self._at + 1, len(self._history) - 1)
        self._set(self._history[self._at])
        self._broadcast("status", self.status())

    def _view(self, message) -> None:
        step = message.get("step")
        if not isinstance(step, int) or isinstance(step, bool) or not 0 <= step < 10**6:
            raise RequestError(
                "the load step to show (step) must be the number of a load step of the analysis"
            )
        # the last one is that of any path
        self.step = step if step < self.scene["steps"] - 1 else None
        self._look = True
        self._next()

    def _improve(self, message) -> None:
        if self.scene["minimize"] is None or not self.scene["handles"]:
            raise RequestError(
                "there is no optimisation problem yet; choose the edges that may move and the "
                "measure to minimise under 'Problem'"
            )
        self._remember()
        self._wait("improve", design=self.design)

    def _stop(self, message) -> None:
        self._waiting.clear()
        if self.job in ("improve", "analyze"):
            self.worker.stop()

    def _keep(self, message) -> None:
        exact = self.last.get("exact")
        if exact is None or exact["design"] != self.design:
            raise RequestError(
                "the exact analysis of this design has not finished; keep the design afterwards"
            )
        if len(self.kept) == MOST_KEPT:
            raise RequestError(
                f"at most {MOST_KEPT} designs can be kept for comparison; remove one of them first"
            )
        used = {own["name"] for own in self.kept}
        name = next(letter for letter in "ABCDEFGH" if letter not in used)
        parts = {key: exact[key] for key in ("design", "measures", "curves")}
        parts["pressure"] = exact["frame"]["pressure"]
        self.kept.append({"name": name} | parts)
        self._broadcast("kept", self.kept)

    def _one_kept(self, message) -> dict:
        found = [own for own in self.kept if own["name"] == message.get("name")]
        if not found:
            raise RequestError("none of the designs kept for comparison has this name")
        return found[0]

    def _drop(self, message) -> None:
        self.kept.remove(self._one_kept(message))
        self._broadcast("kept", self.kept)

    def _take(self, message) -> None:
        self._set(self._one_kept(message)["design"])
        self._remember()

    def _save(self, message) -> None:
        stem = message.get("name") or f"{self.file.removesuffix('.toml')}_design"
        kinds = (".toml", ".dxf", ".vtu")
        for kind in kinds:
            self.project.path(f"{stem}{kind}")
        name = self.project.new(stem, kinds)
        self._remember()
        self._wait("save", design=self.design, folder=str(self.project.folder), name=name)

    def _share(self, message) -> None:
        exact = self.last.get("exact")
        # its warnings come after the state
        checked = exact is not None and (not exact["converged"] or "trustworthy" in exact)
        if not checked or exact["design"] != self.design:
            raise RequestError(
                "the exact analysis of this design has not finished; share the design afterwards"
            )
        name = f"{self.project.new(self.file.removesuffix('.toml') + '_shared', ('.html',))}.html"
        text = shared_page(self.file, self.scene, exact, self.kept, self.errors)
        self.project.path(name).write_text(text, encoding="utf-8")
        self._broadcast("saved", [name])

    def _problem(self, message) -> None:
        known = set(self.scene["offered"]["edges"])
        found = {key: message.get(key) for key in ("fixed", "pressed", "moving")}
        for key, names in found.items():
            if not isinstance(names, list) or not all(
                isinstance(name, str) and name in known for name in names
            ):
                raise RequestError(
                    f"the edges that may move ({key}) must be a list of edges of the section"
                )
        parameters, bound = message.get("parameters"), message.get("bound")
        if not isinstance(parameters, int) or not 1 <= parameters <= MOST_PARAMETERS:
            raise RequestError(
                f"the number of design parameters of an edge must be 1 to {MOST_PARAMETERS}"
            )
        if not _is_number(bound) or bound <= 0.0:
            raise RequestError("the largest offset of an edge must be a positive number (mm)")
        aim, limits = message.get("minimize") or None, message.get("limits")
        offered = self.scene["offered"]["measures"]
        if aim is not None and aim not in offered:
            raise RequestError(
                "the objective of the optimisation must be one of the listed measures"
            )
        if not isinstance(limits, list) or len(limits) > MOST_LIMITS:
            raise RequestError(
                f"the limits of the optimisation must be a list of at most {MOST_LIMITS} limits"
            )
        for own in limits:
            if not isinstance(own, dict) or own.get("measure") not in offered:
                raise RequestError(
                    "every limit of the optimisation must apply to one of the listed measures"
                )
            sides = [own.get("lower"), own.get("upper")]
            if not all(side is None or _is_number(side) for side in sides) or not any(
                side is not None for side in sides
            ):
                raise RequestError(
                    "every limit of the optimisation needs a lower bound, an upper bound or both, "
                    "as numbers"
                )
        limits = [{key: own.get(key) for key in ("measure", "lower", "upper")} for own in limits]
        stem = self.file.removesuffix(".toml").partition("_problem")[0]
        path = self.project.path(f"{self.project.new(f'{stem}_problem')}.toml")
        problem = found | {
            "parameters": parameters, "bound": float(bound), "minimize": aim, "limits": limits,
        }  # fmt: skip
        self._wait("problem", design=self.design, problem=problem, path=str(path))

    def _errors(self, message) -> None:
        self._wait("errors")

    def _on_errors(self, content: dict) -> None:
        self.errors = content
        self._broadcast("errors", content)

    def _on_made(self, name: str) -> None:
        self.job = None
        self.open(name)

    def _open(self, message) -> None:
        self.open(str(message.get("file")))

    # ---- the worker ----

    def _want(self) -> None:
        """Ask for an analysis of the design as soon as the worker can; what it does for an earlier
        design is stopped."""
        self._again = True
        if self.job in ("analyze", "improve", "view"):
            self.worker.stop()
        self._next()

    def _wait(self, kind: str, **arguments) -> None:
        """Add a job."""
        if len(self._waiting) == MOST_JOBS:
            raise RequestError("too many requests are waiting; try again when they are finished")
        self._waiting.append((kind, arguments))
        self._next()

    def _begin(self, kind: str, **arguments) -> None:
        self.job = kind
        self.worker.request(kind, **arguments)

    def _next(self) -> None:
        """Give the worker its next job, if it has none."""
        if self.job is not None:
            return
        if self._waiting:
            kind, arguments = self._waiting.pop(0)
            self._begin(kind, **arguments)
        elif self._again:
            self._again = self._look = False
            self._begin("analyze", design=self.design, step=self.step)
        elif self._look:
            self._look = False
            step = self.scene["steps"] - 1 if self.step is None else self.step
            self._begin("view", step=step)
        else:
            return
        self._broadcast("status", self.status())

    def _received(self, serial: int, kind: str, content) -> None:
        """Take a message of the worker."""
        if kind == "died":
            self._replace_worker()
            return
        if serial != self.worker.serial:
            return
        getattr(self, f"_on_{kind}")(content)

    def _finish(self) -> None:
        self.job, self.progress = None, ""
        self._next()
        if self.job is None:
            self._broadcast("status", self.status())

    def _on_progress(self, text: str) -> None:
        self.progress = text
        self._broadcast("progress", {"text": text})

    def _on_opened(self, content: dict) -> None:
        self._chosen = content["chosen"]
        if self.scene is None:
            self.scene, self.design = content["scene"], content["start"]
            self._history, self._at = [self.design], 0
            self._broadcast("scene", self.scene)
            self._broadcast("design", {"design": self.design})
        self._again = True

    def _on_exact(self, content: dict) -> None:
        self._fallen = 0
        self._store("exact", content)

    def _on_rates(self, content: dict) -> None:
        self._store("rates", content)

    def _on_checks(self, content: dict) -> None:
        if self._again:
            # the design has been changed since: its own come
            return
        self.last["exact"] = self.last["exact"] | content
        self._broadcast("checks", content)

    def _on_view(self, content: dict) -> None:
        if "exact" not in self.last:
            # the first analysis failed: there is no state to show
            return
        # the state now has the picture of another load step
        self.last["exact"] = self.last["exact"] | {"frame": content}
        self._store("view", content)

    def _store(self, kind: str, content: dict) -> None:
        # a picture has no first-order changes until they come
        if kind != "rates":
            self.last.pop("rates", None)
        if kind != "view":
            self.last[kind] = content
        self._broadcast(kind, content)

    def _on_iteration(self, content: dict) -> None:
        if self._again:
            # the design has been changed since: the run is being stopped
            return
        self.design = content["design"]
        self._broadcast("design", {"design": self.design})
        self._store("exact", content)

    def _on_saved(self, names: list) -> None:
        self._broadcast("saved", names)

    def _on_done(self, content: dict) -> None:
        if content["job"] == "improve":
            self._remember()
        # a view repeats no analysis: the notes of that stay
        noted = content["job"] == "view" and content["notes"]
        if content["job"] in ("analyze", "improve") or noted:
            self._broadcast("notes", content["notes"])
        self._finish()

    def _on_stopped(self, kind: str) -> None:
        if kind == "improve":
            # the last iteration stays, and can be taken back
            self._remember()
            self._again = True
        self._finish()

    def _on_failed(self, content: dict) -> None:
        self._broadcast("failed", content)
        if content["job"] == "open":
            self.failure = content["text"]
            self.job = None
            self._broadcast("status", self.status())
            return
        self._finish()

    def _replace_worker(self) -> None:
        """Start a new worker with the same file, and analyse the design there."""
        self._fallen += 1
        self._waiting.clear()
        if self._fallen > RESTARTS:
            self.job = None
            self.failure = (
                f"the process that analyses the seal ended unexpectedly {self._fallen} times; open "
                "the seal file again"
            )
            self._broadcast("status", self.status())
            return
        self.worker.start()
        text = "the process that analyses the seal ended unexpectedly and is restarted"
        self._broadcast("failed", {"job": self.job, "text": text})
        self._begin("open", path=str(self.project.path(self.file)), chosen=self._chosen)
        self._broadcast("status", self.status())

    def end(self) -> None:
        """End the worker."""
        self.worker.end()
