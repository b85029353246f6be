"""Validation of libraries (htexlib-1.md section 9)."""

from __future__ import annotations

import bisect
import struct
import zlib
from dataclasses import dataclass

from blake3 import blake3

from . import limits as defaults
from .asset import read_asset
from .findings import Findings, Refused
from .law import SOURCES, exponents
from .models import Models
from .pages import MINOR, Entry, Root, most_in_file, name_is_allowed, one_file, read_leaf, read_root, read_spectra, start, unpack

SIGNATURE = bytes.fromhex("8948544c0d0a1a0a")
HEADER_BYTES = 128
CONTACTS = ("finger", "tool", "unknown")


class Ended(Exception):
    """The validation ends here."""


@dataclass
class Header:
    root: tuple[int, int]
    leaves: tuple[int, int]
    shared: tuple[int, int]
    payload: tuple[int, int]
    entries: int
    leaf_count: int
    index_hash: bytes
    minor: int


def read_header(data: bytes, limits: dict[str, int], findings: Findings) -> Header:
    """Stage 1; raises `Refused`."""
    if not data or not SIGNATURE.startswith(data[:8]):
        raise Refused("LIBRARY_UNRECOGNISED", "/header")
    if len(data) < HEADER_BYTES:
        raise Refused("LIBRARY_TRUNCATED")
    major, minor = struct.unpack_from("<HH", data, 8)
    if major != 1:
        raise Refused("LIBRARY_VERSION_UNSUPPORTED", "/header")
    newer = minor > MINOR
    if newer:
        findings.add("LIBRARY_VERSION_NEWER", "/header")
    if zlib.crc32(data[:124]) != struct.unpack_from("<I", data, 124)[0]:
        raise Refused("LIBRARY_HEADER_CHECKSUM", "/header")
    if any(data[12:16]) and not newer:
        raise Refused("LIBRARY_HEADER_INVALID", "/header", "reserved bytes")
    numbers = struct.unpack_from("<QQQQQQQQQI", data, 16)
    parts = [tuple(numbers[i : i + 2]) for i in (0, 2, 4, 6)]
    end = HEADER_BYTES
    for start, length in parts:
        if start != end:
            raise Refused("LIBRARY_HEADER_INVALID", "/header", "a gap between parts")
        end += length
        if end >= 1 << 64:
            raise Refused("LIBRARY_HEADER_INVALID", "/header", "an end beyond 2^64")
    if len(data) != end:
        raise Refused("LIBRARY_TRUNCATED" if len(data) < end else "LIBRARY_EXTRA_DATA")
    entries, leaf_count = numbers[8], numbers[9]
    if entries > limits["entries"]:
        raise Refused("LIBRARY_ENTRIES_TOO_MANY", "/header")
    if leaf_count > limits["leaves"]:
        raise Refused("LIBRARY_LEAVES_TOO_MANY", "/header")
    if bool(entries) != bool(leaf_count) or leaf_count > entries:
        raise Refused("LIBRARY_HEADER_INVALID", "/header", "leaves and entries")
    if parts[0][1] > most_in_file(limits["root_bytes"]):
        raise Refused("LIBRARY_PAGE_TOO_LARGE", "/root")
    return Header(*parts, entries, leaf_count, data[92:124], minor)


def read_library(data: bytes, models: Models, limits: dict[str, int] | None = None) -> Findings:
    findings = Findings()
    try:
        limits = defaults.with_defaults(defaults.LIBRARY, limits)
        header = read_header(data, limits, findings)
        page = data[header.root[0] : sum(header.root)]
        contents = unpack(page, limits["root_bytes"], "/root")
        parts = (header.leaf_count, header.leaves[1], header.shared[1], header.minor)
        root = read_root(contents, *parts, limits["leaf_bytes"])
        Validator(data, header, root, models, limits, findings).run()
    except Refused as refused:
        findings.items.append(refused.finding)
    except Ended:
        pass
    return findings


