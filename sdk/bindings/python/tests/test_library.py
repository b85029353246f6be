"""Pack, search and open libraries."""

from __future__ import annotations

import json
import pathlib

import numpy as np
import pytest
from conftest import command

import htex


@pytest.fixture(scope="module")
def library(texture: htex.Texture, place: pathlib.Path) -> htex.Library:
    """Pack three textures: an object, bytes and a file."""
    cloth = place / "cloth.htex"
    path = place / "three.htexlib"
    textures = {"woven/b": texture, "woven/a": cloth.read_bytes(), "Felt": cloth}
    assert htex.pack(path, textures, name="Three") == path.stat().st_size
    return htex.Library(path)


def test_a_library_names_its_textures(library: htex.Library) -> None:
    assert (library.name, len(library)) == ("Three", 3)
    assert library.names == ["Felt", "woven/a", "woven/b"] == list(library)
    assert "woven/a" in library and "woven" not in library
    assert repr(library) == '<htex.Library "Three": 3 texture(s)>'


def test_a_texture_plays_as_its_file(library: htex.Library, texture: htex.Texture, place: pathlib.Path) -> None:
    assert library.to_bytes("Felt") == (place / "cloth.htex").read_bytes()
    played = library["woven/a"].voice(model="ar", seed=7).render(1000)
    assert np.array_equal(played, texture.voice(model="ar", seed=7).render(1000))
    for absent in [library.__getitem__, library.entry, library.to_bytes]:
        with pytest.raises(KeyError, match="velvet"):
            absent("velvet")


def test_a_texture_is_opened_by_the_path_of_its_library_and_its_name(place: pathlib.Path, library: htex.Library) -> None:
    assert htex.open(place / "three.htexlib#woven/a").to_bytes() == library.to_bytes("woven/a")
    with pytest.raises(KeyError, match="woven/c"):
        htex.open(f"{place}/three.htexlib#woven/c")
    with pytest.raises(FileNotFoundError):
        htex.open(place / "none.htexlib#woven/a")


def test_a_library_is_changed_without_its_recordings(place: pathlib.Path, library: htex.Library) -> None:
    new, cloth = place / "changed.htexlib", place / "cloth.htex"
    said = htex.Library.edit(
        place / "three.htexlib",
        new,
        remove=["woven/*"],
        rename={"Felt": "felt"},
        add={"cloth": cloth},
        metadata={"license": "CC0-1.0", "description": "Changed"},
        add_tags=["tested"],
        filters={"name": "f*"},
    )
    # What does not match is neither removed nor edited.
    assert (said.removed, said.renamed, said.added, said.edited, said.textures) == (0, 1, 1, 0, 4)
    said = htex.Library.edit(new, remove=["woven/*"], metadata={"description": "Changed"}, add_tags=["tested"])
    assert (said.removed, said.edited, said.textures, said.bytes) == (2, 2, 2, new.stat().st_size)
    changed = htex.Library(new)
    assert changed.names == ["cloth", "felt"]
    assert changed["felt"].manifest["description"] == "Changed" and "tested" in changed.entry("felt").tags
    with pytest.raises(htex.LibraryError, match="most similar names are felt"):
        htex.Library.edit(new, remove=["fellt"])
    with pytest.raises(htex.OptionError, match="colour"):
        htex.Library.edit(new, metadata={"colour": "red"})

    both = place / "both.htexlib"
    assert htex.Library.merge([new, place / "three.htexlib"], both, prefixes=["a/", ""]) == both.stat().st_size
    assert htex.Library(both).names == ["Felt", "a/cloth", "a/felt", "woven/a", "woven/b"]
    with pytest.raises(htex.LibraryError, match="differ only in case"):
        htex.Library.merge([new, place / "three.htexlib"], both)
    assert len(htex.Library(both)) == 5


def test_entries_are_those_of_the_command(library: htex.Library, place: pathlib.Path) -> None:
    listed = json.loads(command("lib", "ls", "three.htexlib", "--json", cwd=place).stdout)
    assert len(listed) == 3
    for entry, said in zip(library.entries, listed, strict=True):
        assert (entry.name, list(entry.tags), list(entry.models)) == (said["name"], said["tags"], said["models"])
        assert (entry.bytes, entry.blake3) == (said["bytes"], said["blake3"])
        speed = said["conditions"]["speed_mm_s"]
        assert entry.speed_mm_s == (speed["min"], speed["max"])
        assert library.entry(entry.name) == entry


