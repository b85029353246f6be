"""Computes what is felt of a difference, only from the definition in docs/felt.md and the module
`htex_dsp::vibrotactile`.

    python3 tests/peers/felt.py > tests/golden/felt.json

Here the skin is a complex impedance, the threshold a line in decibels over decades, and bands are
edges in hertz.
"""

import json
import math

HERTZ = [20.0 + 5.0 * k for k in range(197)]
EDGES = [20.0 * 2.0 ** (k / 3.0) for k in range(18)]


def threshold_db(hertz):
    """Detection threshold, dB re 1 um peak."""
    if hertz > 250.0:
        return -20.0 + 30.0 * math.log10(hertz / 250.0)
    return -20.0 + 40.0 * math.log10(250.0 / max(hertz, 40.0))


def skin(hertz, soft):
    """Displacement caused by 1 N, metres."""
    s = 2j * math.pi * hertz
    return soft / abs(1000.0 + 1.5 * s + 0.00015 * s * s)


def levels_db(magnitude, shift_db, soft):
    energy = [0.0] * 17
    for hertz, newtons in zip(HERTZ, magnitude):
        micrometres = 1e6 * newtons * skin(hertz, soft)
        above_db = 20.0 * math.log10(micrometres) - threshold_db(hertz) - shift_db
        band = max(k for k in range(17) if EDGES[k] <= hertz * (1 + 1e-12))
        energy[band] += 10.0 ** (above_db / 10.0) / 1.5
    total = 10.0 * math.log10(sum(energy))
    return [10.0 * math.log10(e) for e in energy], total


def felt(recorded, other, shift_db=0.0, soft=1.0):
    ours, our_total = levels_db(recorded, shift_db, soft)
    theirs, their_total = levels_db(other, shift_db, soft)
    error = [max(t, 0.0) - max(o, 0.0) for o, t in zip(ours, theirs)]
    heard = [e for e, o, t in zip(error, ours, theirs) if o > 0.0 or t > 0.0]
    total = max(their_total, 0.0) - max(our_total, 0.0)
    largest = max(abs(e) for e in error)
    return {
        "error_db": error,
        "error_rms_db": math.sqrt(sum(e * e for e in heard) / len(heard)) if heard else 0.0,
        "largest_error_db": largest,
        "total_error_db": total,
        "below": largest < 1.584 and abs(total) < 1.584,
    }


def case(name, recorded, other):
    return {
        "name": name,
        "recorded": [recorded(f) for f in HERTZ],
        "other": [other(f) for f in HERTZ],
        "typical": felt([recorded(f) for f in HERTZ], [other(f) for f in HERTZ]),
        "sensitive": felt([recorded(f) for f in HERTZ], [other(f) for f in HERTZ], -10.0, 2.0),
    }


def slope(f):
    return 2e-3 / (1.0 + f / 60.0)


CASES = [
    case("a slope, 1 dB louder", slope, lambda f: slope(f) * 10 ** 0.05),
    case("a slope, 2 dB louder above 300 Hz", slope, lambda f: slope(f) * (1.0 if f < 300 else 10 ** 0.1)),
    case("a difference near the threshold", lambda f: 6e-5, lambda f: 8e-5),
    case("below the threshold of a typical person", lambda f: 2e-5 / (1 + f / 100), lambda f: 3e-5 / (1 + f / 100)),
    case("a line that is missing", lambda f: slope(f) + (0.01 if f == 250 else 0), slope),
]
print(json.dumps({"frequency_hz": HERTZ, "cases": CASES}))
