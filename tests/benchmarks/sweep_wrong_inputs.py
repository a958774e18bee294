"""Try some 400 wrong inputs, each in a process of its own; print what became of each one."""

import multiprocessing
import resource
import sys
import time
import warnings
from collections import Counter
from contextlib import chdir
from pathlib import Path

import openmdao.api as om
import psutil
from wrong_inputs import cases

import seal_mdao as sm
from seal_mdao.cli.arguments import parser, run, write_summary

SECONDS, GIB = 10.0, 2.0
"""Of the processor and of memory, within which each has to end."""
PATIENCE = 120.0
"""Seconds after which one that takes nothing of the processor hangs, too."""
FAIR = ("clear error", "checked result", "failed path")
"""Endings that surprise nobody."""


def main(arguments) -> int:
    context = multiprocessing.get_context("fork")
    sm.analyze(sm.door_seal())  # compiles, once for all
    # messages name files as given: their length must not depend on where the folder is
    with chdir(arguments.out):
        rows = [tried(context, *case) for case in cases(Path())]
    for kind, text, seconds, memory, name in rows:
        print(f"{kind:15s} {seconds:6.2f} s {memory:5.2f} GiB  {name:58s} {text}")
    counts = Counter(row[0] for row in rows)
    print(f"{len(rows)} inputs: {', '.join(f'{n} {kind}' for kind, n in counts.most_common())}")
    longest, largest = (max(rows, key=lambda row, at=at: row[at]) for at in (2, 3))
    print(f"longest: {longest[2]:.2f} s, {longest[4]}; largest: {largest[3]:.2f} GiB, {largest[4]}")
    write_summary(arguments.out, {"counts": dict(counts), "rows": rows})
    return 0 if set(counts) <= set(FAIR) else 1


def tried(context, name: str, action) -> tuple:
    """Kind of ending, text, seconds of the processor, GiB, and name of one input."""
    mine, theirs = context.Pipe(duplex=False)
    child = context.Process(target=outcome, args=(action, theirs))
    begun = time.perf_counter()
    child.start()
    theirs.close()
    spent = (0.0, 0.0)
    while not mine.poll(0.02):
        spent = taken(child.pid, spent)
        if spent[0] > SECONDS or spent[1] > GIB or time.perf_counter() - begun > PATIENCE:
            child.kill()
            break
    kind, text = ("large", "") if spent[1] > GIB else ("hangs", "")
    if mine.poll():
        try:
            kind, text, *spent = mine.recv()
        except EOFError:
            kind, text = "died", "the process ended without a word"
    child.join(PATIENCE)
    if child.is_alive():
        child.kill()
        child.join()
        kind, text = "hangs", f"the process did not end after: {text}"
    if spent[1] > GIB:
        kind = "large"
    return kind, text, round(spent[0], 3), round(spent[1], 3), name


def taken(pid: int, before: tuple) -> tuple:
    """Seconds of the processor and GiB that a process has taken; as before when it has ended."""
    try:
        process = psutil.Process(pid)
        times = process.cpu_times()
        return times.user + times.system, process.memory_info().rss / 2**30
    except psutil.NoSuchProcess:
        return before


def outcome(action, pipe) -> None:
    """Run one input and send what came of it."""
    warnings.simplefilter("ignore")
    try:
        pipe.send((*judged(action()), *spent()))
    except (ValueError, TypeError, ImportError) as error:
        text = str(error)
        clear = text and "\n" not in text and len(text) < 500
        pipe.send(("clear error" if clear else "unclear error", text[:160], *spent()))
    except (sm.LoadPathError, om.AnalysisError) as error:
        pipe.send(("failed path", str(error)[:160], *spent()))
    except BaseException as error:
        pipe.send(("traceback", f"{type(error).__name__}: {error}"[:160], *spent()))


def judged(result) -> tuple[str, str]:
    """A result that came out of a wrong input: it has to say what is wrong, or be right."""
    if result is None:
        return "silent", "accepted without a word"
    if not result.converged:
        return "failed path", result.failure[:160]
    told = "; ".join(result.warnings)
    return "checked result", (told or "no finding: equilibrium, geometry and det F are in order")[
        :160
    ]


def spent() -> tuple[float, float]:
    """Seconds of the processor and the largest memory of this process, GiB."""
    return time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def arguments_parser():
    return parser(__doc__, "out/wrong_inputs")


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
