"""Keywords that several functions share. They are settings of the ``htex`` command;
``_settings.py`` is generated from its definitions.
"""

from __future__ import annotations

import inspect
import json
import math
import os
import sys
import typing
from collections.abc import Callable, Mapping
from typing import Annotated, Any, TypeVar

from . import _errors
from ._data import Response
from ._settings import FitSettings, Metadata, ReadingSettings

if sys.version_info >= (3, 11):
    from typing import Unpack as Unpack
else:
    from typing_extensions import Unpack as Unpack

F = TypeVar("F", bound=Callable[..., Any])


class Reading(ReadingSettings, total=False):
    """Keywords that state how recordings are read."""

    speed_mm_s: Annotated[float | None, "Scanning speed, mm/s, if the recording does not state it, or to replace what it states"]
    force_n: Annotated[float | None, "Normal force, newtons, if the recording does not state it, or to replace what it states"]
    response: Annotated[
        str | os.PathLike[str] | Response | None,
        "Response of the recording setup, by which spectra are divided: one that was measured, or a CSV file with columns frequency_hz, magnitude and, "
        "if known, phase_rad",
    ]
    strict: Annotated[bool | None, "Refuse recordings with findings that are errors or warnings"]


class Fitting(Reading, FitSettings, Metadata, total=False):
    """Keywords that state how recordings are read and fitted, and the texture's metadata."""


def keywords(kind: type) -> Callable[[F], F]:
    """Decorate a function that takes the keywords of ``kind`` as ``**settings``: show them in its
    signature and docstring.
    """

    def described(function: F) -> F:
        hints = typing.get_type_hints(kind, include_extras=True)
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        shared = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=hint.__args__[0])
            for name, hint in hints.items()
        ]
        lines = [f"    {name}: {hint.__metadata__[0]}" for name, hint in hints.items()]
        function.__doc__ = inspect.cleandoc(function.__doc__ or "") + "\n\nKeywords:\n" + "\n".join(lines)
        function.__signature__ = signature.replace(parameters=own + shared)  # type: ignore[attr-defined]
        return function

    return described


def split(function: str, settings: Mapping[str, object], *kinds: type) -> list[dict[str, Any]]:
    """Return the settings of each kind, in one dict per kind.

    Refuse a keyword that belongs to none of the kinds. Drop settings that are ``None``, which
    stands for the default.
    """
    left = dict(settings)
    parts = [{name: left.pop(name) for name in typing.get_type_hints(kind) if name in left} for kind in kinds]
    if left:
        raise TypeError(f"{function}() got an unexpected keyword argument {next(iter(left))!r}")
    return [{name: value for name, value in part.items() if value is not None} for part in parts]


def as_json(settings: Mapping[str, Any]) -> str:
    """Return settings as JSON, which the extension module takes."""
    for name, value in settings.items():
        if isinstance(value, float) and not math.isfinite(value):
            raise _errors.OptionError(f"{name} is {value}; give a finite number")
    return json.dumps(settings, default=_plain)


def _plain(value: Any) -> Any:
    """Convert paths, NumPy numbers and arrays, and other sequences to values that JSON can
    represent.
    """
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"expected a text, a number, a path or a sequence, got {type(value).__name__}") from None
