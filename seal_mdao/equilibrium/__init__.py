"""Discretised body, its degrees of freedom, assembly of the tangent, linear solvers."""
