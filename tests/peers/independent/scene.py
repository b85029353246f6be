"""Validation of scenes: parts 6 to 9 of the order in scene-findings.md, which need other files and the device."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from . import file_device
from . import limits as defaults
from .asset import Asset, read_asset
from .file_device import FileDevice
from .findings import Findings, Refused, escape
from .models import Models
from .playing import Voice
from .response import compensation_db, read_response
from .scene_document import check_document, read_document
from .shapes import Refusal
from .table import NotATable
from .trace import read_trace
from .typed import is_blank

AMPLIFIED_DB = 10.0


def read_scene(path: Path, models: Models, limits: dict[str, int] | None = None) -> Findings:
    """The findings of a scene file."""
    findings = Findings()
    limits = defaults.with_defaults(defaults.SCENE, limits)
    try:
        scene = read_document(path.read_bytes(), limits, findings)
    except Refused as refused:
        findings.items.append(refused.finding)
        return findings
    if scene is not None:
        check_document(scene, limits, findings)
        Files(scene, path.parent, models, findings).check()
    return findings


def short_name(model: str) -> str:
    return model.rsplit(".", 1)[-1]


class Files:
    """The parts that need assets, traces, responses and the device."""

    def __init__(self, scene: dict, folder: Path, models: Models, findings: Findings):
        self.scene, self.folder, self.models, self.findings = scene, folder, models, findings
        self.device = scene.get("device", {})
        self.read: dict[Path, Asset | None] = {}
        self.assets: list[Asset | None] = []
        self.voices: dict[int, Voice] = {}
        self.curve: tuple[np.ndarray, np.ndarray] | None = None

    def check(self) -> None:
        for index, surface in enumerate(self.scene["surfaces"]):
            self.assets.append(self.surface(index, surface))
        self.trace()
        self.response()
        self.open_device()
        if None not in self.assets:
            self.quantities()
        if self.findings.valid:
            self.beyond_recorded()
            self.compensation()

    def nearest(self, *keys: str) -> str:
        """The pointer to a key, or to the nearest value around it that is there."""
        pointer, value = "", self.scene
        for key in keys:
            if key not in value:
                break
            pointer, value = f"{pointer}/{escape(key)}", value[key]
        return pointer

    # Part 6.

    def surface(self, index: int, surface: dict) -> Asset | None:
        """A surface's asset, or None where it cannot be read; its voice is kept."""
        pointer, path = f"/surfaces/{index}", self.folder / surface["asset"]
        if not path.is_file():
            self.findings.add("ASSET_MISSING", pointer + "/asset")
            return None
        if path not in self.read:
            asset, findings = read_asset(path.read_bytes(), self.models)
            self.read[path] = asset if findings.valid else None
        asset = self.read[path]
        if asset is None:
            self.findings.add("ASSET_INVALID", pointer + "/asset")
            return None
        wanted = surface.get("representation", "auto")
        if is_blank(wanted):
            return asset
        names = [r["model"] for r in asset.manifest["representations"]]
        if wanted != "auto":
            names = [name for name in names if wanted in (name, short_name(name))]
            if not names:
                self.findings.add("REPRESENTATION_MISSING", pointer + "/representation")
                return asset
        voice = self.voice(asset, names)
        if voice is not None:
            self.voices[index] = voice
        else:
            key = "/representation" if "representation" in surface else ""
            self.findings.add("REPRESENTATION_UNPLAYABLE", pointer + key)
        return asset

    def voice(self, asset: Asset, names: list[str]) -> Voice | None:
        for name in names:
            if name in self.models:
                try:
                    return Voice(asset, self.models[name])
                except Refusal:
                    continue
        return None

    # Part 7.

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

    def response(self) -> None:
        if "response" not in self.device:
            return
        path, pointer = self.folder / self.device["response"], "/device/response"
        if not path.is_file():
            self.findings.add("RESPONSE_MISSING", pointer)
            return
        try:
            self.curve = read_response(path.read_bytes())
        except NotATable as error:
            self.findings.add("RESPONSE_INVALID", pointer, str(error))

    # Part 8.

    def open_device(self) -> None:
        """The adapter, its settings, and what the device takes."""
        if self.device.get("adapter", "file") not in file_device.NAMES:
            self.findings.add("DEVICE_UNKNOWN", "/device/adapter")
            return
        settings = self.settings()
        if settings is None:
            return
        device = file_device.device_of(settings)
        rate = self.device.get("rate_hz")
        least = max(file_device.LEAST_RATE_HZ, file_device.LEAST_RATE_OVER_CARRIER * settings["carrier_hz"])
        if rate is not None and not least <= rate <= file_device.MOST_RATE_HZ:
            self.findings.add("DEVICE_RATE", "/device/rate_hz")
        self.fields(device)
        self.quantity(device)

    def settings(self) -> dict[str, str | float] | None:
        """All settings, with their defaults; None after one that cannot be used."""
        result = dict(file_device.DEFAULTS)
        given = self.device.get("settings", {})
        names = sorted(given, key=lambda n: n.encode("utf-8"))
        usable = True
        for name in names:
            pointer = f"/device/settings/{escape(name)}"
            if not isinstance(given[name], str | float | bool):
                self.findings.add("DEVICE_SETTING", pointer)
                usable = False
            elif name == "driver":
                self.findings.add("DEVICE_PATH_UNSAFE", pointer)
                usable = False
            elif name == "path":
                self.findings.add("DEVICE_PATH_UNUSED", pointer)
        if not usable:
            return None
        for name in names:
            if name == "path":
                continue
            result[name] = file_device.value_of(name, given[name])
            if result[name] is None:
                self.findings.add("DEVICE_SETTING", f"/device/settings/{escape(name)}")
                return None
        if "profile" in self.device:
            self.findings.add("DEVICE_SETTING", "/device/profile")
            return None
        wrong = file_device.contradiction(result)
        if wrong is not None:
            self.findings.add("DEVICE_SETTING", self.nearest("device", "settings", wrong))
            return None
        return result

    def fields(self, device: FileDevice) -> None:
        """Keys that must not be given for a device of this quantity, and the drive."""
        volts, sound = device.quantity == "display_voltage", device.quantity == "sound"
        own = self.device.get("levels") == "own"
        unfit = {
            "gain_db": volts or sound,
            "drive_v": not volts,
            "level_dbfs": not sound,
            "pitch": not sound,
            "levels": own and not (volts or sound),
            "reference_rms": not own,
        }
        for key, wrong in unfit.items():
            if wrong and key in self.device:
                self.findings.add("DEVICE_FIELD_UNFIT", f"/device/{key}")
        if volts and self.device.get("drive_v", 0.0) > device.limit:
            self.findings.add("DEVICE_DRIVE_TOO_HIGH", "/device/drive_v")

    def quantity(self, device: FileDevice) -> None:
        """The device's quantity against that of the first asset that could be read."""
        held = next((asset.manifest["quantity"] for asset in self.assets if asset is not None), None)
        if held is None:
            return
        takes = "lateral_force" if device.quantity == "display_voltage" else device.quantity
        fits = device.quantity == "sound" or takes == held
        if fits == ("quantity_gain" in self.device):
            self.findings.add("DEVICE_QUANTITY", self.nearest("device", "quantity_gain"))

    # Part 9.

    def quantities(self) -> None:
        for index, asset in enumerate(self.assets):
            if asset.manifest["quantity"] != self.assets[0].manifest["quantity"]:
                self.findings.add("QUANTITIES_DIFFER", f"/surfaces/{index}/asset")

    def beyond_recorded(self) -> None:
        """A constant motion that is played as if it were another one.

        Traces have no finding here: their motion at a row is not computed.
        """
        motion = self.scene["motion"]
        constant = motion.get("constant") if isinstance(motion, dict) else None
        if constant is None:
            return
        speed, force = constant["speed_mm_s"], constant["force_n"]
        effects = self.scene.get("effects", {})
        for index, voice in self.voices.items():
            ratio_v, ratio_f = voice.ratios(speed, force, voice.foot(speed, force))
            clamped = ratio_v > 0 and not 1 / 16 <= ratio_v <= 8
            a, b, c = voice.exponents
            off = effects.get("frequency_scaling") == "off" and ratio_v != 1 and a != 0
            off |= effects.get("level_scaling") == "off" and (ratio_v != 1 and b != 0 or ratio_f != 1 and c != 0)
            if clamped or off:
                self.findings.add("MOTION_BEYOND_RECORDED", "/motion", f"surface {index}")

    def compensation(self) -> None:
        if self.curve is None:
            return
        pitch = self.device.get("pitch", 1.0)
        bands = [asset.manifest["band"] for asset in self.assets]
        low, high = min(b["low_hz"] for b in bands) * pitch, max(b["high_hz"] for b in bands) * pitch
        try:
            gain_db = compensation_db(*self.curve, low, high, self.device.get("response_depth_db", 40.0))
        except NotATable as error:
            self.findings.add("RESPONSE_INVALID", "/device/response", str(error))
            return
        if gain_db > AMPLIFIED_DB:
            self.findings.add("RESPONSE_RAISED", "/device/response", f"by {gain_db:.1f} dB")
