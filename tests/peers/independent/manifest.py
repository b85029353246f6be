"""The manifest as JSON: its types, its version and its quantity (htex-1.md sections 2, 3 and 7, htex-reports-1.md section 4)."""

from __future__ import annotations

import re

from . import typed as t
from .findings import Findings, Refused
from .jsontext import parse
from .tables import replace_tables

# quantity: (unit, largest level)
QUANTITIES = {
    "lateral_force": ("N", 1e6),
    "normal_force": ("N", 1e6),
    "acceleration": ("m/s2", 1e6),
    "velocity": ("m/s", 1e4),
    "displacement": ("m", 100.0),
}
MINOR = 1
VERSION = re.compile(r"(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)")
LARGEST_OF_A_VERSION = 2**32 - 1
STEP_STORES = ("u16", "u8", "packed", "coded")

STEPS = t.Object({"scale*": t.Number(), "offset": t.Number(), "log": t.Boolean()})


class Store(t.Any):
    """A word, or an object with one of three keys (section 3)."""

    def check(self, value, pointer):
        if isinstance(value, str):
            t.Word(("f64", "f32")).check(value, pointer)
            return
        if not isinstance(value, dict):
            raise t.Wrong(pointer, "neither a word nor an object")
        kinds = [key for key in value if key in (*STEP_STORES, "f32", "f64")]
        if len(kinds) != 1 or kinds[0] not in STEP_STORES:
            raise t.Wrong(pointer, "not one of u16, u8, packed and coded")
        STEPS.check(value[kinds[0]], f"{pointer}/{kinds[0]}")

    def unknown(self, value, pointer):
        if isinstance(value, dict):
            for key in t.in_order(value):
                if key in STEP_STORES:
                    yield from STEPS.unknown(value[key], f"{pointer}/{key}")
                else:
                    yield f"{pointer}/{t.escape(key)}"


NINE_BANDS = "band_error_db"
CORRELATIONS = ("spectral_correlation", "samples_spectral_correlation")
ERRORS = (
    "band_error_rms_db",
    "band_error_matched_rms_db",
    "third_octave_error_rms_db",
    "log_spectral_distance_db",
    "samples_band_error_rms_db",
    "samples_third_octave_error_rms_db",
    "samples_log_spectral_distance_db",
    "rounding_error_db",
)
QUALITY = t.Object(
    {
        "spectral_correlation*": t.Number(),
        "band_error_db*": t.List(t.Number()),
        "band_error_rms_db*": t.Number(),
        **{key: t.Number() for key in ERRORS[1:]},
        "samples_spectral_correlation": t.Number(),
    }
)
LEFT_OUT = t.Object({"band_error_rms_db*": t.Number(), "third_octave_error_rms_db": t.Number()})
EXPONENT = t.Object(
    {
        "exponent*": t.Number(),
        "source*": t.Word(("measured", "given", "assumed")),
        "estimate": t.Number(),
        "standard_error": t.Number(),
    }
)
PROVENANCE = t.Object(
    {
        "tool": t.Text(),
        "simulated": t.Boolean(),
        "recordings": t.List(
            t.Object({"file*": t.Text(), "rate_hz*": t.Number(), "segments*": t.Integer(), "blake3": t.Text()})
        ),
        "made": t.Object(
            {
                "how*": t.Word(("parameters", "mixed")),
                "from": t.List(t.Object({"name*": t.Text(), "weight*": t.Number(), "blake3*": t.Text()})),
            }
        ),
        "options": t.Map(t.Text()),
        "warnings": t.List(t.Text()),
    }
)
MANIFEST = t.Object(
    {
        "htex*": t.Text(),
        "name*": t.Text(),
        "license": t.Text(),
        "author": t.Text(),
        "tags": t.List(t.Text()),
        "description": t.Text(),
        "source": t.Text(),
        "doi": t.Text(),
        "sensor": t.Text(),
        "finger": t.Text(),
        "contact": t.Word(("finger", "tool", "unknown")),
        "quantity*": t.Word(tuple(QUANTITIES)),
        "unit*": t.Text(),
        "band*": t.Object({"low_hz*": t.Number(), "high_hz*": t.Number()}),
        "provenance": PROVENANCE,
        "conditions*": t.List(
            t.Object(
                {
                    "speed_mm_s": t.Number(),
                    "force_n": t.Number(),
                    "repeatability_rms_db": t.Number(),
                    "repeatability_third_octave_rms_db": t.Number(),
                    "segments": t.Integer(),
                }
            )
        ),
        "law": t.Object({"frequency_speed*": EXPONENT, "level_speed*": EXPONENT, "level_force*": EXPONENT}),
        "fluctuation": t.Object(
            {
                "slow*": t.Integer(0, 255),
                "fast*": t.Integer(0, 255),
                "held_out_error_db": t.Number(),
                "halves_error_db": t.Number(),
            }
        ),
        "representations*": t.List(
            t.Object(
                {
                    "model*": t.Text(),
                    "model_version*": t.Text(),
                    "fields*": t.List(
                        t.Object({"name*": t.Text(), "unit": t.Text(), "list": t.Boolean(), "store": Store()})
                    ),
                    "at*": t.List(
                        t.Object(
                            {
                                "condition*": t.Integer(),
                                "level_rms*": t.Number(),
                                "quality": QUALITY,
                                "left_out": LEFT_OUT,
                            }
                        )
                    ),
                    "triangles": t.List(t.List(t.Integer(), 3)),
                    "parameters*": t.Text(),
                }
            )
        ),
        "reference": t.Object({"file*": t.Text()}),
        "plugins": t.List(
            t.Object(
                {
                    "model*": t.Text(),
                    "version*": t.Text(),
                    "file*": t.Text(),
                    "blake3*": t.Text(),
                    "signature": t.Object({"public_key*": t.Text(), "ed25519*": t.Text()}),
                }
            )
        ),
        "extensions": t.Map(t.Any()),
        "extensions_required": t.List(t.Text()),
    }
)


