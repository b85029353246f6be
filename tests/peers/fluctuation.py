"""How well measures see damage in time that leaves the spectrum as it was.

    python tests/peers/fluctuation.py FOLDER --htex htex

FOLDER contains recordings of several takes of each material, NAME_0.wav, NAME_1.wav, ... as in
dexrob/BioTac_slide_20_50, which may not be passed on. The script compares takes of one material
with `htex compare`. It then damages the second take in time, restores its third octaves, and
compares again. For each measure, it prints how often a damaged take differs more than an undamaged
one (the area under the ROC curve: 0.5 is chance, 1 is always).
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import wave

import numpy as np

PAIRS = 3
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--htex", default="htex", help="the command [default: htex]")
    chosen = parser.parse_args()
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
