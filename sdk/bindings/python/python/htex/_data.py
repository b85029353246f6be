"""The data classes of the package. All of them can be pickled."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from typing import Any, Literal, get_type_hints

import numpy as np
import numpy.typing as npt

from . import _htex
from ._measures import Agreement as Agreement

Quantity = Literal["lateral_force", "normal_force", "acceleration", "velocity", "displacement"]
"""A physical quantity, as a manifest names it."""


@dataclass(frozen=True)
class Condition:
    """A condition at which a texture was recorded; an unknown value is ``None``."""

    speed_mm_s: float | None = None
    """Scanning speed, mm/s."""
    force_n: float | None = None
    """Normal force, newtons."""
    repeatability_rms_db: float | None = None
    """How well the recording repeats itself, decibels: the difference between its odd and even time
    blocks, as an RMS over nine frequency bands, divided by √2."""
    repeatability_third_octave_rms_db: float | None = None
    """The same over third octaves, decibels."""
    segments: int | None = None
    """Number of averaged segments; 0 for a computed condition. ``None`` if the asset does not state
    it."""


@dataclass(frozen=True)
class LibraryEntry:
    """What a library states about a texture."""

    name: str
    """Name in the library. ``/`` separates the parts of a name."""
    tags: tuple[str, ...]
    """Search terms."""
    models: tuple[str, ...]
    """The model id of each representation."""
    speed_mm_s: tuple[float, float] | None
    """Lowest and highest recorded speed, mm/s; ``None`` if unknown."""
    force_n: tuple[float, float] | None
    """Lowest and highest recorded force, newtons; ``None`` if unknown."""
    contact: str
    """What slid over the surface: ``finger``, ``tool`` or ``unknown``."""
    law: dict[str, Exponent]
    """How frequencies and level change at motions outside the recorded conditions: as
    ``Texture.law``, but without estimates and standard errors."""
    license: str | None
    """Licence; ``None`` if the texture states none, or in a library of version 1.0."""
    author: str | None
    """Who made the texture; ``None`` as for the licence."""
    quantity: str | None
    """Physical quantity of the samples; ``None`` in a library of version 1.0."""
    felt_error_rms_db: float | None
    """Felt difference from the recordings, RMS over third octaves, decibels; ``None`` if it is
    not known."""
    held_out_error_db: float | None
    """Held-out error, RMS over third octaves, decibels; ``None`` if the texture does not state
    it."""
    bytes: int
    """Size of the texture's file, bytes."""
    blake3: str
    """BLAKE3 hash of the texture's file, hexadecimal."""


@dataclass(frozen=True)
class LibraryDifference:
    """How a newer library differs from an older one."""

    removed: list[str]
    """Names of textures that only the older library has."""
    added: list[str]
    """Names of textures that only the newer library has."""
    renamed: list[tuple[str, str]]
    """Old and new names of textures with the same bytes."""
    changed: list[str]
    """Names of textures with other bytes."""


@dataclass(frozen=True)
class LibraryChange:
    """What ``Library.edit`` changed, and the library that it wrote."""

    removed: int
    """Number of textures that were removed."""
    renamed: int
    """Number of textures that have another name."""
    added: int
    """Number of textures that were added."""
    edited: int
    """Number of textures with other metadata."""
    textures: int
    """Number of textures in the library."""
    bytes: int
    """Size of the library's file, bytes."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A texture spectrum. A sinusoid of amplitude A, at one of the frequencies, has magnitude A."""

    frequency_hz: npt.NDArray[np.float64]
    """Frequencies, hertz."""
    magnitude: npt.NDArray[np.float64]
    """Magnitudes, in ``unit``."""
    quantity: Quantity
    """Physical quantity."""
    unit: str
    """Unit of the magnitudes."""
    band_hz: tuple[float, float]
    """Lower and upper edge of the band, hertz."""

    def __repr__(self) -> str:
        low, high = self.band_hz
        return f"<htex.Spectrum of {len(self.magnitude)} magnitudes in {self.unit}, {low:g} to {high:g} Hz>"


