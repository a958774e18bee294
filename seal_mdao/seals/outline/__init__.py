"""Sections made of lines, arcs, circles and splines: geometry, checks, drawings."""
