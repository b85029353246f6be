"""Mixing of parameters (htex-playing-1.md section 6)."""

from __future__ import annotations

import numpy as np

from .shapes import Refusal, Values, require_stable

MOST_LINES = 64


def mix(model: str, sets: list[Values], weights: list[float]) -> Values:
    """The mix of at least one set; a single one is played as it is."""
    return sets[0] if len(sets) == 1 else MIXES.get(model, mix_scalars)(sets, weights)


def mean(columns: list, weights: list[float]):
    """The weighted mean of numbers, or of lists of one length; rounding puts no mean beyond its numbers."""
    numbers = np.asarray(columns, dtype=float)
    total = sum(weight * column for weight, column in zip(weights, numbers))
    total = np.clip(total, numbers.min(axis=0), numbers.max(axis=0))
    return total.tolist() if isinstance(columns[0], list) else float(total)


def require_equal(sets: list[Values], index: int, why: str) -> None:
    if any(values[index] != sets[0][index] for values in sets):
        raise Refusal(f"sets with different {why} cannot be mixed")


def require_lengths(sets: list[Values], why: str) -> None:
    if any(len(values[0]) != len(sets[0][0]) for values in sets):
        raise Refusal(f"sets with different {why} cannot be mixed")


def mix_scalars(sets, weights):
    return [mean([values[i] for values in sets], weights) for i in range(len(sets[0]))]


def mix_mfcc(sets, weights):
    require_lengths(sets, "lengths")
    require_equal(sets, 1, "bands")
    require_equal(sets, 2, "inverses")
    return [mean([values[0] for values in sets], weights), *sets[0][1:]]


def mix_bands(sets, weights):
    require_lengths(sets, "numbers of knots")
    require_equal(sets, 1, "steps")
    require_equal(sets, 2, "layouts")
    return [mean([values[0] for values in sets], weights), *sets[0][1:]]


def mix_speak(sets, weights):
    if all(len(values[0]) == len(sets[0][0]) for values in sets):
        return mix_scalars(sets, weights)
    frequencies = [f for values in sets for f in values[0]]
    if len(frequencies) > MOST_LINES:
        raise Refusal("more than 64 lines together")
    amplitudes = [a * weight**0.5 for values, weight in zip(sets, weights) for a in values[1]]
    return [frequencies, amplitudes, sets[0][2]]


def mix_ar(sets, weights):
    require_equal(sets, 1, "model rates")
    for values in sets:
        require_stable(values[0])
    order = max(len(values[0]) for values in sets)
    padded = [values[0] + [0.0] * (order - len(values[0])) for values in sets]
    frequencies = mean([line_frequencies(a) for a in padded], weights)
    return [filter_of(frequencies), sets[0][1]]


def mix_maps(sets, weights):
    return next(values for values, weight in zip(sets, weights) if weight >= max(weights) - 1e-9)


def mix_arma(sets, weights):
    require_equal(sets, 2, "model rates")
    return [mix_lines([values[0] for values in sets], weights), mix_lines([values[1] for values in sets], weights), sets[0][2]]


def mix_lines(sets, weights):
    """The mean of each line; a polynomial of a lower order is padded with zero coefficients first."""
    order = max(len(lines) for lines in sets)
    return mean([lines if len(lines) == order else padded_lines(lines, order) for lines in sets], weights)


def padded_lines(lines, order):
    coefficients = filter_of(lines)
    if len(coefficients) and np.max(np.abs(np.roots(np.concatenate([[1.0], -np.asarray(coefficients)])))) >= 1:
        raise Refusal("a zero on the unit circle, and another order")
    return line_frequencies(coefficients + [0.0] * (order - len(coefficients)))


def sum_and_difference(a: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of A(z) +- z^-(p+1) A(1/z), in ascending powers of 1/z."""
    whole = np.concatenate([[1.0], -np.asarray(a, dtype=float), [0.0]])
    return whole + whole[::-1], whole - whole[::-1]


def line_frequencies(a: list[float]) -> list[float]:
    """The line spectral frequencies of a stable filter, ascending."""
    found = []
    for coefficients, sign in zip(sum_and_difference(a), (1, -1)):
        angles = np.angle(np.roots(coefficients))
        count = len(a) // 2 if sign < 0 else (len(a) + 1) // 2
        inner = sorted(angle for angle in angles if 0 < angle < np.pi)
        # The trivial zeros at 1 and -1 may be read as angles next to 0 and pi: keep the inner ones.
        inner = sorted(sorted(inner, key=lambda w: -min(w, np.pi - w))[:count])
        found += [refine(coefficients, sign, w) for w in inner]
    return sorted(found)


def refine(coefficients: np.ndarray, sign: int, w: float) -> float:
    """Newton's method on the real function whose zeros are the frequencies."""
    half = (len(coefficients) - 1) / 2 - np.arange(len(coefficients))
    for _ in range(4):
        if sign > 0:
            value, slope = coefficients @ np.cos(half * w), -coefficients @ (half * np.sin(half * w))
        else:
            value, slope = coefficients @ np.sin(half * w), coefficients @ (half * np.cos(half * w))
        if slope == 0:
            break
        w -= value / slope
    return float(w)


def filter_of(frequencies: list[float]) -> list[float]:
    """The coefficients A_1 to A_p of the filter with these frequencies."""
    order = len(frequencies)
    plus = np.array([1.0, 1.0]) if order % 2 == 0 else np.array([1.0])
    minus = np.array([1.0, -1.0]) if order % 2 == 0 else np.array([1.0, 0.0, -1.0])
    for index, w in enumerate(frequencies):
        factor = np.array([1.0, -2 * np.cos(w), 1.0])
        if index % 2 == 0:
            plus = np.convolve(plus, factor)
        else:
            minus = np.convolve(minus, factor)
    return (-((plus + minus) / 2)[1 : order + 1]).tolist()


# All other models mix every number linearly.
MIXES = {
    "org.htex.ar": mix_ar,
    "org.htex.arma": mix_arma,
    "org.htex.map": mix_maps,
    "org.htex.mfcc": mix_mfcc,
    "org.htex.speak": mix_speak,
    "org.htex.bands": mix_bands,
}
