"""The stages of validation.md that need the manifest alone."""

from __future__ import annotations

import re

from . import spdx
from . import triangles as stored
from .blocks import grid
from .findings import Findings, escape
from .manifest import CORRELATIONS, ERRORS, NINE_BANDS, QUANTITIES
from .models import Models
from .plugins import signature_is_valid
from .stores import Store
from .tables import CODED

KNOWN_EXTENSIONS = (CODED, "org.htex.hatt/1", "org.htex.appearance/1")
from .typed import is_blank

DOI = re.compile(r"10\.[0-9]{4,9}(\.[0-9]+)*/[!-~]+")
HASH = re.compile(r"[0-9A-Fa-f]{64}")
LOWER_HASH = re.compile(r"[0-9a-f]{64}")
MODEL_ID = re.compile(r"[a-z0-9_-]+(\.[a-z0-9_-]+){2,}")
_NUMBER, _PART = r"(?:0|[1-9][0-9]*)", r"(?:0|[1-9][0-9]*|[0-9]*[a-zA-Z-][0-9a-zA-Z-]*)"
SEMVER = re.compile(
    rf"({_NUMBER})\.({_NUMBER})\.({_NUMBER})(?:-({_PART}(?:\.{_PART})*))?(?:\+[0-9a-zA-Z-]+(?:\.[0-9a-zA-Z-]+)*)?"
)
LARGEST_OF_A_SEMANTIC_VERSION = 2**64 - 1
EXTENSION = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+){2,}/[1-9][0-9]*")


def check_manifest(manifest: dict, models: Models, findings: Findings) -> None:
    """All stages from `the whole texture` to `fields`, in order."""
    check_texture(manifest, findings)
    check_provenance(manifest.get("provenance", {}), findings)
    check_conditions(manifest, findings)
    check_law(manifest.get("law"), findings)
    check_fluctuation(manifest.get("fluctuation", {}), findings)
    check_representations(manifest, findings)
    check_plugins(manifest, findings)
    check_extensions(manifest, findings)
    check_fields(manifest, models, findings)


def check_texture(manifest: dict, findings: Findings) -> None:
    if is_blank(manifest["name"]):
        findings.add("NAME_EMPTY", "/name")
    check_license(manifest, findings)
    if "doi" in manifest and not DOI.fullmatch(manifest["doi"]):
        findings.add("DOI_INVALID", "/doi")
    if manifest["unit"] != QUANTITIES[manifest["quantity"]][0]:
        findings.add("UNIT_UNKNOWN", "/unit")
    if not band_is_valid(manifest["band"]):
        findings.add("BAND_INVALID", "/band")


def check_license(manifest: dict, findings: Findings) -> None:
    if "license" not in manifest:
        findings.add("LICENSE_MISSING")
        return
    try:
        unknown = spdx.first_unknown_id(manifest["license"])
    except spdx.NotAnExpression:
        findings.add("LICENSE_INVALID", "/license")
        return
    if unknown is not None:
        findings.add("LICENSE_UNKNOWN", "/license", unknown)


def band_is_valid(band: dict) -> bool:
    low, high = band["low_hz"], band["high_hz"]
    return 0 < low < high <= 20000 and len(grid(low, high)) > 0


def check_provenance(provenance: dict, findings: Findings) -> None:
    for index, recording in enumerate(provenance.get("recordings", [])):
        pointer = f"/provenance/recordings/{index}"
        if not recording["rate_hz"] > 0:
            findings.add("SOURCE_INVALID", pointer + "/rate_hz")
        if not HASH.fullmatch(recording.get("blake3", "0" * 64)):
            findings.add("SOURCE_INVALID", pointer + "/blake3")
        if "/" in recording["file"] or "\\" in recording["file"]:
            findings.add("SOURCE_PATH", pointer + "/file")
    for index, ingredient in enumerate(provenance.get("made", {}).get("from", [])):
        pointer = f"/provenance/made/from/{index}"
        if not 0 <= ingredient["weight"] <= 1:
            findings.add("MADE_INVALID", pointer + "/weight")
        if not HASH.fullmatch(ingredient["blake3"]):
            findings.add("MADE_INVALID", pointer + "/blake3")


def check_conditions(manifest: dict, findings: Findings) -> None:
    if not manifest["conditions"]:
        findings.add("CONDITIONS_EMPTY", "/conditions")
    seen = set()
    for index, condition in enumerate(manifest["conditions"]):
        pointer = f"/conditions/{index}"
        for key in ("speed_mm_s", "force_n", "repeatability_rms_db", "repeatability_third_octave_rms_db"):
            if condition.get(key, 0.0) < 0:
                findings.add("CONDITION_INVALID", f"{pointer}/{key}")
        motion = (condition.get("speed_mm_s", 0.0), condition.get("force_n", 0.0))
        if motion in seen:
            findings.add("CONDITION_DUPLICATE", pointer)
        seen.add(motion)


