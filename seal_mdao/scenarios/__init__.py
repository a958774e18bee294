"""Robust optimisation: variations of a design, analysis of scenarios, statistics of the results."""
