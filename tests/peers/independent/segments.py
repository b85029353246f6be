"""Which parts of a recording are read (recording-findings.md, *Thresholds*, first paragraph)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SWEEP_STANDS_FOR_S = 2.0


@dataclass
class Reading:
    starts: list[int]
    cut_off: bool
    windows: bool
    sliding: np.ndarray


def length_of(rate: float) -> int:
    """The samples of a segment."""
    return int(rate / 5 + 0.5)


def average(values: np.ndarray, rate: float) -> np.ndarray:
    """Averages over 0.05 s: as many samples on either side as half of it has, fewer at the ends."""
    side = int(0.05 * rate / 2 + 0.5)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    index = np.arange(len(values))
    low, high = np.maximum(index - side, 0), np.minimum(index + side + 1, len(values))
    return (sums[high] - sums[low]) / (high - low)


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """The stretches in which a mask holds, as first and end."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist()))


def find(lateral: np.ndarray, rate: float) -> Reading:
    length, count = length_of(rate), len(lateral)
    magnitude = np.abs(lateral)
    smooth, threshold = average(magnitude, rate), float(np.mean(magnitude))
    sliding = smooth >= 0.5 * threshold
    sweeps = [(s, e) for s, e in runs(smooth > threshold) if e - s >= length]
    whole = [(s, e) for s, e in sweeps if s > 0 and e < count]
    represented = sum(min(e - s, SWEEP_STANDS_FOR_S * rate) for s, e in whole)
    if sweeps and not np.all(sliding) and represented >= 0.5 * np.count_nonzero(sliding):
        starts = [(s + e) // 2 - length // 2 for s, e in whole]
        return Reading(starts, len(whole) < len(sweeps), False, sliding)
    windows = bool(sweeps) and not np.all(sliding)
    return Reading(list(range(0, count - length + 1, (length + 1) // 2)), False, windows, sliding)
