"""Simulate recordings, and measure the responses of recording rigs and finger displays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _errors, _htex
from ._data import Response, Simulation
from ._keywords import Unpack, as_json, keywords, split
from ._settings import ResponseSettings

Surface = Literal["sandpaper", "fine-fabric", "coarse-fabric", "corrugated-paper", "vinyl"]


def simulate(
    surface: Surface,
    *,
    seed: int = 0,
    seconds: float = 10.0,
    rate_hz: float = 20_000.0,
    motion: Literal["sweeps", "free"] = "sweeps",
    speed_mm_s: float | tuple[float, float] | None = None,
    force_n: float | tuple[float, float] | None = None,
    law: Mapping[str, float] | None = None,
    drift_db_per_min: float = 0.0,
    lifted: float = 0.0,
) -> Simulation:
    """Simulate a recording of a finger that slides over a surface, as ``htex simulate`` does.

    The result is not a measurement, and textures fitted to it state that they are simulated. With
    ``motion="sweeps"``, the finger sweeps back and forth at one speed and force; the defaults are
    80 mm/s and 0.4 N. With ``motion="free"``, it makes strokes of random speed and force between
    two values; the defaults are 36 to 280 mm/s and 0.15 to 3.8 N. The same seed gives the same
    samples.

    ``law`` states how frequencies and level change with speed and force, by the exponents
    ``frequency_speed``, ``level_speed`` and ``level_force``, relative to 80 mm/s and 0.4 N. For a
    surface with a relief they are 1, 0 and 1. ``drift_db_per_min`` is the change of the texture's
    level during the recording, dB per minute. ``lifted`` is the fraction of the time that the
    finger is off the surface, 0 to 0.8.
    """
    if motion not in ("sweeps", "free"):
        raise _errors.OptionError(f"motion is {motion!r}; known are sweeps, free")
    departures = (as_json(dict(law or {})), drift_db_per_min, lifted)
    found = _htex.simulate(surface, seed, seconds, rate_hz, motion == "free", speed_mm_s, force_n, departures)
    columns, csv, (frequency_hz, magnitude, phase_rad) = found
    response = Response(np.array(frequency_hz), np.array(magnitude), np.array(phase_rad))
    return Simulation(columns, csv=csv, rate_hz=rate_hz, response=response)


@keywords(ResponseSettings)
def response(
    input: npt.ArrayLike | Sequence[npt.ArrayLike],
    output: npt.ArrayLike | Sequence[npt.ArrayLike],
    rate_hz: float,
    **settings: Unpack[ResponseSettings],
) -> Response:
    """Measure the frequency response of a recording rig or a finger display, as ``htex response``
    does.

    ``input`` is the force of an impact hammer or, with ``continuous=True``, a continuous excitation
    such as noise. ``output`` is the signal of the rig or the display that responds to it. Both are
    series at ``rate_hz``, or lists of series, one for each recording.
    """
    (given,) = split("response", settings, ResponseSettings)
    inputs, outputs = _series(input), _series(output)
    if len(inputs) != len(outputs):
        raise _errors.OptionError(f"{len(inputs)} inputs and {len(outputs)} outputs; give an output for each input")
    found = _htex.response(list(zip(inputs, outputs, strict=True)), rate_hz, as_json(given))
    measured: dict[str, Any] = found["measured"]
    arrays = ("frequency_hz", "magnitude", "phase_rad", "coherence", "relative_error")
    fields = {name: np.array(measured.pop(name), dtype=np.float64) for name in arrays}
    return Response(**fields, about={**measured, "settings": found["settings"]})


def _series(series: Any) -> list[list[float]]:
    """Return one series or several series as a list of lists of numbers."""
    several = isinstance(series, (list, tuple)) and len(series) > 0 and np.ndim(series[0]) > 0
    arrays = [np.ma.filled(np.ma.asarray(one, dtype=np.float64), np.nan) for one in (series if several else [series])]
    for array in arrays:
        if array.ndim != 1:
            raise _errors.OptionError(f"a series has one dimension, not {array.ndim}")
    return [array.tolist() for array in arrays]