@dataclass(frozen=True)
class Reach:
    """How the speed or force of a motion relates to the recorded values."""

    kind: Literal["inside", "unknown", "followed", "outside"]
    """Where the value lies: ``inside`` or ``outside`` the recorded range. ``followed``: the model
    itself follows the motion. ``unknown``: the asset does not state the recorded values, so the
    speed or force has no effect."""
    asked: float | None = None
    """The speed or force of the motion; ``None`` unless it is outside the recorded range."""
    recorded: float | None = None
    """The nearest recorded value; ``None`` unless the motion is outside the recorded range."""


@dataclass(frozen=True)
class Exponent:
    """An exponent of a texture's law, which states how frequencies and level change with speed and
    force."""

    exponent: float
    """The exponent that is used for playback."""
    source: Literal["measured", "given", "assumed"]
    """Where the exponent comes from."""
    estimate: float | None = None
    """The exponent as measured. ``exponent`` lies closer to the assumed exponent, the more so the
    larger the standard error is."""
    standard_error: float | None = None
    """Standard error of the measurement."""


@dataclass(frozen=True, eq=False)
class Envelope:
    """Level and mean frequency of what a voice played since the last call, for devices that receive
    a level and a frequency instead of samples.

    The level is exact. The mean frequency and the bands are computed from time windows, so they are
    late by some 20 ms.
    """

    level_rms: float
    """RMS of the samples, in the texture's unit; 0 if there are none."""
    centroid_hz: float
    """Mean frequency of the spectrum, weighted by power, hertz; 0 for silence."""
    frames: int
    """Number of samples since the last call."""
    bands: npt.NDArray[np.float64]
    """Mean square of the samples in each band, in the texture's unit squared."""


@dataclass(frozen=True)
class DeviceStatus:
    """What a device has done since it was opened."""

    frames_written: int
    """Number of samples written to the device."""
    frames_played: int
    """Number of samples played."""
    underruns: int
    """Number of times that the device ran out of samples."""
    latency_s: float
    """Time from writing a sample to its output, seconds."""
    peak: float
    """Largest absolute value written, in the device's unit."""


@dataclass(frozen=True)
class Coverage:
    """How a motion relates to the recorded conditions, and how a voice plays it."""

    inside: bool
    """Whether the motion lies within the recorded conditions. The texture then plays as recorded,
    or interpolated between recorded conditions."""
    slides: bool
    """Whether the voice is audible."""
    excess: float
    """Relative difference between the requested motion and the motion that is actually played."""
    description: str
    """One sentence that states how playback differs from the recording; empty if it does not
    differ."""
    frequency_factor: float
    """Factor that multiplies all frequencies."""
    level_factor: float
    """Factor that multiplies the level."""
    speed: Reach
    """Speed, mm/s."""
    force: Reach
    """Normal force, newtons."""


@dataclass(frozen=True, eq=False, repr=False)
class Processed:
    """The texture spectrum of a recording, with information about how it was read."""

    spectrum: Spectrum
    """The spectrum."""
    condition: Condition
    """Speed and force: the given values or, without them, the measured medians."""
    rate_hz: float
    """Sample rate of the recording, hertz."""
    segments: int
    """Number of averaged segments."""
    from_sweeps: bool
    """Whether the segments are the sweeps of the finger. If not, they are evenly spaced time
    windows."""
    read_s: list[tuple[float, float]]
    """Start and end of each segment that was read, seconds."""
    speed_spread_mm_s: tuple[float, float] | None
    """Lowest and highest speed of the segments, mm/s."""
    force_spread_n: tuple[float, float] | None
    """Lowest and highest normal force of the segments, newtons."""
    simulated: bool
    """Whether the file states that it was simulated."""
    findings: list[dict[str, Any]]
    """Problems that were found in the recording. Each has a code that does not change between
    versions."""
    warnings: list[str]
    """Warnings, as sentences."""
    notes: list[str]
    """Notes about the recording, as sentences."""

    def __repr__(self) -> str:
        return f"<htex.Processed: {self.segments} segments at {self.rate_hz:g} Hz, {self.spectrum!r}>"


