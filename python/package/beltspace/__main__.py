"""The command `beltspace`, also as `python -m beltspace`."""

import shutil
import signal
import sys
from pathlib import Path

from beltspace._beltspace import run_program


def main() -> int:
    """Runs the command line; returns the exit code: 0, 1 for a failure while running, 2 for a wrong request."""
    # Ctrl-C is the program's own business: it saves what is done, or ends at once.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return run_program([_command(), *sys.argv[1:]])


def _command() -> str:
    """The path of the command, which helps and job scripts name: of this environment, where it was started as a module."""
    started = Path(sys.argv[0])
    if started.name != "__main__.py":
        return sys.argv[0]
    return shutil.which("beltspace", path=str(Path(sys.executable).parent)) or "beltspace"


if __name__ == "__main__":
    sys.exit(main())
