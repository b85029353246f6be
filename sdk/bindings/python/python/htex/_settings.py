"""The settings of the command: generated from the definitions of the Rust sources by `cargo xtask generate`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, TypedDict


class ReadingSettings(TypedDict, total=False):
    """How recordings are read."""

    rate_hz: Annotated[float | None, "Sampling rate; needed where the file does not say (NPY, CSV without a time column)"]
    map: Annotated[str | None, "Names and scales other people's columns and channels: ROLE=COLUMN, ROLE=COLUMN:SCALE or ROLE=EXPRESSION, e.g. lateral=lateral_V:0.4444,normal=-(fz1+fz2)*0.31. Roles: lateral, lateral_x, lateral_y (of other quantities: signal, signal_x, signal_y, signal_z), normal, speed, time, x, y; columns by name, number (#3) or path (/run1/fx), in quotes if the name has an operator; the values are in N, the quantity's unit, mm/s, s, mm"]
    tracker: Annotated[str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None, "The finger's motion from a tracker at its own rate: a file with the columns time and x, y (or speed), in times of the recording's clock; a recording without times begins at 0 s. One for each recording, or one for all"]
    tracker_map: Annotated[str | None, "Names and scales the tracker's columns, as `map` does: time=stamp_ms:0.001,x=#2,y=#3"]
    quantity: Annotated[Literal["lateral_force", "normal_force", "acceleration", "velocity", "displacement"] | None, "What the texture's signal is: a force in N, an acceleration in m/s2 (tool tips), a velocity in m/s, a displacement in m [default: lateral_force]"]
    scale: Annotated[float | None, "What a full-scale sample in WAV, FLAC and NPY files is, in the quantity's unit"]
    from_s: Annotated[float | None, "Reads the recording from this time on, s"]
    to_s: Annotated[float | None, "Reads the recording up to this time, s"]
    most_values: Annotated[int | None, "Most numbers of a recording that are kept in memory, where each takes 8 to 40 bytes; columns that are not used do not count [default: 40000000]"]
    segments: Annotated[Literal["auto", "sweeps", "windows"] | None, "Where the texture is read: in the middles of whole sweeps, in evenly spaced windows, or (auto) in sweeps if there are any that speak for at least half of the sliding, a sweep for 2 s at most [default: auto]"]
    averaging: Annotated[Literal["magnitude", "rms", "complex"] | None, "How segments are averaged; `rms` reads noise at its level, `magnitude` is the mean that the paper is taken to use and reads noise 1.05 dB lower, `complex` keeps only what is in phase in all segments [default: rms]"]


class FitSettings(TypedDict, total=False):
    """How models are fitted."""

    models: Annotated[str | Sequence[str] | None, "Models by short name or id, comma-separated, or `all` [default: all]"]
    level: Annotated[Literal["fitted", "recording"] | None, "Level of a representation: the recording's RMS in the band, so that it plays as strong as the recording, or the level of its own fit. Bands keeps energies, so it always has the level of its fit [default: recording]"]
    keep_reference: Annotated[bool | None, "Keep the recorded spectrum in the asset (788 bytes a condition, before compression)"]


class Metadata(TypedDict, total=False):
    """What a texture is, who made it, and how it was recorded."""

    name: Annotated[str | None, "Name of the texture"]
    author: Annotated[str | None, "Who made it"]
    license: Annotated[str | None, "Licence of the asset, as an SPDX expression, e.g. CC-BY-4.0"]
    description: Annotated[str | None, "What the surface is, in words"]
    tags: Annotated[str | Sequence[str] | None, "Tags, comma-separated; may be given several times"]
    source: Annotated[str | None, "Where the recordings come from: a dataset, a laboratory, an address"]
    doi: Annotated[str | None, "DOI of the recordings or of the paper that describes them, e.g. 10.5281/zenodo.1234567"]
    sensor: Annotated[str | None, "What measured the signal, e.g. \"six-axis force sensor, ATI Nano17\""]
    finger: Annotated[str | None, "What slid over the surface, e.g. \"bare index finger\""]
    contact: Annotated[Literal["finger", "tool", "unknown"] | None, "Whether a finger or a tool slid over the surface: it decides how frequencies and level follow motions that were not recorded, as far as neither recordings nor `law` tell"]
    law: Annotated[Mapping[str, float] | None, "How frequencies and level follow motions that were not recorded, in place of what is measured or assumed: exponents of frequency-speed, level-speed and level-force, e.g. frequency-speed=0,level-speed=0.4"]


class ResponseSettings(TypedDict, total=False):
    """How a response is measured."""

    estimator: Annotated[Literal["h1", "h2", "hv"] | None, "h1: for noise in the output; h2: for noise in the input; hv: for noise in both (total least squares) [default: h1]"]
    window_s: Annotated[float | None, "Length of a window, s: the part of the recording that is transformed at a time. The response has a value every 1/length Hz; lengths that are multiples of 0.2 s include the 5 Hz grid of texture spectra [default: 1]"]
    low_hz: Annotated[float | None, "Lowest frequency, Hz [default: 20]"]
    high_hz: Annotated[float | None, "Highest frequency, Hz; half of the sample rate if that is lower [default: 1000]"]
    input_limit: Annotated[float | None, "Magnitude of the input at which its sensor or amplifier is overloaded. Without it, four equal samples in a row at the highest or lowest value count as an overload"]
    output_limit: Annotated[float | None, "Magnitude of the output at which its sensor or amplifier is overloaded. Without it, the same rule applies as for the input"]
    continuous: Annotated[bool | None, "The input is a continuous drive, such as noise or a sweep: use Hann windows with half overlap"]
    pre_trigger_s: Annotated[float | None, "Hits: time before the trigger that belongs to the window, s; the mean of that part is removed [default: 0.02]"]
    trigger: Annotated[float | None, "Hits: level at which a hit starts, relative to the largest input of the recording [default: 0.1]"]
    double: Annotated[float | None, "Hits: size of a second contact that makes a double hit, relative to the hit [default: 0.1]"]
    force_window_s: Annotated[float | None, "Hits: time after the trigger, s, from which on the input is faded to zero; this removes noise between hits"]
    exponential_s: Annotated[float | None, "Hits: time constant of an exponential window on both channels, s, for responses that outlast the window. The window raises their damping by the inverse of this time constant"]