@dataclass(frozen=True, eq=False)
class Imported:
    """A texture imported from a file of another format."""

    texture: _htex.Texture
    """The texture."""
    warnings: list[str]
    """Warnings about the file, as sentences."""
    notes: list[str]
    """Notes about the file, e.g. that a licence is missing."""


@dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """Models fitted to recordings."""

    texture: _htex.Texture
    """The texture."""
    spectra: list[Spectrum]
    """The recorded spectrum of each condition."""
    fit_ms: list[float]
    """Time spent on fitting each model, milliseconds."""
    skipped: list[tuple[str, str]]
    """Models that could not be fitted, each with the reason."""
    notes: list[str]
    """Notes about the recordings, as sentences."""
    felt: list[list[dict[str, Any] | None]] = field(default_factory=list)
    """For each model and each of its conditions: how much of the difference from the recording a
    finger can feel. ``None`` at a condition that was computed between recorded conditions."""
    grid: dict[str, Any] | None = None
    """The grid of the conditions, if one was requested: its lines, its cells with their segments,
    repeatability and status, and the triangles between conditions. It also has the error on time
    blocks that were left out of the fit: with the grid (``left_out_rms_db``), and with a single
    condition for all motions (``one_condition_rms_db``)."""

    @property
    def warnings(self) -> list[str]:
        """The warnings that the asset stores, as sentences."""
        found: list[str] = self.texture.manifest.get("provenance", {}).get("warnings", [])
        return found

    def table(self) -> dict[str, list[Any]]:
        """Return the error of each model at each condition, as columns for pandas or polars."""
        return quality_table(self.texture)

    def __repr__(self) -> str:
        return f"<htex.Fit of {self.texture!r}>"


@dataclass(frozen=True, eq=False, repr=False)
class Tradeoff:
    """Accuracy of models, with their size in bytes and their computing time. ``tradeoff`` returns
    it."""

    columns: dict[str, list[Any]]
    """One row for each combination of options on each recording, as columns for pandas or
    polars."""
    knees: list[dict[str, Any]]
    """The best compromises: the knee of each front of accuracy against bytes or time."""
    left_out: list[dict[str, Any]]
    """Combinations of options that could not be measured, each with the reason."""
    warnings: list[str]
    """Warnings, as sentences."""
    about: dict[str, Any] = field(default_factory=dict)
    """The program, the machine, the measure of error and the recordings."""

    def __repr__(self) -> str:
        rows = len(self.columns.get("model", []))
        return f"<htex.Tradeoff of {rows} points>"


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """A recording compared with a texture, or with another recording."""

    condition: Condition
    """Speed, force and repeatability of the recording."""
    representations: list[dict[str, Any]]
    """Comparison with a texture: for each representation its model, level, error measures, the
    error that a finger can feel, and how its voice fluctuates compared with the recording."""
    other: dict[str, Any] | None
    """Comparison with another recording: the same measures; otherwise ``None``."""
    other_condition: Condition | None
    """Speed, force and repeatability of the other recording."""
    warnings: list[str]
    """Warnings about the recordings, as sentences."""

    def table(self) -> dict[str, list[Any]]:
        """Return the measures as columns for pandas or polars."""
        rows = [self.other] if self.other else self.representations
        names = list(dict.fromkeys(name for row in rows for name in row if name not in ("felt", "band_error_db", "fluctuation")))
        columns = {name: [row.get(name) for row in rows] for name in names}
        columns["felt_error_rms_db"] = [row["felt"]["error_rms_db"] for row in rows]
        fluctuations = [row["fluctuation"] or {} for row in rows]
        columns["fluctuation_error_db"] = [found.get("fluctuation_error_db") for found in fluctuations]
        return columns

    def __repr__(self) -> str:
        return f"<htex.Comparison with {'a recording' if self.other else f'{len(self.representations)} representation(s)'}>"


