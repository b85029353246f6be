"""The examples of the text (`python -m unittest independent.test_examples`, in the folder of the package)."""

from __future__ import annotations

import math
import re
import unittest
from fractions import Fraction
from pathlib import Path

import numpy as np

from .blocks import Budget, read_block
from .findings import Refused
from .jsontext import parse
from .mesh import Mesh, orient
from .mixing import filter_of, line_frequencies
from .pages import read_leaf, read_root
from .shapes import Band, read_power
from .spdx import NotAnExpression, first_unknown_id
from .trace import SPELLINGS
from .triangles import fault_of_cover
from .typed import Integer, is_blank, check

SPEC = Path(__file__).parents[3] / "spec"


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
        root = read_root(hex_of(" root", "htexlib-1.md"), 1, 0x77, 0, 1, 65536)
        self.assertEqual((root.name, root.separators, root.lengths), ("One", [b""], [119]))
        (entry,) = read_leaf(hex_of(" leaf", "htexlib-1.md"), "", 1)
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


    def test_stored(self):
        """The triangles that a player finds are valid ones, without one they are not, and both meshes agree."""
        rng = np.random.default_rng(4)
        for _ in range(60):
            points = [(float(x), float(y)) for x, y in rng.uniform(0.05, 1, (int(rng.integers(4, 14)), 2))]
            mesh = Mesh(points)
            if mesh.edge_of:
                continue
            triangles = [rng.permutation(triangle).tolist() for triangle in mesh.triangles]
            self.assertIsNone(fault_of_cover(points, triangles))
            self.assertIsNotNone(fault_of_cover(points, triangles[1:]))
            self.assertIsNotNone(fault_of_cover(points, triangles + triangles[:1]))
            stored = Mesh(points, triangles)
            for x, y in rng.uniform(-0.3, 1.5, (20, 2)):
                (ours, foot), (theirs, other) = stored.weights((x, y)), mesh.weights((x, y))
                self.assertEqual(foot is None, other is None)
                for index in range(len(points)):
                    self.assertAlmostEqual(ours.get(index, 0.0), theirs.get(index, 0.0), 12)


class Rules(unittest.TestCase):
    def test_whole_numbers(self):
        """Numbers of digits alone are compared as they are written."""
        allowed_texts = ("9007199254740992", "9007199254740993.0", "1e0", "-0")
        for text in (*allowed_texts, "9007199254740993", "1.5", "-1"):
            allowed = text in allowed_texts
            try:
                check(Integer(), parse(text.encode(), 1), "JSON_TYPE")
                self.assertTrue(allowed, text)
            except Refused:
                self.assertFalse(allowed, text)

    def test_white_space(self):
        self.assertTrue(is_blank("\t\u2003\x85"))
        self.assertFalse(is_blank("\x1c") or is_blank("\ufeff"))

    def test_licences(self):
        for text in ("MIT or (Apache-2.0+ AND GPL-2.0)", "MPL-1.0+", "DocumentRef-a:LicenseRef-b WITH AdditionRef-c"):
            self.assertIsNone(first_unknown_id(text))
        self.assertEqual(first_unknown_id("MIT AND mit OR Nothing-1"), "mit")
        for text in ("", "MIT +", "GPL-2.0-only+", "GPL-2.0+", "MIT And MIT", "MIT Apache-2.0", "(MIT", "LicenseRef-a+"):
            with self.assertRaises(NotAnExpression):
                first_unknown_id(text)

    def test_columns(self):
        expected = {
            "f_n": ("force_n", 1.0, True),
            "force_n": ("force_n", 1.0, False),
            "x_position_(um)": ("x_mm", 1e-3, False),
            "vel[m/s]": ("speed_mm_s", 1e3, False),
        }
        for name, meaning in expected.items():
            self.assertEqual(SPELLINGS[name], meaning)


def area_of(mesh: Mesh, triangle) -> Fraction:
    return orient(*(mesh.exact[i] for i in triangle))


def cross(mesh: Mesh, ends) -> Fraction:
    (ax, ay), (bx, by) = (mesh.exact[i] for i in ends)
    return ax * by - ay * bx


if __name__ == "__main__":
    unittest.main()
