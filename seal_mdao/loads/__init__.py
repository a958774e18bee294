"""Dead loads and imposed displacements."""