class Validator:
    """Stages 3 to 5."""

    def __init__(self, data: bytes, header: Header, root: Root, models: Models, limits: dict, findings: Findings):
        self.data, self.header, self.root, self.models = data, header, root, models
        self.limits, self.findings = limits, findings
        self.names: set[str] = set()
        self.objects: list[tuple[int, int]] = []
        self.total = self.count = 0
        self.own_end: int | None = 0
        self.sizes: list[int | None] = []
        self.objects_length = header.shared[1] - sum(root.spectra)

    def run(self) -> None:
        at, complete = self.header.leaves[0], True
        for number, length in enumerate(self.root.lengths):
            pointer = f"/leaves/{number}"
            page = self.data[at : at + length]
            at += length
            try:
                entries = self.leaf(page, number, pointer)
            except Refused as refused:
                self.findings.items.append(refused.finding)
                complete, self.own_end = False, None
                self.sizes.append(None)
                continue
            self.sizes.append(len(entries))
            for index, entry in enumerate(entries):
                self.entry(entry, f"{pointer}/entries/{index}")
        self.whole(complete)

    def leaf(self, page: bytes, number: int, pointer: str) -> list[Entry]:
        """Stage 3."""
        entries = read_leaf(unpack(page, self.limits["leaf_bytes"], pointer), pointer, self.header.minor)
        before = None
        separators = self.root.separators
        for index, entry in enumerate(entries):
            here, name = f"{pointer}/entries/{index}", entry.name.encode("utf-8")
            if not name_is_allowed(entry.name):
                raise Refused("LIBRARY_NAME_INVALID", here)
            outside = name < separators[number] or number + 1 < len(separators) and name >= separators[number + 1]
            if outside or before is not None and name <= before:
                raise Refused("LIBRARY_ORDER_INVALID", here)
            before = name
        for index, entry in enumerate(entries):
            self.check_range(entry, f"{pointer}/entries/{index}")
        return entries

    def check_range(self, entry: Entry, pointer: str) -> None:
        if entry.start + entry.length > self.header.payload[1]:
            raise Refused("LIBRARY_RANGE_INVALID", pointer)
        if sum(item.gap for item in entry.objects) > entry.length:
            raise Refused("LIBRARY_RANGE_INVALID", pointer)
        if any(item.start + item.length > self.objects_length for item in entry.objects):
            raise Refused("LIBRARY_RANGE_INVALID", pointer)
        if entry.size > self.limits["asset_bytes"]:
            raise Refused("LIBRARY_ASSET_TOO_LARGE", pointer)

    def entry(self, entry: Entry, pointer: str) -> None:
        """Stage 4."""
        self.count += 1
        self.total += entry.size
        if self.total > self.limits["ratio"] * len(self.data):
            self.findings.add("LIBRARY_RATIO", pointer)
            raise Ended
        file = one_file(entry.name)
        if file in self.names:
            self.findings.add("LIBRARY_NAMES_ALIKE", pointer)
        self.names.add(file)
        if self.own_end is not None and entry.start != self.own_end:
            self.findings.add("LIBRARY_RANGE_INVALID", pointer, "own bytes")
        self.own_end = entry.start + entry.length
        self.share(entry, pointer)
        texture = self.texture(entry)
        if blake3(texture).digest() != entry.hash:
            self.findings.add("LIBRARY_ASSET_CHANGED", pointer)
            return
        asset, findings = read_asset(texture, self.models)
        if not findings.valid:
            self.findings.add("LIBRARY_ASSET_INVALID", pointer)
            return
        own = stated(asset.manifest)
        pairs = [
            ("tags", entry.tags, own.tags),
            ("models", entry.models, own.models),
            ("conditions", entry.conditions, own.conditions),
            ("contact", entry.law[0][0], own.law[0][0]),
            ("law", (entry.law[0][1:], entry.law[1]), (own.law[0][1:], own.law[1])),
        ]
        # A library of version 1.0 does not state the others.
        if entry.rights is not None:
            pairs += zip(("licence", "author", "quantity"), entry.rights, own.rights)
        for what, theirs, ours in pairs:
            if theirs != ours:
                self.findings.add("LIBRARY_ENTRY_WRONG", pointer, what)

    def share(self, entry: Entry, pointer: str) -> None:
        for item in entry.objects:
            place = (item.start, item.start + item.length)
            index = bisect.bisect_left(self.objects, place)
            if index < len(self.objects) and self.objects[index] == place:
                continue
            before = self.objects[index - 1] if index else (0, 0)
            after = self.objects[index] if index < len(self.objects) else (place[1], 0)
            if before[1] > place[0] or place[1] > after[0]:
                self.findings.add("LIBRARY_RANGE_INVALID", pointer, "objects overlap")
                return
            self.objects.insert(index, place)
            if len(self.objects) > self.limits["objects"]:
                self.findings.add("LIBRARY_OBJECTS_TOO_MANY", pointer)
                raise Ended

    def texture(self, entry: Entry) -> bytes:
        """Its own bytes with the objects inserted."""
        at, shared = self.header.payload[0] + entry.start, self.header.shared[0]
        end, parts = at + entry.length, []
        for item in entry.objects:
            parts.append(self.data[at : at + item.gap])
            parts.append(self.data[shared + item.start : shared + item.start + item.length])
            at += item.gap
        return b"".join([*parts, self.data[at:end]])

    def spectra(self) -> None:
        """The pages of spectra, in stage 5."""
        at = start = self.header.shared[0] + self.objects_length
        for number, length in enumerate(self.root.spectra):
            pointer, page = f"/spectra/{number}", self.data[at : at + length]
            at += length
            if not length:
                continue
            try:
                count = read_spectra(unpack(page, self.limits["leaf_bytes"], pointer), pointer)
                if self.sizes[number] not in (None, count):
                    self.findings.add("LIBRARY_COUNT_WRONG", pointer)
            except Refused as refused:
                self.findings.items.append(refused.finding)
        if self.root.spectra_hash not in (None, blake3(self.data[start:at]).digest()):
            self.findings.add("LIBRARY_INDEX_CHANGED", "/root")

    def whole(self, complete: bool) -> None:
        """Stage 5."""
        index = self.data[self.header.root[0] : sum(self.header.leaves)]
        if blake3(index).digest() != self.header.index_hash:
            self.findings.add("LIBRARY_INDEX_CHANGED", "/header")
        self.spectra()
        if not complete:
            return
        if self.count != self.header.entries:
            self.findings.add("LIBRARY_COUNT_WRONG", "/header")
        if self.own_end != self.header.payload[1]:
            self.findings.add("LIBRARY_RANGE_INVALID", "/header", "the payload does not end with own bytes")
        if self.header.minor <= MINOR and sum(end - start for start, end in self.objects) != self.objects_length:
            self.findings.add("LIBRARY_OBJECT_UNUSED", "/header")


def rights(manifest: dict) -> tuple:
    """Licence, author and quantity, as an entry states them."""
    return start(manifest.get("license")), start(manifest.get("author")), manifest["quantity"]


def stated(manifest: dict) -> Entry:
    """What an entry of a texture states."""
    ranges = []
    for key in ("speed_mm_s", "force_n"):
        recorded = [condition for condition in manifest["conditions"] if condition.get("segments") != 0]
        known = [abs(condition[key]) for condition in recorded if key in condition]
        ranges.append((min(known), max(known)) if known else None)
    law = manifest.get("law")
    names = ("frequency_speed", "level_speed", "level_force")
    sources = [SOURCES.index(law[name]["source"]) if law else 2 for name in names]
    codes = (CONTACTS.index(manifest.get("contact", "unknown")), *sources)
    models = [representation["model"] for representation in manifest["representations"]]
    entry = Entry(tags=manifest.get("tags", []), models=models, conditions=tuple(ranges))
    entry.law, entry.rights = (codes, exponents(manifest)), rights(manifest)
    return entry
