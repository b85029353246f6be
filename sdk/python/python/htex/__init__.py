"""Texture assets for touch: open, play, fit and measure them.

>>> import htex
>>> samples = htex.open("cloth.htex").voice(rate_hz=48_000).render(48_000)  # doctest: +SKIP
"""

from __future__ import annotations

from ._author import agreement, fit, process, tradeoff
from ._data import (
    Agreement,
    Condition,
    Coverage,
    Fit,
    Processed,
    Reach,
    Spectrum,
    Tradeoff,
    quality_table,
)
from ._errors import (
    AssetError,
    Error,
    ModelError,
    MotionError,
    OptionError,
    RecordingError,
    SceneError,
)
from ._htex import Scene, Texture, Voice, __version__, models, open, unregister_model
from ._models import Field, register_model

__all__ = [
    "Agreement",
    "AssetError",
    "Condition",
    "Coverage",
    "Error",
    "Field",
    "Fit",
    "ModelError",
    "MotionError",
    "OptionError",
    "Processed",
    "Reach",
    "RecordingError",
    "Scene",
    "SceneError",
    "Spectrum",
    "Texture",
    "Tradeoff",
    "Voice",
    "__version__",
    "agreement",
    "fit",
    "models",
    "open",
    "process",
    "quality_table",
    "register_model",
    "tradeoff",
    "unregister_model",
]
