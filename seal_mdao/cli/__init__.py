"""The command ``seal-mdao``: one module for every subcommand."""
