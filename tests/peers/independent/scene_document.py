"""The document of a scene: parts 1 to 5 of the order in scene-findings.md, which need no other files."""

from __future__ import annotations

from . import typed as t
from .findings import Findings, Refused
from .jsontext import parse
from .manifest import check_version

EFFECTS = (
    "interpolation frequency_scaling level_scaling fluctuation crossfade compensation resampling direction gain square_root"
    " contact carrier limiter dither quantisation"
).split()
PAIR = t.List(t.Number(), 2)
FAR_MM = 1e6


class Motion(t.Any):
    """`live`, or an object with one of `constant` and `trace`."""

    kinds = {
        "constant": t.Object(
            {"speed_mm_s*": t.Number(), "force_n*": t.Number(), "from_mm": PAIR, "direction_deg": t.Number()}
        ),
        "trace": t.Text(),
    }

    def check(self, value, pointer):
        if isinstance(value, str):
            t.Word(("live",)).check(value, pointer)
            return
        if not isinstance(value, dict):
            raise t.Wrong(pointer, "neither a word nor an object")
        found = [key for key in t.in_order(value) if key in self.kinds]
        for key in found:
            self.kinds[key].check(value[key], f"{pointer}/{key}")
        if len(found) != 1:
            raise t.Wrong(pointer, "not one of constant and trace")

    def unknown(self, value, pointer):
        if isinstance(value, dict):
            yield from t.Object(self.kinds).unknown(value, pointer)


SCENE = t.Object(
    {
        "htex_scene*": t.Text(),
        "surfaces*": t.List(
            t.Object(
                {
                    "asset*": t.Text(),
                    "region": t.Object({"x_mm*": PAIR, "y_mm*": PAIR}),
                    "layer": t.Integer(-(2.0**31), 2.0**31 - 1),
                    "gain": t.Number(),
                    "representation": t.Text(),
                }
            )
        ),
        "motion*": Motion(),
        "device": t.Object(
            {
                "adapter": t.Text(),
                "profile": t.Text(),
                "settings": t.Map(t.Any()),
                "rate_hz": t.Number(),
                "gain_db": t.Number(),
                "quantity_gain": t.Number(),
                "drive_v": t.Number(),
                "level_dbfs": t.Number(),
                "levels": t.Word(("normalised", "own")),
                "reference_rms": t.Number(),
                "pitch": t.Number(),
                "response": t.Text(),
                "response_depth_db": t.Number(),
            }
        ),
        "duration_s": t.Number(),
        "seed": t.Integer(),
        "budget": t.Object(
            {
                "ns_per_sample": t.Number(),
                "max_error_db": t.Number(),
                "error": t.Word(("nine_band", "third_octave", "log_spectral")),
            }
        ),
        "effects": t.Object({name: t.Word(("auto", "on", "off")) for name in EFFECTS}),
    }
)

# key: (low, high, whether low itself is in range)
DEVICE_RANGES = {
    "rate_hz": (0, 1e7, False),
    "gain_db": (-120, 120, True),
    "quantity_gain": (1e-9, 1e9, True),
    "drive_v": (0, 1e4, False),
    "level_dbfs": (-120, 0, True),
    "reference_rms": (1e-12, 1e6, True),
    "pitch": (0.05, 20, True),
    "response_depth_db": (0, 120, True),
}


def in_range(value: float, low: float, high: float, closed: bool = True) -> bool:
    return (low <= value if closed else low < value) and value <= high


def read_document(data: bytes, limits: dict[str, int], findings: Findings) -> dict | None:
    """Parts 1 and 2: the scene with valid types, or None after unknown effects; raises `Refused`."""
    if len(data) > limits["file_bytes"]:
        raise Refused("SCENE_FILE_TOO_LARGE")
    document = parse(data, limits["json_depth"], "SCENE_JSON_")
    if not isinstance(document, dict):
        raise Refused("SCENE_JSON_TYPE", "", "no object")
    newer = check_version(document, "htex_scene", "SCENE_")
    if newer:
        findings.add("SCENE_VERSION_NEWER", "/htex_scene")
    effects = document.get("effects")
    if isinstance(effects, dict):
        for name in t.in_order(effects):
            if name not in EFFECTS and not newer:
                findings.add("EFFECT_UNKNOWN", f"/effects/{t.escape(name)}")
    t.check(SCENE, document, "SCENE_JSON_TYPE")
    if findings.has_errors():
        return None
    if not newer:
        for pointer in t.unknown_keys(SCENE, document):
            findings.add("SCENE_UNKNOWN_KEY", pointer)
    return document


