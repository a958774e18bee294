"""Terms of the equilibrium equations: base classes, and terms that act at single points."""
