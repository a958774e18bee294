"""The page about the optimisation matrix, made of its runs."""

from statistics import median

from matrix_cases import DRAWN_SEED, drawn_cases

KKT = 1e-3
"""Largest entry of the scaled Lagrangian's gradient, and product of a multiplier and a distance."""
VIOLATION = 1e-3
"""Largest scaled violation of a constraint."""

HEAD = """# Robustness of the optimisation

`python tests/benchmarks/optimization_matrix.py --workers 2 --page docs/optimisation_matrix.md` writes
this page from the runs that it makes; an interrupted run is continued. It solves problem (71)
for the paper's case, for each factor changed alone, for 20 combinations of the factors, and for
{run} of {drawn} random cases, with every optimiser of {{mod}}`seal_mdao.optimization` at its settings
there.

A run has converged when the optimiser reports success, the optimality conditions hold to {kkt:g}
(largest entry of the scaled Lagrangian's gradient, KKT in the tables, measured in the same way for
all by {{py:class}}`~seal_mdao.drivers.optimality.Optimality`) and the limits to {violation:g}.
These tolerances, the seed of the random cases and their distribution were fixed before the first
run, and each case is run once. Costs are fractions of that of the nominal seal. They cannot fall
below zero, so the cost of a run is an upper bound of the possible further improvement. The gap is
the largest one between the first and the last contact, wherever it opens.

"""
FACTORS_TEXT = """## The paper's case, single changes, combinations

`corner_x` 0, 2, 4 mm; friction 0.15, 0.25, 0.4; 26 parameters, or 10 of a symmetric section; both
friction histories; exact door and 32 segments; the nominal seal and three random starts within 0.2
mm.

"""
DRAWN_TEXT = """## Random cases

Drawn with seed {seed}. {rule}

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
    text = HEAD.format(run=run, drawn=len(drawn), kkt=KKT, violation=VIOLATION) + _summary(table)
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
    lines = [
        f"- {row['optimizer']}, {row['case']}: {_numbers(row)}{' '.join(row['message'].split())}"
        for row in failed
    ]
    return "## Failures\n\n" + "\n".join(lines) + "\n\n"


def _numbers(row: dict) -> str:
    if row["cost"] is None:
        return ""
    return f"KKT {row['optimality']:.1e}, violation {row['violation']:.1e}; "


def _versions(table: list[dict]) -> str:
    """What the runs were made with; more than one set when the matrix was continued with another."""
    sets = dict.fromkeys(tuple(sorted(row["versions"].items())) for row in table)
    lines = [", ".join(f"{name} {version}" for name, version in found) for found in sets]
    return "Made with " + "; ".join(lines) + ".\n"