def check_document(scene: dict, limits: dict[str, int], findings: Findings) -> None:
    """Parts 3 to 5."""
    surfaces = scene["surfaces"]
    if not surfaces:
        findings.add("SURFACES_EMPTY", "/surfaces")
    if len(surfaces) > limits["surfaces"]:
        findings.add("SURFACES_TOO_MANY", "/surfaces")
    else:
        for index, surface in enumerate(surfaces):
            check_surface(surface, f"/surfaces/{index}", findings)
        check_overlaps(surfaces, findings)
    check_motion(scene, findings)
    device = scene.get("device", {})
    for key, (low, high, closed) in DEVICE_RANGES.items():
        if key in device and not in_range(device[key], low, high, closed):
            findings.add("DEVICE_FIELD_INVALID", f"/device/{key}")
    if "duration_s" in scene and not in_range(scene["duration_s"], 0, 1e9, False):
        findings.add("DURATION_INVALID", "/duration_s")
    for key in ("ns_per_sample", "max_error_db"):
        if key in scene.get("budget", {}) and not in_range(scene["budget"][key], 0, 1e12, False):
            findings.add("BUDGET_INVALID", f"/budget/{key}")


def check_surface(surface: dict, pointer: str, findings: Findings) -> None:
    if not in_range(surface.get("gain", 1.0), 0, 1000):
        findings.add("SURFACE_GAIN_INVALID", pointer + "/gain")
    if t.is_blank(surface.get("representation", "auto")):
        findings.add("REPRESENTATION_NAME_EMPTY", pointer + "/representation")
    for key in ("x_mm", "y_mm") if "region" in surface else ():
        low, high = surface["region"][key]
        if not -FAR_MM <= low < high <= FAR_MM:
            findings.add("REGION_INVALID", f"{pointer}/region/{key}")


def box(surface: dict) -> list[tuple[float, float]]:
    region = surface.get("region")
    return [tuple(region[key]) if region else (-FAR_MM * 2, FAR_MM * 2) for key in ("x_mm", "y_mm")]


def check_overlaps(surfaces: list[dict], findings: Findings) -> None:
    for later, surface in enumerate(surfaces):
        for earlier in surfaces[:later]:
            if earlier.get("layer", 0) != surface.get("layer", 0):
                continue
            pairs = zip(box(earlier), box(surface))
            if all(a[0] < b[1] and b[0] < a[1] for a, b in pairs):
                findings.add("REGION_OVERLAP", f"/surfaces/{later}")
                break


def check_motion(scene: dict, findings: Findings) -> None:
    motion = scene["motion"]
    constant = motion.get("constant") if isinstance(motion, dict) else None
    if constant is None:
        return
    pointer = "/motion/constant"
    if not in_range(constant["speed_mm_s"], 0, 1e4):
        findings.add("MOTION_INVALID", pointer + "/speed_mm_s")
    if not in_range(constant["force_n"], 0, 1000):
        findings.add("MOTION_INVALID", pointer + "/force_n")
    if any(not in_range(x, -FAR_MM, FAR_MM) for x in constant.get("from_mm", [])):
        findings.add("MOTION_INVALID", pointer + "/from_mm")
    if not in_range(constant.get("direction_deg", 0.0), -3600, 3600):
        findings.add("MOTION_INVALID", pointer + "/direction_deg")
    surfaces = scene["surfaces"]
    if surfaces and "from_mm" not in constant and not (len(surfaces) == 1 and "region" not in surfaces[0]):
        findings.add("REGION_UNKNOWN_POSITION", pointer)
