"""The law of motions outside the conditions (htex-playing-1.md section 5)."""

from __future__ import annotations

import math

LEAST_RATIO, MOST_RATIO = 1 / 16, 8.0
CEILING = 4.0
SOURCES = ("measured", "given", "assumed")


def assumed(contact: str, quantity: str) -> tuple[float, float, float]:
    if contact == "tool":
        return 0.0, 0.43, 0.07
    if contact == "finger":
        return 1.0, {"velocity": 1.0, "acceleration": 2.0}.get(quantity, 0.0), 1.0
    return 0.0, 0.75, 0.5


def exponents(manifest: dict) -> tuple[float, float, float]:
    """a, b and c of an asset."""
    if "law" in manifest:
        law = manifest["law"]
        return tuple(law[key]["exponent"] for key in ("frequency_speed", "level_speed", "level_force"))
    return assumed(manifest.get("contact", "unknown"), manifest["quantity"])


def clamp(ratio: float) -> float:
    return min(max(ratio, LEAST_RATIO), MOST_RATIO)


def power(base: float, exponent: float) -> float:
    if base == 0:
        return 1.0 if exponent == 0 else math.inf if exponent < 0 else 0.0
    return base**exponent


def scaled(level: float, largest: float, factor: float) -> float:
    """A level times its factor, not above 4 times the largest of the representation."""
    if level == 0 or factor <= 1:
        return level * factor if level else 0.0
    return max(level, min(level * factor, CEILING * largest))
