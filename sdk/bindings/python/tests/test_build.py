"""Build libraries from recipes, in this process and on a cluster of processes."""

from __future__ import annotations

import hashlib
import http.server
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest
from conftest import command
from distributed import Client

import htex
import htex.dask

RECIPE = """
[library]
name = "surfaces"
[[textures]]
recordings = "*.csv"
license = "CC0-1.0"
models = ["ar", "bands", "mfcc"]
at = { speed_mm_s = 80, force_n = 0.4 }
"""


@pytest.fixture(scope="module")
def recipe(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A recipe of twelve recordings of 2 s."""
    folder = tmp_path_factory.mktemp("recipe")
    for seed in range(4):
        for surface in ("vinyl", "sandpaper", "coarse-fabric"):
            name = f"{surface}-{seed}.csv"
            command("simulate", "--surface", surface, "--seed", seed, "--seconds", 2, "-o", name, cwd=folder)
    (folder / "library.toml").write_text(RECIPE)
    return folder / "library.toml"


@pytest.fixture(scope="module")
def local(recipe: pathlib.Path) -> dict[str, bytes]:
    """Return the files that a build on this machine writes."""
    report = htex.build(recipe, recipe.parent / "local")
    assert report["library"]["textures"] == 12
    return results(recipe.parent / "local")


def results(folder: pathlib.Path) -> dict[str, bytes]:
    """Return all files of a build, except those that are kept for the next build."""
    files = (file for file in folder.rglob("*") if file.is_file() and ".htex-build" not in file.parts)
    return {str(file.relative_to(folder)): file.read_bytes() for file in files}


class Cluster:
    """Start a scheduler and workers on this machine. Each is a process."""

    def __init__(self, folder: pathlib.Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        self.folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []
        self.start_scheduler()

    def start(self, *words: str) -> subprocess.Popen[bytes]:
        environment = os.environ | {
            # A worker that does not answer counts as lost after 3 s instead of 5 min.
            "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "3s",
            "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "10",
        }
        program = [sys.executable, "-m", *words]
        log = open(self.folder / f"{len(self.processes)}.log", "wb")
        process = subprocess.Popen(program, env=environment, stdout=log, stderr=log, cwd=self.folder)
        self.processes.append(process)
        return process

    def start_scheduler(self) -> None:
        port = self.address.rpartition(":")[2]
        self.scheduler = self.start(
            "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"
        )

    def start_worker(self) -> subprocess.Popen[bytes]:
        return self.start(
            "distributed.cli.dask_worker", self.address, "--no-nanny", "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"
        )

    def stop(self) -> None:
        for process in self.processes:
            process.kill()
        for process in self.processes:
            process.wait()


@pytest.fixture
def cluster(tmp_path: pathlib.Path) -> Iterator[Cluster]:
    running = Cluster(tmp_path)
    yield running
    running.stop()


def test_a_worker_that_is_killed_and_one_that_hangs_change_nothing(
    recipe: pathlib.Path, local: dict[str, bytes], cluster: Cluster
) -> None:
    first, hanging = cluster.start_worker(), cluster.start_worker()
    with Client(cluster.address, timeout=60) as client:
        client.wait_for_workers(2, timeout=60)
        done: list[str] = []

        def disturb(key: str) -> None:
            done.append(key)
            if len(done) == 1:
                first.send_signal(signal.SIGKILL)
                hanging.send_signal(signal.SIGSTOP)
                cluster.start_worker()

        told: list[tuple[int, int]] = []
        report = htex.dask.build(
            recipe, client, recipe.parent / "dask", shard_bytes=1, done=disturb, progress=lambda ended, of: told.append((ended, of))
        )
    assert told[0][0] == 0 and told[-1] == (told[0][1], told[0][1]) and sorted(told) == told
    assert report["library"]["textures"] == 12
    assert len(done) == len(set(done)) == 12
    assert results(recipe.parent / "dask") == local


def test_a_scheduler_that_is_lost_is_waited_for(
    recipe: pathlib.Path, local: dict[str, bytes], cluster: Cluster
) -> None:
    cluster.start_worker()
    with Client(cluster.address, timeout=60) as client:
        client.wait_for_workers(1, timeout=60)
        done: list[str] = []

        def disturb(key: str) -> None:
            done.append(key)
            if len(done) == 3:
                cluster.scheduler.kill()
                cluster.scheduler.wait()
                time.sleep(1)
                cluster.start_scheduler()
                cluster.start_worker()

        htex.dask.build(recipe, client, recipe.parent / "restarted", shard_bytes=1, done=disturb)
    assert len(set(done)) == 12
    assert results(recipe.parent / "restarted") == local


def test_what_cannot_be_made_is_named(recipe: pathlib.Path, cluster: Cluster, tmp_path: pathlib.Path) -> None:
    cluster.start_worker()
    (tmp_path / "broken.csv").write_text("t_s,lateral_n\n0,1\n0.1,zero\n")
    (tmp_path / "library.toml").write_text(RECIPE)
    with Client(cluster.address, timeout=60) as client:
        with pytest.raises(htex.BuildError, match="broken.*zero"):
            htex.dask.build(tmp_path / "library.toml", client, tmp_path / "dist")
        assert "broken" in error_of(tmp_path / "dist")[0]
        report = htex.dask.build(tmp_path / "library.toml", client, tmp_path / "dist", keep_going=True)
    assert report["library"]["left_out"] == 1 and error_of(tmp_path / "dist") == []
    with pytest.raises(htex.BuildError, match="broken.*zero"):
        htex.build(tmp_path / "library.toml", tmp_path / "dist")
    assert "broken" in error_of(tmp_path / "dist")[0]
    with pytest.raises(htex.BuildError, match="no file matches"):
        (tmp_path / "broken.csv").unlink()
        htex.build(tmp_path / "library.toml", tmp_path / "dist")
    assert "no file matches" in error_of(tmp_path / "dist")[0]


def test_a_recipe_that_nests_without_end_is_an_exception(tmp_path: pathlib.Path) -> None:
    """Otherwise the TOML parser would overflow the stack and end the interpreter. The stack of a
    thread is even smaller."""
    lines = "motion = { const']\nphases = ['testing']\n" * 7_200
    deep = "[library]\nname = " + "[" * 100_000
    for text, place in ((lines, "line 1, column 18"), (deep, "line 2, column 32")):
        file = tmp_path / "library.toml"
        file.write_text(text)
        with pytest.raises(htex.BuildError, match=place):
            htex.build(file, tmp_path / "dist")


def error_of(folder: pathlib.Path) -> list[str]:
    """Return the error that a report states, line by line."""
    report = json.loads((folder / "build-report.json").read_text())
    error: list[str] = report.get("error", [])
    return error


class Files(http.server.BaseHTTPRequestHandler):
    """Serve the files of a folder by HTTP, with ranges and entity tags."""

    folder: pathlib.Path
    seen: list[str]

    def do_GET(self) -> None:
        file = self.folder / self.path.lstrip("/")
        if not file.is_file():
            self.send_error(404)
            return
        data = file.read_bytes()
        asked = self.headers.get("Range")
        self.seen.append(f"{self.command} {self.path} {asked or 'whole'}")
        first, last = 0, len(data) - 1
        if asked and (found := re.fullmatch(r"bytes=(\d+)-(\d*)", asked)):
            first, last = int(found[1]), min(int(found[2] or last), last)
        self.send_response(206 if asked else 200)
        self.send_header("ETag", f'"{hashlib.sha256(data).hexdigest()}"')
        self.send_header("Last-Modified", "Mon, 02 Nov 2026 10:00:00 GMT")
        if asked:
            self.send_header("Content-Range", f"bytes {first}-{last}/{len(data)}")
        self.send_header("Content-Length", str(last + 1 - first))
        self.end_headers()
        if self.command == "GET":
            self.wfile.write(data[first : last + 1])

    do_HEAD = do_GET

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture
def served(recipe: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[str, list[str]]]:
    """Serve the recipe's folder by HTTP. Return its URL and the requests."""
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    seen: list[str] = []
    handler = type("Handler", (Files,), {"folder": recipe.parent, "seen": seen})
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}", seen
        server.shutdown()


