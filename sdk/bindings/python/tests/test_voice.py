"""Samples of voices: the same as the command's, in blocks, along paths and in threads."""

from __future__ import annotations

import pathlib
import threading

import numpy as np
import pytest
from conftest import command
from scipy import signal
from scipy.io import wavfile

import htex

N = 40_000


def played(place: pathlib.Path, *flags: str, asset: str = "cloth.htex") -> np.ndarray:
    command("synth", asset, "--seconds", "2", "-o", "out.wav", *flags, cwd=place)
    return wavfile.read(place / "out.wav")[1]


@pytest.fixture(scope="module")
def every(place: pathlib.Path) -> htex.Texture:
    """Return an asset with every model, including the models that are fitted only if they are
    named."""
    command("fit", "rec.csv", "--model", ",".join(model["id"] for model in htex.models()), "-o", "every.htex", cwd=place)
    return htex.open(place / "every.htex")


@pytest.mark.parametrize("model", ["ar", "bands"])
def test_samples_are_those_of_the_command(every: htex.Texture, place: pathlib.Path, model: str) -> None:
    expected = played(place, "--model", model, "--seed", "7", asset="every.htex")
    samples = every.voice(model=model, rate_hz=20_000, seed=7).render(N)
    assert samples.dtype == np.float32
    assert samples.tobytes() == expected.tobytes()


def test_motion_synthesis_and_effects_are_those_of_the_command(texture: htex.Texture, place: pathlib.Path) -> None:
    expected = played(place, "--model", "ar", "--speed", "130", "--force", "0.7")
    assert texture.voice("ar", speed_mm_s=130, force_n=0.7).render(N).tobytes() == expected.tobytes()
    expected = played(place, "--model", "ar", "--speed", "130", "--as-recorded")
    off = {"frequency_scaling": False, "level_scaling": False, "contact": False}
    assert texture.voice("ar", speed_mm_s=130, **off).render(N).tobytes() == expected.tobytes()
    for synthesis in ["loop:0.5", "filter:255"]:
        expected = played(place, "--model", "ar", "--quality", synthesis)
        assert texture.voice("ar", synthesis=synthesis).render(N).tobytes() == expected.tobytes()


def test_blocks_do_not_change_the_samples(texture: htex.Texture) -> None:
    whole = texture.voice("ar").render(N)
    voice = texture.voice("ar")
    blocks = np.zeros(N, dtype=np.float32)
    for start in range(0, N, 1000):
        voice.render_into(blocks[start : start + 1000])
    assert whole.tobytes() == blocks.tobytes()


def test_a_path_is_its_motions_in_turn(texture: htex.Texture) -> None:
    speed = np.linspace(40, 160, 200)
    by_path = texture.voice("ar").render_path(speed, 0.5, block=64)
    voice = texture.voice("ar")
    parts = []
    for x in speed:
        voice.set_motion(x, 0.5)
        parts.append(voice.render(64))
    assert by_path.tobytes() == np.concatenate(parts).tobytes()
    assert len(voice.render_path([80.0], [0.4], [1.0], block=10, x_mm=[3.0], y_mm=-2.0)) == 10
    voice.set_motion(80.0, 0.4, x_mm=3.0, y_mm=-2.0)
    assert len(voice.render_path([], [], block=10)) == 0


def test_coverage_tells_how_a_motion_is_played(texture: htex.Texture) -> None:
    voice = texture.voice("ar")
    recorded = texture.conditions[0]
    assert recorded.speed_mm_s is not None and recorded.force_n is not None
    assert voice.coverage(recorded.speed_mm_s, recorded.force_n).inside
    faster = voice.coverage(2 * recorded.speed_mm_s, recorded.force_n)
    assert faster.speed.kind == "outside" and faster.frequency_factor == pytest.approx(2.0, rel=1e-3)
    assert texture.contact == "finger" and texture.law["frequency_speed"].source == "assumed"
    # The voice plays what the texture states.
    level = texture.level(at=(recorded.speed_mm_s, 2 * recorded.force_n))
    assert level == pytest.approx(2 * texture.level(), rel=0.05) and texture.level(at=(0.0, 0.4)) == 0.0
    assert not voice.coverage(0.0, 0.4).slides


@pytest.mark.parametrize(
    "motion", [(np.nan, 0.4), (-1.0, 0.4), (80.0, np.inf), (80.0, -0.1), (80.0, 0.4, np.nan)]
)
def test_an_invalid_motion_changes_nothing(texture: htex.Texture, motion: tuple[float, ...]) -> None:
    voice, other = texture.voice("ar"), texture.voice("ar")
    with pytest.raises(htex.MotionError):
        voice.set_motion(*motion)
    series = [[80.0, motion[0]], [0.4, motion[1]]]
    if len(motion) == 3:
        series.append([0.0, motion[2]])
    with pytest.raises(htex.MotionError, match="block 1"):
        voice.render_path(*series)
    if len(motion) == 2:
        with pytest.raises(htex.MotionError):
            voice.coverage(*motion)
    assert voice.render(1000).tobytes() == other.render(1000).tobytes()


