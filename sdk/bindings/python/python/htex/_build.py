"""Build libraries from recipes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from . import _htex

Path = str | os.PathLike[str]


def build(
    recipe: Path,
    output: Path,
    *,
    keep_going: bool = False,
    work: Path | None = None,
    plugins: Sequence[Path] = (),
    no_removals: bool = False,
) -> dict[str, Any]:
    """Build a library of textures from a recipe, as ``htex build`` does.

    Fitted results stay in ``output``. So an interrupted build continues where it stopped, and a
    repeated build fits only the textures that have changed.

    Args:
        recipe: The recipe, ``library.toml``, as a path or URI. Its recordings may also be URIs.
        output: A folder for the results, or a URI (``s3://``, ``gs://``, ``az://``). For a URI, the
            results are first made in ``work`` and copied to the URI when they are complete.
        keep_going: Leave out a texture that cannot be made instead of raising.
        work: The folder in which results for a URI are first made. The default is a folder in the
            user's cache.
        plugins: Files of further models to fit. WASM modules run in a sandbox; native libraries run
            with all your rights. A recipe itself can name only WASM modules.
        no_removals: If the library would lose textures, e.g. because a folder of recordings was
            moved, raise an error and change nothing.

    Returns:
        The report, as in ``build-report.json``: ``report["library"]`` and ``report["textures"]``;
        and ``report["removed"]`` if the new library lacks textures of the previous one.

    Raises:
        BuildError: The recipe is invalid, a texture cannot be made, or the library would lose
            textures.
        OSError: A file cannot be read or written.
    """
    named = [os.fspath(plugin) for plugin in plugins]
    planned = _htex.Build(os.fspath(recipe), os.fspath(output), keep_going, work, named, no_removals)
    planned.run()
    return planned.finish()