def test_workers_read_recordings_by_uri(
    recipe: pathlib.Path, local: dict[str, bytes], cluster: Cluster, served: tuple[str, list[str]], tmp_path: pathlib.Path
) -> None:
    url, seen = served
    names = sorted(file.name for file in recipe.parent.glob("*.csv"))
    table = "recording\n" + "".join(f"{url}/{name}\n" for name in names)
    # A recipe may name the server from which it comes, but no other server on this machine.
    (recipe.parent / "all.table").write_text(table)
    (recipe.parent / "away.toml").write_text(RECIPE.replace('recordings = "*.csv"', 'table = "all.table"'))
    away = f"{url}/away.toml"
    beside = tmp_path / "library.toml"
    beside.write_text(RECIPE.replace('recordings = "*.csv"', f'recordings = "{url}/{names[0]}"'))
    with pytest.raises(htex.BuildError, match="machine or network"):
        htex.build(beside, tmp_path / "none")
    assert seen == []
    cluster.start_worker()
    with Client(cluster.address, timeout=60) as client:
        client.wait_for_workers(1, timeout=60)
        htex.dask.build(away, client, tmp_path / "dist")
        again = len(seen)
        htex.dask.build(away, client, tmp_path / "dist")
    assert results(tmp_path / "dist") == local
    assert not any(line.startswith("GET") and ".csv" in line for line in seen[again:]), seen[again:]


def test_a_texture_of_a_library_is_read_by_uri(
    recipe: pathlib.Path, local: dict[str, bytes], served: tuple[str, list[str]]
) -> None:
    url, seen = served
    library = htex.Library(f"{url}/local/surfaces.htexlib")
    assert library.to_bytes("vinyl-0") == local["textures/vinyl-0.htex"]
    assert len(seen) <= 3 and all("bytes=" in line for line in seen), seen
    opened = htex.open(f"{url}/local/surfaces.htexlib#vinyl-0")
    assert opened.to_bytes() == local["textures/vinyl-0.htex"]
    with pytest.raises(htex.LibraryError, match="missing"):
        htex.Library(f"{url}/missing.htexlib")
