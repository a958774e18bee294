"""The seal file: a section, its material, what moves against it, and what is asked, as TOML."""
