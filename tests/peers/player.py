"""A player written from spec/htex-1.md alone, with NumPy and SciPy: decodes assets, mixes parameters
between conditions, and computes magnitudes. Compares them with the numbers beside the assets.

Argument: the folder of assets and numbers. Exit status 1 and a line a difference where they differ by more
than 1e-8 of a number, and for MFCC by 2e-8 of the largest magnitude (-154 dB) besides.
"""

import itertools
import json
import pathlib
import struct
import sys
import zipfile

import numpy as np
from scipy import fft, optimize, spatial, special

TOLERANCE = 1e-8
# The pseudo-inverse gives powers that are 0 up to rounding, about 1e-16 of the largest and different on each processor;
# a magnitude is the root of a power.
ROUNDING = {"org.htex.mfcc": 2e-8}


# Container, manifest, blocks (sections 1 to 4).


def read_length(data, at):
    first = data[at]
    if first <= 250:
        return first, at + 1
    size = {0xFB: 2, 0xFC: 4, 0xFD: 8}[first]
    return int.from_bytes(data[at + 1 : at + 1 + size], "little"), at + 1 + size


def read_packed(count, data, at):
    """The steps of a packed list: differences in Rice's code."""
    bits = "".join(f"{byte:08b}" for byte in data[at:])
    k, q, place = int(bits[:3], 2), [int(bits[3:11], 2)], 11
    while len(q) < count:
        ones = bits.index("0", place) - place
        place += ones + 1
        z = (ones << k) + int(bits[place : place + k] or "0", 2)
        place += k
        q.append(q[-1] + (z // 2 if z % 2 == 0 else -(z + 1) // 2))
    return q, at + -(-place // 8)


def read_numbers(store, count, data, at):
    steps = None
    if isinstance(store, str):
        kind = store
    else:
        ((kind, steps),) = store.items()
    if kind == "packed":
        values, at = read_packed(count, data, at) if count else ([], at)
    else:
        code = {"f64": "d", "f32": "f", "u16": "H", "u8": "B"}[kind]
        values = struct.unpack_from(f"<{count}{code}", data, at)
        at += count * struct.calcsize(code)
    if steps:
        values = [steps.get("offset", 0.0) + steps["scale"] * q for q in values]
        if steps.get("log", False):
            values = [np.exp(x) for x in values]
    return np.array(values, float), at


def read_block(representation, data):
    """For each condition a dictionary of the fields by name."""
    at, sets = 0, []
    for _ in representation["at"]:
        fields = {}
        for field in representation["fields"]:
            count = 1
            if field.get("list", False):
                count, at = read_length(data, at)
            values, at = read_numbers(field.get("store", "f64"), count, data, at)
            fields[field["name"]] = values if field.get("list", False) else values[0]
        sets.append(fields)
    assert at == len(data), "bytes behind the last number"
    return sets


def flat(representation, fields):
    parts = []
    for field in representation["fields"]:
        value = fields[field["name"]]
        parts += [len(value), *value] if field.get("list", False) else [value]
    return parts


# Shapes (section 6).


class Band:
    def __init__(self, low, high):
        self.low, self.high = low, high
        first, last = int(np.ceil(low / 5 - 1e-9)), int(np.floor(high / 5 + 1e-9))
        self.grid = 5.0 * np.arange(first, last + 1)

    def holds(self, f):
        return (f >= self.low) & (f <= self.high)

    def log_unit(self, f):
        return np.log(f / self.low) / np.log(self.high / self.low)


def rms(magnitude):
    return np.sqrt(np.sum(magnitude**2) / 3)


def normed(curve):
    """The magnitude of a curve: divided by its RMS on the grid, 0 outside the band."""

    def magnitude(parameters, band, f):
        m = np.zeros_like(f)
        inside = band.holds(f)
        m[inside] = curve(parameters, band, f[inside]) / rms(curve(parameters, band, band.grid))
        return m

    return magnitude


def on_the_grid(spectrum):
    """A curve that is given on the grid: straight between."""
    return lambda parameters, band, f: np.interp(f, band.grid, spectrum(parameters, band))


@normed
def ar(p, band, f):
    rate = p["model_rate_hz"]
    k = np.arange(1, len(p["coefficients"]) + 1)
    z = np.exp(-2j * np.pi * np.outer(f, k) / rate)
    h = 1 / np.abs(1 - z @ p["coefficients"])
    return np.where(f <= rate / 2, h, 0.0)


def mel_bank(count, band):
    mel = lambda f: 2595 * np.log10(1 + f / 700)
    points = np.linspace(mel(band.low), mel(band.high), count + 2)
    edges = 700 * (10 ** (points / 2595) - 1)
    edges[0], edges[-1] = band.low, band.high
    f = band.grid
    rise = (f - edges[:-2, None]) / np.diff(edges)[:-1, None]
    fall = (edges[2:, None] - f) / np.diff(edges)[1:, None]
    return edges, np.maximum(0, np.minimum(rise, fall))


def mfcc_spectrum(p, band):
    count, inverse = (int(np.floor(p[name] + 0.5)) for name in ("bands", "inverse"))
    padded = np.zeros(count)
    kept = p["cepstrum"][:count]
    padded[: len(kept)] = kept
    energy = np.exp(fft.idct(padded, type=2, norm="ortho"))
    edges, bank = mel_bank(count, band)
    if inverse == 0:
        largest = max(bank.shape) * 2.0**-52
        power = np.maximum(0, np.linalg.pinv(bank, rcond=largest) @ energy)
        # Rounding, of which a root would be taken.
        power[bank.sum(axis=0) == 0] = 0
    elif inverse == 1:
        scale = energy.max()
        ridge = np.vstack([bank, np.sqrt(1e-6) * np.eye(bank.shape[1])])
        target = np.concatenate([energy / scale, np.zeros(bank.shape[1])])
        solved = optimize.lsq_linear(ridge, target, (0, np.inf), method="bvls", tol=1e-16)
        power = scale * np.maximum(0, solved.x)
    else:
        sums = bank.sum(axis=1)
        held = sums > 0
        power = np.interp(band.grid, edges[1:-1][held], energy[held] / sums[held])
    return np.sqrt(power)


mfcc = normed(on_the_grid(mfcc_spectrum))


def speak(p, band, f):
    lines, a = p["frequency_hz"], p["amplitude"]
    played = band.holds(lines)
    lines, a = lines[played], a[played]
    d = np.abs(np.subtract.outer(f, lines)) / 5
    with np.errstate(divide="ignore", invalid="ignore"):
        lobe = np.sinc(d) / (1 - d**2)
    lobe = np.where(np.abs(d - 1) < 1e-7, 0.5, lobe)
    lobe = np.where(d >= 2, 0.0, lobe)
    m = np.sqrt(((a * lobe) ** 2).sum(axis=1)) / np.sqrt((a**2 * read_part(lines, band)).sum() / 2)
    return np.where(band.holds(f), m, 0.0)


def read_part(lines, band):
    """The part of each line's power that the band's bins read."""
    d = np.subtract.outer(lines, band.grid) / 5
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.sinc(d) / (1 - d**2)
    height = np.where(np.abs(np.abs(d) - 1) < 1e-7, 0.5, height)
    near = np.abs(np.subtract.outer(np.round(lines / 5), np.round(band.grid / 5))) <= 4
    part = (np.where(near, height, 0.0) ** 2).sum(axis=1) / 1.5
    inside = (lines >= band.grid[0] + 20) & (lines <= band.grid[-1] - 20)
    return np.where(inside, 1.0, part)


@normed
def sbeta(p, band, f):
    alpha, beta = p["alpha"], p["beta"]
    low = band.low + (1.25 if alpha < 1 else 0)
    high = band.high - (1.25 if beta < 1 else 0)
    u = band.log_unit(np.clip(f, low, high))
    return np.exp(
        special.xlogy(alpha - 1, u) + special.xlog1py(beta - 1, -u) - special.betaln(alpha, beta)
    )


@normed
def sslope(p, band, f):
    x = f / p["peak_hz"]
    high_pass, low_pass = p["order_high_pass"], p["order_low_pass"]
    return 1 / np.sqrt((1 + x ** (-2 * high_pass)) * (1 + x ** (2 * low_pass)))


@normed
def bands(p, band, f):
    q = p["below_highest"]
    n = len(q)
    if p["layout"] < 0.5:
        x = (n + 1) * band.log_unit(f)
    else:
        x = 1 + (n - 1) * np.log((f + 20) / (band.low + 20)) / np.log((band.high + 20) / (band.low + 20))
    return 10 ** (-p["step_db"] * np.interp(x, np.arange(1, n + 1), q) / 20)


# Between conditions (section 11).


def place(x, known, scale):
    """Position of a value on an axis: of a group of the same values, the middle of its ends."""
    for low, high in known:
        if low <= x <= high:
            return (low + high) / 2 / scale
    below = [g for g in known if g[1] < x]
    above = [g for g in known if g[0] > x]
    if not below:
        return place(above[0][0], known, scale) - (above[0][0] - x) / scale
    if not above:
        return place(below[-1][1], known, scale) + (x - below[-1][1]) / scale
    a, b = below[-1][1], above[0][0]
    from_, to = place(a, known, scale), place(b, known, scale)
    return from_ + (x - a) / (b - a) * (to - from_)


def value(at, x, known, scale):
    """The value with a position that is nearest to x, none beyond the known ones."""
    middles = [(low + high) / 2 / scale for low, high in known]
    for (low, high), middle in zip(known, middles):
        if abs(at - middle) <= 1e-9:
            return min(max(x, low), high)
    if at < middles[0]:
        return known[0][0]
    if at > middles[-1]:
        return known[-1][1]
    i = max(k for k, middle in enumerate(middles) if middle < at)
    part = (at - middles[i]) / (middles[i + 1] - middles[i])
    return known[i][1] + part * (known[i + 1][0] - known[i][1])


def grouped(values):
    """Ends of the groups of values that are the same within 5 %."""
    groups = []
    for x in sorted(values):
        if groups and x - groups[-1][0] <= 0.05 * x:
            groups[-1] = (groups[-1][0], x)
        else:
            groups.append((x, x))
    return groups


def turn(points, a, b, c):
    """Twice the area of a triangle, positive counterclockwise."""
    (ux, uy), (vx, vy) = points[b] - points[a], points[c] - points[a]
    return ux * vy - uy * vx


def on_a_circle(points, edge, c, d):
    """Whether the angles at c and d opposite an edge sum to half a turn."""

    def angle(at):
        u, v = (points[i] - points[at] for i in edge)
        return np.arctan2(abs(u[0] * v[1] - u[1] * v[0]), u @ v)

    return abs(angle(c) + angle(d) - np.pi) <= 1e-9


def triangulated(points):
    """Delaunay's triangles; those of points on one circle are a fan from the first of them."""
    mesh = spatial.Delaunay(points)
    triangles = [frozenset(map(int, t)) for t in mesh.simplices if abs(turn(points, *t)) > 1e-12]
    cells = {t: {t} for t in triangles}
    for t, other in itertools.combinations(triangles, 2):
        edge = sorted(t & other)
        if len(edge) == 2 and on_a_circle(points, edge, *(t - other), *(other - t)):
            joined = cells[t] | cells[other]
            cells.update((member, joined) for member in joined)
    fans = []
    for cell in set(map(frozenset, cells.values())):
        corners = sorted(frozenset().union(*cell), key=lambda i: tuple(points[i]))
        middle = points[corners].mean(axis=0)
        around = sorted(corners[1:], key=lambda i: np.arctan2(*(points[i] - middle)[::-1]))
        # Counterclockwise from the first.
        start = np.arctan2(*(points[corners[0]] - middle)[::-1])
        first = sum(np.arctan2(*(points[i] - middle)[::-1]) < start for i in around)
        around = around[first:] + around[:first]
        fans += [(corners[0], b, c) for b, c in zip(around, around[1:])]
    return fans, mesh.convex_hull


def outer_edges(triangles):
    """Edges of one triangle only."""
    edges = [frozenset(edge) for t in triangles for edge in itertools.combinations(t, 2)]
    return [tuple(sorted(edge)) for edge in edges if edges.count(edge) == 1]


def weights_at(conditions, motion, stored):
    """Pairs of condition and weight, ascending by position, and the nearest known motion."""
    points = np.array([[c.get("speed_mm_s", 0.0), c.get("force_n", 0.0)] for c in conditions])
    scale = np.abs(points).max(axis=0)
    scale[scale == 0] = 1
    if stored:
        nearest = lambda at: list(at * scale)
        meshed = stored, outer_edges(stored)
        return weights_in(points / scale, np.array(motion) / scale, meshed, motion, nearest)
    axes = [grouped(points[:, axis]) for axis in (0, 1)]
    placed = lambda point: [place(point[axis], axes[axis], scale[axis]) for axis in (0, 1)]
    nearest = lambda at: [value(at[axis], motion[axis], axes[axis], scale[axis]) for axis in (0, 1)]
    points, q = np.array([placed(point) for point in points]), np.array(placed(motion))
    meshed = [], [(0, 0)]
    if len(points) > 2:
        meshed = triangulated(points)
    elif len(points) == 2:
        meshed = [], [(0, 1)]
    return weights_in(points, q, meshed, motion, nearest)


def weights_in(points, q, meshed, motion, nearest):
    """The mix at a position among triangles and the edges around them, and the nearest known motion."""
    triangles, edges = meshed
    ascending = lambda mixed: sorted(
        ((int(i), w) for i, w in mixed if w > 1e-12), key=lambda part: tuple(points[part[0]])
    )
    for corners in triangles:
        a, b, c = points[list(corners)]
        w = np.linalg.solve(np.column_stack([b - a, c - a]), q - a)
        w = np.array([1 - w.sum(), *w])
        if (w >= -1e-12).all():
            return ascending(zip(corners, w)), list(motion)
    best = (np.inf, None, None)
    for i, j in edges:
        along = points[j] - points[i]
        t = np.clip(np.dot(q - points[i], along) / max(np.dot(along, along), 1e-300), 0, 1)
        foot = points[i] + t * along
        away = np.linalg.norm(foot - q)
        if away < best[0]:
            best = (away, [(i, 1 - t), (j, t)], foot)
    return ascending(best[1]), nearest(best[2])


# The law outside the conditions (sections 2 and 11).

ASSUMED = {"tool": (0, 0.43, 0.07), "unknown": (0, 0.75, 0.5)}
OF_A_FINGER = {"velocity": (1, 1, 1), "acceleration": (1, 2, 1)}


def exponents(manifest):
    """The exponents a, b and c that are stated, else assumed."""
    if "law" in manifest:
        keys = ("frequency_speed", "level_speed", "level_force")
        return [manifest["law"][key]["exponent"] for key in keys]
    finger = OF_A_FINGER.get(manifest["quantity"], (1, 0, 1))
    return ASSUMED.get(manifest.get("contact", "unknown"), finger)


def factors(manifest, conditions, motion, nearest):
    """Factors of frequencies and of the level."""
    ratios = []
    for key, asked, known in zip(("speed_mm_s", "force_n"), motion, nearest):
        stated = all(key in c for c in conditions) and any(c[key] > 0 for c in conditions)
        ratios.append(asked / known if stated and known > 0 else 1.0)
    (a, b, c), (speed, force) = exponents(manifest), ratios
    speed = min(max(speed, 1 / 16), 8)
    return min(max(speed**a, 1 / 16), 8), speed**b * force**c


def linear(sets, weights):
    return {name: sum(w * s[name] for w, s in zip(weights, sets)) for name in sets[0]}


def line_spectral_frequencies(coefficients, order):
    a = np.zeros(order + 2)
    a[0] = 1
    a[1 : len(coefficients) + 1] = -coefficients
    angles = []
    for polynomial in (a + a[::-1], a - a[::-1]):
        angle = np.angle(np.roots(polynomial))
        angles += [w for w in angle if 1e-9 < w < np.pi - 1e-9]
    return np.sort(angles)


def coefficients_of(lines):
    order = len(lines)
    symmetric, antisymmetric = np.poly1d([1.0]), np.poly1d([1.0])
    for i, w in enumerate(lines):
        factor = np.poly1d([1, -2 * np.cos(w), 1])
        if i % 2 == 0:
            symmetric *= factor
        else:
            antisymmetric *= factor
    if order % 2 == 0:
        symmetric, antisymmetric = symmetric * np.poly1d([1, 1]), antisymmetric * np.poly1d([1, -1])
    else:
        antisymmetric *= np.poly1d([1, 0, -1])
    a = 0.5 * (symmetric.coeffs + antisymmetric.coeffs)
    return -a[1 : order + 1]


def mix_ar(sets, weights):
    order = max(len(s["coefficients"]) for s in sets)
    lines = [line_spectral_frequencies(s["coefficients"], order) for s in sets]
    mixed = sum(w * x for w, x in zip(weights, lines))
    return {"coefficients": coefficients_of(mixed), "model_rate_hz": sets[0]["model_rate_hz"]}


def mix_mfcc(sets, weights):
    longest = max(len(s["cepstrum"]) for s in sets)
    padded = [{**s, "cepstrum": np.pad(s["cepstrum"], (0, longest - len(s["cepstrum"])))} for s in sets]
    return linear(padded, weights)


def mix_speak(sets, weights):
    if len({len(s["frequency_hz"]) for s in sets}) == 1:
        return linear(sets, weights)
    return {
        "frequency_hz": np.concatenate([s["frequency_hz"] for s in sets]),
        "amplitude": np.concatenate([np.sqrt(w) * s["amplitude"] for w, s in zip(weights, sets)]),
        "random_phase": sets[0]["random_phase"],
    }


MODELS = {
    "org.htex.ar": (ar, mix_ar),
    "org.htex.mfcc": (mfcc, mix_mfcc),
    "org.htex.speak": (speak, mix_speak),
    "org.htex.sbeta": (sbeta, linear),
    "org.htex.sslope": (sslope, linear),
    "org.htex.bands": (bands, linear),
}


# The comparison.


def differ(what, mine, theirs, findings, rounding=0.0):
    mine, theirs = np.atleast_1d(mine).astype(float), np.atleast_1d(theirs).astype(float)
    if mine.shape != theirs.shape:
        findings.append(f"{what}: {len(mine)} numbers, {len(theirs)} expected")
        return 0.0
    # Where a spectrum is nearly 0, relative to its largest value.
    largest = np.abs(theirs).max()
    scale = np.maximum(np.abs(theirs), 1e-6 * largest)
    off = np.maximum(np.abs(mine - theirs) - rounding * largest, 0) / np.where(scale > 0, scale, 1)
    if not off.max() <= TOLERANCE:
        i = int(off.argmax())
        findings.append(f"{what}: number {i} is {mine[i]!r}, {theirs[i]!r} expected ({off[i]:.1e})")
    return off.max()


def check(path, findings):
    """Cases of a file, and the largest difference of a magnitude by model."""
    told = json.loads(path.read_text())
    with zipfile.ZipFile(path.with_name(told["asset"])) as archive:
        manifest = json.loads(archive.read("manifest.json"))
        blocks = {r["model"]: archive.read(r["parameters"]) for r in manifest["representations"]}
    band = Band(manifest["band"]["low_hz"], manifest["band"]["high_hz"])
    frequency = np.array(told["frequency_hz"])
    worst = {}
    for case in told["cases"]:
        representation = next(r for r in manifest["representations"] if r["model"] == case["model"])
        sets = read_block(representation, blocks[case["model"]])
        at = representation["at"]
        conditions = [manifest["conditions"][a["condition"]] for a in at]
        motion = (case["speed_mm_s"], case["force_n"])
        mixed, nearest = weights_at(conditions, motion, representation.get("triangles"))
        ratio, gain = factors(manifest, conditions, motion, nearest)
        level = sum(w * at[i]["level_rms"] for i, w in mixed)
        most = 4 * max(a["level_rms"] for a in at)
        level = max(level, min(level * gain, most)) if gain > 1 else level * gain
        magnitude, mix = MODELS[case["model"]]
        chosen = [sets[i] for i, _ in mixed]
        parameters = chosen[0] if len(chosen) == 1 else mix(chosen, [w for _, w in mixed])
        what = f"{path.stem} {case['model']} at {case['speed_mm_s']} mm/s, {case['force_n']} N"
        differ(f"{what}, parameters", flat(representation, parameters), case["parameters"], findings)
        differ(f"{what}, level", level, case["level_rms"], findings)
        differ(f"{what}, factor", ratio, case["frequency_factor"], findings)
        m = level * magnitude(parameters, band, frequency / ratio)
        if case["model"] != "org.htex.speak":
            m = m / np.sqrt(ratio)
        rounding = ROUNDING.get(case["model"], 0.0)
        off = differ(f"{what}, magnitude", m, case["magnitude"], findings, rounding)
        worst[case["model"]] = max(worst.get(case["model"], 0.0), off)
    return len(told["cases"]), worst


def main(folder):
    findings, count, worst = [], 0, {}
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        cases, off = check(path, findings)
        count += cases
        for model, x in off.items():
            worst[model] = max(worst.get(model, 0.0), x)
    for model, x in sorted(worst.items()):
        print(f"{model}: magnitudes within {x:.1e}")
    print(f"{count} cases, {len(findings)} differences")
    sys.stderr.writelines(line + "\n" for line in findings)
    return 1 if findings or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
