"""Terms of equilibrium: the contract, and terms that act at single points."""
