"""Files of other formats, and devices by name, give the same files, numbers and errors as the
command."""

from __future__ import annotations

import json
import pathlib
import struct
import zlib

import numpy as np
import pytest
from conftest import command

import htex


def png(rows: list[bytes]) -> bytes:
    """Return an 8-bit grey PNG, written according to the specification of PNG."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def rows_of(file: bytes) -> list[bytes]:
    """Return the rows of an 8-bit grey PNG."""
    data, width, at = b"", struct.unpack(">I", file[16:20])[0], 8
    while at < len(file):
        (length,), kind = struct.unpack(">I", file[at : at + 4]), file[at + 4 : at + 8]
        data += file[at + 8 : at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    data, rows, above = zlib.decompress(data), [], bytes(width)
    for start in range(0, len(data), width + 1):
        row = bytearray(data[start + 1 : start + 1 + width])
        for x in range(width):
            left, corner = (row[x - 1], above[x - 1]) if x else (0, 0)
            near = left + above[x] - corner
            paeth = min((left, above[x], corner), key=lambda one: abs(near - one))
            row[x] = (row[x] + [0, left, above[x], (left + above[x]) // 2, paeth][data[start]]) % 256
        above = bytes(row)
        rows.append(above)
    return rows


def test_exports_are_those_of_the_command(place: pathlib.Path, texture: htex.Texture, tmp_path: pathlib.Path) -> None:
    for to, name, more, flags in [
        ("haptic", "a.haptic", {"speed_mm_s": 80, "force_n": 0.4}, ["--speed", "80", "--force", "0.4"]),
        ("hjif", "a.hjif", {"coding": "wavelet", "seed": 3}, ["--coding", "wavelet", "--seed", "3"]),
        ("android", "a.kt", {"seconds": 1.0, "profile": "android"}, ["--seconds", "1", "--profile", "android"]),
        ("gltf", "a.glb", {}, []),
    ]:
        told = htex.export(texture, tmp_path / name, to, **more)  # type: ignore[arg-type]
        run = command("export", place / "cloth.htex", "--to", to, *flags, "-o", f"of-{name}", "--json", cwd=tmp_path)
        said = json.loads(run.stdout)
        assert (tmp_path / name).read_bytes() == (tmp_path / f"of-{name}").read_bytes()
        assert said.pop("bytes") == (tmp_path / name).stat().st_size and said.pop("file") == f"of-{name}"
        assert told == said


def test_imports_are_those_of_the_command(texture: htex.Texture, tmp_path: pathlib.Path) -> None:
    htex.export(texture, tmp_path / "buzz.haptic", "haptic")
    imported = htex.import_file(tmp_path / "buzz.haptic", full_scale=0.2, speed_mm_s=80, force_n=0.5, models="bands", license="CC0-1.0")
    command("import", "buzz.haptic", "--full-scale", "0.2", "--speed", "80", "--force", "0.5", "--model", "bands",
            "--license", "CC0-1.0", "-o", "buzz.htex", cwd=tmp_path)  # fmt: skip
    assert imported.texture.to_bytes() == (tmp_path / "buzz.htex").read_bytes()
    assert imported.notes == []

    htex.export(texture, tmp_path / "mesh.glb", "gltf")
    held = htex.import_file(tmp_path / "mesh.glb")
    assert held.texture.to_bytes() == texture.to_bytes()

    pixels = [bytes(8 * ((x + 2 * y) % 32) for x in range(64)) for y in range(32)]
    (tmp_path / "map.png").write_bytes(png(pixels))
    settings = {"full_scale": 0.3, "speed_mm_s": 80, "force_n": 0.5}
    on = htex.import_file(tmp_path / "map.png", pitch_mm=0.1, license="CC0-1.0", **settings)
    command("import", "map.png", "--full-scale", "0.3", "--speed", "80", "--force", "0.5", "--pitch", "0.1",
            "--license", "CC0-1.0", "-o", "map.htex", cwd=tmp_path)  # fmt: skip
    assert on.texture.to_bytes() == (tmp_path / "map.htex").read_bytes()
    told = htex.export(on.texture, tmp_path / "back.png", "png")
    assert rows_of((tmp_path / "back.png").read_bytes()) == pixels
    assert "lost" not in told and "0.3 N" in told["notes"][0]
    with pytest.raises(htex.OptionError, match="how far apart its pixels are; give `pitch_mm`"):
        htex.import_file(tmp_path / "map.png", **settings)

    for file, settings, error, words in [
        ("buzz.haptic", {}, htex.OptionError, "`full_scale`, `speed_mm_s` and `force_n`"),
        ("mesh.glb", {"full_scale": 1.0}, htex.OptionError, "takes no `full_scale`"),
        ("buzz.ogg", {}, htex.OptionError, "no format that is read"),
        ("none.haptic", {}, FileNotFoundError, "none.haptic"),
    ]:
        with pytest.raises(error, match=words):
            htex.import_file(tmp_path / file, **settings)  # type: ignore[arg-type]
    (tmp_path / "bad.haptic").write_text("{")
    with pytest.raises(htex.ExchangeError, match=r"bad\.haptic: line 1"):
        htex.import_file(tmp_path / "bad.haptic", full_scale=1, speed_mm_s=80, force_n=0.5)
    names = {one["name"] for one in htex.formats()["formats"]}
    assert {"hatt", "haptic", "ahap", "android", "hjif", "wav", "png", "gltf"} <= names


def test_a_device_takes_samples_by_its_name(texture: htex.Texture, tmp_path: pathlib.Path) -> None:
    names = {one["descriptor"]["id"] for one in htex.devices()}
    assert {"org.htex.sdl", "org.htex.channels", "org.htex.parametric"} <= names
    samples = texture.voice(rate_hz=48_000, gain=0.5).render(2_000)
    file = tmp_path / "pad.wav"
    with htex.Device("channels", rate_hz=48_000, settings={"to": "file", "path": file}) as device:
        assert device.write(samples) == 2_000
        assert device.status.frames_written == 2_000
        assert device.status.peak == np.abs(samples).max()
    assert np.array_equal(np.frombuffer(file.read_bytes()[-2_000 * 16 :], "<f4").reshape(-1, 4)[:, 2], samples)
    with pytest.raises(htex.DeviceError, match="closed"):
        device.write(samples)

    gone = tmp_path / "gone.wav"
    with pytest.raises(ZeroDivisionError), htex.Device("channels", settings={"to": "file", "path": gone}) as device:
        device.write(samples)
        raise ZeroDivisionError
    assert not gone.exists()
    for name, settings, error, words in [
        ("none", {}, htex.OptionError, "no device `none`"),
        ("channels", {"to": "nowhere"}, htex.OptionError, "setting `to`"),
        ("sdl", {"driver": "/nowhere/libSDL2.so"}, htex.OptionError, "SDL"),
    ]:
        with pytest.raises(error, match=words):
            htex.Device(name, settings=settings)
