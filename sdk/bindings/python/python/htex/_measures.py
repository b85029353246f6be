"""The measures of agreement: generated from the table of the Rust sources by `cargo xtask generate`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

ErrorMeasure = Literal["nine_band", "third_octave", "log_spectral"]
"""A measure of the error of a model."""


@dataclass(frozen=True)
class Agreement:
    """Agreement of magnitudes with a reference."""

    spectral_correlation: float
    """Pearson correlation of the linear magnitudes, -1 to 1."""
    band_error_db: list[float]
    """Energy relative to the reference's in each of nine bands, decibels."""
    band_error_rms_db: float
    """RMS of the nine band errors, decibels."""
    matching_gain_db: float
    """Gain that makes the total energies equal, decibels."""
    band_error_matched_rms_db: float
    """RMS of the nine band errors, decibels, after a gain has made the total energies equal."""
    third_octave_error_rms_db: float | None
    """RMS error over third-octave bands, decibels; ``None`` for a reference without energy in them."""
    log_spectral_distance_db: float | None
    """RMS, over the bins, of the differences between the magnitudes in decibels; ``None`` for a silent reference."""
