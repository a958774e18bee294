"""Settings that ``--restart`` reads from a recorder file, and their check against the arguments."""

import argparse
from pathlib import Path

import seal_mdao as sm
from seal_mdao.cli.arguments import (
    CASES,
    OF_ACCURACY,
    SEAL_OPTIONS,
    WrongArgumentError,
    checked_arguments,
)
from seal_mdao.optimization import OPTIMIZERS
from seal_mdao.recording import run_log
from seal_mdao.recording.claim import require_free
from seal_mdao.recording.recorded_seals import RecordedProblem, recorded_problem
from seal_mdao.recording.recorder import copy_record
from seal_mdao.recording.recorder_file import open_model
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.file.described import FILE


def recorded_run(arguments: argparse.Namespace) -> tuple[RecordedProblem, str]:
    """Read problem and optimiser of the run to continue, and check the arguments against them.

    Raises
    ------
    WrongArgumentError
        When the file is not that of a door seal, or the arguments ask for another problem than the
        recorded one.
    """
    path = arguments.restart
    with checked_arguments():
        problem = recorded_problem(open_model(path))
        optimizer = recorded_optimizer(path)
    if problem is None or FILE in problem.settings:
        raise WrongArgumentError(
            f"{path} does not contain the settings of the built-in door seal; restart the "
            f"optimisation of a seal file with seal-mdao optimize FILE --restart {path}"
        )
    # recorded settings: options of the seal, problem, optimiser
    options = options_of(problem.seal)
    recorded = {name: getattr(options, name) for name in SEAL_OPTIONS} | problem.settings
    if optimizer is not None:
        recorded["optimizer"] = optimizer
    # an argument may repeat a recorded setting but not change it
    for name in sorted(arguments.given.intersection(recorded)):
        value = getattr(arguments, name)
        _require_same(path, name, value, recorded[name], _argument(name, value))
    if "accuracy" in arguments.given:
        _require_accuracy(arguments, options)
    return problem, optimizer or arguments.optimizer


def recorded_optimizer(path: Path) -> str | None:
    """Return the name of the optimiser that wrote the file last; None when it is not recorded."""
    # the log names the driver class of every run
    runs = run_log.read(path)
    for name, make in OPTIMIZERS.items():
        if runs and type(make()).__name__ == runs[-1].driver:
            return name
    return None


def recorder_file(arguments: argparse.Namespace) -> Path:
    """Return the recorder file in the output folder, after checking that this run may write it.

    Raises
    ------
    WrongArgumentError
        When another run writes it, or it holds the results of another one and ``--overwrite`` is not
        given.
    """
    # not a bare name: OpenMDAO looks for that in a folder of its own
    cases, source = (arguments.out / CASES).absolute(), arguments.restart
    with checked_arguments():
        # another process may be recording into it
        require_free(cases)
    # restart in place: same file
    continues = source is not None and cases.exists() and cases.samefile(source)
    if cases.exists() and not continues and not arguments.overwrite:
        raise WrongArgumentError(
            f"{cases} contains an earlier optimisation; choose another folder (--out), continue "
            f"that optimisation (--restart {cases}), or replace it (--overwrite)"
        )
    return cases


def continued_file(arguments: argparse.Namespace) -> Path:
    """Return the recorder file in the output folder, with the recorded cases copied into it."""
    cases = recorder_file(arguments)
    with checked_arguments():
        # the file of the earlier run is left as it is
        copy_record(arguments.restart, cases)
    return cases


def _require_accuracy(arguments: argparse.Namespace, recorded: DoorOptions) -> None:
    """Require the recorded values of the options that follow from ``--accuracy``."""
    # options of this accuracy against the recorded ones
    given = options_of(sm.door_seal(arguments.accuracy))
    flag = _argument("accuracy", arguments.accuracy)
    for name in sorted(OF_ACCURACY - arguments.given):
        _require_same(arguments.restart, name, getattr(given, name), getattr(recorded, name), flag)


def _argument(name: str, value) -> str:
    flag = f"--{name.replace('_', '-')}"
    return flag if isinstance(value, bool) else f"{flag} {value}"


def _require_same(path: Path, name: str, given, recorded, argument: str) -> None:
    if given != recorded:
        raise WrongArgumentError(
            f"{argument}: {path} was recorded with {name} = {recorded}, and a restart uses the "
            "recorded settings; leave this argument out"
        )
