"""Argument parser of the command and its subcommands."""

import argparse


class OneLineParser(argparse.ArgumentParser):
    """Argument parser whose errors take one line, with status 2."""

    def error(self, message):
        """Exit with the message, without the usage that ``--help`` prints."""
        self.exit(2, f"{self.prog}: error: {message} (see {self.prog} --help)\n")
