"""The ``htex`` command."""

from __future__ import annotations

import sys

from . import _htex


def main() -> int:
    """Run the command with the arguments of the program and return its exit status."""
    # Without -P the current folder would precede the installed packages in processes that the command starts.
    safe = ["-P"] if sys.version_info >= (3, 11) else []
    again = [sys.executable, *safe, "-m", "htex"] if sys.executable else []
    return _htex.run(["htex", *sys.argv[1:]], again)


if __name__ == "__main__":
    sys.exit(main())
