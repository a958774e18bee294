"""A seal that is pressed a little, and its tolerances."""

import seal_mdao as sm
from seal_mdao.distributions import Normal, Triangular, Uniform
from seal_mdao.tolerances.boundary_errors import BoundaryTolerance
from seal_mdao.tolerances.tolerance_set import Tolerance, Tolerances
from seal_mdao.tolerances.tolerance_study import ToleranceStudy


def quick_seal():
    """Six load steps."""
    return sm.door_seal(start=10.2, depth=2.0, n_steps=6)


def some_tolerances():
    return Tolerances(
        (
            Tolerance(sm.Variation("friction"), Uniform(0.2, 0.3)),
            Tolerance(
                sm.Variation("hardness", "factor", ("c10", "c01")), Triangular(0.9, 1.0, 1.1)
            ),
            Tolerance(sm.Variation("depth", "shift"), Normal(0.0, 0.05)),
        ),
        BoundaryTolerance(0.02, 8.0),
    )


def quick_study():
    return ToleranceStudy(quick_seal(), some_tolerances(), ("reaction", "stress_norm"))
