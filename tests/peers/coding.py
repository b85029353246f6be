"""Bytes of coded Bands against held-out error and identity.

    python tests/peers/coding.py FOLDER --htex htex

FOLDER contains recordings of several takes of each material, NAME_0.wav, NAME_1.wav, ... as in
dexrob/BioTac_slide_20_50, which may not be passed on. For each step of Bands, the script fits every
take with `htex fit --storage coded`. It prints

- the bytes of the parameters, coded and packed;
- the median held-out error, in units of a second recording;
- the share of other takes that are named by the curve of one take of each material: the nearest
  curve in third octaves, in the metric of the takes' covariance within materials.

Recordings of one take of each material (NAME.wav) are measured without the last column.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import wave

import numpy as np
from independent.shapes import Band, magnitude

STEPS_DB = (0.5, 0.75, 1, 1.25, 1.5, 1.75, 2, 2.5, 3)
EDGES = 20 * 2 ** (np.arange(18) / 3)
BINS = 5.0 * np.arange(4, 201)
# Share of the mean variance that is added to the covariance.
RIDGE = 0.1


def spectrum(path):
    """Return the mean power of a recording at the multiples of 5 Hz."""
    with wave.open(str(path)) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(float)
        rate = file.getframerate()
    size = round(0.2 * rate)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    starts = range(0, len(samples) - size + 1, size // 2)
    power = np.mean([np.abs(np.fft.rfft(window * samples[at : at + size])) ** 2 for at in starts], axis=0)
    return power[4:201]


def third_octaves(power):
    """Return the levels of the third octaves of power at the bins, dB."""
    bands = [power[(BINS >= low) & (BINS < high)].sum() for low, high in zip(EDGES, EDGES[1:])]
    return 10 * np.log10(bands)


def fit(htex, path, step_db, storage, folder):
    command = [htex, "fit", path, "--model", "bands", "--scale", "1", "--storage", storage, "--json", "-q"]
    command += ["--option", f"bands.step_db={step_db}", "-o", folder / "fit.htex"]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["representations"][0]


def curve(parameters, power):
    """Return the third octaves of Bands at the level of the recording."""
    values = [parameters[name] for name in ("below_highest", "step_db", "layout")]
    shape = magnitude("org.htex.bands", values, Band(20, 1000))(BINS) ** 2
    return third_octaves(shape * power.sum() / shape.sum())


def identity(curves, real):
    """Return the share of takes that the curve of another take of their material names."""
    materials, takes, size = real.shape
    right = total = 0
    for take in range(takes):
        others = [i for i in range(takes) if i != take]
        within = (real[:, others] - real[:, others].mean(1, keepdims=True)).reshape(-1, size)
        covariance = within.T @ within / (materials * (takes - 2))
        metric = np.linalg.inv(covariance + RIDGE * np.trace(covariance) / size * np.eye(size))
        for material in range(materials):
            for other in others:
                away = real[material, other] - curves[:, take]
                right += np.argmin(np.einsum("mi,ij,mj->m", away, metric, away)) == material
                total += 1
    return right / total


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--htex", default="htex")
    arguments = parser.parse_args()
    paths = sorted(arguments.folder.glob("*.wav"))
    if not paths:
        sys.exit(f"{arguments.folder}: there is no WAV file")
    materials = {}
    for path in paths:
        materials.setdefault(path.stem.rpartition("_")[0] or path.stem, []).append(path)
    takes = min(map(len, materials.values()))
    power = {path: spectrum(path) for path in paths}
    table = takes > 2 and np.array([[third_octaves(power[p]) for p in own[:takes]] for own in materials.values()])
    if takes > 2:
        print(f"{len(materials)} materials; real takes name {100 * identity(table, table):.1f} % of the others")
    print("step/dB  coded/B (median, mean)  packed/B  held out  identity/%")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for step in STEPS_DB:
            fits = {path: fit(arguments.htex, path, step, "coded", folder) for path in paths}
            sizes = [fits[path]["payload_bytes"] for path in paths]
            packed = [fit(arguments.htex, path, step, "plain", folder)["payload_bytes"] for path in paths]
            held_out = [at["held_out_error"] for f in fits.values() for at in f["at"] if "held_out_error" in at]
            line = f"{step:7g}  {np.median(sizes):7g} {np.mean(sizes):15.2f} {np.mean(packed):9.2f}"
            line += f" {np.median(held_out):9.3f}" if held_out else "         –"
            if takes > 2:
                curves = [
                    [curve(fits[path]["at"][0]["parameters"], power[path]) for path in own[:takes]]
                    for own in materials.values()
                ]
                line += f" {100 * identity(np.array(curves), table):11.1f}"
            print(line, flush=True)


if __name__ == "__main__":
    main()
