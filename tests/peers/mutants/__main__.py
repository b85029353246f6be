"""`python -m mutants SPEC_FOLDER [--only PART] [--json]`: which mutants the conformance files notice.

Exits with 1 if a mutant survives that is not named as equivalent, if one that is named so is noticed, or if the text
that a mutant replaces is not in its file exactly once.
"""

from __future__ import annotations

import argparse
import io
import json
import multiprocessing
import signal
import sys
import tempfile
import time
from contextlib import redirect_stdout
from pathlib import Path

# Imported before the processes are started, which then need not import them again: this takes longer than most mutants.
import blake3  # noqa: F401
import cryptography.hazmat.primitives.asymmetric.ed25519  # noqa: F401
import numpy  # noqa: F401
import scipy.fft  # noqa: F401
import scipy.optimize  # noqa: F401
import scipy.special  # noqa: F401

from . import assets, baked, libraries, playing
from .mutant import Mutant, Unclear, install

PARTS: dict[str, list[Mutant]] = {
    "playing": playing.MUTANTS,
    "assets": assets.MUTANTS,
    "libraries": libraries.MUTANTS,
    "baked": baked.MUTANTS,
}
PROCESSES = 2
# A mutant may never end. The slowest one that does takes a few seconds.
LIMIT_S = 120


class Noticed(Exception):
    """A file shows the change; the text names the file."""


def notice(difference: str) -> None:
    raise Noticed(difference)


def compare(part: str, spec: Path) -> None:
    """Compare the installed reader with the files of a part; raises `Noticed` at the first difference."""
    from independent.models import read_models

    models = read_models(spec)
    if part == "playing":
        from independent.playing import compare_playing

        compare_playing(spec / "playing-conformance", models, notice)
        return
    if part == "baked":
        from independent.baked import compare_baked

        compare_baked(spec / "baked-conformance", notice)
        return
    from independent.asset import read_asset
    from independent.compare import compare_folder
    from independent.library import read_library

    if part == "assets":
        compare_folder(
            spec / "conformance", ".htex", lambda path, limits: read_asset(path.read_bytes(), models, limits)[1], notice
        )
    else:
        compare_folder(
            spec / "library-conformance",
            ".htexlib",
            lambda path, limits: read_library(path.read_bytes(), models, limits),
            notice,
        )


def first_difference(job: tuple[str, Mutant | None, Path]) -> str | None:
    """What shows a mutant (of None, the reader as it is); None if nothing does. Runs in a process of its own."""
    part, mutant, spec = job
    signal.alarm(LIMIT_S)
    signal.signal(signal.SIGALRM, lambda *_: notice(f"no end after {LIMIT_S} s"))
    with tempfile.TemporaryDirectory() as folder, redirect_stdout(io.StringIO()), numpy.errstate(all="ignore"):
        try:
            mutant.install(Path(folder)) if mutant else install(Path(folder))
            compare(part, spec)
        except Unclear:
            raise
        except Exception as error:
            # A reader that fails on a file shows its change as well.
            return f"{type(error).__name__}: {error}"[:300]
        finally:
            signal.alarm(0)
    return None


def main() -> int:
    parser = argparse.ArgumentParser(prog="mutants", description=__doc__)
    parser.add_argument("spec", type=Path)
    parser.add_argument("--only", choices=PARTS)
    parser.add_argument("--json", action="store_true", help="print what shows each mutant, as JSON")
    arguments = parser.parse_args()
    parts = {part: mutants for part, mutants in PARTS.items() if arguments.only in (None, part)}
    wrong = []
    for mutant in (mutant for mutants in parts.values() for mutant in mutants):
        try:
            mutant.text()
        except Unclear as unclear:
            wrong.append(str(unclear))
    names = [(part, mutant.name) for part, mutants in parts.items() for mutant in mutants]
    wrong += [f"{part}: two mutants are called {name}" for part, name in sorted(set(names)) if names.count((part, name)) > 1]
    if wrong:
        print("\n".join(wrong), file=sys.stderr)
        return 1
    began, report = time.monotonic(), {}
    with multiprocessing.get_context("fork").Pool(PROCESSES, maxtasksperchild=1) as pool:
        for part, mutants in parts.items():
            jobs = [(part, mutant, arguments.spec) for mutant in (None, *mutants)]
            unchanged, *shown = pool.imap(first_difference, jobs)
            if unchanged is not None:
                print(f"{part}: the reader does not agree with the files: {unchanged}", file=sys.stderr)
                return 1
            found = list(zip(mutants, shown))
            report[part] = {
                "mutants": len(mutants),
                "killed": sum(by is not None for _, by in found),
                "survivors": [mutant.name for mutant, by in found if by is None and not mutant.equivalent],
                "equivalent": {mutant.name: mutant.equivalent for mutant, by in found if by is None and mutant.equivalent},
                "not_equivalent": [mutant.name for mutant, by in found if by is not None and mutant.equivalent],
                "by": {mutant.name: by for mutant, by in found},
            }
    if arguments.json:
        print(json.dumps(report, indent=2, ensure_ascii=False))
    else:
        for part, counts in report.items():
            print(
                f"{part}: {counts['mutants']} mutants, {counts['killed']} killed, "
                f"{len(counts['equivalent'])} equivalent, {len(counts['survivors'])} survive"
            )
            for name in counts["survivors"]:
                print(f"  survives: {name}")
            for name in counts["not_equivalent"]:
                print(f"  named as equivalent, and killed: {name}")
        total = sum(counts["mutants"] for counts in report.values())
        print(f"{total} mutants in {time.monotonic() - began:.0f} s")
    return int(any(counts["survivors"] or counts["not_equivalent"] for counts in report.values()))


if __name__ == "__main__":
    sys.exit(main())
