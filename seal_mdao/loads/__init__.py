"""Loads: dead loads, prescribed displacements, fluid pressure and trapped air."""
