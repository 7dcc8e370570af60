"""The command `beltspace`, also as `python -m beltspace`."""

import signal
import sys

from beltspace._beltspace import run_program


def main() -> int:
    """Runs the command line; returns the exit code: 0, 1 for a failure while running, 2 for a wrong request."""
    # Ctrl-C is the program's own business: it saves what is done, or ends at once.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_program(sys.argv)


if __name__ == "__main__":
    sys.exit(main())
