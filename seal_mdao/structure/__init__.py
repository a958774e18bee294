"""The structural form a: hyperelastic bodies, internal force, its rates and seeds."""
