"""The settings of the command: generated from the definitions of the Rust sources by `cargo xtask generate`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, TypedDict


class ReadingSettings(TypedDict, total=False):
    """How recordings are read."""

    rate_hz: Annotated[float | None, "Sample rate, Hz; needed if the file does not state it (NPY, CSV without a time column)"]
    map: Annotated[str | None, "What the columns or channels of a recording mean, and their scales: ROLE=COLUMN, ROLE=COLUMN:SCALE or ROLE=EXPRESSION, separated by commas, e.g. lateral=lateral_V:0.4444,normal=-(fz1+fz2)*0.31. Roles and their units after scaling: lateral, lateral_x, lateral_y and normal (N), speed (mm/s), time (s), x and y (mm). For a `quantity` other than the lateral force, use signal, signal_x, signal_y and signal_z instead of lateral (in the unit of the quantity). A column is a name, a number (#3) or a path (/run1/fx). Put a name that contains an operator in quotes"]
    tracker: Annotated[str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None, "Read the finger's motion from this file of a tracker, which may have its own sample rate. The file has the columns time, x and y (or time and speed). Its times are on the clock of the recording; a recording without times begins at 0 s. Give one file for each recording, or one for all"]
    tracker_map: Annotated[str | None, "What the columns of the tracker's file mean, and their scales, written as for `map`, e.g. time=stamp_ms:0.001,x=#2,y=#3"]
    quantity: Annotated[Literal["lateral_force", "normal_force", "acceleration", "velocity", "displacement"] | None, "Quantity of the texture's signal: a force (N), an acceleration, e.g. of a tool tip (m/s2), a velocity (m/s) or a displacement (m) [default: lateral_force]"]
    scale: Annotated[float | None, "Value for which a full-scale sample stands in WAV, FLAC and NPY files, in the unit of `quantity`"]
    from_s: Annotated[float | None, "Read the recording from this time on, s"]
    to_s: Annotated[float | None, "Read the recording up to this time, s"]
    most_values: Annotated[int | None, "Maximum number of values of a recording to keep in memory. Each value takes 8 to 40 bytes. Columns that are not used do not count [default: 40000000]"]
    segments: Annotated[Literal["auto", "sweeps", "windows"] | None, "Which segments of the recording to use. `sweeps`: the middle of each complete sweep. `windows`: evenly spaced windows. `auto`: sweeps if they represent at least half of the sliding, otherwise windows; a sweep represents at most 2 s [default: auto]"]
    averaging: Annotated[Literal["magnitude", "rms", "complex"] | None, "How to average the segments. `rms` averages the power, so that noise keeps its level. `magnitude` averages the magnitudes, as the paper probably does; noise is then 1.05 dB too low. `complex` averages the complex spectra, so that only signals with the same phase in all segments remain [default: rms]"]


class FitSettings(TypedDict, total=False):
    """How models are fitted."""

    models: Annotated[str | Sequence[str] | None, "Models to fit, by short name or id, comma-separated. `all` selects the models that htex fits by default; some models are fitted only if you name them [default: all]"]
    preset: Annotated[Literal["paper"] | None, "Several settings at once. `paper`: the paper's five models, sweeps, averaged magnitudes, and the paper's choice for every option (docs/paper.md). Other flags take precedence"]
    level: Annotated[Literal["fitted", "recording"] | None, "How strong a model plays. `recording`: as strong as the recording (its RMS in the frequency band). `fitted`: as strong as the model's own fit. Bands always plays at the level of its fit, because it stores energies [default: recording]"]
    keep_reference: Annotated[bool | None, "Keep the recorded spectra in the asset. Each condition takes 788 bytes before compression"]
    storage: Annotated[Literal["auto", "coded", "plain"] | None, "Whether to code the asset: the same texture in fewer bytes, which readers of version 1.0 of the format refuse. `auto`: only with more than eight conditions, and only if the file becomes smaller [default: auto]"]
    recorded_only: Annotated[bool | None, "Fit only the recorded conditions. Without this flag, htex adds computed conditions: between recorded speeds, if frequencies follow the speed; and at a third and three times the speed, if it is the only one and --contact is unknown"]


class Metadata(TypedDict, total=False):
    """What a texture is, who made it, and how it was recorded."""

    name: Annotated[str | None, "Name of the texture"]
    author: Annotated[str | None, "Who made the texture"]
    license: Annotated[str | None, "Licence of the asset, as an SPDX expression, e.g. CC-BY-4.0"]
    description: Annotated[str | None, "What the surface is, in words"]
    tags: Annotated[str | Sequence[str] | None, "Search terms (tags), comma-separated; may be given several times"]
    source: Annotated[str | None, "Where the recordings come from, e.g. a dataset, a laboratory or a web address"]
    doi: Annotated[str | None, "DOI of the recordings or of the paper that describes them, e.g. 10.5281/zenodo.1234567"]
    sensor: Annotated[str | None, "Sensor that measured the signal, e.g. \"six-axis force sensor, ATI Nano17\""]
    finger: Annotated[str | None, "What slid over the surface, e.g. \"bare index finger\""]
    contact: Annotated[Literal["finger", "tool", "unknown"] | None, "Whether a finger or a tool slid over the surface. From this, htex assumes how frequencies and level change at speeds and forces that were not recorded, unless the recordings show it or `law` states it"]
    law: Annotated[Mapping[str, float] | None, "Exponents by which frequencies and level change at speeds and forces that were not recorded: frequency-speed, level-speed and level-force, e.g. frequency-speed=0,level-speed=0.4. They replace measured or assumed exponents"]


class ResponseSettings(TypedDict, total=False):
    """How a response is measured."""

    estimator: Annotated[Literal["h1", "h2", "hv"] | None, "Estimator of the response. Use h1 if the output has noise, h2 if the input has noise, and hv (total least squares) if both have noise [default: h1]"]
    window_s: Annotated[float | None, "Length of a window, s. htex transforms the recording in windows of this length, so that the response has a value every 1/length Hz. If the length is a multiple of 0.2 s, these frequencies include the frequencies of texture spectra, which are 5 Hz apart [default: 1]"]
    low_hz: Annotated[float | None, "Lowest frequency of the response, Hz [default: 20]"]
    high_hz: Annotated[float | None, "Highest frequency of the response, Hz. If half of the sample rate is lower, the response ends at half of the sample rate [default: 1000]"]
    input_limit: Annotated[float | None, "Count the input as overloaded where its magnitude reaches this value. By default, a hit is overloaded if it has four equal samples in a row at the input's highest or lowest value, and the input of a continuous drive is not checked"]
    output_limit: Annotated[float | None, "Count the output as overloaded where its magnitude reaches this value. By default, four equal samples in a row at the output's highest or lowest value count as an overload"]
    continuous: Annotated[bool | None, "Measure with a continuous drive, such as noise or a sweep, instead of the hits of a hammer. htex then uses Hann windows, each of which overlaps the previous one by half"]
    pre_trigger_s: Annotated[float | None, "For hits: time by which each window begins before the trigger, s. htex subtracts the mean of the samples before the trigger from the window [default: 0.02]"]
    trigger: Annotated[float | None, "For hits: level at which a hit starts, as a fraction of the largest input of the recording [default: 0.1]"]
    double: Annotated[float | None, "For hits: smallest size of a second contact, as a fraction of the hit. htex discards a hit if its window has such a second contact (double hit) [default: 0.1]"]
    force_window_s: Annotated[float | None, "For hits: time after the trigger at which htex begins to fade the input to zero, s. The fade removes the noise between hits"]
    exponential_s: Annotated[float | None, "For hits: time constant of an exponential window, s. htex multiplies both channels by this window. Use it if responses last longer than the window; the measured damping rises by the inverse of the time constant"]
