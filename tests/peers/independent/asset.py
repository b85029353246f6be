"""Validation of a whole asset, in the stages of validation.md."""

from __future__ import annotations

from dataclasses import dataclass, field

from blake3 import blake3

from . import limits as defaults
from .archive import check_mimetype, read_archive
from .blocks import BlockError, Budget, read_block, read_reference
from .checks import band_is_valid, check_manifest
from .findings import Findings
from .manifest import read_manifest
from .models import Models

WASM = bytes.fromhex("0061736d")
CONTAINER = ("mimetype", "manifest.json")


@dataclass
class Asset:
    """What was read; `blocks` has the parameters of each representation, or None."""

    manifest: dict | None = None
    entries: dict[str, bytes] = field(default_factory=dict)
    blocks: list[list | None] = field(default_factory=list)
    reference: list[list[float]] | None = None


def read_asset(data: bytes, models: Models, limits: dict[str, int] | None = None) -> tuple[Asset, Findings]:
    """An asset's contents and findings."""
    limits = defaults.with_defaults(defaults.ASSET, limits)
    findings, asset = Findings(), Asset()
    contents = read_archive(data, limits, findings)
    if contents is None:
        return asset, findings
    check_mimetype(contents, findings)
    asset.entries = {entry.name: unpacked for entry, unpacked in contents}
    if "manifest.json" not in asset.entries:
        findings.add("MANIFEST_MISSING")
        return asset, findings
    manifest = read_manifest(asset.entries["manifest.json"], limits, findings)
    if manifest is None:
        return asset, findings
    asset.manifest = manifest
    check_manifest(manifest, models, findings)
    Entries(asset, limits, findings).check()
    return asset, findings


class Entries:
    """The stages about entries that the manifest names."""

    def __init__(self, asset: Asset, limits: dict[str, int], findings: Findings):
        self.asset, self.findings = asset, findings
        self.budget = Budget(limits["values"])
        self.used: set[str] = set(CONTAINER)

    def check(self) -> None:
        manifest = self.asset.manifest
        for index, representation in enumerate(manifest["representations"]):
            self.asset.blocks.append(self.block(representation, f"/representations/{index}/parameters"))
        if "reference" in manifest:
            self.reference(manifest)
        for index, plugin in enumerate(manifest.get("plugins", [])):
            self.module(plugin, f"/plugins/{index}")
        for name in self.asset.entries:
            if name not in self.used:
                self.findings.add("ENTRY_UNREFERENCED", "", name)

    def claim(self, name: str, pointer: str) -> bytes | None:
        """The data of an entry that is there and that no other part uses."""
        if name not in self.asset.entries:
            self.findings.add("ENTRY_MISSING", pointer)
            return None
        if name in self.used:
            self.findings.add("PARAMETERS_ENTRY_INVALID", pointer)
            return None
        self.used.add(name)
        return self.asset.entries[name]

    def block(self, representation: dict, pointer: str):
        data = self.claim(representation["parameters"], pointer)
        if data is None:
            return None
        try:
            return read_block(data, representation["fields"], len(representation["at"]), self.budget)
        except BlockError as error:
            self.findings.add(error.code, pointer, str(error))
            return None

    def reference(self, manifest: dict) -> None:
        pointer = "/reference/file"
        data = self.claim(manifest["reference"]["file"], pointer)
        band = manifest["band"]
        if data is None or not band_is_valid(band):
            return
        try:
            self.asset.reference = read_reference(
                data, band["low_hz"], band["high_hz"], len(manifest["conditions"]), self.budget
            )
        except BlockError as error:
            self.findings.add(error.code, pointer, str(error))

    def module(self, plugin: dict, pointer: str) -> None:
        data = self.claim(plugin["file"], pointer + "/file")
        if data is None:
            return
        if not data.startswith(WASM):
            self.findings.add("PLUGIN_NOT_WASM", pointer + "/file")
        if blake3(data).hexdigest() != plugin["blake3"]:
            self.findings.add("PLUGIN_HASH_MISMATCH", pointer + "/blake3")