def check_law(law: dict | None, findings: Findings) -> None:
    if law is None:
        return
    for name in ("frequency_speed", "level_speed", "level_force"):
        exponent = law[name]
        if not -4 <= exponent["exponent"] <= 4 or exponent.get("standard_error", 0.0) < 0:
            findings.add("LAW_INVALID", f"/law/{name}")


def check_fluctuation(fluctuation: dict, findings: Findings) -> None:
    for key in ("held_out_error_db", "halves_error_db"):
        if not 0 <= fluctuation.get(key, 0.0) <= 100:
            findings.add("FLUCTUATION_INVALID", f"/fluctuation/{key}")


def check_representations(manifest: dict, findings: Findings) -> None:
    if not manifest["representations"]:
        findings.add("REPRESENTATIONS_EMPTY", "/representations")
    ids = set()
    largest = QUANTITIES[manifest["quantity"]][1]
    for index, representation in enumerate(manifest["representations"]):
        pointer = f"/representations/{index}"
        model = representation["model"]
        if not MODEL_ID.fullmatch(model):
            findings.add("MODEL_ID_INVALID", pointer + "/model")
        if model in ids:
            findings.add("MODEL_DUPLICATE", pointer + "/model")
        ids.add(model)
        if not is_semantic(representation["model_version"]):
            findings.add("MODEL_VERSION_INVALID", pointer + "/model_version")
        is_coded = CODED in manifest.get("extensions_required", [])
        check_stored_fields(representation["fields"], is_coded, pointer + "/fields", findings)
        if not representation["at"]:
            findings.add("AT_EMPTY", pointer + "/at")
        check_at(representation["at"], pointer + "/at", len(manifest["conditions"]), largest, findings)
        # An empty list counts as absent.
        if representation.get("triangles"):
            check_triangles(manifest["conditions"], representation, pointer, findings)


def check_stored_fields(fields: list[dict], is_coded: bool, pointer: str, findings: Findings) -> None:
    names = set()
    for index, field in enumerate(fields):
        here = f"{pointer}/{index}"
        if not field["name"]:
            findings.add("FIELD_NAME_EMPTY", here + "/name")
        if field["name"] in names:
            findings.add("FIELD_DUPLICATE", here + "/name")
        names.add(field["name"])
        store = Store.of(field)
        misplaced = store.kind == "packed" and not field.get("list") or store.kind == "coded" and not is_coded
        if store.wrong() or misplaced:
            findings.add("STORE_INVALID", here + "/store")


def check_at(at: list[dict], pointer: str, conditions: int, largest: float, findings: Findings) -> None:
    seen = set()
    for index, element in enumerate(at):
        here = f"{pointer}/{index}"
        if element["condition"] >= conditions:
            findings.add("CONDITION_INDEX_INVALID", here + "/condition")
        elif element["condition"] in seen:
            findings.add("CONDITION_INDEX_DUPLICATE", here + "/condition")
        seen.add(element["condition"])
        if not 0 <= element["level_rms"] <= largest:
            findings.add("LEVEL_INVALID", here + "/level_rms")
        check_measures(element.get("quality", {}), here + "/quality", findings)
        check_measures(element.get("left_out", {}), here + "/left_out", findings)


# No text lists these codes: they are those that tell of conditions or of their indices.
OF_CONDITIONS = {"CONDITIONS_EMPTY", "CONDITION_INVALID", "CONDITION_DUPLICATE"}
OF_INDICES = {"CONDITION_INDEX_INVALID", "CONDITION_INDEX_DUPLICATE"}


def check_triangles(conditions: list[dict], representation: dict, pointer: str, findings: Findings) -> None:
    """The first fault of stored triangles (*Triangles* in section 2)."""
    fault = stored.fault_of_indices(representation["triangles"], len(representation["at"]))
    if fault is None:
        indices = [int(element["condition"]) for element in representation["at"]]
        motions = [stored.motion_of(conditions[index]) for index in indices if index < len(conditions)]
        if any(None in motion for motion in motions):
            fault = ""
        elif not any(
            finding.code in OF_CONDITIONS
            or finding.code in OF_INDICES
            and finding.pointer.startswith(pointer + "/")
            for finding in findings.items
        ):
            fault = stored.fault_of_cover(stored.scaled(motions), representation["triangles"])
    if fault is not None:
        findings.add("TRIANGLES_INVALID", f"{pointer}/triangles{fault}")


