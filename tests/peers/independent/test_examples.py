"""The examples of the text (`python -m unittest independent.test_examples`, in the folder of the package)."""

from __future__ import annotations

import math
import re
import unittest
from fractions import Fraction
from pathlib import Path

import numpy as np

from .blocks import Budget, read_block
from .mesh import Mesh
from .mixing import filter_of, line_frequencies
from .pages import read_leaf, read_root
from .shapes import Band, read_power

SPEC = Path(__file__).parent.parent / "spec"


def hex_of(name: str, document: str) -> bytes:
    """The bytes of a code block of the kind `hex NAME`, without its comments."""
    text = (SPEC / document).read_text("utf-8")
    block = re.search(rf"```hex{name}\n(.*?)```", text, re.DOTALL).group(1)
    return bytes.fromhex("".join(line.split("#")[0] for line in block.splitlines()))


class Examples(unittest.TestCase):
    def test_block(self):
        fields = [
            {"name": "weights", "list": True, "store": "f32"},
            {"name": "peak_hz", "store": {"u16": {"scale": 0.5}}},
            {"name": "gain", "store": {"u8": {"scale": 0.1, "offset": -5.0, "log": True}}},
        ]
        (values,) = read_block(hex_of("", "htex-1.md"), fields, 1, Budget(100))
        self.assertEqual(values[:2], [[0.5, -0.25], 100.0])
        self.assertAlmostEqual(values[2], math.exp(-2), 15)

    def test_packed(self):
        fields = [{"name": "below", "list": True, "store": {"packed": {"scale": 1.0}}}]
        (values,) = read_block(bytes.fromhex("05250938"), fields, 1, Budget(100))
        self.assertEqual(values, [[40, 39, 39, 40, 43]])

    def test_library(self):
        root = read_root(hex_of(" root", "htexlib-1.md"), 1, 0x6A, False)
        self.assertEqual((root.name, root.separators, root.lengths), ("One", [b""], [98 + 8]))
        (entry,) = read_leaf(hex_of(" leaf", "htexlib-1.md"), "", False)
        self.assertEqual((entry.name, entry.tags, entry.length), ("felt", ["textile", "rough"], 617))
        header = hex_of(" header", "htexlib-1.md")
        self.assertEqual(header, (SPEC / "library-conformance/valid_one.htexlib").read_bytes()[:128])

    def test_line_at_the_edge(self):
        self.assertAlmostEqual(read_power(20.0, Band(20, 1000)), 5 / 6, 14)

    def test_line_spectral_frequencies(self):
        rng = np.random.default_rng(1)
        for order in range(0, 21):
            frequencies = sorted(rng.uniform(0.05, 3.09, order).tolist())
            if order > 1 and min(np.diff(frequencies)) < 1e-3:
                continue
            back = line_frequencies(filter_of(frequencies))
            self.assertTrue(np.allclose(back, frequencies, rtol=0, atol=1e-6), order)


class Meshes(unittest.TestCase):
    def test_weights(self):
        """Weights sum to 1, give each condition at its own position, and are continuous."""
        rng = np.random.default_rng(2)
        for _ in range(40):
            count = int(rng.integers(1, 12))
            places = rng.integers(1, 7, (count, 2)) / 6 if rng.random() < 0.5 else rng.uniform(0.05, 1, (count, 2))
            points = list({(float(x), float(y)) for x, y in places})
            mesh = Mesh(points)
            for index, point in enumerate(points):
                weights, _ = mesh.weights(point)
                self.assertAlmostEqual(weights.get(index, 0.0), 1.0, 9)
            for x, y in rng.uniform(-0.3, 1.5, (40, 2)):
                here, _ = mesh.weights((x, y))
                self.assertAlmostEqual(sum(here.values()), 1.0, 9)
                near, _ = mesh.weights((x + 1e-9, y - 1e-9))
                for index in set(here) | set(near):
                    self.assertAlmostEqual(here.get(index, 0.0), near.get(index, 0.0), 5)

    def test_area(self):
        """The triangles cover the hull once."""
        rng = np.random.default_rng(3)
        for _ in range(40):
            places = rng.integers(0, 6, (int(rng.integers(4, 16)), 2))
            points = sorted({(x / 5, y / 5) for x, y in places.tolist()})
            mesh = Mesh(points)
            if mesh.triangles:
                area = sum(float(abs(area_of(mesh, t))) for t in mesh.triangles)
                outline = sum(cross(mesh, edge.ends) for edge in mesh.edges)
                self.assertAlmostEqual(area, float(abs(outline)), 12)


def area_of(mesh: Mesh, triangle) -> Fraction:
    from .mesh import orient

    return orient(*(mesh.exact[i] for i in triangle))


def cross(mesh: Mesh, ends) -> Fraction:
    (ax, ay), (bx, by) = (mesh.exact[i] for i in ends)
    return ax * by - ay * bx


if __name__ == "__main__":
    unittest.main()
