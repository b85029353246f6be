"""Magnitudes of the models of the specification (htex-playing-1.md section 2)."""

from __future__ import annotations

import math
from typing import Callable

import numpy as np
from scipy.fft import idct
from scipy.optimize import nnls
from scipy.special import betaln

from .blocks import grid

BIN = 5.0
Values = list  # of float or list of float, in the order of the model's fields


class Refusal(Exception):
    """Parameters or a motion that a player refuses."""


class Band:
    def __init__(self, low: float, high: float):
        self.low, self.high = low, high
        self.grid = BIN * np.array(grid(low, high), dtype=float)

    def inside(self, f: np.ndarray) -> np.ndarray:
        return (f >= self.low) & (f <= self.high)


def magnitude(model: str, values: Values, band: Band) -> Callable[[np.ndarray], np.ndarray]:
    """The shape as a function of frequencies; 0 outside the band."""
    shape = SHAPES[model](values, band)

    def limited(f: np.ndarray) -> np.ndarray:
        f = np.asarray(f, dtype=float)
        clamped = np.clip(f, band.low, band.high)
        return np.where(band.inside(f), shape(clamped), 0.0)

    return limited


def normed(shape: Callable, band: Band) -> Callable:
    """`norm`: the shape over its RMS on the band's grid."""
    on_grid = shape(band.grid)
    with np.errstate(over="ignore", invalid="ignore"):
        rms = math.sqrt(float(np.sum(on_grid**2)) / 3)
    if not math.isfinite(rms) or rms <= 0:
        raise Refusal("no finite magnitude above 0 on the grid")
    return lambda f: shape(f) / rms


def require_stable(coefficients: list[float]) -> None:
    a = np.asarray(coefficients, dtype=float)
    if len(a) and np.max(np.abs(np.roots(np.concatenate([[1.0], -a])))) >= 1:
        raise Refusal("the filter is not stable")


def ar(values: Values, band: Band) -> Callable:
    coefficients, rate = values
    a = np.asarray(coefficients, dtype=float)
    require_stable(coefficients)
    k = np.arange(1, len(a) + 1)

    def shape(f):
        response = 1 - np.exp(-2j * np.pi * np.outer(f, k) / rate) @ a
        return np.where(f <= rate / 2, 1 / np.abs(response), 0.0)

    return normed(shape, band)


def arma(values: Values, band: Band) -> Callable:
    poles, zeros, rate = values
    inside = all(0 < w < math.pi for w in poles)
    if not inside or any(a >= b for a, b in zip(poles, poles[1:])):
        raise Refusal("the lines of the poles do not ascend between 0 and pi")
    if any(a > b for a, b in zip(zeros, zeros[1:])):
        raise Refusal("the lines of the zeros descend")

    def shape(f):
        turn = 2 * np.pi * f / rate
        with np.errstate(divide="ignore", over="ignore"):
            power = lines_power(zeros, turn) / lines_power(poles, turn)
        return np.where(f <= rate / 2, np.sqrt(power), 0.0)

    return normed(shape, band)


def lines_power(lines: list, turn: np.ndarray) -> np.ndarray:
    """The squared absolute value on the unit circle of the polynomial with these line spectral frequencies: that of the symmetric one
    and that of the antisymmetric one, which are a quarter turn apart, over four."""
    factors = [np.prod([4 * (np.cos(turn) - math.cos(w)) ** 2 for w in lines[i::2]] or [np.ones_like(turn)], axis=0) for i in (0, 1)]
    if len(lines) % 2 == 0:
        return factors[0] * np.cos(turn / 2) ** 2 + factors[1] * np.sin(turn / 2) ** 2
    return (factors[0] + 4 * factors[1] * np.sin(turn) ** 2) / 4


