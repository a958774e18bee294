"""Blocks of load steps whose explicit terms are taken at once."""

BLOCK_BYTES = 64 * 2**20
"""Loads or adjoints of one block."""


def blocks(places, n_equations: int, n_columns: int) -> list:
    """Consecutive pieces of ``places``, as long as their vectors fit in ``BLOCK_BYTES``."""
    size = max(1, BLOCK_BYTES // (8 * n_equations * n_columns))
    return [places[first : first + size] for first in range(0, len(places), size)]


def is_full(nbytes: int) -> bool:
    """Whether vectors of that size make a block."""
    return nbytes >= BLOCK_BYTES
