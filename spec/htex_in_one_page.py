"""Reads and plays .htex files as htex-in-one-page.md says: 60 lines of code that need NumPy alone."""
import io, json, zipfile, numpy as np

TYPES = {"f64": "<f8", "f32": "<f4", "u16": "<u2", "u8": "u1", "packed": "u1"}


def read_asset(path, model):
    """Returns the manifest, the representation of the model, and its set of parameters at each condition."""
    with zipfile.ZipFile(path) as archive:  # Of an entry above 4 MiB the end is missing.
        manifest = json.loads(archive.open("manifest.json").read(2**22))
        if manifest["htex"][:2] != "1." or manifest.get("extensions_required"): raise ValueError("refused")
        found = next(one for one in manifest["representations"] if one["model"] == model)
        block = io.BytesIO(archive.open(found["parameters"]).read(2**22))
    return manifest, found, [{f["name"]: read_field(block, f) for f in found["fields"]} for _ in found["at"]]


def read_field(block, field):
    """Returns the numbers of a field at the next condition; a field that is no list has one."""
    store, count = field.get("store", "f64"), block.read(1)[0] if field.get("list") else 1
    if count > 250: count = int.from_bytes(block.read({251: 2, 252: 4}[count]), "little")
    kind, scale = (store, {}) if isinstance(store, str) else next(s for s in store.items() if s[0] in TYPES)
    number = np.dtype(TYPES[kind])
    data = unpack(block, count) if kind == "packed" and count else block.read(count * number.itemsize)
    numbers = scale.get("offset", 0) + scale.get("scale", 1) * np.frombuffer(data, number).astype(float)
    if len(numbers) != count or not np.isfinite(numbers).all(): raise ValueError("a number is missing")
    return np.exp(numbers) if scale.get("log") else numbers


def unpack(block, count):
    """Returns the steps of a packed list: k, the first step, then the differences."""
    bits = (byte >> place & 1 for byte in iter(lambda: block.read(1)[0], None) for place in range(7, -1, -1))
    integer = lambda size: sum(next(bits) << place for place in range(size - 1, -1, -1))
    k, steps = integer(3), [integer(8)]
    while len(steps) < count:
        z = (sum(iter(lambda: next(bits), 0)) << k) + integer(k)  # As many ones as there are before a zero.
        steps.append(steps[-1] + (-(z + 1) // 2 if z % 2 else z // 2))
    return bytes(steps)


# The curves of the models, in any scale, at frequencies from `low` to `high`.


def bands(f, low, high, below_highest, step_db, layout):
    count, shift = len(below_highest), 20 if layout >= 0.5 else 0
    part = np.log((f + shift) / (low + shift)) / np.log((high + shift) / (low + shift))
    knot = 1 + (count - 1) * part if shift else (count + 1) * part
    return 10 ** (-step_db / 20 * np.interp(knot, np.arange(1, count + 1), below_highest))


def sbeta(f, low, high, alpha, beta):
    u = np.log(np.clip(f, low + 1.25 * (alpha < 1), high - 1.25 * (beta < 1)) / low) / np.log(high / low)
    return u ** (alpha - 1) * (1 - u) ** (beta - 1)


def sslope(f, low, high, peak_hz, order_high_pass, order_low_pass):
    return ((1 + (peak_hz/f) ** (2 * order_high_pass)) * (1 + (f/peak_hz) ** (2 * order_low_pass))) ** -0.5


def ar(f, low, high, coefficients, model_rate_hz):
    turns = np.outer(f, np.arange(1, len(coefficients) + 1)) / model_rate_hz
    return (f <= model_rate_hz / 2) / abs(1 - np.exp(-2j * np.pi * turns) @ coefficients)


CURVES = {"org.htex.bands": bands, "org.htex.sbeta": sbeta, "org.htex.sslope": sslope, "org.htex.ar": ar}
EXPONENTS = "frequency_speed", "level_speed", "level_force"


def play(manifest, found, sets, speed, force):
    """Returns the factor of frequencies, the level, and a function: the magnitude at frequencies."""
    known = [manifest["conditions"][element["condition"]] for element in found["at"]]
    motions = np.array([[one.get("speed_mm_s", 0), one.get("force_n", 0)] for one in known])
    largest = np.where(motions.any(axis=0), motions.max(axis=0), np.inf)
    near = np.linalg.norm((motions - [speed, force]) / largest, axis=1).argmin()
    x, y = (n / o if o and abs(n / o - 1) > 1e-9 else 1 for n, o in zip((speed, force), motions[near]))
    b = {"velocity": 1, "acceleration": 2}.get(manifest["quantity"], 0)
    law = {"tool": (0, 0.43, 0.07), "finger": (1, b, 1)}.get(manifest.get("contact"), (0, 0.75, 0.5))
    if "law" in manifest: law = [manifest["law"][key]["exponent"] for key in EXPONENTS]
    factor = np.clip(np.clip(x, 1 / 16, 8) ** law[0], 1 / 16, 8)
    levels = [element["level_rms"] for element in found["at"]]
    level = min(levels[near] * np.clip(x, 1 / 16, 8) ** law[1] * y ** law[2], 4 * max(levels))
    low, high, curve = manifest["band"]["low_hz"], manifest["band"]["high_hz"], CURVES[found["model"]]
    shape = lambda f: (low <= f) * (f <= high) * curve(np.clip(f, low, high), low, high, **sets[near])
    rms = np.sqrt(sum(shape(5.0 * np.arange(np.ceil(low / 5), high // 5 + 1)) ** 2) / 3)
    return factor, level, lambda f: level / rms / np.sqrt(factor) * shape(f / factor)


def noise(magnitude, count, rate):
    """Returns samples of Gaussian noise that has a magnitude."""
    white = np.fft.rfft(np.random.default_rng().standard_normal(count))
    return np.fft.irfft(white * magnitude(np.fft.rfftfreq(count, 1 / rate)) * np.sqrt(rate / 30), count)
