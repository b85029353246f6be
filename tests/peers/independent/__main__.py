"""`python -m independent SPEC_FOLDER [--probes FILE]`: compare this reader with the conformance files."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .asset import read_asset
from .baked import compare_baked
from .compare import compare_folder, compare_recordings
from .library import read_library
from .models import read_models
from .playing import compare_playing
from .probes import compare_probes
from .quality import compare_quality
from .scene import read_scene


def main() -> int:
    parser = argparse.ArgumentParser(prog="independent", description=__doc__)
    parser.add_argument("spec", type=Path)
    parser.add_argument("--probes", type=Path)
    arguments = parser.parse_args()
    spec = arguments.spec
    models = read_models(spec)
    differs = False

    def summary(name: str, agree: int, total: int) -> None:
        nonlocal differs
        differs |= agree != total
        print(f"{name}: {agree} of {total} agree")

    summary(
        "conformance",
        *compare_folder(
            spec / "conformance", ".htex", lambda path, limits: read_asset(path.read_bytes(), models, limits)[1], print
        ),
    )
    summary("playing-conformance", *compare_playing(spec / "playing-conformance", models, print))
    summary(
        "library-conformance",
        *compare_folder(
            spec / "library-conformance",
            ".htexlib",
            lambda path, limits: read_library(path.read_bytes(), models, limits),
            print,
        ),
    )
    summary(
        "scene-conformance",
        *compare_folder(
            spec / "scene-conformance", ".scene.json", lambda path, limits: read_scene(path, models, limits), print
        ),
    )
    summary("recording-conformance", *compare_recordings(spec / "recording-conformance", print))
    summary("baked-conformance", *compare_baked(spec / "baked-conformance", print))
    summary("quality-conformance", *compare_quality(spec / "quality-conformance", models, print))
    if arguments.probes:
        for kind, (agree, total) in compare_probes(arguments.probes, models, spec / "schemas", print).items():
            summary(f"probes/{kind}", agree, total)
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main())