def test_searches_need_all_that_is_asked_for(library: htex.Library) -> None:
    def names(*words: str, **rest: float | str) -> list[str]:
        return [entry.name for entry in library.find(*words, **rest)]  # type: ignore[arg-type]

    assert names("WOVEN") == ["woven/a", "woven/b"]
    assert names("woven", "b", model="ar") == ["woven/b"]
    speed = library.entry("Felt").speed_mm_s
    assert speed is not None and len(names(speed_mm_s=speed[0])) == 3
    assert names(speed_mm_s=1e5) == [] == names(model="none")
    assert library.find(tags=["none"]) == []


def test_what_is_wrong_is_an_exception_and_leaves_nothing(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "a.htexlib"
    cloth = place / "cloth.htex"
    for textures, error, words in [
        ({"../a": cloth}, htex.LibraryError, "not a name"),
        ({"a": b"no texture"}, htex.AssetError, "ARCHIVE_INVALID"),
        ({"a": tmp_path / "none.htex"}, FileNotFoundError, "none.htex"),
        ({"a": 3}, TypeError, "int"),
    ]:
        with pytest.raises(error, match=words):
            htex.pack(path, textures)  # type: ignore[arg-type]
    mine = {"b": htex.edit(htex.open(cloth), license=""), "a": cloth}
    with pytest.raises(htex.LibraryError, match="^b states no licence"):
        htex.pack(path, mine)
    with pytest.raises(FileNotFoundError):
        htex.pack(tmp_path / "no" / "where.htexlib", {})
    assert list(tmp_path.iterdir()) == []
    assert htex.pack(tmp_path / "mine.htexlib", mine, unlicensed=True) > 0
    with pytest.raises(htex.LibraryError, match="LIBRARY_UNRECOGNISED"):
        htex.Library(cloth)
    with pytest.raises(FileNotFoundError):
        htex.Library(path)
    whole = (place / "three.htexlib").read_bytes()
    with pytest.raises(htex.LibraryError, match="LIBRARY_TRUNCATED"):
        htex.Library(whole[:-1])


def test_a_library_says_what_it_is(place: pathlib.Path, library: htex.Library, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "described.htexlib"
    htex.Library.edit(place / "three.htexlib", path, describe={"version": "1.2", "authors": "Ana; Ben"})
    described = htex.Library(path)
    assert described.metadata == {"version": "1.2", "authors": ["Ana", "Ben"]} and library.metadata == {}
    said = json.loads(command("lib", "info", str(path), "--json", cwd=place).stdout)
    assert (said["version"], said["blake3"]) == ("1.2", described.blake3)
    assert described.info() == {key: value for key, value in said.items() if key != "file"}
    htex.Library.merge([path], tmp_path / "merged.htexlib", describe={"date": "2026-11-30"})
    assert htex.Library(tmp_path / "merged.htexlib").metadata == {"date": "2026-11-30"}
    with pytest.raises(htex.OptionError, match="date is no date"):
        htex.pack(tmp_path / "none.htexlib", {}, describe={"date": "soon"})
    assert not (tmp_path / "none.htexlib").exists()


def test_searches_by_rights_and_spectra_are_those_of_the_command(place: pathlib.Path, library: htex.Library) -> None:
    def by_command(*asked: str) -> list[dict[str, object]]:
        found = command("lib", "find", "three.htexlib", *asked, "--json", cwd=place).stdout
        return list(json.loads(found))

    licences = {entry.license for entry in library.entries}
    assert licences and None not in licences
    some = next(iter(licences))
    assert some is not None
    assert [e.name for e in library.find(license=some[:2] + "*")] == [e["name"] for e in by_command("--license", some[:2] + "*")]
    assert {entry.quantity for entry in library.entries} == {"lateral_force"}
    assert library.find(quantity="acceleration") == [] == library.find(license="none")
    with pytest.raises(htex.OptionError, match="lateral_force"):
        library.find(quantity="weight")
    near = library.similar("woven/a")
    assert [(round(db, 2), entry.name) for db, entry in near] == [(e["distance_db"], e["name"]) for e in by_command("--like", "woven/a")]
    # Two of the textures are the same. Equal distances keep the order of the names.
    assert near[0] == (0.0, library.entry("Felt")) and near[1] == (0.0, library.entry("woven/a"))
    twice = [(name, of) for name, of, _ in library.duplicates(60)]
    assert twice == [(e["name"], e["duplicate_of"]) for e in by_command("--duplicates", "--within", "60")]


def test_two_libraries_are_compared(place: pathlib.Path, library: htex.Library, tmp_path: pathlib.Path) -> None:
    new = tmp_path / "new.htexlib"
    htex.Library.edit(place / "three.htexlib", new, remove=["woven/b"], rename={"Felt": "felt"})
    htex.Library.edit(new, metadata={"description": "Changed"}, filters={"name": "woven/a"})
    difference = library.diff(htex.Library(new))
    assert difference.renamed == [("Felt", "felt")] and difference.changed == ["woven/a"]
    assert (difference.removed, difference.added) == (["woven/b"], [])
    back = htex.Library(new).diff(library)
    assert (back.removed, back.added) == ([], ["woven/b"])
    same = library.diff(library)
    assert (same.removed, same.added, same.renamed, same.changed) == ([], [], [], [])


def test_only_what_a_key_signed_is_opened(place: pathlib.Path, library: htex.Library, tmp_path: pathlib.Path) -> None:
    secret = tmp_path / "signer.key"
    secret.write_bytes(bytes([7] * 32))
    for name, bytes_ in {"cloth.htex": library.to_bytes("Felt"), "three.htexlib": (place / "three.htexlib").read_bytes()}.items():
        (tmp_path / name).write_bytes(bytes_)
        command("sign", name, "--key", secret, cwd=tmp_path)
    cloth, three = tmp_path / "cloth.htex", tmp_path / "three.htexlib"
    signatures = [path.with_name(path.name + ".sig").read_bytes() for path in (cloth, three)]
    key, other = json.loads(signatures[0])["public_key"], "00474ae0c6af07224d0a4250b8a3c82cc7c6e1a9e0e27bce347f01a6bd229caa"
    motion = {"constant": {"speed_mm_s": 80, "force_n": 0.4}}
    scenes = [tmp_path / "cloth.scene.json", tmp_path / "three.scene.json"]
    for scene, asset in zip(scenes, ["cloth.htex", "three.htexlib#Felt"]):
        scene.write_text(json.dumps({"htex_scene": "1.0", "surfaces": [{"asset": asset}], "motion": motion, "duration_s": 0.1}))
    opens = [
        lambda keys: htex.open(cloth, only_signed_by=keys),
        lambda keys: htex.open(f"{three}#Felt", only_signed_by=keys),
        lambda keys: htex.open(cloth.read_bytes(), only_signed_by=keys, signature=signatures[0]),
        lambda keys: htex.Library(three, only_signed_by=keys)["Felt"],
        lambda keys: htex.Library(three.read_bytes(), only_signed_by=keys, signature=signatures[1])["Felt"],
        lambda keys: htex.Scene(scenes[0], only_signed_by=keys),
        lambda keys: htex.Scene(scenes[1], only_signed_by=keys),
    ]
    for opened in opens:
        opened(key)
        opened([other, key])
        with pytest.raises(htex.SignatureError, match="another key"):
            opened(other)
        with pytest.raises(htex.OptionError, match="only_signed_by"):
            opened([])
        with pytest.raises(htex.OptionError, match="64 hexadecimal digits"):
            opened("alice")
    with pytest.raises(htex.SignatureError, match="no signature"):
        htex.open(cloth.read_bytes(), only_signed_by=key)
    with pytest.raises(htex.OptionError, match="only_signed_by"):
        htex.open(cloth.read_bytes(), signature=signatures[0])
    cloth.write_bytes(htex.edit(htex.open(cloth), description="Changed").to_bytes())
    with pytest.raises(htex.SignatureError, match="changed"):
        htex.open(cloth, only_signed_by=key)
    assert htex.Scene(scenes[0]).rate_hz > 0
    with pytest.raises(htex.SignatureError, match=r"cloth\.htex.*changed"):
        htex.Scene(scenes[0], only_signed_by=key)
