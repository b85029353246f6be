"""Compares the import of model files of the Penn Haptic Texture Toolkit with SciPy.

    python tests/peers/hatt.py target/release/htex FOLDER
    python tests/peers/hatt.py --told FILE.xml MAGNITUDES.json

The script imports each `*.xml` in the folder. At each node whose variance is above 0 it compares
the magnitudes from `htex spectrum`, 20 to 490 Hz, with the magnitudes of the file's filter from
`scipy.signal.freqz`: the amplitude that a periodic Hann window of 0.2 s shows for its density. It
prints a line for each file: nodes, bytes, and the largest difference, dB. With `--told` it compares
magnitudes that another program wrote: a list of lists, node by node. It exits with 1 if any differs
by 0.01 dB or more.
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
WITHIN_DB = 0.01


def numbers(element, name):
    return np.array([float(value.text) for value in element.find(name)])


def variance(node):
    return float(node.find("var").text)


def magnitude(node, rate):
    _, h = freqz(numbers(node, "MAcoeff"), numbers(node, "ARcoeff"), worN=2 * np.pi * GRID / rate)
    deviation = float(node.find("gain").text) * np.sqrt(variance(node))
    # One-sided density 2 s^2 / rate, noise bandwidth of the window 1.5 bins, power of a sinusoid half its squared amplitude.
    return deviation * np.abs(h) * np.sqrt(2 * (2 / rate) * 1.5 * BIN_HZ)


def largest_db(file, told):
    """Return the largest difference, over all audible nodes, from what `told` returns for a node
    and its number.
    """
    root = ElementTree.parse(file).getroot()
    rate = float(root.find("SampleRate").text)
    nodes = list(enumerate(root.findall("model")))
    audible = [(i, node) for i, node in nodes if variance(node) > 0]
    ratios = [np.asarray(told(i, node)) / magnitude(node, rate) for i, node in audible]
    return float(np.max(np.abs(20 * np.log10(ratios)))), len(nodes), len(audible)


def spectrum(htex, asset):
    def told(_, node):
        at = ["--speed", node.find("speedMod").text, "--force", node.find("forceMod").text]
        words = [htex, "spectrum", asset, "--model", "arma", *at, "--json"]
        said = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
        found = dict(zip(said["frequency_hz"], said["magnitude"]))
        return [found[hz] for hz in GRID]

    return told


def imported(htex, folder):
    worst, sizes = [], []
    with tempfile.TemporaryDirectory() as place:
        for file in sorted(pathlib.Path(folder).glob("*.xml")):
            asset = pathlib.Path(place) / "texture.htex"
            subprocess.run([htex, "import", file, "-o", asset], check=True, capture_output=True)
            error, nodes, audible = largest_db(file, spectrum(htex, asset))
            size = asset.stat().st_size
            print(f"{file.stem:32} {nodes:3} nodes, {audible:3} audible, {size:6} bytes, {error:.6f} dB")
            worst.append(error)
            sizes.append(size)
    print(f"largest difference {max(worst):.6f} dB, largest file {max(sizes)} bytes")
    return max(worst)


def main(first, *files):
    if first != "--told":
        return imported(first, *files)
    file, told = files
    told = json.loads(pathlib.Path(told).read_text())
    error, _, audible = largest_db(file, lambda i, _: told[i])
    print(f"{audible} audible nodes within {error:.6f} dB")
    return error


if __name__ == "__main__":
    sys.exit(0 if main(*sys.argv[1:]) < WITHIN_DB else 1)
