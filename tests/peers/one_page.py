"""`python one_page.py SPEC_FOLDER`: compares `htex_in_one_page.py` with the conformance files.

The numbers of every valid asset are compared with those of the independent reader, bit for bit. The cases of
playing-conformance are compared where the page describes what is played: at conditions, and at every motion of an
asset that has one condition only.
"""

from __future__ import annotations

import ast
import importlib.util
import inspect
import io
import json
import sys
from pathlib import Path

import numpy as np
from independent.asset import read_asset
from independent.law import exponents
from independent.models import read_models
from independent.playing import close

MOST_LINES, MOST_COLUMNS = 60, 109


def lines_of_code(text: str) -> int:
    """The lines that are neither empty, nor a comment, nor in a docstring."""
    words = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.FunctionDef)) and ast.get_docstring(node):
            words.update(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    lines = enumerate(text.splitlines(), 1)
    return sum(1 for number, line in lines if line.split("#")[0].strip() and number not in words)


def same_numbers(page, path: Path, asset) -> int:
    """The number of fields of an asset that both readers read alike, at all conditions."""
    compared = 0
    for representation, blocks in zip(asset.manifest["representations"], asset.blocks):
        _, _, sets = page.read_asset(path, representation["model"])
        assert len(sets) == len(blocks), path
        for ours, theirs in zip(sets, blocks):
            for field, numbers in zip(representation["fields"], theirs):
                # The last bit of `exp` depends on the processor.
                same = np.allclose(ours[field["name"]], np.atleast_1d(numbers), rtol=5e-16, atol=0)
                assert same, (path, field)
                compared += 1
    return compared


def flat(page, asset, condition: int) -> list[float]:
    """The parameters of a condition in the model's order, each list preceded by its length."""
    _, representation, sets = asset
    lists = {field["name"]: field.get("list", False) for field in representation["fields"]}
    numbers = []
    for name in list(inspect.signature(page.CURVES[representation["model"]]).parameters)[3:]:
        values = sets[condition][name]
        numbers += [len(values), *values] if lists[name] else [*values]
    return numbers


def compare_cases(page, path: Path) -> tuple[int, int]:
    """The number of cases that agree, at conditions and elsewhere."""
    cases = json.loads(path.read_text("utf-8"))
    frequencies = np.array(cases["frequency_hz"])
    at, elsewhere = 0, 0
    for case in cases["cases"]:
        if case["model"] not in page.CURVES or not {"speed_mm_s", "force_n"} <= case.keys() or case.get("refused"):
            continue
        asset = page.read_asset(path.parent / cases["asset"], case["model"])
        known = [asset[0]["conditions"][element["condition"]] for element in asset[1]["at"]]
        # The page has no direction: a speed is that of either.
        motion = abs(case["speed_mm_s"]), case["force_n"]
        # Nor does it know a finger that rests.
        if motion[0] < 0.5 or motion[1] <= 0:
            continue
        here = [i for i, one in enumerate(known) if (one.get("speed_mm_s", 0), one.get("force_n", 0)) == motion]
        if not here and len(known) > 1:
            continue
        factor, level, magnitude = page.play(*asset, *motion)
        pairs = [
            (factor, case["frequency_factor"]),
            (level, case["level_rms"]),
            (magnitude(frequencies), case["magnitude"]),
            (flat(page, asset, here[0] if here else 0), case["parameters"]),
        ]
        wrong = [(ours, theirs) for ours, theirs in pairs if not close(ours, theirs) <= 1]
        assert not wrong, (path.name, case["model"], motion, wrong)
        at, elsewhere = at + bool(here), elsewhere + (not here)
    return at, elsewhere


def compare_laws(page, spec: Path) -> None:
    """The law that is assumed for each contact and quantity, at the double speed and half as much force again."""
    manifest, *rest = page.read_asset(spec / "playing-conformance/one_condition.htex", "org.htex.sslope")
    known, level = manifest["conditions"][0], rest[0]["at"][0]["level_rms"]
    without = {key: value for key, value in manifest.items() if key not in ("law", "contact")}
    for contact in ("finger", "tool", "unknown", None):
        for quantity in ("lateral_force", "normal_force", "acceleration", "velocity", "displacement"):
            changed = {**without, "quantity": quantity} | ({"contact": contact} if contact else {})
            a, b, c = exponents(changed)
            played = page.play(changed, *rest, 2 * known["speed_mm_s"], 1.5 * known["force_n"])
            expected = 2**a, min(level * 2**b * 1.5**c, 4 * level)
            assert np.allclose(played[:2], expected, rtol=1e-12), (contact, quantity, played[:2], expected)


def compare_noise(page, spec: Path) -> float:
    """The difference between the level of the noise and the level of the asset, dB."""
    asset = page.read_asset(spec / "playing-conformance/one_condition.htex", "org.htex.sslope")
    known = asset[0]["conditions"][0]
    _, level, magnitude = page.play(*asset, known["speed_mm_s"], known["force_n"])
    samples = page.noise(magnitude, 400_000, 4000)
    density = np.abs(np.fft.rfft(samples)) ** 2 * 2 / len(samples) / 4000
    # The band is 20 to 1000 Hz; the grid has half a bin more on each side.
    hertz = np.fft.rfftfreq(len(samples), 1 / 4000)
    expected = magnitude(hertz) ** 2 / 15
    inside = expected > 0
    assert np.all(density[~inside] < 1e-12 * expected.max())
    return float(10 * np.log10(density[inside].sum() / expected[inside].sum()))


def main() -> int:
    spec = Path(sys.argv[1])
    source = spec / "htex_in_one_page.py"
    text = source.read_text("utf-8")
    lines, columns = lines_of_code(text), max(map(len, text.splitlines()))
    assert lines <= MOST_LINES and columns <= MOST_COLUMNS, (lines, columns)
    imported = importlib.util.spec_from_file_location("htex_in_one_page", source)
    page = importlib.util.module_from_spec(imported)
    imported.loader.exec_module(page)

    models = read_models(spec)
    fields = assets = refused = 0
    for path in sorted(spec.glob("conformance/valid*.htex")) + sorted(spec.glob("playing-conformance/*.htex")):
        asset, findings = read_asset(path.read_bytes(), models)
        assert findings.valid, path
        if asset.manifest.get("extensions_required"):
            try:
                page.read_asset(path, asset.manifest["representations"][0]["model"])
            except ValueError:
                refused += 1
                continue
            raise AssertionError(f"{path} is not refused")
        fields += same_numbers(page, path, asset)
        assets += 1
    # The example of a packed list in htex-1.md, and a number after it, which shows where it ends.
    steps = {"name": "q", "list": True, "store": {"packed": {"scale": 1}}}
    packed = [steps, {"name": "x", "store": {"u8": {"scale": 1}}}]
    block = io.BytesIO(bytes.fromhex("05250938ff"))
    assert [list(page.read_field(block, field)) for field in packed] == [[40, 39, 39, 40, 43], [255]]
    # A length in three bytes, which no asset of the folders has.
    block = io.BytesIO(bytes.fromhex("fb0101") + bytes(257))
    assert len(page.read_field(block, {"name": "q", "list": True, "store": {"u8": {"scale": 1}}})) == 257

    at = elsewhere = 0
    for path in sorted(spec.glob("playing-conformance/*.json")):
        counts = compare_cases(page, path)
        at, elsewhere = at + counts[0], elsewhere + counts[1]
    compare_laws(page, spec)
    level_db = compare_noise(page, spec)
    assert abs(level_db) < 0.1, level_db
    print(f"{lines} lines; {fields} fields of {assets} assets are the same, {refused} assets are refused")
    print(f"{at} cases at conditions and {elsewhere} elsewhere agree; the noise has its level within 0.1 dB")
    assert assets >= 20 and fields >= 1000 and refused >= 1 and at >= 140 and elsewhere >= 10
    return 0


if __name__ == "__main__":
    sys.exit(main())
