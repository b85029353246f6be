"""From recordings to spectra, textures and tables.

An array is taken as the NPY file that it would be: channels, scale and limits are those of the readers. A texture that was fitted is
read back from its bytes, so that it is what its file holds.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, BinaryIO, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _errors, _htex
from ._data import Agreement, Condition, Fit, Processed, Quantity, Spectrum, Tradeoff
from ._measures import ErrorMeasure

Recording = Union[str, os.PathLike[str], bytes, BinaryIO, npt.ArrayLike]
Segments = Literal["auto", "sweeps", "windows"]
Averaging = Literal["rms", "magnitude", "complex"]


def process(
    recording: Recording,
    *,
    rate_hz: float | None = None,
    map: str | None = None,
    tracker: str | os.PathLike[str] | None = None,
    tracker_map: str | None = None,
    quantity: Quantity = "lateral_force",
    scale: float | None = None,
    response: str | os.PathLike[str] | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    most_values: int | None = None,
    segments: Segments = "auto",
    averaging: Averaging = "rms",
    speed_mm_s: float | None = None,
    force_n: float | None = None,
    strict: bool = False,
) -> Processed:
    """Compute the texture spectrum of a recording, as ``htex process`` does.

    ``recording`` is a file (CSV, WAV, FLAC, NPY, MATLAB, HDF5, TDMS, Parquet, Arrow), the bytes of one, or an array: one row per sample; one column is the
    lateral force, two are its axes, three are its axes and the normal force. An array needs ``rate_hz``.
    Columns of a data frame or of a mapping are known by their names, as those of a CSV file.

    ``map`` names and scales the columns of a file: ``lateral=lateral_V:0.4444,normal=-(fz1+fz2)*0.31``. ``tracker`` is a file
    with the finger's motion at its own rate, whose columns ``tracker_map`` names. ``scale`` is the value of a full-scale sample. ``response`` is a CSV file with the response of the setup. ``strict`` refuses
    recordings with findings that are errors or warnings.
    """
    found = _htex.process(
        _source(recording),
        _reading(
            rate_hz=rate_hz,
            map=map,
            tracker=tracker,
            tracker_map=tracker_map,
            quantity=quantity,
            scale=scale,
            response=response,
            from_s=from_s,
            to_s=to_s,
            most_values=most_values,
            segments=segments,
            averaging=averaging,
            speed_mm_s=speed_mm_s,
            force_n=force_n,
            strict=strict,
        ),
    )
    found["spectrum"] = _spectrum(found["spectrum"])
    found["condition"] = Condition(**found["condition"])
    found["read_s"] = [(start, end) for start, end in found["read_s"]]
    for spread in ("speed_spread_mm_s", "force_spread_n"):
        found[spread] = found[spread] and tuple(found[spread])
    return Processed(**found)


def fit(
    recordings: Recording | Sequence[Recording],
    *,
    name: str | None = None,
    models: str | Iterable[str] = "all",
    options: Mapping[str, Mapping[str, Any]] | None = None,
    conditions: Sequence[Condition | tuple[float | None, float | None]] = (),
    level: Literal["recording", "fitted"] = "recording",
    keep_reference: bool = False,
    grid: Literal["auto"] | Mapping[Literal["speed_mm_s", "force_n"], Iterable[float]] | None = None,
    plugins: Sequence[str | os.PathLike[str]] = (),
    installed: bool = False,
    author: str | None = None,
    license: str | None = None,
    tags: Iterable[str] = (),
    description: str | None = None,
    source: str | None = None,
    doi: str | None = None,
    sensor: str | None = None,
    finger: str | None = None,
    rate_hz: float | None = None,
    map: str | None = None,
    tracker: str | os.PathLike[str] | None = None,
    tracker_map: str | None = None,
    quantity: Quantity = "lateral_force",
    scale: float | None = None,
    response: str | os.PathLike[str] | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    most_values: int | None = None,
    segments: Segments = "auto",
    averaging: Averaging = "rms",
    speed_mm_s: float | None = None,
    force_n: float | None = None,
    strict: bool = False,
) -> Fit:
    """Fit models to recordings of one texture, as ``htex fit`` does.

    ``recordings`` is one recording or a list of them, each as ``process`` takes it. ``models`` are short names or ids,
    or ``"all"``. ``options`` are those of the models: ``{"ar": {"order": 6}}``. ``conditions`` are pairs of speed (mm/s)
    and force (N), one for each recording or one for all. ``name`` is the name of the texture; by default that of the
    first file. ``grid`` gathers recordings of a free motion in many conditions: ``"auto"``, or the lines of one or both axes,
    ``{"speed_mm_s": [40, 80, 160], "force_n": [0.3, 0.6]}``. ``plugins`` are files of further models, or folders of them; ``installed`` adds those of the user.
    The other keywords are those of ``process``, and metadata of the asset.
    """
    sources = _sources(recordings)
    texture, rest = _htex.fit(
        sources,
        _reading(
            rate_hz=rate_hz,
            map=map,
            tracker=tracker,
            tracker_map=tracker_map,
            quantity=quantity,
            scale=scale,
            response=response,
            from_s=from_s,
            to_s=to_s,
            most_values=most_values,
            segments=segments,
            averaging=averaging,
            speed_mm_s=speed_mm_s,
            force_n=force_n,
            strict=strict,
        ),
        {
            "models": _models(models),
            "options": [
                (model, option, str(value))
                for model, own in (options or {}).items()
                for option, value in own.items()
            ],
            "conditions": [_pair(condition) for condition in conditions],
            "level": level,
            "keep_reference": keep_reference,
            "grid": _grid(grid),
            "plugins": list(plugins),
            "installed": installed,
            "name": _stem(sources[0]) if name is None else name,
            "author": author,
            "license": license,
            "tags": list(tags),
            "description": description,
            "origin": source,
            "doi": doi,
            "sensor": sensor,
            "finger": finger,
        },
    )
    rest["spectra"] = [_spectrum(spectrum) for spectrum in rest["spectra"]]
    rest["skipped"] = [(model, reason) for model, reason in rest["skipped"]]
    return Fit(texture=texture, **rest)


def _grid(grid: str | Mapping[Any, Iterable[float]] | None) -> list[str]:
    """Return the lines of a grid as the command takes them; an empty list without a grid."""
    if grid is None:
        return []
    if isinstance(grid, str):
        return [grid]
    names = {"speed_mm_s": "speed", "force_n": "force"}
    axes = [f"{names.get(axis, axis)}={','.join(map(str, lines))}" for axis, lines in grid.items()]
    return axes or ["auto"]


def tradeoff(
    recordings: Recording | Sequence[Recording],
    *,
    models: str | Iterable[str] = "all",
    quick: bool = True,
    error: ErrorMeasure = "nine_band",
    plugins: Sequence[str | os.PathLike[str]] = (),
    installed: bool = False,
    journal: str | os.PathLike[str] | None = None,
    rate_hz: float | None = None,
    map: str | None = None,
    tracker: str | os.PathLike[str] | None = None,
    tracker_map: str | None = None,
    quantity: Quantity = "lateral_force",
    scale: float | None = None,
    response: str | os.PathLike[str] | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    most_values: int | None = None,
    segments: Segments = "auto",
    averaging: Averaging = "rms",
    speed_mm_s: float | None = None,
    force_n: float | None = None,
    strict: bool = False,
) -> Tradeoff:
    """Measure accuracy against bytes and time over models and their options, as ``htex tradeoff`` does.

    ``journal`` is a file from which an interrupted sweep continues. The other keywords are those of ``fit``.
    """
    found = _htex.tradeoff(
        _sources(recordings),
        _reading(
            rate_hz=rate_hz,
            map=map,
            tracker=tracker,
            tracker_map=tracker_map,
            quantity=quantity,
            scale=scale,
            response=response,
            from_s=from_s,
            to_s=to_s,
            most_values=most_values,
            segments=segments,
            averaging=averaging,
            speed_mm_s=speed_mm_s,
            force_n=force_n,
            strict=strict,
        ),
        {
            "models": _models(models),
            "quick": quick,
            "error": error,
            "plugins": list(plugins),
            "installed": installed,
            "journal": journal,
        },
    )
    points = found.pop("points")
    names = [name for name in (points[0] if points else ()) if name != "knobs"]
    return Tradeoff(
        columns={name: [point[name] for point in points] for name in names},
        knees=found.pop("knees"),
        left_out=found.pop("left_out"),
        warnings=found.pop("warnings"),
        about={key: found[key] for key in ("tool", "machine", "error", "method", "recordings")},
    )


def agreement(
    reference: Spectrum | npt.ArrayLike,
    magnitude: Spectrum | npt.ArrayLike,
    *,
    frequency_hz: npt.ArrayLike | None = None,
    band_hz: tuple[float, float] | None = None,
) -> Agreement:
    """Compare magnitudes with those of a reference at the same frequencies.

    Frequencies and band are those of the reference if it is a ``Spectrum``, else 20 to 1000 Hz in steps of 5 Hz.
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


