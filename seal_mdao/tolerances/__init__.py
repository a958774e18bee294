"""Tolerances of parts and assembly: samples, studies that resume, first-order estimates."""
