"""Compares the laws of motion with third-party recordings, using only NumPy, SciPy and the command
as its users run it.

    python tests/peers/real.py FOLDER [--htex COMMAND]

FOLDER may contain any of:

    speeds/NAME_vN.wav   one stroke a file, at the speeds of `SPEEDS`, N from 1 (jennafradin/textsense, exploration_speed)
    hatt/Models_*.xml    models of the Penn Haptic Texture Toolkit (H. Culbertson, J. J. Lopez Delgado, K. J. Kuchenbecker 2014)
    free/*.csv           free motions of a finger at 1 kHz: speed (mm/s), force (N), friction (a coefficient) (CdpLab/MDTextHaptDisplay)

None of these files comes with htex, because their licences do not allow it. For each pair of known
and held-out recordings, the script fits an asset, renders 20 s at the held-out speed, and compares
the spectrum of the samples with the recording's spectrum: the level and the third octaves, next to
the result of playing the nearest recorded speed unchanged (`clamped`). For a free motion, it fits a
grid to one half in time. It compares what plays at the motions of the other half with what was
recorded there, next to the error that the asset states. Tables are printed in Markdown.
"""

import argparse
import itertools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import wave
import xml.etree.ElementTree as tree

import numpy as np
from scipy import signal

SPEEDS = [20.0, 30.0, 50.0, 60.0]
# The strokes have no force; one is stated, so that it changes nothing.
FORCE_N = 0.5
BAND_HZ = (60.0, 1000.0)
RENDERED_S = 20.0
FREE_RATE = 1000
# Windows of the other half are gathered within these ratios of speed and force, as many as these at least.
GATHERED = (1.19, 2.0)
FEWEST_WINDOWS = 4


def read_wav(path):
    """Return samples and rate of a one-channel WAV file with 16-bit integers or 32-bit floats."""
    data = pathlib.Path(path).read_bytes()
    kind = int.from_bytes(data[20:22], "little")
    if kind == 1:
        with wave.open(str(path)) as file:
            samples = np.frombuffer(file.readframes(file.getnframes()), "<i2")
            return samples / 32768.0, file.getframerate()
    rate, start = int.from_bytes(data[24:28], "little"), data.index(b"data") + 8
    return np.frombuffer(data[start:], "<f4").astype(float), rate


