"""Compares the import of model files of the Penn Haptic Texture Toolkit with SciPy.

    python tests/peers/hatt.py target/release/htex FOLDER

imports each `*.xml` of the folder, and at each node whose variance is above 0 compares the magnitudes of `htex spectrum` from 20 to 490 Hz with
those of the file's filter by `scipy.signal.freqz`: the amplitude that a periodic Hann window of 0.2 s reads of its density. Prints a line for each
file: nodes, bytes, and the largest difference, dB.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy as np
from scipy.signal import freqz

GRID = np.arange(20.0, 491.0, 5.0)
BIN_HZ = 5.0


def numbers(element, name):
    return np.array([float(value.text) for value in element.find(name)])


def magnitude(node, rate, hertz):
    _, h = freqz(numbers(node, "MAcoeff"), numbers(node, "ARcoeff"), worN=2 * np.pi * np.asarray(hertz) / rate)
    deviation = float(node.find("gain").text) * np.sqrt(float(node.find("var").text))
    # One-sided density 2 s^2 / rate, noise bandwidth of the window 1.5 bins, power of a sinusoid half its squared amplitude.
    return deviation * np.abs(h) * np.sqrt(2 * (2 / rate) * 1.5 * BIN_HZ)


def decibels(a, b):
    return float(np.max(np.abs(20 * np.log10(a / b))))


def main(htex, folder):
    worst, sizes = 0.0, []
    with tempfile.TemporaryDirectory() as place:
        for file in sorted(pathlib.Path(folder).glob("*.xml")):
            asset = pathlib.Path(place) / "texture.htex"
            subprocess.run([htex, "import", file, "-o", asset], check=True, capture_output=True)
            root = ElementTree.parse(file).getroot()
            rate = float(root.find("SampleRate").text)
            nodes = [node for node in root.findall("model") if float(node.find("var").text) > 0]
            errors = []
            for node in nodes:
                at = ["--speed", node.find("speedMod").text, "--force", node.find("forceMod").text]
                words = [htex, "spectrum", asset, "--model", "arma", *at, "--json"]
                said = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
                found = dict(zip(said["frequency_hz"], said["magnitude"]))
                errors.append(decibels(np.array([found[hz] for hz in GRID]), magnitude(node, rate, GRID)))
            size = asset.stat().st_size
            print(f"{file.stem:32} {len(root.findall('model')):3} nodes, {len(nodes):3} audible, {size:6} bytes, {max(errors):.6f} dB")
            worst, sizes = max(worst, *errors), [*sizes, size]
    print(f"largest difference {worst:.6f} dB, largest file {max(sizes)} bytes")
    return worst < 0.01


if __name__ == "__main__":
    sys.exit(0 if main(*sys.argv[1:3]) else 1)
