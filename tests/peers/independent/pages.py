"""Pages of a library's index (htexlib-1.md sections 3 to 6)."""

from __future__ import annotations

import json
import math
import re
import struct
import unicodedata
import zlib
from dataclasses import dataclass, field
from datetime import date
from typing import Iterator

from .findings import Refused

MAX_TEXT, MAX_LIST, MAX_OBJECTS = 255, 64, 256
MAX_PART = 250
MAX_METADATA, MAX_ERROR = 8192, 100_001
# An entry's name (two lengths), tags, models, conditions, law, length, objects and hash.
LEAST_ENTRY = 2 + 1 + 1 + 1 + 25 + 1 + 1 + 32
MINOR = 1
QUANTITIES = ("lateral_force", "normal_force", "acceleration", "velocity", "displacement")
FORBIDDEN = set('\\:*?"<>|')
INVISIBLE = [
    (0xAD, 0xAD), (0x61C, 0x61C), (0x180E, 0x180E), (0x200B, 0x200F), (0x2028, 0x202E), (0x2060, 0x206F), (0xFEFF, 0xFEFF),
    (0xFFF9, 0xFFFB), (0x13430, 0x1343F), (0x1BCA0, 0x1BCA3), (0x1D173, 0x1D17A), (0xE0000, 0xE0FFF),
]
DEVICE = re.compile(r"(CON|PRN|AUX|NUL|CONIN\$|CONOUT\$|(COM|LPT)[0-9¹²³])", re.ASCII | re.IGNORECASE)


@dataclass
class Object:
    gap: int
    start: int
    length: int


@dataclass
class Entry:
    name: str = ""
    tags: list[str] = field(default_factory=list)
    models: list[str] = field(default_factory=list)
    conditions: tuple = ()
    law: tuple = ()
    start: int = 0
    length: int = 0
    objects: list[Object] = field(default_factory=list)
    hash: bytes = b""
    rights: tuple | None = None

    @property
    def size(self) -> int:
        return self.length + sum(o.length for o in self.objects)


@dataclass
class Root:
    name: str
    separators: list[bytes]
    lengths: list[int]
    spectra: list[int] = field(default_factory=list)
    spectra_hash: bytes | None = None


def most_in_file(limit: int) -> int:
    """The longest page in the file for a limit of its contents (section 9)."""
    return limit + limit // 64 + 72


def unpack(page: bytes, limit: int, pointer: str) -> bytes:
    """The contents of a page: its checksum, its length against the limit, its deflate stream (stage 2)."""
    if len(page) < 8:
        raise Refused("LIBRARY_PAGE_CORRUPT", pointer, "shorter than its head")
    checksum, length = struct.unpack_from("<II", page)
    if zlib.crc32(page[4:]) != checksum:
        raise Refused("LIBRARY_PAGE_CHECKSUM", pointer)
    if length > limit:
        raise Refused("LIBRARY_PAGE_TOO_LARGE", pointer)
    stream = zlib.decompressobj(-15)
    try:
        contents = stream.decompress(page[8:], length + 1)
    except zlib.error as error:
        raise Refused("LIBRARY_PAGE_CORRUPT", pointer, str(error)) from None
    if not stream.eof or stream.unused_data or len(contents) != length:
        raise Refused("LIBRARY_PAGE_CORRUPT", pointer, "another length")
    return contents


class Cursor:
    """Values of a page's contents; anything wrong is LIBRARY_PAGE_INVALID."""

    def __init__(self, data: bytes, pointer: str):
        self.data, self.at, self.pointer = data, 0, pointer

    def fail(self, why: str):
        raise Refused("LIBRARY_PAGE_INVALID", self.pointer, f"{why} at byte {self.at}")

    def take(self, count: int) -> bytes:
        if count > len(self.data) - self.at:
            self.fail("cut off")
        self.at += count
        return self.data[self.at - count : self.at]

    def varint(self) -> int:
        value = shift = 0
        while True:
            byte = self.take(1)[0]
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                break
            shift += 7
        if value >= 1 << 64 or shift and byte == 0:
            self.fail("an integer beyond 2^64, or in a longer form")
        return value

    def count(self, least_bytes: int = 1) -> int:
        """A number of values that follow, each of at least so many bytes."""
        value = self.varint()
        if value * least_bytes > len(self.data) - self.at:
            self.fail("more values than bytes")
        return value

    def text_bytes(self) -> bytes:
        length = self.varint()
        if length > MAX_TEXT:
            self.fail("a text is too long")
        return self.take(length)

    def utf8(self, data: bytes) -> str:
        try:
            return data.decode("utf-8")
        except UnicodeDecodeError:
            self.fail("not UTF-8")

    def text(self) -> str:
        return self.utf8(self.text_bytes())

    def following(self, count: int) -> Iterator[bytes]:
        before = b""
        for _ in range(count):
            common = self.varint()
            if common > len(before):
                self.fail("more in common than the text before has")
            length = self.varint()
            if common + length > MAX_TEXT:
                self.fail("a text is too long")
            before = before[:common] + self.take(length)
            yield before

    def number(self) -> float:
        value = struct.unpack("<d", self.take(8))[0]
        if not math.isfinite(value) or value == 0 and math.copysign(1, value) < 0:
            self.fail("a number that is not finite, or a negative zero")
        return value

    def end(self, newer: bool) -> None:
        if self.at != len(self.data) and not newer:
            self.fail("bytes after the last value")


