"""What tolerances of parts and of assembly do to a seal: samples, records of them, estimates."""
