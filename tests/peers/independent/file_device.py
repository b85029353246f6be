"""The adapter `file` (scene-1.md section 4, *Files*)."""

from __future__ import annotations

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
RANGES = {"full_scale": (1e-6, 1e3), "limit_v": (0.0, 1e3), "carrier_hz": (0.0, 5e5)}
LEAST_RATE_HZ, MOST_RATE_HZ = 100.0, 1e6
LEAST_RATE_OVER_CARRIER = 2.5


def allows(name: str, value) -> bool:
    """Whether a setting exists and may have a value; a path is checked elsewhere."""
    if name == "path":
        return isinstance(value, str)
    if name in CHOICES:
        return isinstance(value, str) and value in CHOICES[name]
    low, high = RANGES.get(name, (1.0, 0.0))
    return isinstance(value, float) and low <= value <= high