def read_root(contents: bytes, leaves: int, leaves_length: int, shared_length: int, minor: int, limit: int) -> Root:
    """Section 4; `limit` is that of a leaf page's contents."""
    cursor = Cursor(contents, "/root")
    name = cursor.text()
    if any(steers(char) for char in name):
        raise Refused("LIBRARY_NAME_INVALID", "/root", "a control character")
    # Of each leaf two lengths of its separator and its own length follow.
    count = cursor.count(3)
    if count != leaves:
        raise Refused("LIBRARY_COUNT_WRONG", "/root", "another number of leaves than in the header")
    separators: list[bytes] = []
    for separator in cursor.following(count):
        if bool(separators) != bool(separator) or separators and separators[-1] >= separator:
            raise Refused("LIBRARY_ORDER_INVALID", "/root", "separators")
        separators.append(separator)
    lengths = read_lengths(cursor, count, "/leaves", limit)
    if sum(lengths) != leaves_length:
        raise Refused("LIBRARY_HEADER_INVALID", "/root", "lengths")
    root = Root(name, separators, lengths)
    if minor >= 1:
        length = cursor.varint()
        if length > MAX_METADATA:
            cursor.fail("the metadata are too long")
        check_metadata(cursor.take(length))
        root.spectra = read_lengths(cursor, count, "/spectra", limit)
        if sum(root.spectra) > shared_length:
            raise Refused("LIBRARY_HEADER_INVALID", "/root", "spectra")
        root.spectra_hash = cursor.take(32)
    cursor.end(minor > MINOR)
    return root


def read_lengths(cursor: Cursor, count: int, pointer: str, limit: int) -> list[int]:
    """The lengths in the file of one page a leaf."""
    lengths = []
    for number in range(count):
        lengths.append(cursor.varint())
        if lengths[-1] > most_in_file(limit):
            raise Refused("LIBRARY_PAGE_TOO_LARGE", f"{pointer}/{number}")
    return lengths


def check_metadata(data: bytes) -> None:
    """Section 4: what a library says about itself."""
    try:
        given = json.loads(data.decode("utf-8"), object_pairs_hook=no_key_twice)
        assert isinstance(given, dict)
        for key in ("version", "description", "homepage", "source", "changelog", "date"):
            if key in given:
                check_text(given[key], key in ("description", "changelog"))
        authors = given.get("authors", [])
        assert isinstance(authors, list)
        for author in authors:
            check_text(author, False)
        if "date" in given:
            assert re.fullmatch(r"[0-9]{4}-[0-9]{2}-[0-9]{2}", given["date"], re.ASCII)
            date.fromisoformat(given["date"])
    except (AssertionError, ValueError) as error:
        raise Refused("LIBRARY_METADATA_INVALID", "/root", str(error)) from None


def no_key_twice(pairs: list) -> dict:
    keys = [key for key, _ in pairs]
    assert len(keys) == len(set(keys))
    return dict(pairs)


def check_text(text: object, lines: bool) -> None:
    assert isinstance(text, str) and not any(steers(char) and not (lines and char == "\n") for char in text)
    assert lines or len(text.encode("utf-8")) <= MAX_TEXT


def read_spectra(contents: bytes, pointer: str) -> int:
    """The number of entries of a page of spectra."""
    cursor = Cursor(contents, pointer)
    known = cursor.take(cursor.varint())
    for flag in known:
        if flag > 1:
            cursor.fail("neither known nor unknown")
        if flag:
            (largest,) = struct.unpack("<f", cursor.take(4))
            if not math.isfinite(largest) or 255 not in cursor.take(48):
                cursor.fail("no largest level")
    cursor.end(False)
    return len(known)


