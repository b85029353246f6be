"""Files that are not assets raise an exception of the right class, and never end the process."""

from __future__ import annotations

import io
import pathlib
import random
import zipfile
from collections.abc import Callable

import pytest

import htex


def mutated(data: bytes, random_: random.Random) -> bytes:
    """Change, remove, repeat or insert a few bytes."""
    out = bytearray(data)
    for _ in range(random_.randint(1, 8)):
        at = random_.randrange(len(out))
        way = random_.randrange(5)
        if way == 0:
            out[at] = random_.randrange(256)
        elif way == 1:
            out[at] ^= 1 << random_.randrange(8)
        elif way == 2:
            del out[at : at + random_.randint(1, 40)]
        elif way == 3:
            out[at:at] = out[at : at + random_.randint(1, 40)]
        else:
            out[at:at] = random_.randbytes(random_.randint(1, 8))
        if not out:
            break
    return bytes(out)


def repacked(data: bytes, random_: random.Random) -> bytes:
    """Change bytes of one entry of an asset. The checksums are made valid, so that later stages
    read it."""
    file = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(file, "w") as new:
        names = old.namelist()
        chosen = random_.choice(names[1:])
        for name in names:
            content = old.read(name)
            if name == chosen:
                content = mutated(content, random_)
            stored = name == "mimetype"
            new.writestr(name, content, zipfile.ZIP_STORED if stored else zipfile.ZIP_DEFLATED)
    return file.getvalue()


@pytest.mark.parametrize(("change", "count"), [(mutated, 90_000), (repacked, 10_000)])
def test_mutated_assets_are_opened_or_refused(
    texture: htex.Texture, change: Callable[[bytes, random.Random], bytes], count: int
) -> None:
    data = texture.to_bytes()
    random_ = random.Random(1)
    refused = 0
    for _ in range(count):
        try:
            opened = htex.open(change(data, random_))
            for model in opened.models:
                opened.voice(model).render_path([80.0, 160.0], 0.4)
                opened.spectrum(model=model)
        except htex.Error:
            refused += 1
    assert refused > count // 4
    if change is repacked:
        # If only parameters are changed, the file is still an asset.
        assert refused < count


def test_mutated_recordings_are_read_or_refused() -> None:
    import numpy as np

    file = io.BytesIO()
    np.save(file, np.random.default_rng(1).normal(size=3000))
    random_ = random.Random(2)
    refused = 0
    for _ in range(500):
        try:
            htex.process(mutated(file.getvalue(), random_), rate_hz=2000, segments="windows")
        except htex.Error:
            refused += 1
    assert refused > 0


def test_unusable_sources_are_refused(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "empty.htex").write_bytes(b"")
    for source, error in [
        (tmp_path / "missing.htex", FileNotFoundError),
        (tmp_path, OSError),
        (tmp_path / "empty.htex", htex.AssetError),
        (place / "rec.csv", htex.AssetError),
        (b"", htex.AssetError),
        (b"PK\x03\x04", htex.AssetError),
        (42, TypeError),
        (None, TypeError),
        ([1, 2], TypeError),
        (io.StringIO("text"), TypeError),
    ]:
        with pytest.raises(error):
            htex.open(source)  # type: ignore[arg-type]
    with pytest.raises(IsADirectoryError):
        htex.open(place / "cloth.htex").save(tmp_path)
    with pytest.raises(FileNotFoundError) as found:
        htex.open(tmp_path / "missing.htex")
    assert found.value.filename == str(tmp_path / "missing.htex")


def test_unusable_plugins_are_refused(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "model.wasm").write_bytes(b"\0asm")
    for plugin in [tmp_path / "model.wasm", tmp_path / "missing.so"]:
        with pytest.raises(htex.ModelError):
            htex.open(place / "cloth.htex", plugins=[plugin])
