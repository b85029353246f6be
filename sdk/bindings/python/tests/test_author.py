"""Compare spectra, fits and agreement with SciPy, the golden vectors and the command."""

from __future__ import annotations

import csv
import io
import json
import pathlib
import threading

import numpy as np
import pytest
from conftest import ROOT, command
from scipy import signal

import htex


def golden(file: str) -> dict[str, dict]:
    path = ROOT / "tests" / "golden" / f"{file}.json"
    return {case["name"]: case for case in json.loads(path.read_text())["cases"]}


def hold(case: dict, name: str, got: object) -> None:
    np.testing.assert_allclose(got, case["expected"][name], rtol=case["rtol"], atol=case["atol"])


def closed_form() -> np.ndarray:
    """Return the recording of the golden vectors: back-and-forth sweeps with four sinusoids on two
    axes."""
    n = np.arange(200_000)
    t, tau = n / 20_000, n % 25_000
    sign = np.where(n // 25_000 % 2 == 0, 1.0, -1.0)
    rise = 0.5 * (1 - np.cos(np.pi * tau / 2000))
    fall = 0.5 * (1 - np.cos(np.pi * (1 - (tau - 21_000) / 2000)))
    envelope = np.select([tau < 2000, tau < 21_000, tau < 23_000], [rise, 1.0, fall], 0.0)
    lines = [(50.0, 0.01, 0.3), (137.5, 0.006, 1.1), (400.0, 0.004, 2.0), (905.0, 0.002, 0.7)]
    texture = sum(a * np.cos(2 * np.pi * f * t + p) for f, a, p in lines)
    force = sign * 0.2 * envelope + envelope * texture
    return np.stack([0.05 * force, 0.998749217771909 * force], axis=1)


@pytest.mark.parametrize("name", ["closed_form_raw", "closed_form_compensated"])
def test_the_spectrum_is_that_of_the_golden_vectors(name: str, tmp_path: pathlib.Path) -> None:
    case = golden("pipeline")[name]
    response = None
    if name.endswith("compensated"):
        f = np.arange(0, 1001, 5.0)
        h = 1 / (1 - (f / 620) ** 2 + 2j * 0.06 * f / 620)
        response = tmp_path / "response.csv"
        rows = zip(f, abs(h), np.angle(h), strict=True)
        lines = ["frequency_hz,magnitude,phase_rad", *(f"{a!r},{b!r},{c!r}" for a, b, c in ((float(a), float(b), float(c)) for a, b, c in rows))]
        response.write_text("\n".join(lines))
    found = htex.process(closed_form(), rate_hz=20_000, averaging="magnitude", response=response)
    assert found.from_sweeps and found.segments == case["expected"]["n_sweeps"]
    magnitude = found.spectrum.magnitude
    picked = [magnitude[int(f / 5) - 4] for f in case["expected"]["mag_f_hz"]]
    hold(case, "mag_n", picked)
    hold(case, "mag_sum", magnitude.sum())
    hold(case, "mag_sum_sq", (magnitude**2).sum())


@pytest.mark.parametrize("averaging", ["rms", "magnitude"])
def test_the_spectrum_is_that_of_scipy(averaging: str) -> None:
    rate, length = 10_000, 2000
    x = np.random.default_rng(1).normal(size=25_000) * 0.01
    found = htex.process(x, rate_hz=rate, segments="windows", averaging=averaging)
    starts = np.arange(0, len(x) - length + 1, length // 2)
    assert found.segments == len(starts)
    window = signal.windows.hann(length, sym=False)
    parts = np.stack([x[s : s + length] for s in starts])
    parts = (parts - parts.mean(axis=1, keepdims=True)) * window
    magnitudes = abs(np.fft.rfft(parts, axis=1)) * 2 / window.sum()
    expected = np.sqrt((magnitudes**2).mean(axis=0)) if averaging == "rms" else magnitudes.mean(axis=0)
    np.testing.assert_allclose(found.spectrum.magnitude, expected[4:201], rtol=1e-9)


def test_agreement_is_that_of_the_golden_vectors() -> None:
    for case in golden("fidelity").values():
        found = htex.agreement(case["input"]["reference"], case["input"]["model"])
        for name in ["third_octave_error_rms_db", "log_spectral_distance_db"]:
            hold(case, name, getattr(found, name))


def test_processing_is_that_of_the_command(place: pathlib.Path) -> None:
    for options, flags in [
        ({}, []),
        ({"segments": "windows", "averaging": "magnitude"}, ["--segments", "windows", "--averaging", "magnitude"]),
        ({"from_s": 0.5, "to_s": 4.0}, ["--from", "0.5", "--to", "4"]),
    ]:
        expected = json.loads(command("process", "rec.csv", "--json", *flags, cwd=place).stdout)
        found = htex.process(place / "rec.csv", **options)
        assert np.array_equal(found.spectrum.magnitude, expected["magnitude"])
        assert [list(part) for part in found.read_s] == expected["read_s"]
        assert found.condition.speed_mm_s == expected["speed_mm_s"]
        assert found.findings == expected["findings"] and found.warnings == expected["warnings"]
    data = (place / "rec.csv").read_bytes()
    for source in [data, io.BytesIO(data)]:
        assert np.array_equal(htex.process(source).spectrum.magnitude, htex.process(place / "rec.csv").spectrum.magnitude)


def test_a_fit_is_that_of_the_command(place: pathlib.Path) -> None:
    fit = htex.fit(place / "rec.csv", name="cloth", license="CC0-1.0")
    assert fit.texture.to_bytes() == (place / "cloth.htex").read_bytes()
    flags = ["--model", "ar,bands", "--option", "ar.order=6", "--level", "fitted", "--averaging", "magnitude"]
    flags += ["--keep-reference", "--tag", "a,b", "--name", "Cloth", "--at", "speed=82,force=0.41", "--doi", "10.1000/xyz"]
    command("fit", "rec.csv", "-o", "other.htex", *flags, cwd=place)
    fit = htex.fit(
        [place / "rec.csv"],
        models=["ar", "bands"],
        options={"ar": {"order": 6}},
        level="fitted",
        averaging="magnitude",
        keep_reference=True,
        tags=["a", "b"],
        name="Cloth",
        conditions=[(82, 0.41)],
        doi="10.1000/xyz",
    )
    assert fit.texture.to_bytes() == (place / "other.htex").read_bytes()


def test_a_fit_is_a_table(place: pathlib.Path) -> None:
    pandas = pytest.importorskip("pandas")
    fit = htex.fit(place / "rec.csv", models=["ar", "bands"])
    table = pandas.DataFrame(fit.table())
    assert list(table["model"]) == ["org.htex.ar", "org.htex.bands"]
    for i, model in enumerate(table["model"]):
        error = htex.agreement(fit.spectra[0], fit.texture.read_spectrum(model=model))
        assert table["band_error_rms_db"][i] == pytest.approx(error.band_error_rms_db, abs=1e-4)


def test_arrays_have_the_channels_of_files(place: pathlib.Path) -> None:
    with open(place / "rec.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    columns = [name for name in ("fx_n", "fy_n", "fz_n") if name in rows[0]]
    array = np.array([[float(row[name]) for name in columns] for row in rows])
    rate = htex.process(place / "rec.csv").rate_hz
    found = htex.process(array, rate_hz=rate)
    np.testing.assert_allclose(
        found.spectrum.magnitude, htex.process(place / "rec.csv").spectrum.magnitude, rtol=1e-6
    )
    assert found.condition.force_n is not None
    assert htex.fit(array, rate_hz=rate, models="ar").texture.name == "array"


def test_columns_of_frames_are_known_by_their_names(place: pathlib.Path) -> None:
    import pandas as pd

    # The later columns come first here. Their names state what they are.
    frame = pd.read_csv(place / "rec.csv", comment="#").iloc[:, ::-1]
    expected = htex.process(place / "rec.csv")
    for recording in [frame, {name: frame[name].to_numpy() for name in frame}]:
        found = htex.process(recording)
        assert np.array_equal(found.spectrum.magnitude, expected.spectrum.magnitude)
        assert (found.rate_hz, found.condition) == (expected.rate_hz, expected.condition)
    # Times in the index, and names that CSV would have to quote.
    timed = frame.drop(columns="t_s").set_index(pd.to_timedelta(frame["t_s"], unit="s"))
    found = htex.process(timed.rename_axis(None).assign(**{"it's, a µ": 0.0}))
    np.testing.assert_allclose(found.spectrum.magnitude, expected.spectrum.magnitude, rtol=1e-9)
    with pytest.raises(htex.OptionError, match="double quote"):
        htex.process(frame.assign(**{'a"b': 0.0}))
    with pytest.raises(htex.OptionError, match="2 to 3 numbers"):
        htex.process({"time_s": [0.0, 1.0], "fx_n": [1.0, 2.0, 3.0]})
    unnamed = pd.DataFrame(frame[["fx_n", "fy_n"]].to_numpy())
    as_array = htex.process(unnamed.to_numpy(), rate_hz=20_000)
    assert np.array_equal(htex.process(unnamed, rate_hz=20_000).spectrum.magnitude, as_array.spectrum.magnitude)


def test_masked_samples_are_refused() -> None:
    noise = np.random.default_rng(1).normal(size=10_000)
    masked = np.ma.masked_greater(noise, 2.0)
    for recording in [masked, {"lateral_n": masked}]:
        with pytest.raises(htex.OptionError, match="masked values; leave their rows out, or fill them"):
            htex.process(recording, rate_hz=1e4)
    whole = np.ma.masked_array(noise)
    assert htex.process(whole, rate_hz=1e4).segments == htex.process(noise, rate_hz=1e4).segments


def test_a_fit_says_what_is_felt(place: pathlib.Path) -> None:
    fit = htex.fit(place / "rec.csv", models=["ar", "sbeta"])
    expected = json.loads(command("fit", "rec.csv", "--model", "ar,sbeta", "-o", "felt.htex", "--json", cwd=place).stdout)
    assert [at for model in fit.felt for at in model] == [
        at["felt"] for representation in expected["representations"] for at in representation["at"]
    ]


def test_unusable_recordings_are_refused(place: pathlib.Path) -> None:
    noise = np.random.default_rng(1).normal(size=10_000)
    for arguments, options, error in [
        (place / "missing.csv", {}, FileNotFoundError),
        (place, {}, OSError),
        (noise, {}, htex.OptionError),
        (noise, {"rate_hz": np.nan}, htex.OptionError),
        (noise, {"rate_hz": 50.0}, htex.RecordingError),
        (noise[:10], {"rate_hz": 1e4}, htex.RecordingError),
        (noise * np.nan, {"rate_hz": 1e4}, htex.RecordingError),
        (noise.reshape(10, 10, 100), {"rate_hz": 1e4}, htex.RecordingError),
        (np.zeros((0,)), {"rate_hz": 1e4}, htex.RecordingError),
        (b"", {}, htex.RecordingError),
        (b"RIFF", {}, htex.RecordingError),
        (np.array(["a", "b"]), {"rate_hz": 1e4}, TypeError),
        (noise, {"rate_hz": 1e4, "quantity": "heat"}, htex.OptionError),
        (noise, {"rate_hz": 1e4, "segments": "all"}, htex.OptionError),
        (noise, {"rate_hz": 1e4, "averaging": "median"}, htex.OptionError),
        (noise, {"rate_hz": 1e4, "map": "nonsense"}, htex.OptionError),
        (noise, {"rate_hz": 1e4, "speed_mm_s": -1.0}, htex.RecordingError),
        (noise, {"rate_hz": 1e4, "response": "missing.csv"}, FileNotFoundError),
    ]:
        with pytest.raises(error):
            htex.process(arguments, **options)


def test_unusable_fits_are_refused(place: pathlib.Path) -> None:
    for options, error in [
        ({"models": ["wavelet"]}, htex.ModelError),
        ({"options": {"ar": {"order": 1000}}}, htex.OptionError),
        ({"options": {"ar": {"length": 1}}}, htex.OptionError),
        ({"models": "ar", "options": {"bands": {"bands": 9}}}, htex.OptionError),
        ({"level": "loud"}, htex.OptionError),
        ({"conditions": [(80, 0.4)] * 2}, htex.OptionError),
        ({"name": " "}, htex.AssetError),
        ({"doi": "no"}, htex.AssetError),
        ({"plugins": ["missing.wasm"]}, htex.ModelError),
    ]:
        with pytest.raises(error):
            htex.fit(place / "rec.csv", **options)
    for function in [htex.fit, htex.tradeoff]:
        with pytest.raises(htex.OptionError):
            function([])
        with pytest.raises(htex.OptionError):
            function(place / "rec.csv", models=[])


def test_unusable_spectra_are_refused() -> None:
    ones = np.ones(197)
    for reference, magnitude, options in [
        (ones, ones[:10], {}),
        (ones, -ones, {}),
        (ones * np.nan, ones, {}),
        (ones, ones, {"frequency_hz": np.zeros(197)}),
        (ones, ones, {"band_hz": (1000.0, 20.0)}),
        (ones, ones, {"band_hz": (0.0, np.nan)}),
        (ones[:0], ones[:0], {"frequency_hz": ones[:0]}),
    ]:
        with pytest.raises(htex.OptionError):
            htex.agreement(reference, magnitude, **options)
    zeros = htex.agreement(ones * 0, ones * 0)
    assert zeros.third_octave_error_rms_db is None


def test_another_thread_runs_during_a_fit(place: pathlib.Path) -> None:
    ticks, done = [], threading.Event()

    def count() -> None:
        while not done.wait(0.001):
            ticks.append(1)

    thread = threading.Thread(target=count)
    thread.start()
    htex.fit(place / "rec.csv")
    during = len(ticks)
    done.set()
    thread.join()
    assert during > 5


def test_expressions_and_a_tracker_are_options_of_reading(tmp_path: pathlib.Path) -> None:
    force = closed_form()
    columns = [np.arange(len(force)) / 20_000 + 5, 0.5 * force[:, 0] + 0.1, 0.5 * force[:, 0] - 0.1, force[:, 1]]
    recording, tracker = tmp_path / "force.csv", tmp_path / "tracker.csv"
    np.savetxt(recording, np.stack(columns, axis=1), delimiter=",", header="t_s,a,b,y", comments="")
    stamp = np.arange(4.9, 15.2, 1 / 60)
    np.savetxt(tracker, np.stack([1000 * stamp, 80 * stamp], axis=1), delimiter=",", header="stamp,px", comments="")
    reading = {"map": "lateral_x=a+b,lateral_y=y", "tracker": tracker, "tracker_map": "time=stamp:0.001,x=px:1"}
    found = htex.process(recording, **reading)
    plain = htex.process(force, rate_hz=20_000)
    np.testing.assert_allclose(found.spectrum.magnitude, plain.spectrum.magnitude, rtol=1e-6, atol=1e-12)
    assert found.condition.speed_mm_s == pytest.approx(80, rel=1e-3)
    with pytest.raises(htex.OptionError, match="character 11"):
        htex.process(recording, map="lateral=a+*b")
    with pytest.raises(htex.RecordingError, match="map them, as in time=COLUMN,x=COLUMN:SCALE"):
        htex.process(recording, map="lateral=a", tracker=tracker)
