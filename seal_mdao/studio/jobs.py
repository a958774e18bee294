"""Jobs of the worker process, by name."""

import traceback
from pathlib import Path

from seal_mdao.studio.improvement import improve
from seal_mdao.studio.problem_form import offered, write_problem
from seal_mdao.studio.saved import save_design
from seal_mdao.studio.workbench import StoppedError, Workbench


class Jobs:
    """Executes jobs with the open seal file, and sends their results.

    Parameters
    ----------
    pipe : Connection
    least : ctypes value
        Jobs with a smaller number are stopped.
    """

    def __init__(self, pipe, least):
        self._pipe, self._least = pipe, least
        self._serial, self._bench = 0, None

    def run(self, serial: int, kind: str, arguments: dict, failures: tuple, noted: list) -> None:
        """Execute a job; its results, ``stopped`` or ``failed`` are sent.

        ``noted`` are the warnings of the job, which are sent with its results.
        """
        self._serial = serial
        try:
            self._watch()
            getattr(self, f"_{kind}")(**arguments)
        except StoppedError:
            self._send("stopped", kind)
        except failures as error:
            self._send("failed", {"job": kind, "text": " ".join(str(error).split())})
        except Exception:
            # a fault of the program: the page says so, the terminal has the traceback
            traceback.print_exc()
            text = (
                f"internal error of seal-mdao studio in {kind!r}; the terminal shows the traceback"
            )
            self._send("failed", {"job": kind, "text": text})
        else:
            texts = {str(own.message).split("\n")[0] for own in noted}
            self._send("done", {"job": kind, "notes": sorted(texts)[:3]})

    def _send(self, kind: str, content) -> None:
        self._pipe.send((self._serial, kind, content))

    def _watch(self) -> None:
        if self._serial < self._least.value:
            raise StoppedError

    # ---- the jobs ----

    def _open(self, path: str, chosen: dict | None) -> None:
        def report(text: str) -> None:
            self._send("progress", text)

        self._bench = Workbench(path, report, self._watch, chosen)
        scene = self._bench.scene() | {"offered": offered(self._bench)}
        opened = {"scene": scene, "chosen": self._bench.chosen}
        self._send("opened", opened | {"start": self._bench.start()})

    def _analyze(self, design: list, step: int | None) -> None:
        self._send("exact", self._bench.analyze(design, step))
        self._send_rates(step)
        self._send_checks()

    def _send_checks(self) -> None:
        # they need derivatives, too, but the preview does not wait for them
        self._watch()
        if self._bench.result.converged:
            self._send("checks", self._bench.checks())

    def _send_rates(self, step: int | None) -> None:
        found = self._bench.first_order(step)
        if found is not None:
            self._send("rates", found)

    def _view(self, step: int) -> None:
        self._send("view", self._bench.view(step))
        self._send_rates(step)

    def _improve(self, design: list) -> None:
        improve(self._bench, design, lambda state: self._send("iteration", state))
        self._send_rates(None)
        self._send_checks()

    def _save(self, design: list, folder: str, name: str) -> None:
        paths = save_design(self._bench, design, folder, name)
        self._send("saved", [path.name for path in paths])

    def _errors(self) -> None:
        self._send("errors", self._bench.errors())

    def _problem(self, design: list, problem: dict, path: str) -> None:
        write_problem(self._bench, design, problem, Path(path))
        self._send("made", Path(path).name)
