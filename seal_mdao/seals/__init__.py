"""Seals: the contract, seals put together from terms, and the door seal of the paper."""
