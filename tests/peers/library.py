"""A reader of libraries, written only from spec/htexlib-1.md: lists and extracts textures.

    python3 tests/peers/library.py spec/library-conformance/valid_*.htexlib

The script prints each library's textures as JSON, one line per file. It needs `pip install blake3`
to compare hashes, and works without it.
"""

import json
import struct
import sys
import zlib

try:
    from blake3 import blake3
except ImportError:
    blake3 = None


class Page:
    def __init__(self, packed):
        crc, length = struct.unpack_from("<II", packed)
        assert crc == zlib.crc32(packed[4:])
        inflater = zlib.decompressobj(-15)
        self.bytes = inflater.decompress(packed[8:])
        assert inflater.eof and not inflater.unused_data and len(self.bytes) == length
        self.at = 0

    def take(self, count):
        self.at += count
        assert self.at <= len(self.bytes)
        return self.bytes[self.at - count : self.at]

    def varint(self):
        value, shift = 0, 0
        while True:
            (byte,) = self.take(1)
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    def text(self):
        return self.take(self.varint()).decode()

    def following(self, count):
        texts, text = [], b""
        for _ in range(count):
            text = text[: self.varint()]
            text += self.take(self.varint())
            texts.append(text)
        return texts

    def range(self, bits):
        if not bits & 1:
            return None
        (low,) = struct.unpack("<d", self.take(8))
        return [low, low if bits & 4 else struct.unpack("<d", self.take(8))[0]]


def read(file):
    assert file[:8] == b"\x89HTL\r\n\x1a\n" and struct.unpack_from("<H", file, 8)[0] == 1
    assert struct.unpack_from("<I", file, 124)[0] == zlib.crc32(file[:124])
    parts = [struct.unpack_from("<QQ", file, at) for at in (16, 32, 48, 64)]
    root, leaves, shared, payload = (file[at : at + length] for at, length in parts)
    if blake3:
        assert blake3(root + leaves).digest() == file[92:124]
    minor = struct.unpack_from("<H", file, 10)[0]
    root = Page(root)
    name, count = root.text(), root.varint()
    separators = root.following(count)
    entries, at = [], 0
    for i in range(count):
        length = root.varint()
        rows = leaf(Page(leaves[at : at + length]), shared, payload, minor)
        at += length
        assert all(separators[i] <= row["name"].encode() for row in rows)
        for row in rows:
            row["leaf"] = i
        entries += rows
    assert len(entries) == struct.unpack_from("<Q", file, 80)[0]
    metadata, spectra = {}, []
    if minor >= 1:
        known = ("version", "description", "authors", "homepage", "source", "changelog", "date")
        given = json.loads(root.take(root.varint()))
        metadata = {key: given[key] for key in known if key in given}
        lengths = [root.varint() for _ in range(count)]
        pages = shared[len(shared) - sum(lengths) :]
        assert not blake3 or blake3(pages).digest() == root.take(32)
        at = 0
        for length, rows in zip(lengths, leaf_sizes(entries)):
            spectra += read_spectra(Page(pages[at : at + length])) if length else [None] * rows
            at += length
    spectra += [None] * (len(entries) - len(spectra))
    for entry in entries:
        del entry["leaf"]
    return {"name": name, "metadata": metadata, "entries": entries, "spectra": spectra}


def leaf_sizes(entries):
    """The number of entries of each leaf."""
    sizes = {}
    for entry in entries:
        sizes[entry["leaf"]] = sizes.get(entry["leaf"], 0) + 1
    return list(sizes.values())


def read_spectra(page):
    known = page.take(page.varint())
    spectra = []
    for is_known in known:
        if not is_known:
            spectra.append(None)
            continue
        (largest,) = struct.unpack("<f", page.take(4))
        spectra.append([largest - 40 * (1 - byte / 255) for byte in page.take(48)])
    return spectra


def leaf(page, shared, payload, minor):
    count = page.varint()
    words = [page.text() for _ in range(page.varint())]
    names = page.following(count)
    tags, models = ([[words[page.varint()] for _ in range(page.varint())] for _ in range(count)] for _ in "tm")
    rows = [{"name": name.decode(), "tags": t} for name, t in zip(names, tags)]
    for row, m in zip(rows, models):
        row["models"] = m
    for row in rows:
        (bits,) = page.take(1)
        conditions = {"speed_mm_s": page.range(bits), "force_n": page.range(bits >> 1)}
        row["conditions"] = {k: {"min": v[0], "max": v[1]} for k, v in conditions.items() if v}
    for row in rows:
        (bits,) = page.take(1)
        row["contact"] = ("finger", "tool", "unknown")[bits & 3]
        row["law"] = {}
        for place, key in enumerate(("frequency_speed", "level_speed", "level_force")):
            source = ("measured", "given", "assumed")[bits >> (2 * place + 2) & 3]
            (exponent,) = struct.unpack("<d", page.take(8))
            assert abs(exponent) <= 4
            row["law"][key] = {"exponent": exponent, "source": source}
    start = page.varint()
    owns = []
    for _ in rows:
        length = page.varint()
        owns.append(payload[start : start + length])
        start += length
    textures = []
    for own in owns:
        texture, done = b"", 0
        for _ in range(page.varint()):
            before, first, length = page.varint(), page.varint(), page.varint()
            texture += own[done : done + before] + shared[first : first + length]
            done += before
        textures.append(texture + own[done:])
    for row, texture in zip(rows, textures):
        digest = page.take(32)
        assert not blake3 or blake3(texture).digest() == digest
        row["bytes"], row["blake3"] = len(texture), digest.hex()
    if minor >= 1:
        rights = [page.text() for _ in range(page.varint())]
        for key in ("license", "author"):
            for row in rows:
                choice = page.varint()
                if choice:
                    row[key] = rights[choice - 1]
        quantities = ("lateral_force", "normal_force", "acceleration", "velocity", "displacement")
        for row in rows:
            row["quantity"] = quantities[page.take(1)[0]]
        for key in ("felt_error_rms_db", "held_out_error_db"):
            for row in rows:
                error = page.varint()
                if error:
                    row[key] = (error - 1) / 100
    return rows


if __name__ == "__main__":
    for path in sys.argv[1:]:
        with open(path, "rb") as file:
            print(json.dumps(read(file.read()), ensure_ascii=False))
