"""Estimated errors of measures by particles, load steps and penalties."""
