"""Writes tests/golden/arma.json with SciPy: python tests/peers/arma.py > tests/golden/arma.json.

The line spectral frequencies are root angles of the symmetric and the antisymmetric polynomial. The
magnitudes come from `scipy.signal.freqz`, and the samples from `scipy.signal.lfilter`.
"""

import json

import numpy as np
from scipy.signal import freqz, lfilter

GRID = np.arange(20.0, 501.0, 5.0)
RATE = 1000.0
#: Radius and angle, in half turns, of poles and zeros; those of angles inside (0, 1) have a conjugate.
FILTERS = {
    "two_pairs": ([(0.95, 0.1), (0.8, 0.55)], [(0.9, 0.3)]),
    "odd_orders": ([(0.9, 0.0), (0.92, 0.2), (0.7, 0.7)], [(0.99998, 1.0), (0.6, 0.4)]),
    "no_zeros": ([(0.98, 0.33)], []),
    "no_poles": ([], [(0.97, 0.25), (0.5, 0.0)]),
    "like_the_toolkit": (
        [(0.94, 0.04), (0.9, 0.15), (0.85, 0.3), (0.8, 0.45), (0.8, 0.6), (0.7, 0.75), (0.6, 0.9)],
        [(0.99999, 1.0), (0.93, 0.1), (0.97, 0.22), (0.7, 0.5), (0.6, 0.8)],
    ),
}


def polynomial(roots):
    out = np.array([1.0])
    for radius, angle in roots:
        w = np.pi * angle
        real = angle in (0.0, 1.0)
        out = np.convolve(out, [1.0, -radius * np.cos(w)] if real else [1.0, -2 * radius * np.cos(w), radius**2])
    return out


def lines(a):
    whole = np.append(a, 0.0)
    angles = np.concatenate([np.angle(np.roots(whole + whole[::-1])), np.angle(np.roots(whole - whole[::-1]))])
    return np.sort(angles[(angles > 1e-9) & (angles < np.pi - 1e-9)])


def case(name, poles, zeros):
    a, b = polynomial(poles), polynomial(zeros)
    _, h = freqz(b, a, worN=2 * np.pi * GRID / RATE)
    shape = np.abs(h) / np.sqrt(np.sum(np.abs(h) ** 2) / 3)
    x = np.sin(0.37 * np.arange(48) ** 1.3)
    return {
        "name": name,
        "input": {
            "a": a[1:].tolist(),
            "b": b[1:].tolist(),
            "pole_lines": lines(a).tolist(),
            "zero_lines": lines(b).tolist(),
            "rate_hz": RATE,
            "x": x.tolist(),
        },
        "expected": {"magnitude": shape.tolist(), "y": lfilter(b, a, x).tolist()},
        "rtol": 1e-7,
        "atol": 1e-9,
        "by": "tests/peers/arma.py: scipy.signal.freqz and lfilter, lines by numpy.roots",
    }


if __name__ == "__main__":
    cases = [case(name, *filter) for name, filter in FILTERS.items()]
    rule = "|got-exp| <= atol + rtol*|exp|, elementwise"
    print(json.dumps({"file": "arma", "rule": rule, "cases": cases}, indent=1))
