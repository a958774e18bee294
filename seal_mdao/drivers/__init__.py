"""OpenMDAO drivers that reach the optimum although an analysis may fail on the way."""
