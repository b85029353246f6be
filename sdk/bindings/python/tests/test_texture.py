"""Opening, describing, saving and pickling textures."""

from __future__ import annotations

import io
import json
import pathlib
import pickle

import numpy as np
import pytest
from conftest import command

import htex


def test_a_texture_describes_its_asset(texture: htex.Texture, place: pathlib.Path) -> None:
    info = json.loads(command("info", "cloth.htex", "--json", cwd=place).stdout)
    manifest = info["manifest"]
    assert (texture.name, texture.unit) == (manifest["name"], manifest["unit"])
    assert list(texture.band_hz) == [manifest["band"]["low_hz"], manifest["band"]["high_hz"]]
    assert texture.models == [r["model"] for r in info["representations"]]
    assert texture.manifest["license"] == "CC0-1.0"
    assert texture.conditions[0].speed_mm_s == manifest["conditions"][0]["speed_mm_s"]
    for representation, stated in zip(info["representations"], manifest["representations"], strict=True):
        model = representation["model"]
        assert texture.level(model=model) == stated["at"][0]["level_rms"]
        assert texture.parameters(model=model) == representation["at"][0]["parameters"]


def test_the_spectrum_is_that_of_the_command(texture: htex.Texture, place: pathlib.Path) -> None:
    for at, flags in [(None, []), ((160.0, None), ["--speed", "160"])]:
        said = command("spectrum", "cloth.htex", "--model", "ar", "--json", *flags, cwd=place)
        expected = json.loads(said.stdout)
        spectrum = texture.spectrum(model="ar", at=at)
        assert np.array_equal(spectrum.frequency_hz, expected["frequency_hz"])
        assert np.array_equal(spectrum.magnitude, expected["magnitude"])
    few = texture.spectrum([100.0, 200.0], model="ar")
    assert few.magnitude.shape == (2,)


def test_paths_bytes_and_files_are_the_same(texture: htex.Texture, place: pathlib.Path) -> None:
    path = place / "cloth.htex"
    data = path.read_bytes()
    with open(path, "rb") as file:
        opened = [htex.open(str(path)), htex.open(data), htex.open(bytearray(data)), htex.open(file)]
    opened.append(htex.open(io.BytesIO(data)))
    for other in opened:
        assert other.manifest == texture.manifest
        assert other.to_bytes() == data


def test_saving_replaces_the_file_as_a_whole(texture: htex.Texture, tmp_path: pathlib.Path) -> None:
    target = tmp_path / "copy.htex"
    target.write_bytes(b"before")
    texture.save(target)
    assert target.read_bytes() == texture.to_bytes()
    assert [file.name for file in tmp_path.iterdir()] == ["copy.htex"]
    with pytest.raises(OSError):
        texture.save(tmp_path / "missing" / "copy.htex")


def test_what_is_data_can_be_pickled(texture: htex.Texture, place: pathlib.Path) -> None:
    copy = pickle.loads(pickle.dumps(texture))
    assert copy.to_bytes() == texture.to_bytes()
    assert pickle.loads(pickle.dumps(texture.conditions)) == texture.conditions
    spectrum = texture.spectrum()
    assert np.array_equal(pickle.loads(pickle.dumps(spectrum)).magnitude, spectrum.magnitude)
    fit = htex.fit(place / "rec.csv", models="bands")
    again = pickle.loads(pickle.dumps(fit))
    assert again.texture.to_bytes() == fit.texture.to_bytes()
    error = pickle.loads(pickle.dumps(htex.MotionError("text")))
    assert isinstance(error, htex.MotionError) and isinstance(error, ValueError)


def test_everything_has_a_repr(texture: htex.Texture, place: pathlib.Path) -> None:
    voice = texture.voice(model="ar")
    fit = htex.fit(place / "rec.csv", models="bands")
    values = [texture, voice, texture.spectrum(), texture.conditions[0], voice.coverage(80, 0.4), fit]
    values += [htex.process(place / "rec.csv"), htex.agreement(fit.spectra[0], fit.spectra[0])]
    for value in values:
        assert type(value).__name__ in repr(value) and "object at 0x" not in repr(value)
        assert type(value).__module__ == "htex"


def test_models_are_listed() -> None:
    ids = [model["id"] for model in htex.models()]
    assert "org.htex.ar" in ids and len(ids) == len(set(ids))