def friction_map(values: Values, band: Band) -> Callable:
    width, pitch, speed, _, rms, grey = values
    width = int(width)
    if not grey or len(grey) % width or len(grey) // width > 255:
        raise Refusal("the grey values are no rows of the width")
    rows = np.asarray(grey, dtype=float).reshape(-1, width)
    k = np.arange(1, width // 2 + 1)
    cycles, lines = k / width, k * speed / (width * pitch)
    gain = (3 * np.sinc(cycles) ** 2 - np.sinc(2 * cycles) - 3 * np.sinc(2 * cycles) ** 2 + np.sinc(4 * cycles)) / (np.pi * cycles) ** 2
    waves = np.mean(np.abs(np.fft.fft(rows)[:, k]) ** 2, axis=0) / width**2
    power = np.where(2 * k == width, 1, 2) * gain**2 * waves * ((lines >= band.low) & (lines <= band.high))

    def shape(f):
        d = (np.asarray(f)[:, None] - lines) / BIN
        return np.sqrt(np.where(np.abs(d) < 2, window_lobe(d), 0.0) ** 2 @ (2 * power))

    own = math.sqrt(np.sum(shape(band.grid) ** 2) / 3)
    if own <= 1e-9 or abs(rms - own) > 1e-6 * own:
        raise Refusal("rms is not that of the grey values")
    return normed(shape, band)


def window_lobe(d: np.ndarray) -> np.ndarray:
    """sinc(d) / (1 - d^2), 1/2 at d = +-1."""
    near = np.abs(np.abs(d) - 1) < 1e-9
    safe = np.where(near, 0.0, d)
    return np.where(near, 0.5, np.sinc(safe) / (1 - safe**2))


def read_power(frequency: float, band: Band) -> float:
    """R_i: the part of a line's power that the band's bins read."""
    first, last = band.grid[0], band.grid[-1]
    if frequency - first >= 4 * BIN and last - frequency >= 4 * BIN:
        return 1.0
    # The higher of two bins that are equally near.
    nearest = math.floor(frequency / BIN + 0.5) * BIN
    bins = nearest + BIN * np.arange(-4, 5)
    bins = bins[(bins >= first) & (bins <= last)]
    return float(np.sum(window_lobe((bins - frequency) / BIN) ** 2) / 1.5)


def speak(values: Values, band: Band) -> Callable:
    lines = [(f, a) for f, a in zip(values[0], values[1]) if band.low <= f <= band.high]
    power = sum(a * a * read_power(f, band) / 2 for f, a in lines)
    if not power > 0:
        raise Refusal("no line in the band has an amplitude")
    frequencies, amplitudes = (np.array(column) for column in zip(*lines))

    def shape(f):
        d = (np.asarray(f)[:, None] - frequencies) / BIN
        heights = np.where(np.abs(d) >= 2, 0.0, window_lobe(d)) * amplitudes
        return np.sqrt(np.sum(heights**2, axis=1)) / math.sqrt(power)

    return shape


def sbeta(values: Values, band: Band) -> Callable:
    alpha, beta = values
    a, b = (1.25 if alpha < 1 else 0.0), (1.25 if beta < 1 else 0.0)
    width = math.log(band.high / band.low)
    if band.low + a > band.high - b:
        raise Refusal("a band narrower than what is left out at its edges")

    def power(base, exponent):
        """The logarithm of base^exponent; 0^0 is 1."""
        with np.errstate(divide="ignore"):
            return np.zeros_like(base) if exponent == 0 else exponent * np.log(base)

    def log_density(f):
        g = np.minimum(np.maximum(f, band.low + a), band.high - b)
        u, rest = np.log(g / band.low) / width, np.log(band.high / g) / width
        return power(u, alpha - 1) + power(rest, beta - 1) - betaln(alpha, beta)

    highest = float(np.max(log_density(band.grid)))
    if not math.isfinite(highest):
        raise Refusal("no finite density on the grid")
    return normed(lambda f: np.exp(log_density(f) - highest), band)


def sslope(values: Values, band: Band) -> Callable:
    peak, high_pass, low_pass = values

    def shape(f):
        ratio = np.log(f / peak)
        return np.exp(-0.5 * (np.logaddexp(0, -2 * high_pass * ratio) + np.logaddexp(0, 2 * low_pass * ratio)))

    return normed(shape, band)


def bands(values: Values, band: Band) -> Callable:
    knots, step, layout = values
    count = len(knots)

    def shape(f):
        if layout < 0.5:
            x = (count + 1) * np.log(f / band.low) / math.log(band.high / band.low)
        else:
            x = 1 + (count - 1) * np.log((f + 20) / (band.low + 20)) / math.log((band.high + 20) / (band.low + 20))
        return 10 ** (-step * np.interp(x, np.arange(1, count + 1), knots) / 20)

    return normed(shape, band)


def whole(x: float) -> int:
    """The nearest integer, halves up."""
    return math.floor(x + 0.5)


def mel_bank(count: int, band: Band) -> tuple[np.ndarray, np.ndarray]:
    """Edges in hertz, and the weights at the grid, a row a filter."""
    mel = np.linspace(2595 * math.log10(1 + band.low / 700), 2595 * math.log10(1 + band.high / 700), count + 2)
    edges = 700 * (10 ** (mel / 2595) - 1)
    # The outer edges are the band's, and have weight 0 exactly; the way back from mel would round them.
    edges[0], edges[-1] = band.low, band.high
    rows = [np.interp(band.grid, edges[i : i + 3], [0, 1, 0], left=0, right=0) for i in range(count)]
    return edges, np.array(rows)


def mfcc(values: Values, band: Band) -> Callable:
    cepstrum, count, inverse = values[0], whole(values[1]), whole(values[2])
    padded = np.zeros(count)
    padded[: min(count, len(cepstrum))] = cepstrum[:count]
    logs = idct(padded, norm="ortho")
    edges, weights = mel_bank(count, band)
    if inverse == 3:
        amplitudes = log_log(edges, weights, logs, band.grid)
        return normed(lambda f: np.interp(f, band.grid, amplitudes), band)
    with np.errstate(over="ignore"):
        energies = np.exp(logs)
    if not np.all(np.isfinite(energies)) or not np.any(energies > 0):
        raise Refusal("band energies that are not finite, or all zero")
    if inverse == 0:
        share = 2.0**-52 * max(weights.shape)
        power = np.maximum(np.linalg.pinv(weights, rcond=share) @ energies, 0.0)
        power[np.all(weights == 0, axis=0)] = 0.0
    elif inverse == 1:
        power = non_negative(weights, energies)
    else:
        sums = weights.sum(axis=1)
        some = sums > 0
        if not np.any(some):
            raise Refusal("no filter has weight on the grid")
        power = np.interp(band.grid, edges[1:-1][some], energies[some] / sums[some])
    amplitudes = np.sqrt(power)
    return normed(lambda f: np.interp(f, band.grid, amplitudes), band)


def log_log(edges: np.ndarray, weights: np.ndarray, logs: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Amplitudes at the grid: ln p is linear in ln f between the apexes, and beyond the outermost ones with a slope of at most 8."""
    sums = weights.sum(axis=1)
    some = sums > 0
    if not np.any(some):
        raise Refusal("no filter has weight on the grid")
    x, y, at = np.log(edges[1:-1][some]), logs[some] - np.log(sums[some]), np.log(grid)
    power = np.interp(at, x, y)
    if len(x) > 1:
        first, last = (np.clip((y[i + 1] - y[i]) / (x[i + 1] - x[i]), -8, 8) for i in (0, len(x) - 2))
        power += first * np.minimum(at - x[0], 0) + last * np.maximum(at - x[-1], 0)
    with np.errstate(over="ignore"):
        return np.exp(power / 2)


def non_negative(weights: np.ndarray, energies: np.ndarray) -> np.ndarray:
    """The p >= 0 that minimises |W p - e|^2 + 1e-6 |p|^2."""
    some, points = weights.sum(axis=1) > 0, weights.sum(axis=0) > 0
    power = np.zeros(weights.shape[1])
    largest = np.max(energies[some], initial=0.0)
    if largest <= 0:
        return power
    # Where no filter has weight, p is 0, exactly: those points are not left to the solver.
    size = int(np.sum(points))
    matrix = np.vstack([weights[np.ix_(some, points)], 1e-3 * np.eye(size)])
    target = np.concatenate([energies[some] / largest, np.zeros(size)])
    power[points] = nnls(matrix, target)[0] * largest
    return power


SHAPES = {
    "org.htex.ar": ar,
    "org.htex.arma": arma,
    "org.htex.mfcc": mfcc,
    "org.htex.speak": speak,
    "org.htex.sbeta": sbeta,
    "org.htex.sslope": sslope,
    "org.htex.bands": bands,
    "org.htex.map": friction_map,
}
SUMS_OF_SINUSOIDS = {"org.htex.speak", "org.htex.map"}
FOLLOW_THE_MOTION = {"org.htex.map"}
