"""Ladder of published benchmarks: seal files, finite elements beside them, values of the literature.

``python -m tests.benchmarks.ladder`` measures the rungs and writes ``docs/benchmarks/ladder.json``, from
which the page "How accurate is it" is made.
"""
