"""A mutant, and its copy of the independent reader."""

from __future__ import annotations

import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

PACKAGE = "independent"
READER = Path(__file__).parents[1] / PACKAGE


class Unclear(ValueError):
    """The replaced text is not in the file exactly once."""


@dataclass(frozen=True)
class Mutant:
    """A change of one rule: `old`, which is in `file` exactly once, becomes `new`.

    `equivalent` is the reason why no file can show the change; it is empty for all other mutants.
    """

    name: str
    file: str
    old: str
    new: str
    equivalent: str = ""

    def text(self) -> str:
        """The changed source text."""
        text = (READER / self.file).read_text("utf-8")
        count = text.count(self.old)
        if count != 1 or self.old == self.new:
            raise Unclear(f"{self.name}: the text is {count} times in {self.file}: {self.old!r}")
        return text.replace(self.old, self.new)

    def install(self, folder: Path) -> None:
        """Copy the reader with the change into `folder`, from which Python then imports it."""
        install(folder)
        (folder / PACKAGE / self.file).write_text(self.text(), "utf-8")


def install(folder: Path) -> None:
    """Copy the reader into `folder`, from which Python then imports it."""
    shutil.copytree(READER, folder / PACKAGE, ignore=shutil.ignore_patterns("__pycache__"))
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(folder))
