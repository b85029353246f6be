"""The data classes of the package. All of them can be pickled."""

from __future__ import annotations

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
    """RMS over nine bands of the difference between odd and even blocks of time of the recording, over √2, decibels."""
    segments: int | None = None
    """Number of averaged segments, if the asset states it; 0 for a computed condition."""


@dataclass(frozen=True)
class LibraryEntry:
    """What a library states about a texture."""

    name: str
    """Name in the library, with ``/`` between its parts."""
    tags: tuple[str, ...]
    """Search terms."""
    models: tuple[str, ...]
    """Ids of the models of its representations."""
    speed_mm_s: tuple[float, float] | None
    """Lowest and highest recorded speed, mm/s; ``None`` if unknown."""
    force_n: tuple[float, float] | None
    """Lowest and highest recorded force, newtons; ``None`` if unknown."""
    contact: str
    """What slid over the surface: ``finger``, ``tool`` or ``unknown``."""
    law: dict[str, Exponent]
    """How frequencies and level follow unrecorded motions: ``Texture.law`` without estimates."""
    bytes: int
    """Size of the texture's file, bytes."""
    blake3: str
    """BLAKE3 hash of the texture's file, hexadecimal."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A texture spectrum. A sinusoid of amplitude A on the grid has magnitude A."""

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
    """How a speed or force relates to the recorded values."""

    kind: Literal["inside", "unknown", "followed", "outside"]
    """Where the value lies. Outside the recorded range, the texture follows its law."""
    asked: float | None = None
    """The requested value."""
    recorded: float | None = None
    """The nearest recorded value."""


@dataclass(frozen=True)
class Exponent:
    """An exponent of a texture's law, and its source."""

    exponent: float
    """The exponent used for playback."""
    source: Literal["measured", "given", "assumed"]
    """Where it comes from."""
    estimate: float | None = None
    """The measurement, before its error pulled it towards the assumed exponent."""
    standard_error: float | None = None
    """Standard error of the measurement."""


@dataclass(frozen=True, eq=False)
class Envelope:
    """What a voice played since the last call, for devices that are driven by level and frequency.

    The level is exact. The other numbers are computed from windows that lag by some 20 ms.
    """

    level_rms: float
    """RMS of the samples, in the unit; 0 if there are none."""
    centroid_hz: float
    """Mean frequency, weighted by power, hertz; 0 for silence."""
    frames: int
    """Number of the samples."""
    bands: npt.NDArray[np.float64]
    """Mean square in each band, in the squared unit."""


@dataclass(frozen=True)
class DeviceStatus:
    """What a device has done since it was opened."""

    frames_written: int
    """Number of samples written to the device."""
    frames_played: int
    """Number of samples played."""
    underruns: int
    """Number of times the device ran out of samples."""
    latency_s: float
    """Time from writing a sample to its output, seconds."""
    peak: float
    """Largest absolute value written, in the device's unit."""


@dataclass(frozen=True)
class Coverage:
    """How a motion relates to the recorded conditions, and how a voice plays it."""

    inside: bool
    """Whether the texture is played as recorded or interpolated between recordings."""
    slides: bool
    """Whether the voice is audible."""
    excess: float
    """Relative difference between the motion and the one that is actually played."""
    description: str
    """One sentence; empty if nothing differs from the recording."""
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
    """Whether the segments are sweeps; if not, they are evenly spaced windows."""
    read_s: list[tuple[float, float]]
    """The segments that were read, seconds."""
    speed_spread_mm_s: tuple[float, float] | None
    """Lowest and highest speed over the segments, mm/s."""
    force_spread_n: tuple[float, float] | None
    """Lowest and highest normal force over the segments, newtons."""
    simulated: bool
    """Whether the file says that it comes from a simulator."""
    findings: list[dict[str, Any]]
    """Findings, with stable codes."""
    warnings: list[str]
    """Warnings, as sentences."""
    notes: list[str]
    """Notes, as sentences."""

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
    """Notes about the file, such as that a licence is missing."""


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
    """Models that could not be fitted, with reasons."""
    notes: list[str]
    """Notes about the recordings, as sentences."""
    felt: list[list[dict[str, Any] | None]] = field(default_factory=list)
    """What is felt of the difference from the recordings, of each model at each of its conditions; None at a condition that was computed
    between recorded ones."""
    grid: dict[str, Any] | None = None
    """The grid of the conditions, if one was requested: its lines, its cells with their segments, repeatability and status,
    the triangles between conditions, and the errors of blocks of time that were left out: of the grid (``left_out_rms_db``) and of one condition
    for all motions (``one_condition_rms_db``)."""

    @property
    def warnings(self) -> list[str]:
        """The warnings stored in the asset, as sentences."""
        found: list[str] = self.texture.manifest.get("provenance", {}).get("warnings", [])
        return found

    def table(self) -> dict[str, list[Any]]:
        """Return the error of each model at each condition, as columns for pandas or polars."""
        return quality_table(self.texture)

    def __repr__(self) -> str:
        return f"<htex.Fit of {self.texture!r}>"


