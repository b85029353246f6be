"""The package: the command, types, the README's examples."""

from __future__ import annotations

import inspect
import pathlib
import re
import shutil
import subprocess
import sys
import typing
from typing import Any

import pytest
from conftest import command

import htex

HERE = pathlib.Path(__file__).resolve().parent


def test_the_command_ends_with_its_status(place: pathlib.Path) -> None:
    assert command("-V", cwd=place).stdout == f"htex {htex.__version__}\n"
    assert "Usage: htex synth" in command("synth", "--help", cwd=place).stdout
    assert "unexpected argument" in command("synth", "--loud", cwd=place, code=2).stderr
    assert "missing.htex" in command("info", "missing.htex", cwd=place, code=1).stderr


def test_the_command_starts_itself_again(place: pathlib.Path) -> None:
    said = command("device", "check", "file", cwd=place).stdout
    assert "memory" in said and "failed" not in said


def test_one_process_runs_the_command_several_times(place: pathlib.Path) -> None:
    program = """
from htex import _htex
for words, status in [(["info", "cloth.htex"], 0), (["info", "no.htex"], 1), (["device", "check", "file"], 1)]:
    assert _htex.run(["htex", *words], []) == status
"""
    run = subprocess.run([sys.executable, "-c", program], cwd=place, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    assert "cannot find this program" in run.stderr


def test_the_script_is_installed(place: pathlib.Path) -> None:
    script = pathlib.Path(sys.executable).with_name("htex")
    if not script.exists():
        pytest.skip("the package is not installed")
    run = subprocess.run([script, "info", "cloth.htex"], cwd=place, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0 and "bands" in run.stdout


def test_types_are_strict(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("mypy")
    settings = str(HERE.parent / "pyproject.toml")
    for words in [["mypy", "--strict", "--config-file", settings, "-p", "htex"], ["mypy.stubtest", "htex._htex"]]:
        words = [sys.executable, "-m", *words]
        run = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=600)
        assert run.returncode == 0, run.stdout + run.stderr


def test_types_can_be_asked_for() -> None:
    import htex.dask
    import htex.plot

    for module in [htex, htex.dask, htex.plot]:
        for name in getattr(module, "__all__", vars(module)):
            value = getattr(module, name)
            if isinstance(value, type) or inspect.isfunction(value):
                typing.get_type_hints(value)
            members = vars(value).values() if isinstance(value, type) else []
            for member in members:
                if inspect.isfunction(member):
                    typing.get_type_hints(member)


def test_the_examples_of_the_readme_run(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    shutil.copy(place / "rec.csv", tmp_path)
    text = (HERE.parent / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 6
    for block in blocks:
        run = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert run.returncode == 0, run.stderr
    assert (tmp_path / "cloth.wav").stat().st_size == 44 + 2 * 480_000


def _blocks(page: str, language: str) -> list[str]:
    text = (HERE.parents[3] / "docs" / page).read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def test_the_lines_of_pages_run(place: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import htex.dask

    monkeypatch.chdir(tmp_path)
    shutil.copy(place / "cloth.htex", tmp_path)
    (plays,) = _blocks("languages.md", "python")
    played: dict[str, Any] = {}
    exec(plays, played)
    assert played["samples"].shape == (48_000,) and played["samples"].any()
    # The page's scheduler does not exist. The tests of `htex.dask` test it.
    (builds,) = _blocks("libraries.md", "python")
    call = builds.replace('Client("tcp://scheduler:8786")', "None").replace("htex.dask.build(", "bind(")
    bound: dict[str, Any] = {"bind": inspect.signature(htex.dask.build).bind}
    exec(call, bound)
    assert bound["report"].arguments["output"] == "dist"


def test_the_analysis_of_the_page_runs(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    golden = HERE.parents[3] / "tests/golden/study"
    monkeypatch.chdir(tmp_path)
    (analyses,) = _blocks("studies.md", "python")
    given: dict[str, Any] = {"htex": htex, "ratings": golden / "ratings.csv", "spectra": golden / "spectra.csv"}
    exec(analyses, given)
    assert (tmp_path / "results").is_dir()
    (console,) = _blocks("studies.md", "console")
    line, *lines = console.splitlines()
    printed = command(*line.removeprefix("$ htex ").split(), cwd=tmp_path).stdout.splitlines()
    shown = [line for line in lines if line != "..."]
    assert printed[: len(shown)] == shown
