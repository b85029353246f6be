"""Make textures without recordings: from parameters, between two other textures, or with other
metadata.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

from . import _htex
from ._author import pair
from ._data import Condition, Quantity
from ._keywords import Unpack, as_json, keywords, split
from ._settings import Metadata


@keywords(Metadata)
def make(
    model: str,
    parameters: Mapping[str, float | Sequence[float]],
    level_rms: float,
    *,
    at: Condition | tuple[float | None, float | None] = (None, None),
    quantity: Quantity = "lateral_force",
    fluctuation: tuple[float, float] | None = None,
    plugins: Sequence[str | os.PathLike[str]] = (),
    installed: bool = False,
    **metadata: Unpack[Metadata],
) -> _htex.Texture:
    """Make a texture from a model's parameters, as ``htex make`` does.

    The texture states that it was made by hand.

    ``parameters`` holds the model's parameters by name; ``htex.models()`` lists them with units and
    ranges. If a parameter is a list, give all its values. ``level_rms`` is the RMS of the texture
    in the unit of ``quantity``, which is newtons for a force. ``at`` is the speed (mm/s) and the
    force (N) for which these parameters hold. ``fluctuation`` says how strongly the texture becomes
    stronger and weaker in time: the standard deviations at 0.5 to 8 Hz and at 8 to 32 Hz, decibels,
    each from 0 to 7.97.
    """
    (given,) = split("make", metadata, Metadata)
    values = {name: _values(value) for name, value in parameters.items()}
    return _htex.make(
        {
            "model": model,
            "parameters": values,
            "level_rms": level_rms,
            "at": pair(at),
            "quantity": quantity,
            "fluctuation": fluctuation,
            "metadata": as_json(given),
            "plugins": list(plugins),
            "installed": installed,
        }
    )


@keywords(Metadata)
def mix(a: _htex.Texture, b: _htex.Texture, weight: float, **metadata: Unpack[Metadata]) -> _htex.Texture:
    """Make a texture between the textures ``a`` and ``b``, as ``htex mix`` does.

    ``weight`` is the share of ``b``, 0 to 1.

    Each model that both textures have interpolates between their parameters, in the same way as
    between the conditions of one texture. The result states from which textures it was mixed.
    """
    (given,) = split("mix", metadata, Metadata)
    return _htex.mix(a, b, weight, as_json(given))


@keywords(Metadata)
def edit(
    texture: _htex.Texture,
    *,
    fluctuation: tuple[float, float] | None = None,
    **metadata: Unpack[Metadata],
) -> _htex.Texture:
    """Return the texture with other metadata, without fitting it again, as ``htex edit`` does.

    Metadata that you do not give stays as it is. An empty text removes an entry. ``tags`` replaces
    all tags. ``fluctuation`` sets how strongly the texture becomes stronger and weaker in time: the
    standard deviations at 0.5 to 8 Hz and at 8 to 32 Hz, decibels, each from 0 to 7.97. ``(0, 0)``
    removes the fluctuation.
    """
    (given,) = split("edit", metadata, Metadata)
    return _htex.edit(texture, as_json(given), fluctuation)


def _values(value: float | Sequence[float]) -> list[float]:
    try:
        return [float(value)]  # type: ignore[arg-type]
    except TypeError:
        return [float(one) for one in value]  # type: ignore[union-attr]
