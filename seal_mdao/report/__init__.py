"""One self-contained HTML page about an optimisation: ``write_report``."""
