"""Seal files (TOML): section, materials, profiles, design, measures, optimisation and
tolerances."""
