"""Figures of analyses, sensitivities and optimisations.

Every function takes results and returns a matplotlib ``Figure`` that belongs to no window, so all
of them work without a display; ``save`` writes one to a file.
"""

from importlib import import_module

# public functions by module; imported at first use, so that matplotlib is loaded only for figures
_FUNCTIONS = {
    "style": "save",
    "ring_figure": "ring_view",
    "section_figures": "deformed_shapes critical_modes section_cloud design_comparison",
    "travel_curves": "load_deflection contact_width",
    "time_curves": "force_over_time",
    "contact_curves": "contact_pressure gap_profile",
    "iteration_curves": "cost_history objective_history constraint_history",
    "derivative_errors": "sensitivity_errors step_study",
    "material_figures": "material_fit calibration_figure",
    "calibration_curves": "force_calibration",
    "error_figures": "error_parts",
    "relaxation_figures": "relaxation_fit",
    "softening_figures": "softening_fit",
    "target_figures": "force_targets",
    "several_seals": "load_deflection_of seals_compared",
    "swept_numbers": "numbers_over",
    "animation": "save_animation",
    "sample_statistics": "distributions correlations designs_compared",
}
_MODULE_OF = {name: module for module, names in _FUNCTIONS.items() for name in names.split()}

__all__ = list(_MODULE_OF)


def __getattr__(name):
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)


def __dir__():
    return sorted(__all__)
