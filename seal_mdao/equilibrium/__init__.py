"""The discretised body, its degrees of freedom, the assembly of the tangent, linear solvers."""