@dataclass(frozen=True, eq=False, repr=False)
class Response:
    """The frequency response of a recording rig or a finger display. The arrays have one entry for each frequency."""

    frequency_hz: npt.NDArray[np.float64]
    """Frequencies, hertz."""
    magnitude: npt.NDArray[np.float64]
    """Magnitude, in the output's unit divided by the input's unit."""
    phase_rad: npt.NDArray[np.float64]
    """Phase of the output relative to the input, radians."""
    coherence: npt.NDArray[np.float64] | None = None
    """Coherence of input and output, 0 to 1; ``None`` if it was not measured."""
    relative_error: npt.NDArray[np.float64] | None = None
    """Relative standard deviation of the magnitude; ``None`` if it was not measured."""
    about: dict[str, Any] = field(default_factory=dict)
    """The settings, the peak, the warnings, and the hits or windows; if one was discarded, it has
    the reason."""

    def to_csv(self) -> bytes:
        """Return the response as a CSV file, which ``process``, ``fit`` and scenes accept."""
        return _htex.response_csv(self.frequency_hz.tolist(), self.magnitude.tolist(), self.phase_rad.tolist())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the CSV file. It appears complete or not at all."""
        _htex.write_file(path, self.to_csv())

    def __repr__(self) -> str:
        low, high = self.frequency_hz[[0, -1]]
        return f"<htex.Response of {len(self.frequency_hz)} frequencies, {low:g} to {high:g} Hz>"


class Simulation(dict[str, npt.NDArray[np.float64]]):
    """A simulated recording: its columns by name.

    ``process`` and ``fit`` accept it, and pandas converts it to a data frame.
    """

    csv: bytes
    """The recording as a CSV file, which states that it is simulated."""
    rate_hz: float
    """Sample rate, hertz."""
    response: Response
    """Response of the simulated rig, for ``process(..., response=...)``."""

    def __init__(self, columns: Any, *, csv: bytes, rate_hz: float, response: Response) -> None:
        super().__init__(columns)
        self.csv, self.rate_hz, self.response = csv, rate_hz, response

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the CSV file. It appears complete or not at all."""
        _htex.write_file(path, self.csv)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_simulation, (dict(self), self.csv, self.rate_hz, self.response))

    def __repr__(self) -> str:
        return f"<htex.Simulation of {len(self['t_s'])} samples at {self.rate_hz:g} Hz>"


def _simulation(columns: Any, csv: bytes, rate_hz: float, response: Response) -> Simulation:
    """Restore a pickled simulation."""
    return Simulation(columns, csv=csv, rate_hz=rate_hz, response=response)


def quality_table(texture: _htex.Texture) -> dict[str, list[Any]]:
    """Return the errors that a texture stores for each model at each condition, as columns for
    pandas or polars. The held-out errors are in units of the difference between two recordings
    (``held_out_error``) and in decibels."""
    rows: list[dict[str, Any]] = []
    for representation in texture.manifest["representations"]:
        for at in representation["at"]:
            condition = texture.conditions[at["condition"]]
            row = {
                "model": representation["model"],
                "speed_mm_s": condition.speed_mm_s,
                "force_n": condition.force_n,
                "level_rms": at["level_rms"],
            }
            row["held_out_error"] = row["held_out_error_db"] = None
            held_out = at.get("left_out", {}).get("third_octave_error_rms_db")
            if held_out is not None:
                row["held_out_error_db"] = held_out
                second = condition.repeatability_third_octave_rms_db
                if second:
                    row["held_out_error"] = held_out / (math.sqrt(2) * second)
            quality = at.get("quality", {})
            row.update({name: value for name, value in quality.items() if name != "band_error_db"})
            rows.append(row)
    names = list(dict.fromkeys(name for row in rows for name in row))
    return {name: [row.get(name) for row in rows] for name in names}


def _reopen(
    data: bytes, plugins: list[str | os.PathLike[str]], embedded: bool, installed: bool
) -> _htex.Texture:
    """Open a pickled texture."""
    return _htex.open(data, plugins=plugins, embedded=embedded, installed=installed)


for _class in (Condition, Exponent, Spectrum, Reach, Coverage, Envelope, Agreement, Processed, Fit, Tradeoff, Comparison, Response, Simulation):
    # Evaluated here, because later `typing.get_type_hints` would look for the names in the module
    # `htex`, which is set below.
    _class.__annotations__ = get_type_hints(_class)
    _class.__module__ = "htex"
