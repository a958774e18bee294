"""The door seal of Kim et al. (2000), section 5."""
