"""Checking and converting the options that users pass through to Ipopt."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from types import ModuleType

DEFAULTS = {
    "bound_relax_factor": 0.0,
    "hessian_approximation": "limited-memory",
    "print_level": 0,
    "sb": "yes",
}
"""Settings of the driver that ``opt_settings`` overrides.

Ipopt by itself relaxes all bounds by 1e-8 and iterates outside the given ones. The model is never
run outside (a square root may not stand it), so there would be nothing to gain out there, and the
line search would notice.
"""

INSTALL_HINT = 'IpoptDriver needs ipyopt, which is not installed: pip install "seal_mdao[ipopt]"'

INTEGER_OPTIONS = frozenset(
    [
        "accept_after_max_steps",
        "acceptable_iter",
        "adaptive_mu_kkterror_red_iters",
        "derivative_test_first_index",
        "file_print_level",
        "filter_reset_trigger",
        "limited_memory_max_history",
        "limited_memory_max_skipping",
        "ma57_block_size",
        "ma57_node_amalgamation",
        "ma57_pivot_order",
        "ma57_small_pivot_flag",
        "ma77_buffer_lpage",
        "ma77_buffer_npage",
        "ma77_file_size",
        "ma77_maxstore",
        "ma77_nemin",
        "ma77_print_level",
        "ma86_nemin",
        "ma86_print_level",
        "ma97_nemin",
        "ma97_print_level",
        "max_filter_resets",
        "max_iter",
        "max_refinement_steps",
        "max_resto_iter",
        "max_soc",
        "max_soft_resto_iters",
        "min_refinement_steps",
        "mumps_mem_percent",
        "mumps_permuting_scaling",
        "mumps_pivot_order",
        "mumps_scaling",
        "num_linear_variables",
        "pardiso_iter_coarse_size",
        "pardiso_iter_max_levels",
        "pardiso_iter_max_row_fill",
        "pardiso_max_droptol_corrections",
        "pardiso_max_iter",
        "pardiso_max_iterative_refinement_steps",
        "pardiso_msglvl",
        "print_frequency_iter",
        "print_level",
        "quality_function_max_section_steps",
        "soc_method",
        "watchdog_shortened_iter_trigger",
        "watchdog_trial_iter_max",
    ]
)
"""Ipopt's integer options; ipyopt does not tell their types. Other numbers are real."""


def import_ipyopt() -> ModuleType:
    """Import ipyopt when it is needed.

    Raises
    ------
    ImportError
        With one line that names the extra, if ipyopt is not installed.
    """
    try:
        import ipyopt
    except ImportError as error:
        raise ImportError(INSTALL_HINT) from error
    return ipyopt


def ipopt_settings(settings: dict[str, Any], **defaults: Any) -> dict[str, Any]:
    """Return all settings for Ipopt: the driver's defaults, overridden by the user's.

    Parameters
    ----------
    settings : dict
        The user's ``opt_settings``. Numbers may be of any numeric type and yes/no options may be
        booleans.
    **defaults
        Further defaults, from the driver's options.

    Raises
    ------
    ValueError
        If an option is not known to Ipopt, or its value is refused.
    """
    known = {option["name"] for option in import_ipyopt().get_ipopt_options()}
    for name in settings:
        if name not in known:
            raise ValueError(_unknown(name, known))
    merged = {**DEFAULTS, **defaults, **settings}
    converted = {name: _convert(name, value) for name, value in merged.items()}
    _check_values(converted)
    return converted


def _unknown(name: str, known: set[str]) -> str:
    close = difflib.get_close_matches(str(name), known, n=3)
    hint = f"; did you mean {' or '.join(repr(c) for c in close)}?" if close else "."
    return f"opt_settings: Ipopt has no option '{name}'{hint}"


def _convert(name: str, value: Any) -> int | float | str:
    """Return ``value`` in the Python type that Ipopt wants for the option."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool) and name not in INTEGER_OPTIONS:
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    if not isinstance(value, int | float):
        raise ValueError(f"opt_settings['{name}'] must be a number or a string, not {value!r}.")
    if name not in INTEGER_OPTIONS:
        return float(value)
    if int(value) != value:
        raise ValueError(f"opt_settings['{name}'] must be an integer, not {value!r}.")
    return int(value)


def _check_values(settings: dict[str, Any]) -> None:
    """Let Ipopt judge every value on a scratch problem, so that the wrong one can be named."""
    empty = np.zeros(0, dtype=int)
    scratch = import_ipyopt().Problem(
        n=1,
        x_l=np.zeros(1),
        x_u=np.ones(1),
        m=0,
        g_l=np.zeros(0),
        g_u=np.zeros(0),
        sparsity_indices_jac_g=(empty, empty),
        sparsity_indices_h=(empty, empty),
        eval_f=lambda x: 0.0,
        eval_grad_f=lambda x, out: None,
        eval_g=lambda x, out: None,
        eval_jac_g=lambda x, out: None,
    )
    for name, value in settings.items():
        try:
            scratch.set(**{name: value})
        except (ValueError, TypeError) as error:
            raise ValueError(f"opt_settings['{name}']: Ipopt refuses {value!r}.") from error