def write_wav(path, samples, rate):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(np.round(np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes())


def power(samples, rate):
    """Return frequencies, Hz, and mean squared magnitudes in 0.2 s windows that overlap by half."""
    size = round(rate / 5)
    window = np.hanning(size + 1)[:-1]
    parts = [samples[i : i + size] for i in range(0, len(samples) - size + 1, size // 2)]
    spectra = [np.abs(np.fft.rfft((part - part.mean()) * window)) ** 2 for part in parts]
    power = np.mean(spectra, axis=0) * (2 / window.sum()) ** 2
    return np.arange(len(power)) * rate / size, power


def within(frequency):
    return (frequency >= BAND_HZ[0]) & (frequency <= BAND_HZ[1])


def level_db(spectrum):
    frequency, of = spectrum
    return 10 * np.log10(of[within(frequency)].sum())


def third_octaves_db(a, b):
    """Return the RMS difference of two spectra in third octaves of 20 * 2^(k/3) Hz, dB."""
    edges = 20 * 2 ** (np.arange(18) / 3)
    errors = []
    for low, high in zip(edges, edges[1:]):
        sums = [of[(f >= low) & (f < high) & within(f)].sum() for f, of in (a, b)]
        if min(sums) > 0:
            errors.append(10 * np.log10(sums[0] / sums[1]))
    return float(np.sqrt(np.mean(np.square(errors))))


def with_level(spectrum, other):
    """Return a spectrum with the level of another."""
    frequency, of = spectrum
    return frequency, of * 10 ** ((level_db(other) - level_db(spectrum)) / 10)


class Htex:
    """The command, in its own folder."""

    def __init__(self, command, folder):
        self.command, self.folder = command, pathlib.Path(folder)

    def run(self, *arguments):
        done = subprocess.run([self.command, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder)
        if done.returncode:
            raise SystemExit(f"htex {' '.join(map(str, arguments))}: {done.stderr}")
        return done.stdout

    def fit(self, recordings, *options):
        """Make an asset from (file, speed, force)."""
        files = [file for file, *_ in recordings]
        at = [f"--at=speed={speed},force={force}" for _, speed, force in recordings]
        self.run("fit", *files, *at, "--model", "bands", "--name", "real", "-o", "real.htex", *options)
        return json.loads(self.run("info", "real.htex", "--json"))

    def play(self, speed, force):
        """Return the spectrum of what plays at a motion."""
        motion = ("--speed", speed, "--force", force)
        self.run("synth", "real.htex", "--model", "bands", *motion, "--seconds", RENDERED_S, "-o", "played.wav")
        return power(*read_wav(self.folder / "played.wav"))


class Strokes:
    """Strokes of one material at all speeds."""

    def __init__(self, name, files):
        self.name, self.files = name, files
        self.spectra = {speed: power(*read_wav(file)) for speed, file in files.items()}

    def held_out(self, htex, known, options=()):
        """Return the errors at each held-out speed."""
        law = htex.fit([(self.files[v], v, FORCE_N) for v in known], *options)["law"]
        for speed in sorted(set(self.files) - set(known)):
            truth, played = self.spectra[speed], htex.play(speed, FORCE_N)
            nearest = min(known, key=lambda v: abs(v - speed))
            outside = speed < min(known) or speed > max(known)
            clamped = self.spectra[nearest]
            yield {
                "material": self.name,
                "known": known,
                "at": speed,
                "outside": outside,
                "exponent": law["level_speed"]["exponent"],
                "level": level_db(played) - level_db(truth),
                "level_clamped": level_db(clamped) - level_db(truth),
                "third": third_octaves_db(played, truth),
                "third_clamped": third_octaves_db(clamped, truth),
                "floor": third_octaves_db(with_level(clamped, truth), truth),
            }


def strokes(folder):
    materials = {}
    for file in sorted(folder.glob("*_v*.wav")):
        name, number = re.fullmatch(r"(.+)_v(\d+)", file.stem).groups()
        materials.setdefault(name, {})[SPEEDS[int(number) - 1]] = file.resolve()
    return [Strokes(name, files) for name, files in materials.items()]


def smooth(values, rate):
    """Return the average over 50 ms, over fewer samples at the ends."""
    kernel = np.ones(2 * round(rate / 40) + 1)
    return np.convolve(values, kernel, "same") / np.convolve(np.ones(len(values)), kernel, "same")


def steady_windows(recording):
    """Return logarithms of speed and force, and the power, of each 0.2 s window in which both stay
    within 10 %.
    """
    speed, force, lateral = recording
    size, window = FREE_RATE // 5, np.hanning(FREE_RATE // 5 + 1)[:-1]
    averages = [smooth(values, FREE_RATE) for values in (speed, force)]
    for start in range(0, len(lateral) - size + 1, size // 2):
        part = slice(start, start + size)
        means = np.array([speed[part].mean(), force[part].mean()])
        if means[0] < 1 or means[1] <= 0:
            continue
        if all(np.abs(average[part] - mean).max() <= 0.1 * mean for average, mean in zip(averages, means)):
            spectrum = np.fft.rfft(signal.detrend(lateral[part]) * window)
            yield np.log(means), (2 / window.sum() * np.abs(spectrum)) ** 2


def gathered(recording):
    """Return mean speed and force, and the spectrum, of windows with about the same motion."""
    cells = {}
    for motion, of in steady_windows(recording):
        cells.setdefault(tuple(np.round(motion / np.log(GATHERED))), []).append((motion, of))
    for windows in cells.values():
        if len(windows) >= FEWEST_WINDOWS:
            motions, powers = zip(*windows)
            frequency = np.arange(len(powers[0])) * 5.0
            yield np.exp(np.mean(motions, axis=0)), (frequency, np.mean(powers, axis=0))


def rms(values):
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def free_half(htex, known, other):
    """Return the stated error of a grid for one half, and the errors at the other half's motions of
    the grid and of a single condition.
    """
    columns = dict(zip(("speed_mm_s", "fz_n", "lateral_n"), known))
    table = np.column_stack(list(columns.values()))
    np.savetxt(htex.folder / "half.csv", table, "%.6f", ",", header=",".join(columns), comments="")
    truths = list(gathered(other))
    row = {}
    for key, options in (("grid", ("--grid", "auto")), ("one", ())):
        arguments = ("--rate", FREE_RATE, "--model", "bands", "--name", "real", "-o", "real.htex")
        htex.run("fit", "half.csv", *arguments, *options)
        asset = json.loads(htex.run("info", "real.htex", "--json"))["manifest"]
        if key == "grid":
            left_out = [at["left_out"]["third_octave_error_rms_db"] for at in asset["representations"][0]["at"] if at.get("left_out")]
            row |= {"conditions": len(asset["conditions"]), "stated": rms(left_out)}
        row[key] = rms([third_octaves_db(htex.play(*motion), truth) for motion, truth in truths])
    return row


def free(htex, folder):
    """Predict each half of a free motion from the other."""
    global BAND_HZ
    BAND_HZ = (20.0, 499.0)
    print("\n## Free motions: each half in time from the other\n")
    print("| material | half | conditions | stated, dB | measured, dB | one condition, dB |\n|---|---|---|---|---|---|")
    for file in sorted(folder.glob("*.csv")):
        data = np.genfromtxt(file, delimiter=",", names=True)
        recording = np.array([data["speed"], data["force"], data["friction"] * data["force"]])
        halves = np.array_split(recording, 2, axis=1)
        for half in (0, 1):
            r = free_half(htex, halves[half], halves[1 - half])
            print(f"| {file.stem} | {half + 1} | {r['conditions']} | {r['stated']:.2f} | {r['grid']:.2f} | {r['one']:.2f} |")


def median(rows, key):
    return float(np.median([abs(row[key]) for row in rows]))


def table(rows, title):
    print(f"\n## {title}\n")
    print("| material | recorded, mm/s | at, mm/s | exponent of level | level, dB | nearest recording | third octaves, dB | nearest recording | with its level exact |")
    print("|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        known = ", ".join(f"{v:g}" for v in r["known"])
        print(
            f"| {r['material']} | {known} | {r['at']:g} | {r['exponent']:.2f} | {r['level']:+.1f} | {r['level_clamped']:+.1f} "
            f"| {r['third']:.1f} | {r['third_clamped']:.1f} | {r['floor']:.1f} |"
        )
    worse = max(abs(r["level"]) - abs(r["level_clamped"]) for r in rows)
    gain = np.median([r["third_clamped"] - r["third"] for r in rows])
    worst = max(r["third"] - r["third_clamped"] for r in rows)
    print(
        f"\nMedians of {len(rows)}: level {median(rows, 'level'):.2f} dB (nearest recording {median(rows, 'level_clamped'):.2f}), third octaves "
        f"{median(rows, 'third'):.2f} dB ({median(rows, 'third_clamped'):.2f}; with its level exact {median(rows, 'floor'):.2f}). The law is better by "
        f"{gain:.2f} dB in the median, worse by at most {worst:.2f} dB in third octaves and {worse:.2f} dB in the level."
    )


def speeds(htex, folder):
    all_rows = {"one": [], "inside": [], "outside": []}
    for material in strokes(folder):
        for count in (1, 2, 3):
            for known in itertools.combinations(sorted(material.files), count):
                for row in material.held_out(htex, known):
                    kind = "one" if count == 1 else "outside" if row["outside"] else "inside"
                    all_rows[kind].append(row)
    table(all_rows["one"], "Strokes: one recorded speed")
    table(all_rows["inside"], "Strokes: between recorded speeds")
    table(all_rows["outside"], "Strokes: outside several recorded speeds")


def node_signal(model, seconds, rate, seed):
    """Return the samples of an ARMA node."""
    numbers = lambda key: [float(v.text) for v in model.find(key).findall("value")]
    ar, ma = numbers("ARcoeff"), numbers("MAcoeff")
    ar = ar if ar[:1] == [1.0] else [1.0, *ar]
    ma = ma if ma[:1] == [1.0] else [1.0, *ma]
    noise = np.random.default_rng(seed).standard_normal(int(seconds * rate) + 1000)
    return signal.lfilter(ma, ar, noise * np.sqrt(float(model.find("var").text)))[1000:]


def hatt(htex, folder):
    """Play each audible node as a recording, and predict the next faster node with about the same
    force.
    """
    global BAND_HZ
    BAND_HZ = (20.0, 500.0)
    rows = []
    for path in sorted(folder.glob("*.xml")):
        nodes = []
        for i, model in enumerate(tree.parse(path).getroot().findall("model")):
            speed, force = (float(model.find(key).text) for key in ("speedMod", "forceMod"))
            if float(model.find("var").text) > 0 and speed > 0 and force > 0:
                samples = node_signal(model, 10, 1000, i)
                nodes.append((speed, force, samples))
        scale = 0.9 / max((np.abs(samples).max() for *_, samples in nodes), default=1)
        nodes.sort(key=lambda node: node[:2])
        for speed, force, samples in nodes:
            faster = [n for n in nodes if n[0] > 1.1 * speed and 0.67 < n[1] / force < 1.5]
            if not faster:
                continue
            target = faster[0]
            file = htex.folder / "node.wav"
            write_wav(file, scale * samples, 1000)
            options = ("--quantity", "acceleration", "--contact", "tool")
            htex.fit([(file.name, speed, force)], *options)
            played = htex.play(target[0], target[1])
            truth, own = power(scale * target[2], 1000), power(scale * samples, 1000)
            rows.append([third_octaves_db(played, truth), third_octaves_db(own, truth), level_db(played) - level_db(truth)])
    third, own, level = np.array(rows).T
    print(
        f"\n## HaTT: each node from the next slower one\n\n{len(rows)} pairs of {len(list(folder.glob('*.xml')))} materials. Third octaves, median: "
        f"{np.median(third):.2f} dB by the law of a tool, {np.median(own):.2f} dB as recorded; level {np.median(np.abs(level)):.2f} dB."
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--htex", default="htex", help="the command [default: htex]")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        # The command runs in a folder of its own.
        htex = Htex(os.path.abspath(shutil.which(chosen.htex) or chosen.htex), place)
        for name, measure in (("speeds", speeds), ("hatt", hatt), ("free", free)):
            if (chosen.folder / name).is_dir():
                measure(htex, chosen.folder / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
