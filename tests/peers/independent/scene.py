"""Validation of scenes (scene-1.md, scene-findings.md)."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from . import file_device
from . import limits as defaults
from .asset import Asset, read_asset
from .findings import Findings, Refused, escape
from .models import Models
from .playing import Voice
from .scene_document import check_document, read_document
from .shapes import Refusal
from .table import NotATable, read_table

AMPLIFIED_DB = 10.0
LEAST_STEP_S = 1e-9
FARTHEST = 1e9
MOST_TRACE_NUMBERS = 40_000_000


def read_scene(path: Path, models: Models, limits: dict[str, int] | None = None) -> Findings:
    findings = Findings()
    limits = defaults.with_defaults(defaults.SCENE, limits)
    try:
        scene = read_document(path.read_bytes(), limits, findings)
        check_document(scene, limits, findings)
        if len(scene["surfaces"]) <= limits["surfaces"]:
            Files(scene, path.parent, models, findings).check()
    except Refused as refused:
        findings.items.append(refused.finding)
    return findings


def short_name(model: str) -> str:
    return model.rsplit(".", 1)[-1]


class Files:
    """The stages that need assets, traces, responses and the device."""

    def __init__(self, scene: dict, folder: Path, models: Models, findings: Findings):
        self.scene, self.folder, self.models, self.findings = scene, folder, models, findings
        self.device = scene.get("device", {})
        self.assets: list[Asset | None] = []
        self.voices: list[Voice] = []

    def check(self) -> None:
        for index, surface in enumerate(self.scene["surfaces"]):
            self.assets.append(self.surface(surface, f"/surfaces/{index}"))
        self.trace()
        self.beyond_recorded()
        quantity = self.open_device()
        self.response()
        self.quantities(quantity)

    # Assets and representations.

    def surface(self, surface: dict, pointer: str) -> Asset | None:
        path = self.folder / surface["asset"]
        if not path.is_file():
            self.findings.add("ASSET_MISSING", pointer + "/asset")
            return None
        asset, findings = read_asset(path.read_bytes(), self.models)
        if not findings.valid:
            self.findings.add("ASSET_INVALID", pointer + "/asset")
            return None
        wanted = surface.get("representation", "auto")
        if not wanted.strip():
            return asset
        names = [r["model"] for r in asset.manifest["representations"]]
        if wanted != "auto":
            names = [name for name in names if wanted in (name, short_name(name))]
            if not names:
                self.findings.add("REPRESENTATION_MISSING", pointer + "/representation")
                return asset
        voice = self.voice(asset, names)
        if voice is None:
            self.findings.add("REPRESENTATION_UNPLAYABLE", pointer)
        else:
            self.voices.append(voice)
        return asset

    def voice(self, asset: Asset, names: list[str]) -> Voice | None:
        for name in names:
            if name in self.models:
                try:
                    return Voice(asset, self.models[name])
                except Refusal:
                    continue
        return None

    # Motion.

    def trace(self) -> None:
        motion = self.scene["motion"]
        if not isinstance(motion, dict) or "trace" not in motion:
            return
        path, pointer = self.folder / motion["trace"], "/motion/trace"
        if not path.is_file():
            self.findings.add("TRACE_MISSING", pointer)
            return
        try:
            columns, assumptions = read_trace(path.read_bytes())
        except NotATable as error:
            self.findings.add("TRACE_INVALID", pointer, str(error))
            return
        for assumption in assumptions:
            self.findings.add("TRACE_ASSUMED", pointer, assumption)
        last = columns["t_s"][-1] - columns["t_s"][0]
        if self.scene.get("duration_s", 0.0) > last:
            self.findings.add("DURATION_BEYOND_TRACE", "/duration_s")

    def beyond_recorded(self) -> None:
        """A constant motion that is played as if it were another one."""
        motion = self.scene["motion"]
        constant = motion.get("constant") if isinstance(motion, dict) else None
        if constant is None:
            return
        effects = self.scene.get("effects", {})
        for index, voice in enumerate(self.voices):
            speed, force = constant["speed_mm_s"], constant["force_n"]
            ratio_v, ratio_f = voice.ratios(speed, force, voice.foot(speed, force))
            clamped = ratio_v > 0 and not 1 / 16 <= ratio_v <= 8
            a, b, c = voice.exponents
            off = effects.get("frequency_scaling") == "off" and ratio_v != 1 and a != 0
            off |= effects.get("level_scaling") == "off" and (ratio_v != 1 and b != 0 or ratio_f != 1 and c != 0)
            if clamped or off:
                self.findings.add("MOTION_BEYOND_RECORDED", "/motion", f"surface {index}")
                return

    # The device.

    def open_device(self) -> str | None:
        """Check adapter and settings; the device's quantity, or None where it cannot be opened."""
        findings, pointer = self.findings, "/device/settings"
        settings = self.device.get("settings", {})
        if self.device.get("adapter", "file") not in ("file", "org.htex.file"):
            findings.add("DEVICE_UNKNOWN", "/device/adapter")
            return None
        before = len(findings.items)
        if "driver" in settings:
            findings.add("DEVICE_PATH_UNSAFE", pointer + "/driver")
        if "path" in settings:
            findings.add("DEVICE_PATH_UNUSED", pointer + "/path")
        if "profile" in self.device:
            findings.add("DEVICE_SETTING", "/device/profile")
        for name, value in settings.items():
            if name != "driver" and not file_device.allows(name, value):
                findings.add("DEVICE_SETTING", f"{pointer}/{escape(name)}")
        quantity = settings.get("quantity", "lateral_force")
        if quantity == "display_voltage" and "limit_v" not in settings:
            findings.add("DEVICE_SETTING", pointer)
        if any(finding.severity == "error" for finding in findings.items[before:]):
            return None
        rate = self.device.get("rate_hz")
        if rate is not None and not file_device.LEAST_RATE_HZ <= rate <= file_device.MOST_RATE_HZ:
            findings.add("DEVICE_RATE", "/device/rate_hz")
        elif rate is not None and rate < file_device.LEAST_RATE_OVER_CARRIER * settings.get("carrier_hz", 0.0):
            findings.add("DEVICE_RATE", "/device/rate_hz")
        self.fields(quantity)
        limit = settings.get("limit_v")
        if quantity == "display_voltage" and self.device.get("drive_v", 0.0) > limit:
            findings.add("DEVICE_DRIVE_TOO_HIGH", "/device/drive_v")
        return quantity

    def fields(self, quantity: str) -> None:
        """Keys that must not be given for a device of this quantity."""
        volts, sound = quantity == "display_voltage", quantity == "sound"
        unfit = {
            "gain_db": volts or sound,
            "drive_v": not volts,
            "level_dbfs": not sound,
            "levels": not (volts or sound) and self.device.get("levels") == "own",
            "reference_rms": self.device.get("levels", "normalised") != "own",
            "pitch": not sound,
        }
        for key, wrong in unfit.items():
            if wrong and key in self.device:
                self.findings.add("DEVICE_FIELD_UNFIT", f"/device/{key}")

    def quantities(self, device: str | None) -> None:
        found = None
        for index, asset in enumerate(self.assets):
            if asset is None:
                continue
            quantity = asset.manifest["quantity"]
            if found is not None and quantity != found:
                self.findings.add("QUANTITIES_DIFFER", f"/surfaces/{index}/asset")
                return
            found = quantity
        if found is None or device is None:
            return
        takes = "lateral_force" if device == "display_voltage" else device
        given = "quantity_gain" in self.device
        if given and (device == "sound" or takes == found):
            self.findings.add("DEVICE_QUANTITY", "/device/quantity_gain")
        elif not given and device != "sound" and takes != found:
            self.findings.add("DEVICE_QUANTITY", "/device" if self.device else "")

    # The response.

    def response(self) -> None:
        if "response" not in self.device:
            return
        path, pointer = self.folder / self.device["response"], "/device/response"
        if not path.is_file():
            self.findings.add("RESPONSE_MISSING", pointer)
            return
        bands = [asset.manifest["band"] for asset in self.assets if asset is not None]
        if not bands:
            return
        pitch = self.device.get("pitch", 1.0)
        low, high = min(b["low_hz"] for b in bands) * pitch, max(b["high_hz"] for b in bands) * pitch
        try:
            frequencies, magnitudes = read_response(path.read_bytes())
            gain_db = compensation_db(frequencies, magnitudes, low, high, self.device.get("response_depth_db", 40.0))
        except NotATable as error:
            self.findings.add("RESPONSE_INVALID", pointer, str(error))
            return
        if gain_db > AMPLIFIED_DB:
            self.findings.add("RESPONSE_RAISED", pointer, f"by {gain_db:.1f} dB")


