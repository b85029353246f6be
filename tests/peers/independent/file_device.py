"""The adapter `org.htex.file` (scene-1.md section 4, *Files*): its settings and its limit.

A reader with other devices asks their adapters (device-abi-1.md).
"""

from __future__ import annotations

from dataclasses import dataclass

from .jsontext import NUMBER, number_of

NAMES = ("file", "org.htex.file")
QUANTITIES = (
    "lateral_force",
    "normal_force",
    "acceleration",
    "velocity",
    "displacement",
    "display_voltage",
    "sound",
)
CHOICES = {
    "format": ("auto", "wav", "csv", "npy", "raw"),
    "encoding": ("f32", "i24", "i16"),
    "quantity": QUANTITIES,
}
RANGES = {"full_scale": (0.000001, 1000.0), "limit_v": (0.0, 1000.0), "carrier_hz": (0.0, 500000.0)}
DEFAULTS = {
    "format": "auto",
    "encoding": "f32",
    "full_scale": 1.0,
    "quantity": "lateral_force",
    "limit_v": 0.0,
    "carrier_hz": 0.0,
}
STEPS = {"i24": 2.0**23, "i16": 2.0**15}
LEAST_RATE_HZ, MOST_RATE_HZ = 100.0, 1e6
LEAST_RATE_OVER_CARRIER = 2.5


@dataclass
class FileDevice:
    """What a file with these settings takes; `limit` is infinite where it has none."""

    quantity: str
    limit: float


def value_of(name: str, value) -> str | float | None:
    """A setting as its kind has it (device-abi-1.md section 3), or None where it cannot be used."""
    if name in CHOICES:
        return value if isinstance(value, str) and value in CHOICES[name] else None
    if name not in RANGES:
        return None
    if isinstance(value, str):
        # Settings are passed as text, with numbers as in JSON.
        value = number_of(value) if NUMBER.fullmatch(value) else None
    low, high = RANGES[name]
    return value if isinstance(value, float) and low <= value <= high else None


def contradiction(settings: dict[str, str | float]) -> str | None:
    """The setting at which settings contradict each other, the first in the order of the table."""
    form, encoding, volts = settings["format"], settings["encoding"], settings["quantity"] == "display_voltage"
    if form == "csv" and encoding != "f32" or form == "npy" and encoding == "i24":
        return "encoding"
    if encoding == "f32" and settings["full_scale"] != 1:
        return "full_scale"
    if (settings["limit_v"] > 0) != volts:
        return "limit_v"
    if settings["carrier_hz"] > 0 and not volts:
        return "carrier_hz"
    return None


def device_of(settings: dict[str, str | float]) -> FileDevice:
    limits = [settings["limit_v"]] if settings["limit_v"] > 0 else []
    if settings["encoding"] in STEPS:
        limits.append(settings["full_scale"] * (1 - 1 / STEPS[settings["encoding"]]))
    return FileDevice(settings["quantity"], min(limits, default=float("inf")))
