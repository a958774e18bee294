"""Pictures and numbers of the documentation, made by the package."""
