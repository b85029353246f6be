"""Files of other formats: import them as textures, and export textures to them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from . import _errors, _htex
from ._author import model_list
from ._data import Imported, Quantity
from ._keywords import Unpack, as_json, keywords, split
from ._settings import FitSettings, Metadata

formats = _htex.formats


class Importing(FitSettings, Metadata, total=False):
    """Keywords of ``import_file``: how models are fitted, and the texture's metadata."""


@keywords(Importing)
def import_file(
    file: str | os.PathLike[str],
    *,
    full_scale: float | None = None,
    speed_mm_s: float | None = None,
    force_n: float | None = None,
    quantity: Quantity = "lateral_force",
    pitch_mm: float | None = None,
    profile: str | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    plugins: Sequence[str | os.PathLike[str]] = (),
    installed: bool = False,
    **settings: Unpack[Importing],
) -> Imported:
    """Read a file of another format as a texture, as ``htex import`` does.

    ``formats()`` lists the formats, and for each what is kept and what is lost.

    Give only metadata for files that state units, speeds and forces (Penn's HaTT), and for files
    that contain a texture (glTF). All other files contain a signal between -1 and 1, to which
    models are fitted. For these, give ``full_scale`` (the value that 1 stands for, in the unit of
    ``quantity``), ``speed_mm_s`` and ``force_n``. For an image of a friction map (``.png``), give
    the same three settings, where ``full_scale`` is the value of white. Also give ``pitch_mm``, the
    distance between its pixels, unless the file states it. No model is fitted to an image. If a
    file states frequencies as positions in an actuator's range, name the actuator with ``profile``.
    """
    fitting, metadata = split("import_file", settings, FitSettings, Metadata)
    if "models" in fitting:
        fitting["models"] = model_list(fitting["models"])
    if options:
        fitting["options"] = {model: {name: str(value) for name, value in own.items()} for model, own in options.items()}
    texture, warnings, notes = _htex.import_file(
        file,
        {
            "full_scale": full_scale,
            "pitch_mm": pitch_mm,
            "quantity": quantity,
            "speed_mm_s": speed_mm_s,
            "force_n": force_n,
            "profile": profile,
            "settings": as_json(fitting),
            "metadata": as_json(metadata),
            "plugins": list(plugins),
            "installed": installed,
        },
    )
    return Imported(texture=texture, warnings=warnings, notes=notes)


def export(
    texture: _htex.Texture,
    file: str | os.PathLike[str],
    to: str,
    *,
    model: str | None = None,
    speed_mm_s: float | None = None,
    force_n: float | None = None,
    seconds: float = 2.0,
    stroke: str | os.PathLike[str] | None = None,
    profile: str | None = None,
    rate_hz: float | None = None,
    coding: Literal["vectorial", "wavelet"] | None = None,
    seed: int = 0,
) -> dict[str, Any]:
    """Write a texture as a file for phones, game controllers and game engines, as ``htex export``
    does. The file plays the texture at one condition, or along a stroke.

    ``to`` is the name of a format (``formats()`` lists them). ``speed_mm_s`` and ``force_n`` are
    the condition. Instead, ``stroke`` may name a CSV file with time, speed and force (columns
    ``t_s``, ``speed_mm_s``, ``force_n``). ``profile`` names the actuator, which limits the part of
    the spectrum that can be played; each format has a default. ``rate_hz`` applies only to WAV,
    ``coding`` only to ``hjif``. The result is a dict that states what is lost, as in the JSON of
    the command. To measure the loss, the file is read again, played through the profile, and
    compared with the texture's own samples.
    """
    path = Path(file)
    if stroke is not None and (speed_mm_s is not None or force_n is not None):
        raise _errors.OptionError("a stroke has its own speed and force; give the stroke, or speed_mm_s and force_n")
    written, told = _htex.export(
        texture,
        {
            "to": to,
            "model": model,
            "speed_mm_s": speed_mm_s,
            "force_n": force_n,
            "seconds": seconds,
            "stroke": stroke,
            "profile": profile,
            "rate_hz": rate_hz,
            "coding": coding,
            "extension": path.suffix.removeprefix(".") or None,
            "seed": seed,
        },
    )
    _htex.write_file(path, written)
    return told
