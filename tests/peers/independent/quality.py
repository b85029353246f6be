"""The measures of `quality`, from htex-writing.md, section 1: what a representation's voice reads, and how it agrees with
the reference."""

from __future__ import annotations

from pathlib import Path
from typing import Callable

import numpy as np

from .asset import read_asset
from .models import Models
from .playing import Voice
from .shapes import Band, magnitude, read_power, window_lobe

AR, ARMA, BANDS, SPEAK = (f"org.htex.{name}" for name in ("ar", "arma", "bands", "speak"))
# Manifests have four decimals. Lines are read of samples, which are rounded.
TOLERANCE, LINES_TOLERANCE = 2e-4, 0.02


def passed(f: np.ndarray, rate: float) -> np.ndarray:
    """The part of a magnitude that the conversion of rates passes."""
    total = np.zeros_like(f)
    for p in range(4):
        t = np.arange(224) - 111 - p / 4
        h = np.sinc(t) * np.i0(6.75526 * np.sqrt(np.maximum(0, 1 - (t / 112) ** 2))) / np.i0(6.75526)
        total += np.cos(2 * np.pi * np.outer(f / rate, t)) @ (h / h.sum())
    return np.where(f > 0.49 * rate, abs(total / 4), 1.0)


def sharpened(shape: np.ndarray) -> np.ndarray:
    """The density at the grid of a voice whose parameters are energies that were read."""
    p = shape**2
    s = p.copy()
    for _ in range(2):
        ends = np.concatenate([s[:1], s, s[-1:]])
        read = (ends[:-2] + 4 * s + ends[2:]) / 6
        s = np.where(read > 0, s * p / np.where(read > 0, read, 1), s)
    return np.sqrt(s)


def noise(model: str, shape: Callable, values: list, band: Band) -> np.ndarray:
    """What is read of noise, for a level of 1."""
    grid, offsets = band.grid, np.arange(-16, 17) / 8
    lobe = np.where(abs(offsets) < 2, window_lobe(offsets), 0)
    f = grid[:, None] + 5 * offsets
    if model == BANDS:
        knots = sharpened(shape(grid))
        density = lambda f: np.where(band.inside(f), np.interp(f, grid, knots), 0)
    else:
        density = shape

    def read(f: np.ndarray, weights: np.ndarray) -> np.ndarray:
        edge = np.clip(f, band.low, band.high)
        near = np.where(abs(f - edge) <= 2.5, edge, f)
        return np.sqrt(((lobe * weights * density(near.ravel()).reshape(f.shape)) ** 2).sum(axis=1))

    rate = values[-1] if model in (AR, ARMA) else None
    if rate is None or band.high <= 0.49 * rate:
        level = magnitude_read = read(f, np.ones_like(f))
    else:
        mirrored = np.where(f > rate / 2, rate - f, f)
        level = read(mirrored, f <= rate / 2)
        magnitude_read = read(mirrored, passed(f.ravel(), rate).reshape(f.shape))
    return magnitude_read / np.sqrt((level**2).sum() / 3)


def lines(values: list, band: Band) -> np.ndarray:
    """What is read of lines that start at phase 0, for a level of 1."""
    kept = [(f, a) for f, a in zip(values[0], values[1]) if band.low <= f <= band.high]
    f, a = (np.array(column) for column in zip(*kept))
    a = a / np.sqrt(sum(a * a * read_power(f, band) / 2 for f, a in kept))
    distance = band.grid[:, None] / 5 - f / 5
    turns = np.exp(1j * 2 * np.pi * np.outer(f, 0.1 * np.arange(1, 200)))
    return np.sqrt((abs((window_lobe(distance) * a) @ turns) ** 2).mean(axis=1))


def measures(ours: np.ndarray, theirs: np.ndarray, band: Band) -> dict[str, float | list[float]]:
    """The agreement of a magnitude with that of a recording."""
    grid = band.grid
    points = np.log(band.low * (band.high / band.low) ** (np.arange(11) / 10))
    triangles = [np.interp(np.log(grid), points[i : i + 3], [0, 1, 0], left=0, right=0) for i in range(9)]
    smallest = 1e-12 * max(weights @ theirs**2 for weights in triangles)

    def nine(ours: np.ndarray) -> np.ndarray:
        energies = [(weights @ ours**2 + smallest, weights @ theirs**2 + smallest) for weights in triangles]
        return np.array([10 * np.log10(a / b) for a, b in energies])

    rms = lambda x: float(np.sqrt(np.mean(np.square(x))))
    gain = np.sqrt((theirs**2).sum() / (ours**2).sum())
    floored = np.maximum(ours, 1e-9 * theirs.max())
    octaves = []
    for k in range(17):
        low, high = (20 * 2 ** (i / 3) * (1 - 1e-12) for i in (k, k + 1))
        inside = (grid >= low) & (grid < high)
        if (theirs[inside] > 0).any():
            octaves.append(10 * np.log10((floored[inside] ** 2).sum() / (theirs[inside] ** 2).sum()))
    heard = theirs > 0
    return {
        "spectral_correlation": float(np.corrcoef(ours, theirs)[0, 1]),
        "band_error_db": nine(ours).tolist(),
        "band_error_rms_db": rms(nine(ours)),
        "band_error_matched_rms_db": rms(nine(gain * ours)),
        "third_octave_error_rms_db": rms(octaves),
        "log_spectral_distance_db": rms(20 * np.log10(floored[heard] / theirs[heard])),
    }


def compare_quality(folder: Path, models: Models, say: Callable[[str], None]) -> tuple[int, int]:
    """Compare `quality` of each representation with what its parameters and the reference give."""
    agree = total = 0
    for path in sorted(folder.glob("*.htex")):
        asset, findings = read_asset(path.read_bytes(), models)
        assert findings.valid, path
        manifest = asset.manifest
        band = Band(manifest["band"]["low_hz"], manifest["band"]["high_hz"])
        for representation in manifest["representations"]:
            model = representation["model"]
            sets = Voice(asset, models[model]).sets
            for at, values in zip(representation["at"], sets):
                read = lines(values, band) if model == SPEAK else noise(model, magnitude(model, values, band), values, band)
                reference = np.array(asset.reference[int(at["condition"])], dtype=float)
                ours = measures(at["level_rms"] * read, reference, band)
                tolerance = LINES_TOLERANCE if model == SPEAK else TOLERANCE
                for key, number in ours.items():
                    total += 1
                    off = float(np.max(np.abs(np.subtract(number, at["quality"][key]))))
                    if off <= tolerance:
                        agree += 1
                    else:
                        say(f"{folder.name}/{path.name}: {model}, {key}: ours {number}, {at['quality'][key]}")
    return agree, total