def test_unusable_arrays_are_refused(texture: htex.Texture) -> None:
    voice = texture.voice("ar")
    read_only = np.zeros(10, dtype=np.float32)
    read_only.flags.writeable = False
    for array, error in [
        (np.zeros(10, dtype=np.float64), TypeError),
        (np.zeros((2, 5), dtype=np.float32), TypeError),
        ([0.0] * 10, TypeError),
        (np.zeros(20, dtype=np.float32)[::2], ValueError),
        (read_only, ValueError),
        (np.zeros(10, dtype=">f4"), TypeError),
    ]:
        with pytest.raises(error):
            voice.render_into(array)
    voice.render_into(np.zeros(0, dtype=np.float32))


def test_unusable_options_are_refused(texture: htex.Texture) -> None:
    for options, error in [
        ({"model": "wavelet"}, htex.ModelError),
        ({"rate_hz": 0.0}, htex.OptionError),
        ({"rate_hz": np.nan}, htex.OptionError),
        ({"synthesis": "granular"}, htex.OptionError),
        ({"speed_mm_s": np.nan}, htex.MotionError),
        ({"position_mm": 1.0}, htex.OptionError),
        ({"ceiling": 0.0}, htex.OptionError),
        ({"x_mm": 1.0, "y_mm": 2.0}, htex.OptionError),
        ({"speed_mm_s": 80.0, "force_n": 0.4, "x_mm": 1.0}, htex.OptionError),
        ({"seed": -1}, OverflowError),
    ]:
        with pytest.raises(error):
            texture.voice(**options)
    voice = texture.voice("ar")
    for block, speed in [(0, [80.0]), (64, [80.0, 80.0])]:
        with pytest.raises(htex.OptionError):
            voice.render_path(speed, [0.4], block=block)
    for speed in ["fast", None, [[80.0]]]:
        with pytest.raises(TypeError, match="one number for each block"):
            voice.render_path(speed, 0.4)  # type: ignore[arg-type]
    with pytest.raises(htex.OptionError):
        voice.render_path([80.0] * 3, 0.4, block=2**63)
    with pytest.raises(MemoryError):
        voice.render(2**61)
    with pytest.raises(OverflowError):
        voice.render(-1)


def test_another_thread_runs_while_samples_are_rendered(texture: htex.Texture) -> None:
    voice = texture.voice("ar", rate_hz=48_000)
    ticks, done = [], threading.Event()

    def count() -> None:
        while not done.wait(0.001):
            ticks.append(1)

    thread = threading.Thread(target=count)
    thread.start()
    voice.render(4_000_000)
    during = len(ticks)
    done.set()
    thread.join()
    assert during > 1


def test_a_voice_is_shared_by_threads(texture: htex.Texture) -> None:
    voice = texture.voice("ar")
    parts: list[np.ndarray] = []
    threads = [threading.Thread(target=lambda: parts.append(voice.render(5000))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    whole = texture.voice("ar").render(40_000).reshape(8, 5000)
    assert {part.tobytes() for part in parts} == {row.tobytes() for row in whole}


def test_the_envelope_is_that_of_the_samples(texture: htex.Texture) -> None:
    voice = texture.voice("ar", envelope_bands=3, gain=0.5, limit=0.02)
    samples = np.concatenate([voice.render(n) for n in (1, 4_000, 19_999, 36_000)]).astype(float)
    assert np.abs(samples).max() <= np.float32(0.02)
    envelope = voice.envelope()
    assert envelope.frames == len(samples)
    assert envelope.level_rms == pytest.approx(np.sqrt(np.mean(samples**2)), rel=1e-6)
    # Hann windows of 1024 samples. One ends every 256 samples, and samples before the first are 0.
    padded = np.concatenate([np.zeros(1024), samples])
    ends = np.arange(256, len(samples) + 1, 256)
    window = signal.get_window("hann", 1024)
    spectra = np.fft.rfft([padded[end : end + 1024] * window for end in ends])
    power = np.mean(np.abs(spectra) ** 2, axis=0) / (1024 * np.sum(window**2))
    power[1:-1] *= 2.0
    frequency_hz = np.fft.rfftfreq(1024, 1 / 20_000)
    assert envelope.centroid_hz == pytest.approx(np.sum(power * frequency_hz) / np.sum(power), rel=1e-6)
    edges_hz = voice.envelope_edges_hz
    assert edges_hz == pytest.approx(20.0 * 50.0 ** (np.arange(4) / 3))
    band = np.searchsorted(edges_hz[1:-1], frequency_hz, side="right")
    assert envelope.bands == pytest.approx(np.bincount(band, power), rel=1e-6)
    assert voice.envelope().frames == 0
    voice.set_motion(0.0, 0.0)
    voice.render(1_000)
    assert voice.is_silent
    with pytest.raises(htex.OptionError):
        voice.set_gain(-1.0)
    with pytest.raises(htex.OptionError):
        texture.voice("ar").envelope()
    with pytest.raises(htex.OptionError):
        texture.voice("ar", rate_hz=1_000.0)