def _reading(**options: Any) -> dict[str, Any]:
    """Return the options of reading, as the extension takes them."""
    return options


def _models(models: str | Iterable[str]) -> list[str]:
    """Return the names of models; none stands for all of them."""
    names = [models] if isinstance(models, str) else list(models)
    if not names:
        raise _errors.OptionError('no models; name at least one, or give "all"')
    return [] if "all" in names else names


def _sources(recordings: Any) -> list[Any]:
    """Return the sources of recordings; a list of numbers is one recording."""
    several = isinstance(recordings, (list, tuple))
    if several and not recordings:
        raise _errors.OptionError("no recordings; give at least one")
    if not several or isinstance(recordings[0], (int, float)):
        return [_source(recordings)]
    return [_source(recording) for recording in recordings]


def _source(recording: Any) -> Any:
    """Return a path, or a name and the bytes of a file; an array is what an NPY file of it would be."""
    if isinstance(recording, (str, os.PathLike)):
        return recording
    if isinstance(recording, (bytes, bytearray, memoryview)):
        return ("recording", bytes(recording))
    if hasattr(recording, "read"):
        content = recording.read()
        if not isinstance(content, bytes):
            raise TypeError("expected a file opened in binary mode; open it with mode 'rb'")
        name = getattr(recording, "name", "recording")
        return (os.path.basename(name) if isinstance(name, str) else "recording", content)
    named = _columns(recording)
    if named is not None:
        return ("frame", _csv(named))
    array = _unmasked("the array", recording)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"expected a path, bytes, a binary file or an array of numbers, got {array.dtype}")
    if array.dtype not in (np.float32, np.float64, np.int16, np.int32):
        array = array.astype(np.float64)
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    return ("array", file.getvalue())


