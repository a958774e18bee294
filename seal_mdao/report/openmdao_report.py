"""The report ``seal`` among OpenMDAO's own: written when ``run_driver`` returns.

Ask for it with ``Problem(reports=["seal"])`` or ``OPENMDAO_REPORTS=seal``; the driver needs a recorder.
"""

FILE = "seal_report.html"


def register() -> None:
    """Register the report; OpenMDAO calls this when it loads the entry point."""
    from openmdao.utils.reports_system import register_report

    register_report(
        "seal", run, "Histories, shapes with stress, contact and forces of an optimisation",
        "Problem", "run_driver", "post", predicate=is_optimisation,
    )  # fmt: skip


def is_optimisation(problem) -> bool:
    """Whether there can be a report: the driver optimises, on the first process."""
    return bool(problem.driver.supports["optimization"]) and problem.comm.rank == 0


def run(problem) -> None:
    """Write the report of a problem whose driver has a SQLite recorder."""
    from openmdao.recorders.sqlite_recorder import SqliteRecorder
    from openmdao.utils.om_warnings import DriverWarning, issue_warning

    from seal_mdao.openmdao_access import recorder_file, recorders
    from seal_mdao.recording.recorder import RestartRecorder
    from seal_mdao.report.write import write_report

    for recorder in recorders(problem.driver):
        if isinstance(recorder, SqliteRecorder) and recorder.connection:
            if isinstance(recorder, RestartRecorder):
                recorder.note_end()
            out = problem.get_reports_dir() / FILE
            group = seal_group(problem.model)
            given, kept = ({}, None) if group is None else (inputs_of(group), group.options["kept"])
            write_report(recorder_file(recorder), out, given, kept)
            return
    issue_warning(
        "the report 'seal' needs a SQLite recorder on the driver, for example "
        "seal_mdao.RestartRecorder",
        category=DriverWarning,
    )


def seal_group(model):
    """The first ``SealGroup`` in a model; None when there is none."""
    from seal_mdao.components.seal_group import SealGroup

    return next(model.system_iter(include_self=True, recurse=True, typ=SealGroup), None)


def inputs_of(group) -> dict:
    """Values of a group's inputs by their own names, in its units."""
    inputs = group.list_inputs(out_stream=None, return_format="dict")
    return {name.rsplit(".", 1)[-1]: meta["val"] for name, meta in inputs.items()}
