"""The door seal of Kim et al. (2000), section 5: one seal among others, nothing else knows it."""
