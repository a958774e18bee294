"""Constants of rubbers from tests: data, modes of testing, fits, stability."""
