"""Recordings without a texture in the band (recording-findings.md, *Thresholds*)."""

from __future__ import annotations

from typing import Iterable

import numpy as np

from . import segments
from .findings import Findings

COSINES = (0.35875, -0.48829, 0.14128, -0.01168)


def check(lateral: np.ndarray, rate: float, findings: Findings) -> None:
    length = segments.length_of(rate)
    starts = segments.find(lateral, rate).starts
    long = min(5 * length, len(lateral))
    if not starts or long < 2 * length or not np.any(lateral):
        return
    values = lateral / np.max(np.abs(lateral))
    due: list[int] = []
    for start in starts:
        if not due or start - due[-1] >= long // 4:
            due.append(start)
    centred = [min(max(start + length // 2 - long // 2, 0), len(values) - long) for start in due]
    turns = 2 * np.pi * np.arange(long) / long
    window = sum(c * np.cos(k * turns) for k, c in enumerate(COSINES))
    shown, _ = powers((values[s : s + length] for s in starts), np.hanning(length + 1)[:-1], rate, False)
    inside, above = powers((values[s : s + long] for s in centred), window, rate, True)
    if shown > 1e-24 and shown >= 5 * inside:
        findings.add("RECORDING_BELOW_BAND", "/lateral")
    elif above > 1e-24 and above >= 1000 * inside:
        findings.add("RECORDING_ABOVE_BAND", "/lateral")


def powers(parts: Iterable[np.ndarray], window: np.ndarray, rate: float, level: bool) -> tuple[float, float]:
    """Mean powers of stretches in the band and above it."""
    hertz = np.fft.rfftfreq(len(window), 1 / rate)
    places = np.arange(len(window)) - (len(window) - 1) / 2
    total = []
    for part in parts:
        part = part - np.mean(part)
        if level:
            part = part - places * (places @ part) / (places @ places)
        total.append(np.abs(np.fft.rfft(part * window)) ** 2)
    power = np.mean(total, axis=0) / (np.sum(window**2) * len(window))
    return float(np.sum(power[(hertz >= 20) & (hertz <= 1000)])), float(np.sum(power[hertz > 1000]))
