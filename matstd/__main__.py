"""Entry point: `matstd` and `python -m matstd`."""

import sys

from matstd.stop import clean_stop, leave, raise_if_asked


def main() -> None:
    """Run the command line. An interrupt ends it tidily, also while it imports what it needs."""
    try:
        with clean_stop():
            from matstd.cli import main as run

            code = run()
            if code:
                raise_if_asked()  # a failure may be what an interrupt was made of
    except KeyboardInterrupt:
        leave()
    sys.exit(code)


if __name__ == "__main__":
    main()
