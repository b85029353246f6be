"""A player's numbers at a motion (htex-playing-1.md)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import numpy as np

from .asset import Asset, read_asset
from .axes import Axis, StoredAxis
from .blocks import flat
from .law import clamp, exponents, power, scaled
from .mesh import Mesh
from .mixing import mix
from .models import Models
from .shapes import FOLLOW_THE_MOTION, SUMS_OF_SINUSOIDS, Band, Refusal, Values, magnitude

LEFT_OUT = 1e-12
SAME_RATIO = 1e-9
SLIDES_MM_S = 0.5


@dataclass
class Played:
    """What a player plays at a motion, before it generates samples."""

    values: Values
    frequency_factor: float
    level_rms: float
    magnitude: Callable[[np.ndarray], np.ndarray]

    @property
    def parameters(self) -> list[float]:
        return flat(self.values)


class Voice:
    """One representation of an asset."""

    def __init__(self, asset: Asset, model: dict):
        manifest = asset.manifest
        index = next(i for i, r in enumerate(manifest["representations"]) if r["model"] == model["id"])
        representation = manifest["representations"][index]
        if representation["model_version"].split(".")[0] != model["version"].split(".")[0]:
            raise Refusal("another major version of the model")
        self.model = model
        self.band = Band(manifest["band"]["low_hz"], manifest["band"]["high_hz"])
        self.exponents = exponents(manifest)
        stored = [field["name"] for field in representation["fields"]]
        self.sets = [
            [block[stored.index(field["name"])] for field in model["fields"]] for block in asset.blocks[index]
        ]
        self.levels = [element["level_rms"] for element in representation["at"]]
        conditions = [manifest["conditions"][int(element["condition"])] for element in representation["at"]]
        speeds = [condition.get("speed_mm_s") for condition in conditions]
        forces = [condition.get("force_n") for condition in conditions]
        self.stated = list(zip(speeds, forces))
        if representation.get("triangles"):
            self.axes = (StoredAxis(speeds), StoredAxis(forces))
            triangles = [tuple(map(int, triangle)) for triangle in representation["triangles"]]
            self.mesh = Mesh(self.positions(speeds, forces), triangles)
            return
        for grouped in (True, False):
            self.axes = (Axis(speeds, grouped), Axis(forces, grouped))
            points = self.positions(speeds, forces)
            if len(set(points)) == len(points):
                break
        self.mesh = Mesh(points)

    def positions(self, speeds: list[float | None], forces: list[float | None]) -> list[tuple[float, float]]:
        return [(self.axes[0].position(v), self.axes[1].position(f)) for v, f in zip(speeds, forces)]

    def default(self) -> tuple[float, float]:
        """Speed and force of the default condition: the first, or the strongest if the first is silent."""
        known = list(zip(self.levels, self.stated))
        heard = [i for i, (level, motion) in enumerate(known) if level > 0 and slides(*motion)]
        if not heard or heard[0] == 0:
            chosen = 0
        else:
            chosen = max(heard, key=lambda i: (self.levels[i], -i))
        speed, force = self.stated[chosen]
        return speed or 0.0, force or 0.0

    def motion(self, case: dict) -> tuple[float, float, bool]:
        """Speed and force of a case, and whether one is given; what it lacks is the default condition's."""
        speed, force = self.default()
        return case.get("speed_mm_s", speed), case.get("force_n", force), bool({"speed_mm_s", "force_n"} & case.keys())

    def at(self, speed: float, force: float, may_rest: bool = True) -> Played:
        # A finger slides in either direction, and nothing else depends on the sign.
        speed = abs(speed)
        point = (self.axes[0].position(speed), self.axes[1].position(force))
        weights, foot = self.mesh.weights(point)
        kept = sorted((i for i, w in weights.items() if w > LEFT_OUT), key=lambda i: self.mesh.points[i])
        for i in kept:
            check_ranges(self.model, self.sets[i])
        values = mix(self.model["id"], [self.sets[i] for i in kept], [weights[i] for i in kept])
        check_ranges(self.model, values)
        level = sum(weights[i] * self.levels[i] for i in kept)
        if may_rest and not slides(speed, force):
            level = 0.0
        ratio_v, ratio_f = self.ratios(speed, force, foot)
        a, b, c = (0.0, 0.0, 0.0) if self.model["id"] in FOLLOW_THE_MOTION else self.exponents
        ratio_v = clamp(ratio_v)
        factor = clamp(power(ratio_v, a))
        level = scaled(level, max(self.levels), power(ratio_v, b) * power(ratio_f, c))
        shape = magnitude(self.model["id"], values, self.band)
        density = 1.0 if self.model["id"] in SUMS_OF_SINUSOIDS else factor**-0.5
        return Played(values, factor, level, lambda f: level * density * shape(np.asarray(f) / factor))

    def foot(self, speed: float, force: float):
        """The foot on the nearest edge, or None where the motion lies in a triangle."""
        return self.mesh.weights((self.axes[0].position(speed), self.axes[1].position(force)))[1]

    def ratios(self, speed: float, force: float, foot) -> tuple[float, float]:
        """v / v0 and F / F0; 1 on an axis that has no values to go by."""
        if foot is None:
            return 1.0, 1.0
        result = []
        for axis, place, value in zip(self.axes, foot, (speed, force)):
            nearest = axis.nearest(place, value) if axis.complete else 0.0
            ratio = value / nearest if nearest > 0 else 1.0
            result.append(1.0 if abs(ratio - 1) <= SAME_RATIO else ratio)
        return result[0], result[1]


