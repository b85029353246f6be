"""Stores of numbers (htex-1.md section 3)."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

SMALLEST_NORMAL = 2.0**-1022
SMALLEST_SHARE = 2.0**-50
LARGEST_STEP = {"u16": 65535, "u8": 255, "packed": 255, "coded": 255}


@dataclass(frozen=True)
class Store:
    kind: str
    scale: float = 1.0
    offset: float = 0.0
    log: bool = False

    @staticmethod
    def of(field: dict) -> "Store":
        value = field.get("store", "f64")
        if isinstance(value, str):
            return Store(value)
        kind = next(key for key in LARGEST_STEP if key in value)
        steps = value[kind]
        return Store(kind, steps["scale"], steps.get("offset", 0.0), steps.get("log", False))

    @property
    def bytes(self) -> int:
        return {"f64": 8, "f32": 4, "u16": 2, "u8": 1, "packed": 0, "coded": 0}[self.kind]

    def value(self, raw: bytes) -> float:
        """The number of `bytes` bytes."""
        if self.kind == "f64":
            return struct.unpack("<d", raw)[0]
        if self.kind == "f32":
            return struct.unpack("<f", raw)[0]
        return self.step(int.from_bytes(raw, "little"))

    def step(self, q: int) -> float:
        exponent = self.offset + self.scale * q
        if not self.log:
            return exponent
        try:
            return math.exp(exponent)
        except OverflowError:
            return math.inf

    def wrong(self) -> str | None:
        """The key of the steps that breaks the rule (`scale` or `offset`), or None."""
        if self.kind not in LARGEST_STEP:
            return None
        if not self.scale > 0:
            return "scale"
        ends = [self.offset, self.offset + self.scale * LARGEST_STEP[self.kind]]
        largest = max(abs(end) for end in ends)
        if self.log:
            values = [self.step(0), self.step(LARGEST_STEP[self.kind])]
            if not all(math.isfinite(v) for v in values) or values[0] < SMALLEST_NORMAL:
                return "offset" if not math.isfinite(values[0]) or values[0] < SMALLEST_NORMAL else "scale"
            largest = max(largest, 1.0)
        if not math.isfinite(largest):
            return "scale"
        return "scale" if self.scale < SMALLEST_SHARE * largest else None