def read_leaf(contents: bytes, pointer: str, minor: int) -> list[Entry]:
    """Section 5: the columns of a leaf."""
    cursor = Cursor(contents, pointer)
    count = cursor.count(LEAST_ENTRY)
    if count == 0:
        cursor.fail("no entry")
    words = read_texts(cursor)
    names = [cursor.utf8(name) for name in cursor.following(count)]
    entries = [Entry(name) for name in names]
    for entry in entries:
        entry.tags = read_words(cursor, words)
    for entry in entries:
        entry.models = read_words(cursor, words)
    for entry in entries:
        entry.conditions = read_range(cursor)
    for entry in entries:
        entry.law = read_law(cursor)
    start = cursor.varint()
    for entry in entries:
        entry.start, entry.length = start, cursor.varint()
        start += entry.length
    for entry in entries:
        entry.objects = read_objects(cursor)
    for entry in entries:
        entry.hash = cursor.take(32)
    if minor >= 1:
        read_rights(cursor, entries)
    cursor.end(minor > MINOR)
    return entries


def read_texts(cursor: Cursor) -> list[str]:
    texts = [cursor.text() for _ in range(cursor.count())]
    if any(a.encode() >= b.encode() for a, b in zip(texts, texts[1:])):
        cursor.fail("texts are not ascending")
    return texts


def read_rights(cursor: Cursor, entries: list[Entry]) -> None:
    """Licences, authors, quantities, felt differences and held-out errors."""
    texts = read_texts(cursor)
    columns = []
    for _ in range(2):
        choices = [cursor.varint() for _ in entries]
        if any(choice > len(texts) for choice in choices):
            cursor.fail("no such right")
        columns.append([texts[choice - 1] if choice else None for choice in choices])
    quantities = list(cursor.take(len(entries)))
    if any(quantity >= len(QUANTITIES) for quantity in quantities):
        cursor.fail("no such quantity")
    for entry, licence, author, quantity in zip(entries, *columns, quantities):
        entry.rights = (licence, author, QUANTITIES[quantity])
    for _ in range(2):
        if any(cursor.varint() > MAX_ERROR for _ in entries):
            cursor.fail("an error is too large")


def start(text: str | None) -> str | None:
    """The start of a text that a choice has."""
    return text if text is None else text.encode("utf-8")[:MAX_TEXT].decode("utf-8", "ignore")


def read_words(cursor: Cursor, words: list[str]) -> list[str]:
    count = cursor.varint()
    if count > MAX_LIST:
        cursor.fail("a list is too long")
    result = []
    for _ in range(count):
        index = cursor.varint()
        if index >= len(words):
            cursor.fail("no such word")
        result.append(words[index])
    return result


def read_range(cursor: Cursor) -> tuple:
    """The least and greatest speed and force, each a pair or None."""
    bits = cursor.take(1)[0]
    if bits > 15 or bits & 4 and not bits & 1 or bits & 8 and not bits & 2:
        cursor.fail("bits of a range")
    result = []
    for known, equal in ((bits & 1, bits & 4), (bits & 2, bits & 8)):
        if not known:
            result.append(None)
            continue
        low = cursor.number()
        high = low if equal else cursor.number()
        if low < 0 or not equal and not low < high:
            cursor.fail("a range")
        result.append((low, high))
    return tuple(result)


def read_law(cursor: Cursor) -> tuple:
    """Contact, sources of a, b and c, and the exponents."""
    bits = cursor.take(1)[0]
    codes = tuple(bits >> shift & 3 for shift in (0, 2, 4, 6))
    if 3 in codes:
        cursor.fail("bits of a law")
    numbers = tuple(cursor.number() for _ in range(3))
    if any(not -4 <= number <= 4 for number in numbers):
        cursor.fail("an exponent out of range")
    return codes, numbers


def read_objects(cursor: Cursor) -> list[Object]:
    count = cursor.varint()
    if count > MAX_OBJECTS:
        cursor.fail("too many objects")
    result = [Object(cursor.varint(), cursor.varint(), cursor.varint()) for _ in range(count)]
    if any(item.length == 0 for item in result):
        cursor.fail("an empty object")
    return result


def steers(char: str) -> bool:
    """Section 6: a control character, or an invisible one."""
    invisible = any(low <= ord(char) <= high for low, high in INVISIBLE)
    return unicodedata.category(char) == "Cc" or invisible


def one_file(name: str) -> str:
    """Section 6: what names have in common that some system takes for one file."""
    folded = unicodedata.normalize("NFD", name).casefold()
    return unicodedata.normalize("NFD", folded)


def name_is_allowed(name: str) -> bool:
    """Section 6, of one name."""
    if not 1 <= len(name.encode("utf-8")) <= MAX_TEXT:
        return False
    if any(char in FORBIDDEN or steers(char) for char in name):
        return False
    parts = name.split("/")
    for index, part in enumerate(parts):
        if part in ("", ".", "..") or part[-1] in " ." or len(part.encode("utf-8")) > MAX_PART:
            return False
        if DEVICE.fullmatch(part.split(".")[0].rstrip(" ")):
            return False
        if index < len(parts) - 1 and part.lower().endswith(".htex"):
            return False
    return True
