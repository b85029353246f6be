"""Analyse rating studies, in which participants rate rendered textures, and plan how many
participants a study needs (``pip install htex[lab]``).

>>> import htex
>>> analysis = htex.study.analyse("ratings.csv", "spectra.csv", scale=(0, 6))  # doctest: +SKIP
>>> analysis.frames["pairs"]  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .rules import Finding, TableError, explain

if TYPE_CHECKING:
    from .planning import Power, power
    from .study import Analysis, analyse

__all__ = ["Analysis", "Finding", "Power", "TableError", "analyse", "explain", "power"]


def __getattr__(name: str) -> Any:
    """Import pandas and SciPy only when they are needed. If they are missing, state how to install
    them."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        from . import planning, study
    except ImportError as error:
        if error.name is None or error.name.startswith("htex"):
            raise
        raise ImportError(f"studies need {error.name}; `pip install htex[lab]` brings it", name=error.name) from error
    return getattr(study if hasattr(study, name) else planning, name)
