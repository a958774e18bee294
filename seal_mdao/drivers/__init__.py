"""OpenMDAO drivers that continue if single analyses fail."""
