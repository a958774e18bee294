"""Newton iterations with independent stresses: for stiff contact and nearly incompressible bodies.

An iterate of Newton's method is right to the first order only. A point that moves by s along a profile
of radius R leaves it by s^2/(2 R), a body that turns by an angle a swells by a^2: nothing for the body,
but the contact penalty and the bulk modulus make forces of it that are many times those of equilibrium.
They are in the residual, where the next iteration removes them, and they are in the tangent too, as
geometric stiffness and as points that open or touch: this is what leads the next iterate astray.

With pressure p and contact force f as unknowns of their own, eliminated from every linearised step,
the residual is the same, and the tangent is that at the linearised values

    p_{k+1} = p(d_k) + dp/dd (d_{k+1} - d_k),    f_{k+1} = f(z_k) + df/dx (x_{k+1} - z_k),

which no penalty multiplies. So points are open, stick or slip as they do at f_{k+1}. Converged iterates
satisfy the same discrete equation.

D. Magisano, L. Leonetti, G. Garcea, Advantages of the mixed format in geometrically nonlinear
analysis of beams and shells using solid finite elements, Int. J. Numer. Methods Eng. 109, 2017.
"""

import numpy as np

from seal_mdao.analysis.increment import Increment, Solution
from seal_mdao.analysis.newton import iterate


def mixed_newton(increment: Increment, guess: np.ndarray) -> Solution:
    """Iterate to equilibrium with linearised pressures and contact forces.

    Parameters
    ----------
    guess : ndarray, shape (n, 2)
        The predictor, which is the first linearised step from ``increment.last``.
    """
    begin = increment.problem.begin_mixed(increment.last, increment.target)
    return iterate(increment, guess, begin, mixed=True)
