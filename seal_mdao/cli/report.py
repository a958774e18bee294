"""Write the HTML report of the recorder file of an optimisation."""

import webbrowser
from pathlib import Path

from seal_mdao.cli.arguments import checked_arguments, existing_file, parser


def main(arguments) -> int:
    # imported here: the command line starts faster without matplotlib
    from seal_mdao.report.write import write_report

    with checked_arguments():
        path = write_report(arguments.cases, arguments.out / "report.html")
    print(path)
    if arguments.show:
        webbrowser.open(Path(path).resolve().as_uri())
    return 0


def arguments_parser():
    made = parser(
        __doc__, ".", "CASES.sql", "seal-mdao report out/bulb_optimization/cases.sql --show"
    )
    made.add_argument("cases", type=existing_file, metavar="CASES.sql", help="recorder file")
    made.add_argument("--show", action="store_true", help="open the report in a browser")
    return made
