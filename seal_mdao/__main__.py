"""``python -m seal_mdao``: the command ``seal-mdao``."""

import sys

from seal_mdao.cli.subcommands import main

if __name__ == "__main__":
    sys.exit(main())
