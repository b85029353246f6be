"""Texture assets for touch: open, play, fit and measure them.

>>> import htex
>>> samples = htex.open("cloth.htex").voice(rate_hz=48_000).render(48_000)  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ._author import agreement, compare, fit, process, tradeoff
from ._build import build
from ._by_hand import edit, make, mix
from ._data import (
    Agreement,
    Comparison,
    Condition,
    Coverage,
    DeviceStatus,
    Envelope,
    Exponent,
    Fit,
    Imported,
    LibraryChange,
    LibraryDifference,
    LibraryEntry,
    Processed,
    Reach,
    Response,
    Simulation,
    Spectrum,
    Tradeoff,
    quality_table,
)
from ._errors import (
    AssetError,
    BuildError,
    DeviceError,
    Error,
    ExchangeError,
    LibraryError,
    ModelError,
    MotionError,
    OptionError,
    RecordingError,
    SceneError,
    SignatureError,
)
from ._exchange import export, formats, import_file
from ._htex import Device, Library, Scene, Texture, Voice, __version__, devices, models, open, pack, unregister_model
from ._models import Field, register_model
from ._rig import response, simulate

if TYPE_CHECKING:
    from . import study as study

__all__ = [
    "Agreement",
    "AssetError",
    "BuildError",
    "Comparison",
    "Condition",
    "Coverage",
    "Device",
    "DeviceError",
    "DeviceStatus",
    "Envelope",
    "Exponent",
    "Error",
    "ExchangeError",
    "Field",
    "Fit",
    "Imported",
    "Library",
    "LibraryChange",
    "LibraryDifference",
    "LibraryEntry",
    "LibraryError",
    "ModelError",
    "MotionError",
    "OptionError",
    "Processed",
    "Reach",
    "RecordingError",
    "Response",
    "Scene",
    "SceneError",
    "SignatureError",
    "Simulation",
    "Spectrum",
    "Texture",
    "Tradeoff",
    "Voice",
    "__version__",
    "agreement",
    "build",
    "compare",
    "devices",
    "edit",
    "export",
    "fit",
    "formats",
    "import_file",
    "make",
    "mix",
    "models",
    "open",
    "pack",
    "process",
    "quality_table",
    "register_model",
    "response",
    "simulate",
    "tradeoff",
    "unregister_model",
]


def __getattr__(name: str) -> Any:
    """Import a module that most programs do not use."""
    if name == "study":
        return importlib.import_module("htex.study")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
