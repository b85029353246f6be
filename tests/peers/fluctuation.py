"""How well measures see damage in time that leaves the spectrum as it was, and what the fluctuation
of an asset adds to a texture.

    python tests/peers/fluctuation.py FOLDER --htex htex
    python tests/peers/fluctuation.py FOLDER --htex htex --halves

FOLDER contains recordings of several takes of each material, NAME_0.wav, NAME_1.wav, ... as in
dexrob/BioTac_slide_20_50, which may not be passed on. The script compares takes of one material
with `htex compare`. It then damages the second take in time, restores its third octaves, and
compares again. For each measure, it prints how often a damaged take differs more than an undamaged
one (the area under the ROC curve: 0.5 is chance, 1 is always).

With --halves, FOLDER contains any recordings: NAME.wav, or NAME.csv of a free motion at 1 kHz as
`real.py` describes it. The script fits the first half of each, plays it as long as the second half,
with and without `--fluctuation`, and compares both with the second half: the modulation spectrum M
and the third octaves A, RMS, decibels. Of a free motion, the second half is first divided by the law
of the asset. The first half itself is compared too. A recording shorter than 2 s is left out.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import wave

import numpy as np

import real

PAIRS = 3
SEEDS = 4
SHORTEST_S = 2.0
EDGES = np.append(20 * 2 ** (np.arange(17) / 3), 1000)


def read(path):
    with wave.open(str(path)) as file:
        return np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(float), file.getframerate()


def write(path, samples, rate):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        # Samples are counts of a sensor, small enough for a fixed factor.
        file.writeframes(np.clip(np.round(samples), -32768, 32767).astype("<i2").tobytes())


def restored(samples, original, rate):
    """Return samples with the power of the original in each third octave."""
    spectrum, of = np.fft.rfft(samples), np.fft.rfft(original)
    hertz = np.fft.rfftfreq(len(samples), 1 / rate)
    for low, high in zip(EDGES, EDGES[1:]):
        band = (hertz >= low) & (hertz < high)
        power = [np.sum(np.abs(part[band]) ** 2) for part in (of, spectrum)]
        if min(power) > 0:
            spectrum[band] *= np.sqrt(power[0] / power[1])
    return np.fft.irfft(spectrum, len(samples))


def modulated(hz):
    return lambda x, rate, random: x * (1 + 0.5 * np.sin(2 * np.pi * (hz * np.arange(len(x)) / rate + random.random())))


def repeated(seconds):
    def damage(x, rate, random):
        size = round(seconds * rate)
        start = random.integers(len(x) - size)
        return np.resize(x[start : start + size], len(x))

    return damage


def clicks(x, rate, random):
    """Add four clicks a second of six standard deviations."""
    out = x.copy()
    places = random.integers(len(x), size=round(4 * len(x) / rate))
    out[places] += 6 * x.std() * random.choice([-1, 1], len(places))
    return out


DAMAGES = {
    "modulated by 50 % at 4 Hz": modulated(4),
    "modulated by 50 % at 16 Hz": modulated(16),
    "0.5 s repeated": repeated(0.5),
    "0.2 s repeated": repeated(0.2),
    "clicks": clicks,
}


def compare(htex, first, second):
    words = [htex, "compare", first, second, "--quantity", "acceleration", "--json"]
    other = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)["other"]
    fluctuation = other["fluctuation"]
    kurtosis = fluctuation["kurtosis"]
    return {
        "third octaves": other["third_octave_error_rms_db"],
        "modulation": fluctuation["fluctuation_error_db"],
        "kurtosis": abs(np.log(kurtosis[1] / kurtosis[0])),
    }


def auc(damaged, takes):
    return np.mean([(d > t) + 0.5 * (d == t) for d in damaged for t in takes])


def bands_of(samples, rate):
    """Return the power envelopes of the third octaves at a reduced rate, and that rate."""
    count = len(samples)
    reduced = min(count, -(-count * 2500 // int(rate)))
    spectrum = np.fft.rfft(samples - samples.mean())
    hertz = np.arange(len(spectrum)) * rate / count
    top = min(1000.0, 0.475 * rate)
    envelopes = []
    for low, high in zip(EDGES, EDGES[1:]):
        if low >= top:
            break
        inside = (hertz >= low) & (hertz < min(high, top))
        analytic = np.zeros(reduced, complex)
        places = np.flatnonzero(inside)
        analytic[places] = spectrum[places]
        envelopes.append(np.abs(np.fft.ifft(analytic)) ** 2)
    return np.array(envelopes), rate * reduced / count


def modulation(samples, rate):
    """The modulation spectrum M, decibels; octaves without a bin are not a number."""
    envelopes, rate = bands_of(samples, rate)
    envelopes /= envelopes.mean(axis=1, keepdims=True)
    count = envelopes.shape[1]
    window = np.hanning(count + 1)[:-1]
    hertz = np.fft.rfftfreq(count, 1 / rate)

    def octaves(envelope):
        power = np.abs(np.fft.rfft((envelope - envelope.mean()) * window)) ** 2 / (rate * np.sum(window**2))
        inside = [(hertz >= 2.0**k) & (hertz < 2.0 ** (k + 1)) for k in range(6)]
        return np.array([power[bins].mean() if bins.any() else np.nan for bins in inside])

    own = np.mean([octaves(envelope) for envelope in envelopes], axis=0)
    return 10 * np.log10(np.append(octaves(envelopes.mean(axis=0)), own) + 1e-12)


def thirds(samples, rate):
    """The powers of the third octaves, decibels."""
    envelopes, _ = bands_of(samples, rate)
    return 10 * np.log10(envelopes.mean(axis=1) * (len(samples) / envelopes.shape[1]) ** -2)


def differences(played, recorded, rate):
    rms = [np.sqrt(np.nanmean((of(played, rate) - of(recorded, rate)) ** 2)) for of in (modulation, thirds)]
    return np.array(rms)


def halves(path):
    """Return the halves of a recording as lists of columns, the lateral signal first, and the rate."""
    if path.suffix == ".wav":
        samples, rate = real.read_wav(path)
        columns = [samples / (2 * np.abs(samples).max())]
    else:
        table = np.genfromtxt(path, delimiter=",", names=True)
        columns, rate = [table["friction"] * table["force"], table["speed"], table["force"]], 1000
    half = len(columns[0]) // 2
    return [[column[k * half : (k + 1) * half] for column in columns] for k in (0, 1)], rate


def without_law(columns, law, rate):
    """Return the signal divided by the level that the law gives it as speed and force change."""
    if len(columns) == 1:
        return columns[0]
    signal = columns[0].copy()
    size = round(0.2 * rate) + 1
    for column, key in zip(columns[1:], ("level_speed", "level_force")):
        smooth = np.convolve(column, np.ones(size), "same") / np.convolve(np.ones(len(column)), np.ones(size), "same")
        signal /= (smooth / column.mean()) ** law[key]["exponent"]
    return signal


def heldout(htex, place, path, model):
    """Return the strength, and M and A of the first half, the stationary and the fluctuating voice."""
    (first, second), rate = halves(path)
    recording, asset, played = place / "first.csv", place / "first.htex", place / "played.wav"
    words = ["--quantity", "acceleration"]
    if len(first) == 1:
        recording = recording.with_suffix(".wav")
        real.write_wav(recording, first[0], rate)
    else:
        words = ["--quantity", "lateral_force"]
        times = np.arange(len(first[0])) / rate
        names = "time_s,lateral_n,speed_mm_s,normal_n"
        np.savetxt(recording, np.column_stack([times, *first]), delimiter=",", header=names, comments="")
    run = lambda *words: subprocess.run([htex, *map(str, words)], check=True, capture_output=True).stdout
    run("fit", recording, *words, "--model", model, "-o", asset)
    info = json.loads(run("info", asset, "--json"))
    fluctuation = info["manifest"].get("fluctuation", {"slow": 0, "fast": 0})
    target = without_law(second, info["law"], rate)
    seconds, found = len(target) / rate, []
    for flag in ([], ["--fluctuation"]):
        tries = []
        for seed in range(SEEDS):
            run("synth", asset, *flag, "--rate", max(rate, 2000), "--seconds", seconds, "--seed", seed, "-o", played)
            samples, played_rate = real.read_wav(played)
            if played_rate != rate:
                samples = real.signal.resample(samples, len(target))
            tries.append(differences(samples[: len(target)], target, rate))
        found.append(np.mean(tries, axis=0))
    strength = [fluctuation[key] / 32 for key in ("slow", "fast")]
    return strength, [differences(without_law(first, info["law"], rate), target, rate), *found]


def print_halves(chosen):
    paths = sorted(p for p in chosen.folder.iterdir() if p.suffix in (".wav", ".csv"))
    print("| recording | slow, fast (dB) | first half M, A | stationary M, A | fluctuating M, A |")
    print("|---|---|---|---|---|")
    rows = []
    with tempfile.TemporaryDirectory() as place:
        for path in paths:
            (first, second), rate = halves(path)
            if len(first[0]) + len(second[0]) < SHORTEST_S * rate:
                continue
            strength, found = heldout(chosen.htex, pathlib.Path(place), path, chosen.model)
            rows.append(found)
            cells = " | ".join(f"{m:.1f}, {a:.1f}" for m, a in found)
            print(f"| {path.stem} | {strength[0]:.2f}, {strength[1]:.2f} | {cells} |", flush=True)
    print("| mean of all | | " + " | ".join(f"{m:.2f}, {a:.2f}" for m, a in np.mean(rows, axis=0)) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--htex", default="htex", help="the command [default: htex]")
    parser.add_argument("--halves", action="store_true", help="compare what plays with the other half")
    parser.add_argument("--model", default="bands", help="the model that plays [default: bands]")
    chosen = parser.parse_args()
    if chosen.halves:
        print_halves(chosen)
        return 0
    random = np.random.default_rng(1)
    found = {name: [] for name in ("takes", *DAMAGES)}
    with tempfile.TemporaryDirectory() as place:
        file = pathlib.Path(place) / "damaged.wav"
        for first in sorted(chosen.folder.glob("*_0.wav")):
            material = first.stem.removesuffix("_0")
            for i in range(PAIRS):
                pair = [chosen.folder / f"{material}_{k}.wav" for k in (i, i + 1)]
                found["takes"].append(compare(chosen.htex, *pair))
                samples, rate = read(pair[1])
                samples = samples - samples.mean()
                for name, damage in DAMAGES.items():
                    write(file, restored(damage(samples, rate, random), samples, rate), rate)
                    found[name].append(compare(chosen.htex, pair[0], file))
    measures = list(found["takes"][0])
    print("| damage | " + " | ".join(measures) + " |\n|---" * 1 + "|---" * len(measures) + "|")
    for name in DAMAGES:
        areas = [auc([one[m] for one in found[name]], [one[m] for one in found["takes"]]) for m in measures]
        print(f"| {name} | " + " | ".join(f"{area:.2f}" for area in areas) + " |")
    quantiles = [np.quantile([one[m] for one in found["takes"]], 0.95) for m in measures]
    print("95 % of takes differ by at most: " + ", ".join(f"{m} {q:.2f}" for m, q in zip(measures, quantiles)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