def check_version(document: dict, key: str, prefix: str, minor: int = 0) -> bool:
    """Section 7: whether the document's minor version is above `minor`; raises `Refused`."""
    if key not in document:
        raise Refused(prefix + "VERSION_MISSING")
    match = VERSION.fullmatch(document[key]) if isinstance(document[key], str) else None
    if not match or any(int(number) > LARGEST_OF_A_VERSION for number in match.groups()):
        raise Refused(prefix + "VERSION_INVALID", f"/{key}")
    if match.group(1) != "1":
        raise Refused(prefix + "VERSION_UNSUPPORTED", f"/{key}")
    return int(match.group(2)) > minor


def read_manifest(data: bytes, limits: dict[str, int], findings: Findings) -> dict | None:
    """The stage of the manifest, and that of unknown keys; None after an error."""
    try:
        return accept(parse(data, limits["json_depth"], nodes=limits["json_nodes"]), limits, findings)
    except Refused as refused:
        findings.items.append(refused.finding)
        return None


def accept(document, limits: dict[str, int], findings: Findings) -> dict:
    """The same after the text was parsed; raises `Refused`."""
    if not isinstance(document, dict):
        raise Refused("JSON_TYPE", "", "no object")
    newer = check_version(document, "htex", "", MINOR)
    if newer:
        findings.add("VERSION_NEWER", "/htex")
    replace_tables(document)
    quantity = document.get("quantity")
    if isinstance(quantity, str) and quantity not in QUANTITIES:
        raise Refused("QUANTITY_UNKNOWN", "/quantity")
    t.check(MANIFEST, document, "JSON_TYPE")
    if len(document["conditions"]) > limits["conditions"]:
        raise Refused("CONDITIONS_TOO_MANY", "/conditions")
    if not newer:
        for pointer in sorted(t.unknown_keys(MANIFEST, document), key=lambda p: p.encode("utf-8")):
            findings.add("JSON_UNKNOWN_KEY", pointer)
    return document
