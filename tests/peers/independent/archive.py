"""The container (htex-1.md section 1, htex-reports-1.md section 3)."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass

from .findings import Findings, Refused

END, DIRECTORY, LOCAL, LOCATOR = b"PK\5\6", b"PK\1\2", b"PK\3\4", b"PK\6\7"
END_BYTES, DIRECTORY_BYTES, LOCAL_BYTES = 22, 46, 30
END_SEARCH = 65557
# Bits 0, 6 and 13, and bit 3.
FLAGS_ENCRYPTED, FLAG_DESCRIPTOR = 0x2041, 8
STORED, DEFLATED = 0, 8
MIMETYPE = b"application/vnd.htex+zip"


@dataclass
class Entry:
    """A record of the directory, and where its data are."""

    name: str
    flags: int
    method: int
    time: bytes
    crc: int
    packed: int
    size: int
    offset: int
    extra: int
    comment: int
    disk: int
    data_at: int = 0


@dataclass
class End:
    count: int
    directory_size: int
    directory_at: int
    at: int


def read_archive(data: bytes, limits: dict[str, int], findings: Findings) -> list[tuple[Entry, bytes]] | None:
    """The entries with their unpacked data, or None after an error."""
    try:
        end = find_end(data, limits)
    except Refused as refused:
        findings.items.append(refused.finding)
        return None
    entries = read_directory(data, end, limits, findings)
    if findings.has_errors():
        return None
    contents = []
    for entry in entries:
        unpacked = unpack(data[entry.data_at : entry.data_at + entry.packed], entry)
        if unpacked is None:
            findings.add("ENTRY_CORRUPT", "", entry.name)
        contents.append((entry, unpacked))
    return None if findings.has_errors() else contents


def find_end(data: bytes, limits: dict[str, int]) -> End:
    """The first stage: the file and the end record; the first finding is raised."""
    if len(data) > limits["file_bytes"]:
        raise Refused("FILE_TOO_LARGE")
    at = data.rfind(END, max(0, len(data) - END_SEARCH))
    # A record that is cut off is none; an earlier one may be whole.
    while at >= 0 and at + END_BYTES > len(data):
        at = data.rfind(END, max(0, len(data) - END_SEARCH), at + 3)
    if at < 0:
        raise Refused("ARCHIVE_INVALID", "", "no end record")
    disk, start_disk, here, count, size, offset, comment = struct.unpack_from("<HHHHIIH", data, at + 4)
    locator = at >= 20 and data[at - 20 : at - 16] == LOCATOR
    if locator or 0xFFFF in (disk, start_disk, here, count) or 0xFFFFFFFF in (size, offset):
        raise Refused("ARCHIVE_ZIP64")
    if at + END_BYTES != len(data):
        raise Refused("ARCHIVE_EXTRA_DATA", "", "bytes after the end record")
    if disk or start_disk or here != count or comment or offset + size > at:
        raise Refused("ARCHIVE_INVALID", "", "the end record contradicts a single archive")
    if offset + size < at:
        raise Refused("ARCHIVE_EXTRA_DATA", "", "bytes between directory and end record")
    if count > limits["entries"]:
        raise Refused("ARCHIVE_TOO_MANY_ENTRIES")
    return End(count, size, offset, at)


def read_directory(data: bytes, end: End, limits: dict[str, int], findings: Findings) -> list[Entry]:
    """The second stage: each record with its local header, then all together."""
    entries: list[Entry] = []
    names: set[str] = set()
    at, position, total = end.directory_at, 0, 0
    for _ in range(end.count):
        entry, after = directory_record(data, at, end.at)
        if entry is None:
            findings.add("ARCHIVE_INVALID", "", "a record of the directory")
            return entries
        at = after
        check_record(entry, names, limits, findings)
        next_position = check_local(data, entry, position, findings)
        if next_position is None:
            return entries
        position = next_position
        total += entry.size
        entries.append(entry)
    if at != end.at:
        findings.add("ARCHIVE_INVALID", "", "the records do not end where the directory does")
    elif position != end.directory_at:
        findings.add("ARCHIVE_EXTRA_DATA", "", "bytes between the last entry and the directory")
    if total > limits["total_bytes"]:
        findings.add("ARCHIVE_TOO_LARGE")
    return entries


def directory_record(data: bytes, at: int, limit: int) -> tuple[Entry | None, int]:
    if at + DIRECTORY_BYTES > limit or data[at : at + 4] != DIRECTORY:
        return None, at
    flags, method = struct.unpack_from("<HH", data, at + 8)
    crc, packed, size, name, extra, comment, disk = struct.unpack_from("<IIIHHHH", data, at + 16)
    (offset,) = struct.unpack_from("<I", data, at + 42)
    after = at + DIRECTORY_BYTES + name + extra + comment
    if after > limit:
        return None, at
    text = data[at + DIRECTORY_BYTES : at + DIRECTORY_BYTES + name].decode("latin-1")
    time = data[at + 12 : at + 16]
    return Entry(text, flags, method, time, crc, packed, size, offset, extra, comment, disk), after


def name_is_safe(name: str) -> bool:
    """Item 4 of section 1."""
    if any(not " " <= char <= "~" or char in "\\:" for char in name):
        return False
    return all(part not in ("", ".", "..") for part in name.split("/"))


def check_record(entry: Entry, names: set[str], limits: dict[str, int], findings: Findings) -> None:
    """The checks of a directory record, in the order of htex-reports-1.md section 3."""
    if not name_is_safe(entry.name):
        findings.add("ENTRY_NAME_UNSAFE", "", entry.name)
    if entry.name.lower() in names:
        findings.add("ENTRY_NAME_DUPLICATE", "", entry.name)
    names.add(entry.name.lower())
    if entry.flags & FLAGS_ENCRYPTED:
        findings.add("ENTRY_ENCRYPTED", "", entry.name)
    elif entry.method not in (STORED, DEFLATED):
        findings.add("ENTRY_COMPRESSION_UNKNOWN", "", entry.name)
    if entry.flags & FLAG_DESCRIPTOR:
        findings.add("ENTRY_DATA_DESCRIPTOR", "", entry.name)
    if 0xFFFFFFFF in (entry.packed, entry.size, entry.offset):
        findings.add("ARCHIVE_ZIP64", "", entry.name)
    if entry.extra or entry.comment:
        findings.add("ENTRY_EXTRA_FIELD", "", entry.name)
    if entry.size > limits["entry_bytes"]:
        findings.add("ENTRY_TOO_LARGE", "", entry.name)
    if entry.size > limits["ratio"] * entry.packed:
        findings.add("ENTRY_RATIO", "", entry.name)


def check_local(data: bytes, entry: Entry, position: int, findings: Findings) -> int | None:
    """Compare the local header at `position`; where the entry's data end, or None to stop."""
    if entry.offset != position:
        findings.add("ARCHIVE_EXTRA_DATA", "", entry.name)
        return None
    # The header, with its name, extra field and data, may reach into the directory: then bytes are left over below.
    if position + LOCAL_BYTES > len(data) or data[position : position + 4] != LOCAL:
        findings.add("ARCHIVE_INVALID", "", entry.name)
        return None
    flags, method = struct.unpack_from("<HH", data, position + 6)
    time = data[position + 10 : position + 14]
    crc, packed, size, name, extra = struct.unpack_from("<IIIHH", data, position + 14)
    entry.data_at = position + LOCAL_BYTES + name + extra
    after = entry.data_at + entry.packed
    if after > len(data):
        findings.add("ARCHIVE_INVALID", "", entry.name)
        return None
    text = data[position + LOCAL_BYTES : position + LOCAL_BYTES + name].decode("latin-1")
    local = (text, flags, method, time, crc, packed, size)
    differ = local != (entry.name, entry.flags, entry.method, entry.time, entry.crc, entry.packed, entry.size)
    if differ or entry.method == STORED and entry.packed != entry.size or entry.disk:
        findings.add("ENTRY_HEADER_MISMATCH", "", entry.name)
    if extra and not entry.extra:
        findings.add("ENTRY_EXTRA_FIELD", "", entry.name)
    return after


def unpack(packed: bytes, entry: Entry) -> bytes | None:
    """The entry's data, or None where they are corrupt; no more than `size` bytes are unpacked."""
    if entry.method == STORED:
        data = packed
    else:
        stream = zlib.decompressobj(-15)
        try:
            data = stream.decompress(packed, entry.size + 1)
        except zlib.error:
            return None
        if not stream.eof or stream.unused_data or stream.unconsumed_tail:
            return None
    if len(data) != entry.size or zlib.crc32(data) != entry.crc:
        return None
    return data


def check_mimetype(contents: list[tuple[Entry, bytes]], findings: Findings) -> None:
    """Item 5 of section 1."""
    for index, (entry, data) in enumerate(contents):
        if entry.name == "mimetype":
            if index:
                findings.add("MIMETYPE_NOT_FIRST")
            if entry.method != STORED:
                findings.add("MIMETYPE_COMPRESSED")
            if data != MIMETYPE:
                findings.add("MIMETYPE_WRONG")
            return
    findings.add("MIMETYPE_MISSING")
