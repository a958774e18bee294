"""Benchmarks with known answers: what the verification tests assert and the documentation shows.

Every function returns plain numbers and arrays, and states the exact solution, its source and units.
"""
