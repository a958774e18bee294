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

    # the first SQLite recorder of the driver that is in use
    for recorder in recorders(problem.driver):
        if isinstance(recorder, SqliteRecorder) and recorder.connection:
            if isinstance(recorder, RestartRecorder):
                # the run log must have its end before the file is read
                recorder.note_end()
            out = problem.get_reports_dir() / FILE
            write_report(
                recorder_file(recorder),
                out,
                constant_inputs(problem),
                analysis_cache(problem.model),
            )
            return
    issue_warning(
        "the OpenMDAO report 'seal' needs an SQLite recorder on the driver, for example "
        "seal_mdao.RestartRecorder",
        category=DriverWarning,
    )


def analysis_cache(model):
    """Where a ``SealGroup`` of a model keeps its analyses; None when none does."""
    from seal_mdao.components.seal_group import SealGroup

    groups = model.system_iter(include_self=True, recurse=True, typ=SealGroup)
    return next((g.options["cache"] for g in groups if g.options["cache"] is not None), None)


def constant_inputs(problem) -> dict:
    """Values of the inputs of seals that the driver does not change, by their absolute names."""
    from seal_mdao.openmdao_access import find_value, independent_outputs, sources
    from seal_mdao.recording.recorded_seals import inputs_of_seals

    model = problem.model
    # sources that no driver changes: the same at all points
    free = independent_outputs(problem.driver).difference(sources(problem.driver).values())
    inputs = model.get_nonlinear_vectors()[0]
    names = [name for name in inputs_of_seals(model) if model.get_source(name) in free]
    return {name: find_value(inputs, name).copy() for name in names}
