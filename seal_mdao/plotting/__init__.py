"""Figures of analyses, sensitivities and optimisations.

Every function takes results and returns a matplotlib ``Figure`` that belongs to no window, so all
of them work without a display; ``save`` writes one to a file.
"""

from importlib import import_module

# function: module; imported at first use, so that matplotlib is loaded only where figures are made
_LAZY = {
    "save": "seal_mdao.plotting.style",
    "deformed_shapes": "seal_mdao.plotting.deformation",
    "load_deflection": "seal_mdao.plotting.reaction",
    "critical_modes": "seal_mdao.plotting.critical",
    "section_cloud": "seal_mdao.plotting.cloud",
    "contact_pressure": "seal_mdao.plotting.contact",
    "contact_width": "seal_mdao.plotting.contact",
    "gap_profile": "seal_mdao.plotting.gap",
    "cost_history": "seal_mdao.plotting.history",
    "objective_history": "seal_mdao.plotting.history",
    "constraint_history": "seal_mdao.plotting.history",
    "design_comparison": "seal_mdao.plotting.comparison",
    "sensitivity_errors": "seal_mdao.plotting.sensitivity",
    "step_study": "seal_mdao.plotting.sensitivity",
    "material_fit": "seal_mdao.plotting.fitted_material",
    "calibration_figure": "seal_mdao.plotting.calibration",
    "distributions": "seal_mdao.plotting.tolerances",
    "correlations": "seal_mdao.plotting.tolerances",
    "designs_compared": "seal_mdao.plotting.tolerances",
}

__all__ = list(_LAZY)


def __getattr__(name):
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_LAZY[name]), name)


def __dir__():
    return sorted(__all__)
