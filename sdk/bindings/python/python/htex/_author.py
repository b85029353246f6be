"""Compute spectra, textures and tables from recordings.

``fit`` reads the fitted texture back from the bytes of its file. So the returned texture has
exactly the digits that the file stores.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _errors, _htex
from ._data import Agreement, Comparison, Condition, Fit, Processed, Response, Spectrum, Tradeoff
from ._keywords import Fitting, Reading, Unpack, as_json, keywords, split
from ._measures import ErrorMeasure
from ._settings import FitSettings, Metadata, ReadingSettings
from ._sources import Recording, source, sources, stem


@keywords(Reading)
def process(recording: Recording, **settings: Unpack[Reading]) -> Processed:
    """Compute the texture spectrum of a recording, as ``htex process`` does.

    ``recording`` is a file (CSV, WAV, FLAC, NPY, MATLAB, HDF5, TDMS, Parquet, Arrow), the bytes of
    a file, or an array. An array has one row per sample and needs ``rate_hz``. One column is the
    lateral force. Two columns are the x and y components of the lateral force. A third column is
    the normal force. A data frame or a mapping may also be given; its columns are recognised by
    name, as in a CSV file, and an index of times is the time. For a recording from ``htex record``
    or a study, the JSON file next to it specifies how the recording is read. You may also pass this
    JSON file itself.
    """
    with _reading("process", settings) as (reading, _):
        found = _htex.process(source(recording), reading)
    found["spectrum"] = _spectrum(found["spectrum"])
    found["condition"] = Condition(**found["condition"])
    found["read_s"] = [(start, end) for start, end in found["read_s"]]
    for spread in ("speed_spread_mm_s", "force_spread_n"):
        found[spread] = found[spread] and tuple(found[spread])
    return Processed(**found)


@keywords(Fitting)
def fit(
    recordings: Recording | Sequence[Recording],
    *,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    conditions: Sequence[Condition | tuple[float | None, float | None]] = (),
    grid: Literal["auto"] | Mapping[Literal["speed_mm_s", "force_n"], Iterable[float]] | None = None,
    plugins: Sequence[str | os.PathLike[str]] = (),
    installed: bool = False,
    **settings: Unpack[Fitting],
) -> Fit:
    """Fit models to recordings of one texture, as ``htex fit`` does.

    ``recordings`` is one recording or a list of them, in the forms that ``process`` accepts.
    ``conditions`` are pairs of speed (mm/s) and force (N): one for each recording, or one for all.
    ``models`` are short names or ids, or ``"all"``. ``options`` holds the options of each model,
    such as ``{"ar": {"order": 6}}``. ``plugins`` are the files of further models, or folders with
    such files. ``installed`` also uses the models that the user has installed. ``name`` is the name
    of the texture; the default is the name of the first file. ``grid`` divides recordings of a free
    motion into conditions. It is ``"auto"``, or the grid lines for one or both axes, such as
    ``{"speed_mm_s": [40, 80, 160], "force_n": [0.3, 0.6]}``.
    """
    files = sources(recordings)
    with _reading("fit", settings, FitSettings, Metadata) as (reading, (fitting, metadata)):
        fitting["models"] = model_list(fitting.get("models", "all"))
        fitting["options"] = {model: {name: str(value) for name, value in own.items()} for model, own in (options or {}).items()}
        if lines := _grid(grid):
            fitting["grid"] = lines
        if metadata.get("name") is None:
            metadata["name"] = stem(files[0])
        request = {
            "settings": as_json(fitting),
            "metadata": as_json(metadata),
            "conditions": [pair(condition) for condition in conditions],
            "plugins": list(plugins),
            "installed": installed,
        }
        texture, rest = _htex.fit(files, reading, request)
    rest["spectra"] = [_spectrum(spectrum) for spectrum in rest["spectra"]]
    rest["skipped"] = [(model, reason) for model, reason in rest["skipped"]]
    return Fit(texture=texture, **rest)


def _grid(grid: str | Mapping[Any, Iterable[float]] | None) -> list[str]:
    """Return the lines of a grid as the command expects them, or an empty list without a grid.
    """
    if grid is None:
        return []
    if isinstance(grid, str):
        return [grid]
    names = {"speed_mm_s": "speed", "force_n": "force"}
    axes = [f"{names.get(axis, axis)}={','.join(map(str, lines))}" for axis, lines in grid.items()]
    return axes or ["auto"]


@keywords(Reading)
def tradeoff(
    recordings: Recording | Sequence[Recording],
    *,
    models: str | Iterable[str] = "all",
    quick: bool = True,
    error: Literal["held_out"] | ErrorMeasure | None = None,
    plugins: Sequence[str | os.PathLike[str]] = (),
    installed: bool = False,
    journal: str | os.PathLike[str] | None = None,
    **settings: Unpack[Reading],
) -> Tradeoff:
    """Measure the accuracy of models against their size in bytes and their computing time, for many
    values of their options, as ``htex tradeoff`` does.

    ``error`` selects the error that determines the fronts and knees. ``"held_out"`` is the error on
    parts of the recording that were not fitted; at 1, the model is as good as a second recording.
    The other errors compare the model with the fitted data, in decibels. The default is
    ``"held_out"``, or ``"third_octave"`` if a recording is too short to hold out a part.
    ``journal`` is a file that stores the results so far: with the same file, an interrupted sweep
    continues where it stopped. ``models``, ``plugins`` and ``installed`` are as in ``fit``.
    """
    request = {
        "models": model_list(models),
        "quick": quick,
        "error": error,
        "plugins": list(plugins),
        "installed": installed,
        "journal": journal,
    }
    with _reading("tradeoff", settings) as (reading, _):
        found = _htex.tradeoff(sources(recordings), reading, request)
    points = found.pop("points")
    names = [name for name in (points[0] if points else ()) if name != "knobs"]
    return Tradeoff(
        columns={name: [point[name] for point in points] for name in names},
        knees=found.pop("knees"),
        left_out=found.pop("left_out"),
        warnings=found.pop("warnings"),
        about={key: found[key] for key in ("tool", "machine", "error", "method", "recordings")},
    )


@keywords(Reading)
def compare(recording: Recording, other: _htex.Texture | Recording, **settings: Unpack[Reading]) -> Comparison:
    """Compare a recording with each representation of a texture, or with another recording, as
    ``htex compare`` does.

    ``other`` is a texture, an ``.htex`` file, or a recording in a form that ``process`` accepts.
    The texture plays at the recording's speed and force if both are known. Otherwise it plays at
    its default condition: the first one, or the strongest one if the first is silent.
    """
    if isinstance(other, (str, os.PathLike)) and os.fspath(other).lower().endswith(".htex"):
        other = _htex.open(other)
    against = other if isinstance(other, _htex.Texture) else source(other)
    with _reading("compare", settings) as (reading, _):
        found = _htex.compare(source(recording), against, reading)
    for name in ("condition", "other_condition"):
        found[name] = found[name] and Condition(**found[name])
    return Comparison(**found)


def agreement(
    reference: Spectrum | npt.ArrayLike,
    magnitude: Spectrum | npt.ArrayLike,
    *,
    frequency_hz: npt.ArrayLike | None = None,
    band_hz: tuple[float, float] | None = None,
) -> Agreement:
    """Compare the magnitudes of a spectrum with those of a reference at the same frequencies.

    If the reference is a ``Spectrum``, its frequencies and band are the defaults. Otherwise the
    default is 20 to 1000 Hz in steps of 5 Hz.
    """
    if isinstance(reference, Spectrum):
        frequency_hz = reference.frequency_hz if frequency_hz is None else frequency_hz
        band_hz = reference.band_hz if band_hz is None else band_hz
        reference = reference.magnitude
    if frequency_hz is None:
        frequency_hz = np.arange(20.0, 1000.1, 5.0)
    if isinstance(magnitude, Spectrum):
        if not np.array_equal(magnitude.frequency_hz, np.asarray(frequency_hz)):
            raise _errors.OptionError("the spectra have different frequencies; compute both at the same")
        magnitude = magnitude.magnitude
    found = _htex.agreement(
        np.asarray(frequency_hz, dtype=np.float64),
        (20.0, 1000.0) if band_hz is None else band_hz,
        np.asarray(reference, dtype=np.float64),
        np.asarray(magnitude, dtype=np.float64),
    )
    return Agreement(**found)


@contextlib.contextmanager
def _reading(function: str, settings: Mapping[str, object], *others: type) -> Iterator[tuple[tuple[str, str], list[dict[str, Any]]]]:
    """Return the settings for reading recordings, in the form that the extension module takes, and
    the other settings.

    A ``Response`` is written to a temporary CSV file.
    """
    reading, *rest, besides = split(function, settings, ReadingSettings, *others, Reading)
    response = besides.pop("response", None)
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(response, Response):
            file = os.path.join(folder, "response.csv")
            response.save(file)
            response = file
        if response is not None:
            reading["response"] = response
        yield (as_json(reading), as_json(besides)), rest


def model_list(models: str | Iterable[str]) -> list[str]:
    """Return the names of models as a list. An empty list stands for all models."""
    names = [models] if isinstance(models, str) else list(models)
    if not names:
        raise _errors.OptionError('no models; name at least one, or give "all"')
    return [] if "all" in names else names


def pair(condition: Any) -> tuple[float | None, float | None]:
    if isinstance(condition, Condition):
        return (condition.speed_mm_s, condition.force_n)
    speed_mm_s, force_n = condition
    return (speed_mm_s, force_n)


def _spectrum(fields: dict[str, Any]) -> Spectrum:
    return Spectrum(
        frequency_hz=np.array(fields["frequency_hz"], dtype=np.float64),
        magnitude=np.array(fields["magnitude"], dtype=np.float64),
        quantity=fields["quantity"],
        unit=fields["unit"],
        band_hz=(fields["band_hz"][0], fields["band_hz"][1]),
    )
