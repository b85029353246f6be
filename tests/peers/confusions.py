"""Compares measures of difference with people who told materials apart, using only NumPy, SciPy and
the command as its users run it.

    python tests/peers/confusions.py FOLDER [--htex COMMAND] [--levelled rms|peak|not]

FOLDER contains four sounds of each of five materials from LMT-108, NAME1.wav to NAME4.wav
(shinolab/vibrotactile-autoencoder, history, f3dc99a2). 18 people felt them on a vibrating display
and said which material it was, 630 times (`CONFUSIONS`). How the sounds were levelled is
not known: each is set to one RMS between 20 and 1000 Hz, or to one peak, or is left as it is. `htex compare` measures each pair of sounds from two
materials; the distance of the materials is the mean over the 16 pairs. The script prints Spearman's
correlation, over the ten pairs of materials, between that distance and how seldom people took one
material for the other. The interval contains 95 % of 1,000 draws of sounds and trials.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import wave

import numpy as np
from scipy import signal, stats

MATERIALS = ["stone", "ceramic", "cherry", "grass", "paper"]
SOUNDS = range(4)
# Rows are what was felt, columns what was answered.
CONFUSIONS = np.array(
    [[60, 2, 29, 7, 28], [1, 124, 1, 0, 0], [25, 1, 96, 2, 2], [8, 0, 6, 91, 21], [11, 0, 7, 22, 86]]
)
PAIRS = [(i, j) for i in range(5) for j in range(i)]
# Keys of `htex compare --json`, whose values are larger the more two sounds differ.
MEASURES = [
    "felt.sensation_error_rms",
    "felt.total_error_db",
    "felt.error_rms_db",
    "log_spectral_distance_db",
    "third_octave_error_rms_db",
    "band_error_rms_db",
    "spectral_correlation",
]
DRAWS = 1000


def levelled(path, to, by):
    """Write a sound at a tenth of its rate, between 20 and 1000 Hz and at one level."""
    with wave.open(str(path)) as file:
        rate, channels = file.getframerate(), file.getnchannels()
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2").reshape(-1, channels)[:, 0]
    band = signal.butter(4, [20, 1000], "bandpass", fs=rate, output="sos")
    samples = signal.resample_poly(signal.sosfiltfilt(band, samples), 1, 10)
    # As strong as 0.08 RMS, or a recorded full scale of 0.5.
    level = {"rms": 0.08 / np.sqrt(np.mean(samples**2)), "peak": 0.5 / np.abs(samples).max(), "not": 0.5 / 32768}
    samples = level[by] * samples
    with wave.open(str(to), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(round(rate / 10))
        file.writeframes(np.round(np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes())


def compared(command, folder, one, other, quantity):
    """Return the measures of two sounds."""
    arguments = ["compare", one, other, "--quantity", quantity, "--scale", "1", "--segments", "windows", "--json"]
    done = subprocess.run([command, *arguments], capture_output=True, text=True, cwd=folder)
    if done.returncode:
        raise SystemExit(f"htex {' '.join(arguments)}: {done.stderr}")
    found = json.loads(done.stdout)["other"]
    values = []
    for key in MEASURES:
        value = found
        for part in key.split("."):
            value = value[part]
        values.append(1 - value if key == "spectral_correlation" else abs(value))
    return values


def confused(counts):
    """Return how often each pair of materials was confused."""
    share = counts / counts.sum(axis=1, keepdims=True)
    return np.array([(share[i, j] + share[j, i]) / 2 for i, j in PAIRS])


def correlation(distances, chosen, counts):
    """Return Spearman's correlation of the chosen sounds' distances with how seldom the materials
    were confused.
    """
    means = [np.mean(distances[i, j][np.ix_(chosen[i], chosen[j])]) for i, j in PAIRS]
    return stats.spearmanr(means, -confused(counts)).statistic


def drawn(random):
    """Draw sounds and trials with replacement."""
    sounds = [random.integers(0, 4, 4) for _ in MATERIALS]
    counts = [random.multinomial(row.sum(), row / row.sum()) for row in CONFUSIONS]
    return sounds, np.array(counts, float)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--htex", default="htex", help="the command [default: htex]")
    parser.add_argument("--quantity", default="lateral_force", help="what the samples are taken for [default: lateral_force]")
    parser.add_argument("--levelled", choices=("rms", "peak", "not"), default="rms", help="how sounds are levelled [default: rms]")
    chosen = parser.parse_args()
    command = os.path.abspath(shutil.which(chosen.htex) or chosen.htex)
    distances = {key: {} for key in MEASURES}
    with tempfile.TemporaryDirectory() as place:
        name = lambda material, sound: f"{MATERIALS[material]}{sound + 1}.wav"
        for material in range(5):
            for sound in SOUNDS:
                levelled(chosen.folder / name(material, sound), pathlib.Path(place) / name(material, sound), chosen.levelled)
        for i, j in PAIRS:
            found = [[compared(command, place, name(i, k), name(j, m), chosen.quantity) for m in SOUNDS] for k in SOUNDS]
            for key, values in zip(MEASURES, np.moveaxis(np.array(found), 2, 0)):
                distances[key][i, j] = values
    random = np.random.default_rng(1)
    draws = [drawn(random) for _ in range(DRAWS)]
    print("| measure | Spearman's correlation | 95 % |\n|---|---|---|")
    for key in MEASURES:
        whole = correlation(distances[key], [SOUNDS] * 5, CONFUSIONS.astype(float))
        low, high = np.quantile([correlation(distances[key], *draw) for draw in draws], [0.025, 0.975])
        print(f"| `{key}` | {whole:.2f} | {low:.2f} to {high:.2f} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