def slides(speed: float | None, force: float | None) -> bool:
    """Whether something is felt at a condition, as far as it is known."""
    return (speed is None or speed >= SLIDES_MM_S) and (force is None or force > 0)


def check_ranges(model: dict, values: Values) -> None:
    """Refuse parameters outside the descriptor's ranges."""
    for field, value in zip(model["fields"], values):
        numbers = value if isinstance(value, list) else [value]
        if isinstance(value, list) and len(value) > field["kind"]["max_len"]:
            raise Refusal(f"too many {field['name']}")
        if any(not field["min"] <= number <= field["max"] for number in numbers):
            raise Refusal(f"{field['name']} is out of range")
    if model["id"] == "org.htex.speak" and len(values[0]) != len(values[1]):
        raise Refusal("as many amplitudes as frequencies")
    if model["id"] == "org.htex.bands" and not values[0]:
        raise Refusal("no knot")


def close(ours, theirs) -> float:
    """The largest difference over what is allowed: 1e-8 of a number, or of a millionth of the largest."""
    ours, theirs = np.atleast_1d(np.asarray(ours, float)), np.atleast_1d(np.asarray(theirs, float))
    if ours.shape != theirs.shape:
        return np.inf
    if not len(theirs):
        return 0.0
    allowed = 1e-8 * np.maximum(np.abs(theirs), 1e-6 * np.max(np.abs(theirs)))
    difference = np.abs(ours - theirs)
    return float(np.max(np.where(difference == 0, 0.0, difference / np.where(allowed == 0, 1e-300, allowed))))


def compare_playing(folder: Path, models: Models, say: Callable[[str], None]) -> tuple[int, int]:
    """Every case of playing-conformance; how many agree, of how many."""
    agree = total = 0
    for path in sorted(folder.glob("*.json")):
        cases = json.loads(path.read_text("utf-8"))
        asset, findings = read_asset((folder / cases["asset"]).read_bytes(), models)
        if not findings.valid:
            say(f"{path.name}: the asset is not valid: {findings.items}")
            continue
        voices: dict[str, Voice] = {}
        frequencies = np.array(cases["frequency_hz"])
        for case in cases["cases"]:
            total += 1
            what = f"{path.stem} {case['model']} {case.get('speed_mm_s', '-')} mm/s {case.get('force_n', '-')} N"
            refused = case.get("refused", False)
            try:
                voice = voices.setdefault(case["model"], None) or Voice(asset, models[case["model"]])
                voices[case["model"]] = voice
                played = voice.at(*voice.motion(case))
                if refused:
                    say(f"{what}: played, and is to be refused")
                    continue
                errors = {
                    "parameters": close(played.parameters, case["parameters"]),
                    "frequency_factor": close(played.frequency_factor, case["frequency_factor"]),
                    "level_rms": close(played.level_rms, case["level_rms"]),
                    "magnitude": close(played.magnitude(frequencies), case["magnitude"]),
                }
            except Refusal as refusal:
                agree += refused
                if not refused:
                    say(f"{what}: refused: {refusal}")
                continue
            wrong = {key: f"{value:.3g} x the tolerance" for key, value in errors.items() if value > 1}
            agree += not wrong
            if wrong:
                say(f"{what}: {wrong}")
    return agree, total
