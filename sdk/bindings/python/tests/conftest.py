"""Fixtures: a simulated recording, an asset that was fitted to it, and the command."""

from __future__ import annotations

import pathlib
import subprocess
import sys

import pytest

import htex

ROOT = pathlib.Path(__file__).resolve().parents[4]


def command(*arguments: object, cwd: pathlib.Path, code: int = 0) -> subprocess.CompletedProcess[str]:
    """Run the command of the package and check its exit status."""
    words = [sys.executable, "-P", "-m", "htex", *map(str, arguments)]
    if sys.version_info < (3, 11):
        words.remove("-P")
    run = subprocess.run(words, cwd=cwd, capture_output=True, text=True, timeout=300)
    assert run.returncode == code, run.stderr
    return run


@pytest.fixture(scope="session")
def place(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """Return a folder with a recording, rec.csv, and the asset that the command fits to it,
    cloth.htex."""
    folder = tmp_path_factory.mktemp("place")
    command("simulate", "--surface", "coarse-fabric", "-o", "rec.csv", cwd=folder)
    command("fit", "rec.csv", "-o", "cloth.htex", "--license", "CC0-1.0", cwd=folder)
    return folder


@pytest.fixture(scope="session")
def texture(place: pathlib.Path) -> htex.Texture:
    """The asset."""
    return htex.open(place / "cloth.htex")