TRACE_COLUMNS = ("t_s", "x_mm", "y_mm", "force_n", "speed_mm_s")


def read_trace(data: bytes) -> tuple[dict[str, list[float]], list[str]]:
    """The columns of a trace, and what was assumed of them."""
    names, values = read_table(data)
    columns, assumptions = {}, []
    by_bare = {name.split("_")[0]: name for name in TRACE_COLUMNS}
    unused = []
    for name, column in zip(names, values):
        known = name if name in TRACE_COLUMNS else by_bare.get(name)
        if known is None or known in columns:
            unused.append(name)
            continue
        columns[known] = column
        if known != name:
            assumptions.append(f"{name} is read as {known}")
    if unused:
        assumptions.append(f"not used: {', '.join(unused)}")
    if any(name not in columns for name in TRACE_COLUMNS[:4]):
        raise NotATable("a column is missing")
    times = columns["t_s"]
    if len(times) < 2 or any(b - a < LEAST_STEP_S for a, b in zip(times, times[1:])):
        raise NotATable("fewer than two rows, or times that do not ascend by 1 ns")
    if sum(map(len, values)) > MOST_TRACE_NUMBERS or any(abs(x) > FARTHEST for c in columns.values() for x in c):
        raise NotATable("too many numbers, or one beyond 1e9")
    return columns, assumptions


def read_response(data: bytes) -> tuple[np.ndarray, np.ndarray]:
    names, values = read_table(data)
    columns = dict(zip(names, values))
    if "frequency_hz" not in columns or "magnitude" not in columns:
        raise NotATable("a column is missing")
    frequencies, magnitudes = np.array(columns["frequency_hz"]), np.array(columns["magnitude"])
    if np.any(np.diff(frequencies) <= 0) or np.any(magnitudes < 0):
        raise NotATable("frequencies that do not ascend, or a negative magnitude")
    return frequencies, magnitudes


def compensation_db(frequencies: np.ndarray, magnitudes: np.ndarray, low: float, high: float, depth: float) -> float:
    """The largest gain of the compensation in the band, dB (section 4)."""
    inside = frequencies[(frequencies > low) & (frequencies < high)]
    points = np.concatenate([[low], inside, [high]])
    values = np.interp(points, frequencies, magnitudes)
    largest = float(np.max(values))
    if not largest > 0:
        raise NotATable("all 0 in the band")
    h, floor = np.interp(np.linspace(low, high, 20001), points, values / largest), 10 ** (-depth / 10)
    gains = h / (h * h + floor)
    return 20 * math.log10(float(np.max(gains)))
