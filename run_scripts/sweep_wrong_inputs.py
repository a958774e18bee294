"""Try 200 wrong inputs, each in a process of its own; print what became of each one."""

import multiprocessing
import resource
import sys
import time
import warnings
from collections import Counter

from _common import parser, run, write_summary
from _wrong_inputs import cases

import seal_mdao as sm

SECONDS, GIB = 10.0, 2.0
"""Within which each has to end."""
FAIR = ("clear error", "checked result", "failed path")
"""Endings that surprise nobody."""


def main(arguments) -> int:
    context = multiprocessing.get_context("fork")
    sm.analyze(sm.door_seal())  # compiles, once for all
    rows = [tried(context, *case, arguments.out) for case in cases(arguments.out)]
    for kind, text, seconds, memory, name in rows:
        print(f"{kind:15s} {seconds:6.2f} s {memory:5.2f} GiB  {name:58s} {text}")
    counts = Counter(row[0] for row in rows)
    print(f"{len(rows)} inputs: {', '.join(f'{n} {kind}' for kind, n in counts.most_common())}")
    write_summary(arguments.out, {"counts": dict(counts), "rows": rows})
    return 0 if set(counts) <= set(FAIR) else 1


def tried(context, name: str, action, out) -> tuple:
    """Kind of ending, text, seconds, GiB, and name of one input."""
    mine, theirs = context.Pipe(duplex=False)
    child = context.Process(target=outcome, args=(action, theirs))
    begun = time.perf_counter()
    child.start()
    kind, text, memory = "hangs", "", 0.0
    if mine.poll(SECONDS):
        try:
            kind, text, memory = mine.recv()
        except EOFError:
            kind, text = "died", "the process ended without a word"
    seconds = time.perf_counter() - begun
    child.terminate()
    child.join()
    if memory > GIB:
        kind = "large"
    return kind, text, round(seconds, 3), round(memory, 3), name


def outcome(action, pipe) -> None:
    """Run one input and send what came of it."""
    warnings.simplefilter("ignore")
    try:
        pipe.send((*judged(action()), peak()))
    except (ValueError, TypeError, ImportError) as error:
        text = str(error)
        clear = text and "\n" not in text and len(text) < 500
        pipe.send(("clear error" if clear else "unclear error", text[:160], peak()))
    except BaseException as error:
        pipe.send(("traceback", f"{type(error).__name__}: {error}"[:160], peak()))


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


def peak() -> float:
    """Largest memory of this process, GiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def arguments_parser():
    return parser(__doc__, "out/wrong_inputs")


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
