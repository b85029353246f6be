"""The ``htex`` command."""

from __future__ import annotations

import sys

from . import _htex
from .study import cli


def main() -> int:
    """Run the command with the arguments of the program and return its exit status."""
    words = sys.argv[1:]
    answered = cli.run(words)
    if answered is not None:
        return answered
    # Without -P, processes that the command starts would search the current folder before the
    # installed packages.
    safe = ["-P"] if sys.version_info >= (3, 11) else []
    again = [sys.executable, *safe, "-m", "htex"] if sys.executable else []
    status = _htex.run(["htex", *words], again)
    if words == ["explain"]:
        sys.stdout.write(cli.rules())
    return status


if __name__ == "__main__":
    sys.exit(main())
