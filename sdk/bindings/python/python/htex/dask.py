"""Build libraries from recipes on a Dask cluster.

The recipe and the results are the same as for :func:`htex.build`; only the fits run on the workers
of the cluster. Every worker needs the same version of this package. It also needs the recordings,
either under the same paths, or as URIs together with the environment variables for reading them.

Dask is the only supported cluster engine. The process that calls :func:`build` writes all results,
so that each is written once.

>>> from distributed import Client
>>> import htex.dask
>>> htex.dask.build("library.toml", Client("tcp://scheduler:8786"))  # doctest: +SKIP
"""

from __future__ import annotations

import hashlib
import os
import pathlib
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from . import _htex
from ._build import Path
from ._errors import BuildError

if TYPE_CHECKING:
    from distributed import Client
else:
    try:
        from distributed import Client
    except ImportError:
        Client = Any

__all__ = ["build"]

# A job: its key, the job itself as JSON, and the size of its recordings in bytes.
Job = tuple[str, str, int]
# Number of files that a worker hashes at a time.
_FILES = 32
# Pause between two attempts to reach the scheduler, seconds.
_PAUSE_S = 2.0


def build(
    recipe: Path,
    client: Client,
    output: Path = "dist",
    *,
    keep_going: bool = False,
    work: Path | None = None,
    plugins: Sequence[Path] = (),
    no_removals: bool = False,
    shard_bytes: int = 64_000_000,
    patience_s: float = 300.0,
    done: Callable[[str], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Build a library of textures from a recipe on a Dask cluster.

    The results are byte-identical to the results of :func:`htex.build`. If a worker is lost, other
    workers do its work. Only this process writes results, so each is written once. If the scheduler
    is lost, the build continues when the scheduler is back. If the build itself is interrupted, the
    results that were fitted so far stay in ``output``.

    Args:
        recipe: The recipe, ``library.toml``, as a path or URI. Its recordings may also be URIs,
            which the workers read.
        client: The client that is connected to the cluster.
        output: A folder for the results, or a URI. For a URI, the results are first made in
            ``work`` and copied to the URI when they are complete.
        keep_going: Leave out a texture that cannot be made instead of raising.
        work: The folder in which results for a URI are first made. The default is a folder in the
            user's cache.
        plugins: Files of further models to fit, as for :func:`htex.build`. They must have the same
            paths on every worker.
        no_removals: If the library would lose textures, raise an error and change nothing, as for
            :func:`htex.build`.
        shard_bytes: Largest size, bytes, of the recordings that a worker gets at a time. A texture
            with larger recordings gets a turn of its own.
        patience_s: Longest time to wait for a scheduler or workers that cannot be reached, seconds.
        done: A function that is called with the key of each finished job.
        progress: A function that is called with the number of fits that are finished and the number
            of all fits of this build: at the beginning, and after each shard.

    Returns:
        The report, as in ``build-report.json``.

    Raises:
        BuildError: The recipe is invalid, a texture cannot be made, or the cluster could not be
            reached for too long.
        OSError: A file cannot be read or written.
    """
    source = os.fspath(recipe)
    if "://" not in source:
        source = str(pathlib.Path(source).resolve())
    target = _htex.work_folder(os.fspath(output), work)
    patience = _Patience(patience_s)
    # The workers hash the recordings, because they can read them fastest.
    while files := _htex.unhashed(source, target):
        hashed: list[tuple[str, str]] = []
        with patience:
            try:
                batches = [files[i : i + _FILES] for i in range(0, len(files), _FILES)]
                for part in _results(client, _hash, [(source, batch) for batch in batches]):
                    hashed += part
                    patience.renew()
            finally:
                _htex.remember(target, hashed)
            break  # What is still not known has just changed; it is read here.
    named = [os.fspath(plugin) for plugin in plugins]
    planned = _htex.Build(source, os.fspath(output), keep_going, work, named, no_removals)
    total = len(planned.pending())
    if progress is not None:
        progress(0, total)
    while pending := planned.pending():
        with patience:
            for results in _results(client, _run, list(_shards(pending, shard_bytes))):
                for key, made in results:
                    planned.store(key, made)
                    if done is not None:
                        done(key)
                if progress is not None:
                    progress(total - len(planned.pending()), total)
                patience.renew()
    return planned.finish()


class _Patience:
    """Wait while the cluster cannot be reached, but only for a limited time."""

    def __init__(self, longest_s: float) -> None:
        self.longest_s = longest_s
        self.renew()

    def renew(self) -> None:
        """Note that the cluster is reachable."""
        self.seen = time.monotonic()

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if not isinstance(error, _lost()):
            return False
        if time.monotonic() - self.seen > self.longest_s:
            words = f"the cluster was away for {self.longest_s:g} s ({error}); what was fitted is kept, run the build again"
            raise BuildError(words) from error
        time.sleep(_PAUSE_S)
        return True


def _shards(pending: Iterable[Job], shard_bytes: int) -> Iterator[list[tuple[str, str]]]:
    """Group jobs into shards, in the order of their keys, which are content hashes."""
    shard: list[tuple[str, str]] = []
    size = 0
    for key, job, recording_bytes in sorted(pending):
        if shard and size + recording_bytes > shard_bytes:
            yield shard
            shard, size = [], 0
        shard.append((key, job))
        size += recording_bytes
    if shard:
        yield shard


def _results(client: Client, work: Callable[[Any], Any], parts: Sequence[Any]) -> Iterator[Any]:
    """Run the parts of the work on the cluster, and yield each part's result when it is
    finished."""
    from distributed import as_completed

    names = [_name(work, part) for part in parts]
    futures = client.map(work, parts, key=names, retries=3, pure=True)
    try:
        for future in as_completed(futures):  # type: ignore[no-untyped-call]
            yield future.result(timeout=60)
            future.release()
    finally:
        # Cancels the remaining work after an error, or when the caller stops.
        for future in futures:
            future.release()  # type: ignore[no-untyped-call]


def _name(work: Callable[[Any], Any], part: Any) -> str:
    """Name a part of the work by its contents, so that equal parts run only once."""
    digest = hashlib.blake2b(repr(part).encode(), digest_size=16).hexdigest()
    return f"htex{work.__name__}-{digest}"


def _hash(of_recipe: tuple[str, Sequence[str]]) -> list[tuple[str, str]]:
    """Hash files of a recipe on a worker."""
    recipe, files = of_recipe
    return [(file, _htex.hash_file(recipe, file)) for file in files]


def _run(shard: list[tuple[str, str]]) -> list[tuple[str, bytes]]:
    """Run jobs on a worker."""
    return [(key, _htex.run_job(key, job)) for key, job in shard]


def _lost() -> tuple[type[BaseException], ...]:
    """Return the exceptions that are raised when the scheduler or the workers cannot be reached."""
    from distributed import CancelledError, KilledWorker
    from distributed.comm.core import CommClosedError

    return (CancelledError, KilledWorker, CommClosedError, TimeoutError)
