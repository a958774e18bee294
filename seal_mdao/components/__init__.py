"""OpenMDAO components of a seal, which convert units, names and errors."""
