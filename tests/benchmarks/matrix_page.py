"""The page about the optimisation matrix, made of its runs."""

from statistics import median

from matrix_cases import DRAWN_SEED, drawn_cases

KKT = 1e-3
"""Largest entry of the scaled Lagrangian's gradient, and product of a multiplier and a distance."""
VIOLATION = 1e-3
"""Largest scaled violation of a constraint."""

HEAD = """# Robustness of the optimisation

This page tests how reliably the optimisers solve the problem of the paper, Eq. (71): minimise the
squared gaps of the door seal with limits on area and stress. The cases are the problem of the paper,
variants in which one factor is changed, 20 combinations of these factors, and {run} of the
{drawn} random cases defined below. Each case is solved by every optimiser of
{{mod}}`seal_mdao.optimization` with the settings of this package. The command
`python tests/benchmarks/optimization_matrix.py --workers 2 --page docs/optimisation_matrix.md` solves
all cases and writes this page; after an interruption the same command continues.

An optimisation has converged if the optimiser reports success, the error of the optimality conditions
is at most {kkt:g}, and no constraint is violated by more than {violation:g}. The error of the
optimality conditions (column KKT) is the largest entry of the gradient of the scaled Lagrangian or of
the complementarity products, computed in the same way for all optimisers by
{{py:class}}`~seal_mdao.drivers.optimality.Optimality`. These limits and the distribution of the random
cases were fixed before the first run, and each case is run once. The cost is the objective divided by
that of the nominal seal. The lower bound of the cost is zero, so the cost of a result is an upper bound
of the possible further improvement. The nominal seal violates the stress limits, so the cost of a
feasible design can exceed 100 %.

"""
LEGEND = """| factor | meaning |
|---|---|
| `corner_x` | horizontal position of the end of the flat part of the door, mm; paper: 2 |
| friction | friction coefficient; paper: 0.25 |
| parameters | number of design parameters; paper: 26; with 10 the section is symmetric |
| `friction_history incremental` | [slip from the last load step only](theory/contact.md#history-rules) |
| segments | the door contour is a polygon of this many segments; paper: exact contour |
| start | seed of random initial offsets, within 0.2 mm unless given; paper: nominal seal |
| `keep_force` | the final vertical reaction must stay within 10 % of that of the nominal seal |
| `clamp_load` | the same limits for the vertical reaction at 2, 4, 6, 8 and 10 mm of travel |
| `pressure_floor` | mean pressure of each contact region: at least half of that in the nominal seal |
| `stress_norm` | limit on the p-norm of the stress of all particles instead of seven stresses |
| `gap_integral` | the objective is the integral of the squared gap instead of the sum over points |

"""
FACTORS_TEXT = """## The paper's case, single changes, combinations

Each cell lists major iterations (not recorded for SLSQP), analyses, cost, and the error of the
optimality conditions (KKT).

"""
FAILURES_TEXT = """## Failures

The exit message `SUCCESS` of SLSQP means only that the objective has stopped changing; in the cases
below the optimality conditions are not satisfied.

"""
GAP_TEXT = """The gap is the largest one between the first and the last contact.

"""
DRAWN_TEXT = """## Random cases

{rule} The seed of this selection is {seed}.

"""


def converged(row: dict) -> bool:
    """Whether a run has converged, by the same measure for every optimiser."""
    return bool(row["success"]) and row["optimality"] <= KKT and row["violation"] <= VIOLATION


def page(table: list[dict], drawn: set[str]) -> str:
    """The page as markdown.

    Parameters
    ----------
    table : list of dict
        The runs, as ``optimization_matrix.py`` records them.
    drawn : set of str
        Names of the drawn cases.
    """
    kinds = (
        (FACTORS_TEXT, [row for row in table if row["case"] not in drawn]),
        (
            DRAWN_TEXT.format(seed=DRAWN_SEED, rule=_rule()),
            [row for row in table if row["case"] in drawn],
        ),
    )
    run = len({row["case"] for row in table} & drawn)
    text = HEAD.format(run=run, drawn=len(drawn), kkt=KKT, violation=VIOLATION)
    text += _summary(table) + LEGEND
    if any("largest_gap_mm" in row for row in table):
        text += GAP_TEXT
    text += "".join(head + markdown(rows) + "\n" for head, rows in kinds if rows)
    return text + _failures(table) + _versions(table)


def markdown(table: list[dict]) -> str:
    """All runs, a line each case."""
    names = list(dict.fromkeys(row["optimizer"] for row in table))
    lines = [f"| case | {' | '.join(names)} |", "|---" * (len(names) + 1) + "|"]
    for case in dict.fromkeys(row["case"] for row in table):
        cells = {row["optimizer"]: _cell(row) for row in table if row["case"] == case}
        lines.append(f"| {case} | " + " | ".join(cells.get(name, "") for name in names) + " |")
    return "\n".join(lines) + "\n"


def _rule() -> str:
    """The rule as its function states it, in one paragraph."""
    _, _, rule = drawn_cases.__doc__.partition("\n\n")
    return " ".join(rule.split()).replace("``", "`")


def _cell(row: dict) -> str:
    if row["cost"] is None:
        return "**failed**"
    steps = "" if row["iterations"] is None else f"{row['iterations']} iterations, "
    # runs that were recorded before the gap was have none
    gap = f"gap {row['largest_gap_mm']:.4f} mm, " if "largest_gap_mm" in row else ""
    text = (
        f"{steps}{row['analyses']} analyses, {100 * row['cost']:.4f} %, {gap}"
        f"KKT {row['optimality']:.0e}"
    )
    return text if converged(row) else f"**failed**: {text}"


def _summary(table: list[dict]) -> str:
    """A sentence for each optimiser."""
    sentences = []
    for name in dict.fromkeys(row["optimizer"] for row in table):
        rows = [row for row in table if row["optimizer"] == name]
        good = [row for row in rows if converged(row)]
        text = f"{name} converged in {len(good)} of {len(rows)} cases"
        if good:
            analyses, cost = [row["analyses"] for row in good], max(row["cost"] for row in good)
            text += (
                f", with {median(analyses):g} analyses in the median and {max(analyses)} at most, and a "
                f"cost of at most {100 * cost:.2g} %"
            )
        sentences.append(text + ".")
    return " ".join(sentences) + "\n\n"


def _failures(table: list[dict]) -> str:
    failed = [row for row in table if not converged(row)]
    if not failed:
        return "## Failures\n\nNone.\n\n"
    lines = ["| optimiser | case | KKT | violation | exit message |", "|---|---|---|---|---|"]
    for row in failed:
        message = " ".join(row["message"].split())
        lines.append(f"| {row['optimizer']} | {row['case']} | {_numbers(row)} | {message} |")
    return FAILURES_TEXT + "\n".join(lines) + "\n\n"


def _numbers(row: dict) -> str:
    if row["cost"] is None:
        return " | "
    return f"{row['optimality']:.1e} | {row['violation']:.1e}"


def _versions(table: list[dict]) -> str:
    """What the runs were made with; more than one set when the matrix was continued with another."""
    sets = dict.fromkeys(tuple(sorted(row["versions"].items())) for row in table)
    lines = [", ".join(f"{name} {version}" for name, version in found) for found in sets]
    return "Made with " + "; ".join(lines) + ".\n"
