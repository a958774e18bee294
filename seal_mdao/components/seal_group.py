"""Groups of a seal: base class, and geometry, area and contact analysis."""

import openmdao.api as om

from seal_mdao.components.area_comp import AreaComp
from seal_mdao.components.options import CONTACT_OPTIONS, declare_seal_options
from seal_mdao.components.rkpm_contact_comp import RkpmContactComp
from seal_mdao.components.spline_geometry_comp import SplineGeometryComp
from seal_mdao.openmdao_access import RunOnce
from seal_mdao.seals.seal import SETTINGS_OPTION


class DesignGroup(om.Group):
    """Base class of groups whose components share the inputs of one seal; it records its settings."""

    def initialize(self):
        self.options.declare(
            SETTINGS_OPTION,
            default=[],
            types=list,
            desc="Description of the seal as JSON text; written by setup for recorder files.",
        )

    def setup(self):
        seal = self.options["seal"]
        # recorders store options that are text: a report rebuilds the seal from them. OpenMDAO drops
        # values of more than 10 kB by ``sys.getsizeof``, which does not count the entries of a list
        self.options[SETTINGS_OPTION] = [seal.settings()]
        # no feedback between the components: each runs once
        self.nonlinear_solver = RunOnce()
        # several components promote these inputs: one default for all
        for name in seal.inputs:
            value, units, _ = seal.scalars[name]
            self.set_input_defaults(name, value, units=units)

    def guess_nonlinear(self, inputs, outputs, residuals, *discrete):
        """Start an iterative solver of a loop through this group from the last completed analysis.

        The NaN of a failed analysis would return to the inputs of all later designs.
        """
        if isinstance(self.nonlinear_solver, RunOnce):
            self.nonlinear_solver.replace_nan()


class SealGroup(DesignGroup):
    """Group that computes the measures of a seal from its design parameters.

    Promoted inputs: ``boundary_offsets`` (mm), the seal's own scalar inputs (``door_radius`` of the
    door seal) and those named in ``parameters``. Promoted outputs: ``particles`` (mm), ``area``
    (mm**2), and the measures: of the door seal ``von_mises`` (kPa), ``gap`` (mm), ``gap_square_sum``
    (mm**2), ``reaction`` (N/m) unless ``measures`` says otherwise. Without a gap region in the
    nominal seal there is no ``gap``, and ``gap_square_sum`` is zero. A design that cannot be analysed
    raises ``AnalysisError`` and leaves NaN in all of them.

    Parameters
    ----------
    seal : Seal
    measures : sequence of str or Measure, optional
        Outputs: names of measures of the seal, or measures; the standard ones when left out.
    parameters : sequence of str
        Scalar parameters (``seal.scalars``) and placements of profiles, such as ``lid_y``, that become
        inputs beside those that the seal always has.
    sensitivity : {"auto", "direct", "adjoint"}
        Method of the partials; ``auto`` selects the one with fewer right-hand sides.
    factor_memory : float
        GiB for factors of converged tangents; those beyond are computed again for the partials.
    cache : AnalysisCache, optional
        Cache of analyses; by default the last one only.
    callback : callable, optional
        Called with every converged load step.
    """

    def initialize(self):
        super().initialize()
        declare_seal_options(self.options)

    def setup(self):
        # the settings of the seal in recorder files include its placement parameters
        seal = self.options["seal"] = self.options["seal"].placed(self.options["parameters"])
        super().setup()
        self.add_subsystem("geometry", SplineGeometryComp(seal=seal), promotes=["*"])
        self.add_subsystem("section", AreaComp(seal=seal), promotes=["*"])
        # all options of the group but its settings
        chosen = {name: self.options[name] for name in CONTACT_OPTIONS}
        self.add_subsystem("contact", RkpmContactComp(**chosen), promotes=["*"])
