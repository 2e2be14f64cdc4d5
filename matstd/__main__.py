"""Entry point: `matstd` and `python -m matstd`."""

import sys

from matstd.cli import main

if __name__ == "__main__":
    sys.exit(main())