def check_measures(measures: dict, pointer: str, findings: Findings) -> None:
    """The numbers of `quality` or `left_out`, in the order of the table."""
    order = ("spectral_correlation", NINE_BANDS, *ERRORS[:4], "samples_spectral_correlation", *ERRORS[4:])
    for key in order:
        if key not in measures:
            continue
        value = measures[key]
        if key == NINE_BANDS:
            wrong = len(value) != 9
        elif key in CORRELATIONS:
            wrong = not -1 <= value <= 1
        else:
            wrong = value < 0
        if wrong:
            findings.add("QUALITY_INVALID", f"{pointer}/{key}")


def check_plugins(manifest: dict, findings: Findings) -> None:
    represented = {representation["model"] for representation in manifest["representations"]}
    ids = set()
    for index, plugin in enumerate(manifest.get("plugins", [])):
        pointer = f"/plugins/{index}"
        model = plugin["model"]
        if not MODEL_ID.fullmatch(model):
            findings.add("PLUGIN_INVALID", pointer + "/model")
        if not is_semantic(plugin["version"]):
            findings.add("PLUGIN_INVALID", pointer + "/version")
        if plugin["file"] != f"plugins/{model}.wasm":
            findings.add("PLUGIN_INVALID", pointer + "/file")
        if not LOWER_HASH.fullmatch(plugin["blake3"]):
            findings.add("PLUGIN_INVALID", pointer + "/blake3")
        if model in ids:
            findings.add("PLUGIN_DUPLICATE", pointer + "/model")
        ids.add(model)
        if model not in represented:
            findings.add("PLUGIN_UNUSED", pointer + "/model")
        if "signature" in plugin and not signature_is_valid(plugin):
            findings.add("PLUGIN_SIGNATURE_INVALID", pointer + "/signature")


def check_extensions(manifest: dict, findings: Findings) -> None:
    for name in sorted(manifest.get("extensions", {}), key=lambda n: n.encode("utf-8")):
        if not EXTENSION.fullmatch(name):
            findings.add("EXTENSION_NAME_INVALID", f"/extensions/{escape(name)}")
    for index, name in enumerate(manifest.get("extensions_required", [])):
        if name in KNOWN_EXTENSIONS:
            continue
        findings.add("EXTENSION_REQUIRED_UNKNOWN", f"/extensions_required/{index}")


def is_semantic(version: str) -> bool:
    return version_key(version) is not None


def version_key(version: str):
    """A key that orders semantic versions, or None where it is none."""
    match = SEMVER.fullmatch(version)
    if not match or any(int(match.group(i)) > LARGEST_OF_A_SEMANTIC_VERSION for i in (1, 2, 3)):
        return None
    release = tuple(int(match.group(i)) for i in (1, 2, 3))
    if match.group(4) is None:
        return (release, 1, ())
    parts = tuple((0, int(p), "") if p.isdigit() else (1, 0, p) for p in match.group(4).split("."))
    return (release, 0, parts)


def check_fields(manifest: dict, models: Models, findings: Findings) -> None:
    """Stored fields against the descriptor's, then absent ones."""
    for index, representation in enumerate(manifest["representations"]):
        model = models.get(representation["model"])
        if model is None:
            continue
        fitted = version_key(representation["model_version"])
        own = version_key(model["version"])
        if fitted is None or fitted[0][0] != own[0][0]:
            continue
        newer = fitted > own
        described = {field["name"]: field for field in model["fields"]}
        pointer = f"/representations/{index}/fields"
        for number, field in enumerate(representation["fields"]):
            check_field(field, described.get(field["name"]), newer, f"{pointer}/{number}", findings)
        stored = {field["name"] for field in representation["fields"]}
        for name, field in described.items():
            if name not in stored and "default" not in field:
                findings.add("FIELD_MISSING", pointer, name)


def check_field(field: dict, described: dict | None, newer: bool, pointer: str, findings: Findings) -> None:
    if described is None:
        if not newer:
            findings.add("FIELD_UNKNOWN", pointer + "/name")
        return
    if field.get("list", False) != (described["kind"]["type"] == "list"):
        findings.add("FIELD_KIND_WRONG", pointer)
        return
    expected = None if described["unit"] == "1" else described["unit"]
    if (field.get("unit") or None) != expected:
        findings.add("FIELD_UNIT_WRONG", pointer)
