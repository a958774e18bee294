"""Ipopt's return codes in words."""

from __future__ import annotations

SUCCESS_CODES = frozenset({0, 1})
"""Solve_Succeeded and Solved_To_Acceptable_Level; nothing else is a success."""

NUMBER_TROUBLE_CODES = frozenset({-2, -3, -13})
"""Ends that a failed analysis can cause: Ipopt's last iterate is not to be trusted then."""

MESSAGES = {
    0: "Optimal solution found",
    1: "Solved to acceptable level",
    2: "Converged to a point of local infeasibility; the problem may be infeasible",
    3: "The search direction became too small",
    4: "The iterates diverge; the problem may be unbounded",
    5: "Stopped by request",
    6: "A feasible point was found, as asked for",
    -1: "Maximum number of iterations exceeded",
    -2: "Restoration of feasibility failed",
    -3: "The search direction could not be computed (linear solver)",
    -4: "Maximum CPU time exceeded",
    -10: "Too few degrees of freedom: more equality constraints than free design variables",
    -11: "Invalid problem definition (check the bounds)",
    -12: "Invalid option (for example a linear solver that is not installed)",
    -13: "A function or derivative value is not a number",
    -100: "Unrecoverable exception inside Ipopt",
    -101: "Foreign exception inside Ipopt",
    -102: "Not enough memory",
    -199: "Internal error of Ipopt",
}


def status_message(code: int) -> str:
    """Return Ipopt's return code in words, with the number where it is not a success."""
    words = MESSAGES.get(code, "Unknown return code of Ipopt")
    return words if code in SUCCESS_CODES else f"{words} (Ipopt code {code})"
