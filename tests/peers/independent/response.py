"""Responses of finger and display, and their compensation (scene-1.md section 4)."""

from __future__ import annotations

import math

import numpy as np

from .table import NotATable, read_table


def read_response(data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and magnitudes."""
    names, values = read_table(data)
    columns = dict(zip(names, values))
    if "frequency_hz" not in columns or "magnitude" not in columns:
        raise NotATable("a column is missing")
    frequencies, magnitudes = np.array(columns["frequency_hz"]), np.array(columns["magnitude"])
    if np.any(np.diff(frequencies) <= 0) or np.any(magnitudes < 0):
        raise NotATable("frequencies that do not ascend, or a negative magnitude")
    return frequencies, magnitudes


def compensation_db(frequencies: np.ndarray, magnitudes: np.ndarray, low: float, high: float, depth: float) -> float:
    """The largest gain of the compensation in the band, dB (*Compensation*)."""
    inside = frequencies[(frequencies > low) & (frequencies < high)]
    points = np.concatenate([[low], inside, [high]])
    values = np.interp(points, frequencies, magnitudes)
    largest = float(np.max(values))
    if not largest > 0:
        raise NotATable("all 0 in the band")
    h, floor = np.interp(np.linspace(low, high, 20001), points, values / largest), 10 ** (-depth / 10)
    gains = h / (h * h + floor)
    return 20 * math.log10(float(np.max(gains)))
