"""Base component with checks of dense partials along random directions, for slow evaluations."""

import numpy as np

from seal_mdao.openmdao_access import UnchangedByResiduals

SMALLEST = 0.3
"""Least amount of the random numbers in -1 to 1 along scalar inputs: smaller ones leave differences
dominated by rounding. With k inputs no more than 1/k, so that few draws suffice."""


class RandomDirectionsComp(UnchangedByResiduals):
    """Compare partials with differences along random directions in ``check_partials``.

    With ``directional=True`` OpenMDAO uses the direction of all ones, unless a component is matrix
    free. For particles that is a translation, along which errors of opposite sign cancel. This
    component is matrix free during the check only: OpenMDAO then draws random directions and compares
    products of the partials with them, forward and reverse. In totals its partials are an ordinary
    Jacobian, which may be assembled.
    """

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.matrix_free = False
        self._checked, self._upward = {}, set()

    def set_check_partial_options(self, wrt, *args, **kwargs):
        """Set options of ``check_partials``; ``directional`` is always True, for OpenMDAO requires
        one value for all inputs. Random numbers along scalar inputs with forward differences are
        positive."""
        if kwargs.get("form") == "forward":
            self._upward.add(wrt)
        super().set_check_partial_options(wrt, *args, **kwargs | {"directional": True})

    def check_partials(self, *args, **kwargs):
        """Check the partials as ``Component.check_partials`` does of a component that is matrix free."""
        # compute_partials once at the point of the check, then products with its table
        self.matrix_free = True
        self._avoid_small_directions()
        try:
            data, worst = super().check_partials(*args, **kwargs)
        finally:
            self.matrix_free, self._checked = False, {}
        # OpenMDAO's differences lie in the memory of the Jacobian, which the next totals overwrite
        for block in data[self.pathname].values():
            block["J_fd"] = [table.copy() for table in block["J_fd"]]
        return data, worst

    def refuse_complex_step(self):
        """Raise RuntimeError under complex step, which the contact analysis does not support."""
        if self.under_complex_step:
            raise RuntimeError(
                f"{self.msginfo}: the contact analysis does not support complex steps; its partial "
                "derivatives are analytic, so leave this component out of groups that approximate "
                "derivatives with method='cs', or use method='fd'"
            )

    def _avoid_small_directions(self):
        """Advance NumPy's generator until the next draw has no small number for a scalar input."""
        # the threshold decreases with the number of inputs, so that few draws suffice
        inputs = self.get_io_metadata("input", ["shape"])
        shapes = [data["shape"] for data in inputs.values()]
        # |a| >= least, a >= least in forward differences
        sign = [np.abs if name not in self._upward else np.positive for name in inputs]
        least = min(SMALLEST, 1.0 / len(shapes))
        while True:
            # trial draw in the order of OpenMDAO's inputs; once accepted the state is restored, so that
            # OpenMDAO draws the same numbers
            state = np.random.get_state()
            drawn = [2.0 * np.random.random(np.prod(shape, dtype=int)) - 1.0 for shape in shapes]
            if all(d.size > 1 or of(d[0]) >= least for d, of in zip(drawn, sign, strict=True)):
                np.random.set_state(state)
                return

    def compute_jacvec_product(self, inputs, d_inputs, d_outputs, mode):
        """Multiply the partials by a direction of the inputs ("fwd") or of the outputs ("rev")."""
        if not self._checked:
            self.compute_partials(inputs, self._checked)
        # fwd: df = J dx;  rev: dx = J^T df
        for (of, wrt), table in self._checked.items():
            matrix = np.atleast_2d(table)
            if mode == "fwd":
                d_outputs[of] += (matrix @ d_inputs[wrt].ravel()).reshape(d_outputs[of].shape)
            else:
                d_inputs[wrt] += (matrix.T @ d_outputs[of].ravel()).reshape(d_inputs[wrt].shape)
