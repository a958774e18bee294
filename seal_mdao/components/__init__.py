"""OpenMDAO components: thin wrappers that translate units, names and errors."""
