"""Argument parser of the command and its subcommands."""

import argparse
import re
import sys

NEGATIVE = re.compile(r"-\.?\d[\d.eE+-]*([:,]|[eE])")
"""Beginning of an argument that is no option: a negative range (-3:6:4), list (-3,0), number (-1e-3)."""


class OneLineParser(argparse.ArgumentParser):
    """Argument parser whose errors take one line, with status 2, and that accepts negative ranges."""

    def parse_known_args(self, args=None, namespace=None):
        """Parse arguments; a negative range such as -3:6:4 is a value, not an option."""
        # argparse takes all but plain negative numbers for options, unless a space comes first
        given = sys.argv[1:] if args is None else args
        given = [f" {own}" if NEGATIVE.match(own) else own for own in given]
        return super().parse_known_args(given, namespace)

    def error(self, message):
        """Exit with the message, without the usage that ``--help`` prints."""
        self.exit(2, f"{self.prog}: error: {message} (see {self.prog} --help)\n")