def _columns(recording: Any) -> dict[str, Any] | None:
    """Return the columns of a data frame or a mapping by their names; ``None`` for what has no names."""
    if not (isinstance(recording, Mapping) or hasattr(recording, "columns")):
        return None
    names = list(getattr(recording, "columns", recording))
    if not names or not all(isinstance(name, str) for name in names):
        return None
    return {name: _unmasked(f"column {name!r}", recording[name]) for name in names}


def _unmasked(what: str, values: Any) -> Any:
    """Return values as an array; numpy would read what is under a mask as samples."""
    if np.ma.is_masked(values):
        raise _errors.OptionError(f"{what} has masked values; leave their rows out, or fill them with filled()")
    return np.asarray(values)


def _csv(columns: Mapping[str, Any]) -> bytes:
    """Return columns as a CSV file of all digits, whose reader knows their names."""
    for name, values in columns.items():
        if values.ndim != 1 or values.dtype.kind not in "biuf":
            raise TypeError(f"column {name!r} is of {values.dtype} in {values.ndim} dimensions; give numbers, one for each sample")
        if any(c in name for c in ',"\r\n'):
            raise _errors.OptionError(f"column {name!r}: a name has no comma, quote or line end; rename it")
    rows = zip(*(values.astype(np.float64).tolist() for values in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def _stem(source: Any) -> str:
    name = source[0] if isinstance(source, tuple) else os.path.basename(os.fspath(source))
    return os.path.splitext(name)[0] or "texture"


def _pair(condition: Any) -> tuple[float | None, float | None]:
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
