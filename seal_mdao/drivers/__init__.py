"""OpenMDAO drivers that converge although single analyses may fail."""
