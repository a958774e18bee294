"""``openmdao seal_report``: the report of a recorder file from the command line.

Every ``openmdao`` command loads this module, so it imports what it needs when it is called.
"""

import sys


def setup():
    """Return parser, executor and description of the command for OpenMDAO."""
    return add_arguments, execute, "Write and show an HTML report of a recorded optimisation."


def add_arguments(parser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "cases", metavar="CASES.sql", help="recorder file (SqliteRecorder) of the driver"
    )
    parser.add_argument("-o", metavar="report.html", dest="outfile", help="file to write")
    parser.add_argument("--no-display", action="store_true", help="do not open a browser")


def execute(options, user_args) -> None:
    """Write the report and show it; report errors of the file in one line."""
    from openmdao.utils.webview import webview

    from seal_mdao.errors import GeometryError
    from seal_mdao.report.write import write_report
    from seal_mdao.standard_streams import make_writable

    # names with characters that the terminal's encoding lacks
    make_writable()
    try:
        report = write_report(options.cases, options.outfile)
    except (ValueError, OSError, GeometryError) as error:
        # one line on the error stream instead of a traceback
        print(f"openmdao seal_report: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)
    print(report)
    if not options.no_display:
        webview(str(report))
