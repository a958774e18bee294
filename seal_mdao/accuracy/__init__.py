"""Estimated errors of measures caused by particles, load steps and penalties."""
