"""The functions of the package give the same files and numbers as the command: make, mix, edit,
compare, simulate and measure."""

from __future__ import annotations

import inspect
import json
import pathlib
import pickle

import numpy as np
import pytest
from conftest import command
from scipy import signal

import htex


def test_textures_by_hand_are_those_of_the_command(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    made = htex.make("sbeta", {"alpha": 2.0, "beta": 5}, 0.02, at=(80, 0.4), name="hum", license="CC0-1.0")
    command(*"make --model sbeta --set alpha=2 beta=5 --level 0.02 --at speed=80,force=0.4".split(), "--license", "CC0-1.0", "-o", "hum.htex", cwd=tmp_path)
    assert made.to_bytes() == (tmp_path / "hum.htex").read_bytes()

    lines = htex.make("sbeta", {"alpha": 3.0, "beta": 4.0}, np.float64(0.04), at=(80, 0.4), name="other", license="CC0-1.0")
    lines.save(tmp_path / "other.htex")
    mixed = htex.mix(made, lines, 0.25, name="between", tags=["mixed"])
    command("mix", "hum.htex", "other.htex", "--weight", "0.25", "--tag", "mixed", "-o", "between.htex", cwd=tmp_path)
    assert mixed.to_bytes() == (tmp_path / "between.htex").read_bytes()
    assert mixed.level() == pytest.approx(0.025)

    cloth = htex.open(place / "cloth.htex")
    swelling = htex.make("sbeta", {"alpha": 2.0, "beta": 5}, 0.02, fluctuation=(3, 1.5), name="swell")
    command(*"make --model sbeta --set alpha=2 beta=5 --level 0.02 --fluctuation 3,1.5 --name swell -o swell.htex".split(), cwd=tmp_path)
    assert swelling.to_bytes() == (tmp_path / "swell.htex").read_bytes()
    assert swelling.manifest["fluctuation"] == {"slow": 96, "fast": 48}
    steady = htex.edit(swelling, fluctuation=(0, 0))
    command("edit", "swell.htex", "--fluctuation", "0,0", "-o", "steady.htex", cwd=tmp_path)
    assert steady.to_bytes() == (tmp_path / "steady.htex").read_bytes()
    assert "fluctuation" not in steady.manifest
    for wrong in [(8, 0), (-1, 0), (0, float("nan"))]:
        with pytest.raises(htex.OptionError, match="fluctuation: .* from 0 to 7.97"):
            htex.edit(swelling, fluctuation=wrong)

    edited = htex.edit(cloth, author="A. Uthor", tags=["a", "b"])
    command("edit", place / "cloth.htex", "--author", "A. Uthor", "--tag", "a,b", "-o", "edited.htex", cwd=tmp_path)
    assert edited.to_bytes() == (tmp_path / "edited.htex").read_bytes()


def test_comparisons_are_those_of_the_command(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    command("simulate", "--surface", "vinyl", "--seconds", "4", "-o", "vinyl.csv", cwd=tmp_path)
    expected = json.loads(command("compare", place / "rec.csv", place / "cloth.htex", "--json", cwd=tmp_path).stdout)
    for other in [place / "cloth.htex", htex.open(place / "cloth.htex")]:
        found = htex.compare(place / "rec.csv", other)
        assert found.representations == expected["representations"]
        assert found.condition.repeatability_rms_db == expected["repeatability_rms_db"]
        assert len(found.table()["model"]) == 6
    expected = json.loads(command("compare", place / "rec.csv", "vinyl.csv", "--json", cwd=tmp_path).stdout)["other"]
    found = htex.compare(place / "rec.csv", tmp_path / "vinyl.csv")
    assert found.other is not None and found.other == {name: expected[name] for name in found.other}
    with pytest.raises(htex.OptionError, match='give quantity="lateral_force"'):
        htex.compare(place / "rec.csv", place / "cloth.htex", quantity="acceleration", map="signal=fx_n:1")


def test_simulations_are_those_of_the_command_and_say_what_they_are(tmp_path: pathlib.Path) -> None:
    found = htex.simulate("vinyl", seed=3, seconds=2, rate_hz=10_000, speed_mm_s=100)
    command("simulate", "--surface", "vinyl", "--seed", "3", "--seconds", "2", "--rate", "10000", "--speed", "100",
            "-o", "rec.csv", "--frf", "frf.csv", cwd=tmp_path)  # fmt: skip
    assert found.csv == (tmp_path / "rec.csv").read_bytes()
    assert found.response.to_csv() == (tmp_path / "frf.csv").read_bytes()
    assert np.array_equal(found["fx_n"], np.loadtxt(tmp_path / "rec.csv", delimiter=",", skiprows=2)[:, 1])
    assert pickle.loads(pickle.dumps(found)).csv == found.csv
    fit = htex.fit(found, models="bands", response=found.response)
    assert fit.texture.manifest["provenance"]["simulated"]
    by_file = htex.process(tmp_path / "rec.csv", response=tmp_path / "frf.csv")
    assert np.array_equal(fit.spectra[0].magnitude, by_file.spectrum.magnitude)
    free = htex.simulate("vinyl", seconds=1, motion="free", speed_mm_s=(40, 200))
    assert len(free["t_s"]) == 20_000


def test_a_response_is_that_of_its_filter(tmp_path: pathlib.Path) -> None:
    rate = 10_000
    noise = np.random.default_rng(1).normal(size=20 * rate)
    b, a = signal.iirpeak(180, 5, fs=rate)
    found = htex.response(noise, signal.lfilter(b, a, noise), rate, continuous=True)
    _, expected = signal.freqz(b, a, worN=found.frequency_hz, fs=rate)
    at = found.frequency_hz == 180
    assert abs(20 * np.log10(found.magnitude[at] / abs(expected[at]))) < 0.1
    assert found.coherence is not None and found.coherence[at] > 0.99 and found.about["settings"]
    found.save(tmp_path / "rig.csv")
    assert (tmp_path / "rig.csv").read_bytes() == found.to_csv()
    with pytest.raises(htex.OptionError, match="2 inputs and 1 outputs"):
        htex.response([noise, noise], noise, rate)
    with pytest.raises(htex.OptionError, match="the window"):
        htex.response(noise, noise, rate, window_s=-1.0)
    with pytest.raises(htex.RecordingError):
        htex.response(noise * np.nan, noise, rate)


def test_a_take_is_read_as_the_json_beside_it_says(place: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "rec.csv").write_bytes((place / "rec.csv").read_bytes())
    record = "record --source file:rec.csv --fast --countdown 0 --seconds 2 --take cloth --target-force 0.4 --format npy -o takes"
    command(*record.split(), cwd=tmp_path)
    (beside,) = (tmp_path / "takes").glob("*.json")
    takes = [htex.process(beside), htex.process(beside.with_suffix(".npy"))]
    expected = json.loads(command("process", beside, "--json", cwd=tmp_path).stdout)
    for take in takes:
        assert np.array_equal(take.spectrum.magnitude, expected["magnitude"])


def test_keywords_are_shown_and_others_refused(place: pathlib.Path) -> None:
    shown = inspect.signature(htex.process).parameters
    assert list(shown)[0] == "recording" and {"rate_hz", "strict", "averaging"} <= set(shown)
    assert "Sample rate" in (htex.process.__doc__ or "")
    with pytest.raises(TypeError, match="unexpected keyword argument 'rate'"):
        htex.process(place / "rec.csv", rate=1e4)  # type: ignore[call-arg]
    for function, arguments in [
        (htex.make, ("sbeta", {"alpha": 2.0}, 0.1)),
        (htex.make, ("sbeta", {"alpha": 2.0, "beta": 5.0}, -1.0)),
        (htex.make, ("sbeta", {"alpha": 2.0, "beta": 5.0, "gamma": 1.0}, 0.1)),
        (htex.mix, (*[htex.open(place / "cloth.htex")] * 2, 1.5)),
        (htex.edit, (htex.open(place / "cloth.htex"),)),
        (htex.simulate, ("silk",)),
    ]:
        with pytest.raises(htex.OptionError):
            function(*arguments)
