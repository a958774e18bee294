"""Isotropic rubbers and foams in plane strain: strain energy W(T, J) and its derivatives."""