@dataclass(frozen=True, eq=False, repr=False)
class Tradeoff:
    """Accuracy against bytes and time."""

    columns: dict[str, list[Any]]
    """Every setting on every recording, as columns for pandas or polars."""
    knees: list[dict[str, Any]]
    """Knees of the fronts."""
    left_out: list[dict[str, Any]]
    """Settings that could not be measured, with reasons."""
    warnings: list[str]
    """Warnings, as sentences."""
    about: dict[str, Any] = field(default_factory=dict)
    """Program, machine, measure of the error, and recordings."""

    def __repr__(self) -> str:
        rows = len(self.columns.get("model", []))
        return f"<htex.Tradeoff of {rows} points>"


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """A recording compared with a texture, or with another recording."""

    condition: Condition
    """Speed and force of the recording, and its repeatability."""
    representations: list[dict[str, Any]]
    """If compared with a texture: each representation's model, level, measures and felt error."""
    other: dict[str, Any] | None
    """The same measures, if it was compared with another recording."""
    other_condition: Condition | None
    """Speed and force of the other recording, and its repeatability."""
    warnings: list[str]
    """Warnings about the recordings, as sentences."""

    def table(self) -> dict[str, list[Any]]:
        """Return the measures as columns for pandas or polars."""
        rows = [self.other] if self.other else self.representations
        names = list(dict.fromkeys(name for row in rows for name in row if name not in ("felt", "band_error_db")))
        columns = {name: [row.get(name) for row in rows] for name in names}
        columns["felt_error_rms_db"] = [row["felt"]["error_rms_db"] for row in rows]
        return columns

    def __repr__(self) -> str:
        return f"<htex.Comparison with {'a recording' if self.other else f'{len(self.representations)} representation(s)'}>"


@dataclass(frozen=True, eq=False, repr=False)
class Response:
    """The frequency response of a recording rig or a finger display. The arrays have one entry for each frequency."""

    frequency_hz: npt.NDArray[np.float64]
    """Frequencies, hertz."""
    magnitude: npt.NDArray[np.float64]
    """Magnitude, in the output's unit divided by the input's."""
    phase_rad: npt.NDArray[np.float64]
    """Phase of the output relative to the input, radians."""
    coherence: npt.NDArray[np.float64] | None = None
    """Coherence, 0 to 1, if it was measured."""
    relative_error: npt.NDArray[np.float64] | None = None
    """Relative standard deviation of the magnitude, if it was measured."""
    about: dict[str, Any] = field(default_factory=dict)
    """Settings, hits or windows with the reasons why some were thrown out, peak and warnings."""

    def to_csv(self) -> bytes:
        """Return the CSV file that ``process``, ``fit`` and scenes accept as a response."""
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
    """Return the stored error of each model at each condition, as columns."""
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
    # Evaluated here, because `typing.get_type_hints` would look for the names in the module that is
    # set below.
    _class.__annotations__ = get_type_hints(_class)
    _class.__module__ = "htex"
