"""Register, fit and play models that are written in Python, and check their errors."""

from __future__ import annotations

import json
import pathlib
import pickle
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from conftest import command
from scipy import signal

import htex

ID = "org.example.plateau"


@pytest.fixture(autouse=True)
def clean() -> Iterator[None]:
    """Each test begins without registered models."""
    yield
    for model in htex.models():
        if not model["id"].startswith("org.htex."):
            assert htex.unregister_model(model["id"])


class Plateau:
    """Flat noise between two frequencies."""

    id = ID
    fields = [
        htex.Field("low_hz", "Hz", 0, 2000, "Lowest frequency."),
        htex.Field("high_hz", "Hz", 0, 2000, "Highest frequency."),
    ]

    def fit(self, frequency_hz: np.ndarray, magnitude: np.ndarray) -> dict[str, Any]:
        power = np.cumsum(magnitude**2)
        low, high = np.searchsorted(power, [0.05 * power[-1], 0.95 * power[-1]])
        return {"low_hz": frequency_hz[low], "high_hz": frequency_hz[high]}

    def magnitude(self, parameters: dict[str, Any], frequency_hz: np.ndarray) -> np.ndarray:
        inside = (frequency_hz >= parameters["low_hz"]) & (frequency_hz <= parameters["high_hz"])
        return 3.0 * inside


class Counter(Plateau):
    """Samples that are known: 0, 1, 2, … by the seed and the parameters."""

    class Voice:
        def __init__(self, parameters: dict[str, Any], seed: int) -> None:
            self.step = parameters["high_hz"]
            self.next = seed

        def render(self, n: int) -> np.ndarray:
            first, self.next = self.next, self.next + n
            return (np.arange(first, first + n) % 7) * self.step

    def voice(self, parameters: dict[str, Any], rate_hz: float, seed: int) -> Voice:
        return self.Voice(parameters, seed)

    def fit(self, frequency_hz: np.ndarray, magnitude: np.ndarray) -> dict[str, Any]:
        return {"low_hz": 20, "high_hz": 0.5}

    def magnitude(self, parameters: dict[str, Any], frequency_hz: np.ndarray) -> np.ndarray:
        return np.ones_like(frequency_hz)


def test_a_model_is_registered_and_fitted(place: pathlib.Path) -> None:
    assert htex.register_model(Plateau) is Plateau
    described = {model["id"]: model for model in htex.models()}[ID]
    assert described["name"] == "Plateau" and described["summary"] == "Flat noise between two frequencies."
    fit = htex.fit(place / "rec.csv", models=["plateau", "ar"])
    texture = fit.texture
    assert texture.models == [ID, "org.htex.ar"]
    expected = Plateau().fit(fit.spectra[0].frequency_hz, fit.spectra[0].magnitude)
    assert texture.parameters(model="plateau") == expected
    spectrum = texture.spectrum(model="plateau")
    inside = (spectrum.frequency_hz >= expected["low_hz"]) & (spectrum.frequency_hz <= expected["high_hz"])
    # The RMS of magnitudes m on the grid is sqrt(Σ m² / 3).
    level = texture.level(model="plateau")
    np.testing.assert_allclose(spectrum.magnitude, inside * level * np.sqrt(3 / inside.sum()), rtol=1e-9)
    assert level == pytest.approx(np.sqrt((fit.spectra[0].magnitude ** 2).sum() / 3), rel=1e-6)
    outside = texture.spectrum([1.0, 5000.0], model="plateau").magnitude
    assert not outside.any()
    models = htex.fit(place / "rec.csv").texture.models
    assert models[0] == "org.htex.ar" and models[-1] == ID


def test_an_asset_names_a_model_of_python(place: pathlib.Path) -> None:
    htex.register_model(Plateau)
    fit = htex.fit(place / "rec.csv", models="plateau")
    assert any(f"{ID} is a model of Python, this process only" in warning for warning in fit.warnings)
    fit.texture.save(place / "plateau.htex")
    said = command("info", "plateau.htex", cwd=place).stdout
    assert "Python, this process only" in said
    assert ID in command("synth", "plateau.htex", "-o", "p.wav", cwd=place, code=2).stderr
    samples = htex.open(place / "plateau.htex").voice().render(100)
    assert samples.any()
    assert htex.unregister_model(ID) and not htex.unregister_model(ID)
    with pytest.raises(htex.ModelError, match=ID):
        htex.open(place / "plateau.htex").voice()
    # A texture keeps the models with which it was opened. A pickled texture is opened again.
    assert fit.texture.voice().render(100).tobytes() == samples.tobytes()
    with pytest.raises(htex.ModelError, match=ID):
        pickle.loads(pickle.dumps(fit.texture)).voice()


def test_noise_has_the_magnitudes_of_the_model(place: pathlib.Path) -> None:
    htex.register_model(Plateau)
    texture = htex.fit(place / "rec.csv", models="plateau").texture
    samples = texture.voice(seed=3).render(20_000 * 60)
    frequency, power = signal.welch(samples, 20_000, "hann", 4000, scaling="spectrum")
    parameters = texture.parameters()
    # The two bins next to each edge contain parts of both sides.
    inside = (frequency > parameters["low_hz"] + 10) & (frequency < parameters["high_hz"] - 10)
    expected = texture.spectrum(frequency[inside]).magnitude
    assert 10 * abs(np.log10(2 * power[inside].mean() / (expected**2).mean())) < 0.3
    outside = (frequency < parameters["low_hz"] - 10) | (frequency > parameters["high_hz"] + 10)
    assert power[outside].sum() < 1e-3 * power.sum()
    whole = texture.voice(seed=3)
    assert np.concatenate([whole.render(n) for n in (1, 999, 19_000)]).tobytes() == samples[:20_000].tobytes()


def test_noise_is_that_of_a_built_in_model_with_the_same_curve(place: pathlib.Path) -> None:
    class Same:
        """The curve of sBeta, asked from the built-in model."""

        id = "org.example.same"
        fields = [htex.Field("alpha", "1", 0, 1e6), htex.Field("beta", "1", 0, 1e6)]
        builtin = htex.fit(place / "rec.csv", models="sbeta").texture

        def fit(self, frequency_hz: np.ndarray, magnitude: np.ndarray) -> dict[str, Any]:
            return dict(zip(["alpha", "beta"], self.builtin.parameters().values()))

        def magnitude(self, parameters: dict[str, Any], frequency_hz: np.ndarray) -> np.ndarray:
            return self.builtin.spectrum(frequency_hz).magnitude

    htex.register_model(Same)
    texture = htex.fit(place / "rec.csv", models=["same", "sbeta"]).texture
    own, builtin = (texture.voice(model, seed=5).render(20_000) for model in ("same", "sbeta"))
    np.testing.assert_allclose(own, builtin, rtol=0, atol=1e-5 * abs(builtin).max())


def test_a_voice_of_the_model_plays_its_own_samples(place: pathlib.Path) -> None:
    htex.register_model(Counter)
    texture = htex.fit(place / "rec.csv", models="plateau").texture
    at = texture.conditions[0]
    for seed, blocks in [(0, [1000]), (3, [1, 64, 935])]:
        voice = texture.voice(seed=seed, speed_mm_s=at.speed_mm_s, force_n=at.force_n)
        samples = np.concatenate([voice.render(n) for n in blocks])
        known = (np.arange(seed, seed + 1000) % 7 * 0.5).astype(np.float32)
        np.testing.assert_allclose(samples, texture.level() * known, rtol=1e-6)


def test_lists_are_parameters(place: pathlib.Path) -> None:
    class Peaks:
        """Lines."""

        id = "org.example.peaks"
        fields = [htex.Field("peak_hz", "Hz", 20, 1000, most=4), htex.Field("width_hz", "Hz", 1, 100)]

        def fit(self, frequency_hz: np.ndarray, magnitude: np.ndarray) -> dict[str, Any]:
            return {"width_hz": 20, "peak_hz": frequency_hz[np.argsort(magnitude)[-3:]]}

        def magnitude(self, parameters: dict[str, Any], frequency_hz: np.ndarray) -> np.ndarray:
            distance = frequency_hz[:, None] - np.array(parameters["peak_hz"])
            return np.exp(-((distance / parameters["width_hz"]) ** 2)).sum(axis=1)

    htex.register_model(Peaks)
    fit = htex.fit(place / "rec.csv", models="peaks")
    strongest = fit.spectra[0].frequency_hz[np.argsort(fit.spectra[0].magnitude)[-3:]]
    assert fit.texture.parameters() == {"peak_hz": list(strongest), "width_hz": 20.0}
    assert fit.texture.voice().render(1000).any()


def test_a_voice_follows_the_conditions(place: pathlib.Path) -> None:
    command("simulate", "--surface", "coarse-fabric", "--speed", "40", "-o", "slow.csv", cwd=place)
    recordings = [place / "rec.csv", place / "slow.csv"]
    conditions = [(80, 0.4), (40, 0.4)]
    htex.register_model(Plateau)
    texture = htex.fit(recordings, models="plateau", conditions=conditions).texture
    mixed = texture.parameters(at=(60, 0.4))["high_hz"]
    ends = [texture.parameters(at=at)["high_hz"] for at in conditions]
    assert min(ends) < mixed < max(ends)
    path = texture.voice().render_path(np.linspace(40, 80, 50), 0.4, block=100)
    assert path.any() and np.isfinite(path).all()

    htex.register_model(Counter)
    texture = htex.fit(recordings, models="plateau", conditions=conditions).texture
    with pytest.raises(htex.ModelError, match="has no retune") as raised:
        texture.voice().render_path(np.linspace(40, 80, 50), 0.4)
    assert isinstance(raised.value.__cause__, TypeError)


def test_models_play_in_scenes_and_sweeps(place: pathlib.Path) -> None:
    htex.register_model(Plateau)
    htex.fit(place / "rec.csv", models="plateau").texture.save(place / "plateau.htex")
    content = {
        "htex_scene": "1.0",
        "surfaces": [{"asset": "plateau.htex"}],
        "motion": {"constant": {"speed_mm_s": 80, "force_n": 0.4}},
        "duration_s": 0.2,
    }
    (place / "plateau.scene.json").write_text(json.dumps(content))
    assert htex.Scene(place / "plateau.scene.json").render().any()
    assert "plateau" in str(htex.tradeoff(place / "rec.csv", models="plateau").columns["model"])


def fail(*_: Any) -> Any:
    raise LookupError("no such\nsurface")


@pytest.mark.parametrize(
    ("method", "returned", "message", "cause"),
    [
        ("fit", fail, "LookupError: no such surface", LookupError),
        ("fit", lambda *_: {"low_hz": 20}, "fit returned low_hz; return low_hz, high_hz", ValueError),
        ("fit", lambda *_: [20, 30], "fit returned list; return a dict with low_hz, high_hz", TypeError),
        ("fit", lambda *_: {"low_hz": 20, "high_hz": "x"}, "could not convert", ValueError),
        ("fit", lambda *_: {"low_hz": 20, "high_hz": np.ones(2)}, "TypeError", TypeError),
        ("fit", lambda *_: {"low_hz": 20, "high_hz": np.nan}, "`high_hz`", None),
        ("fit", lambda *_: {"low_hz": -1, "high_hz": 30}, "`low_hz`", None),
        ("magnitude", fail, "LookupError: no such surface", LookupError),
        ("magnitude", lambda _, p, f: f[:-1], "return one magnitude for each", ValueError),
        ("magnitude", lambda _, p, f: 1.0, "return one magnitude for each", ValueError),
        ("magnitude", lambda _, p, f: f * np.nan, "magnitude returned nan at 20 Hz", ValueError),
        ("magnitude", lambda _, p, f: f - 500, "magnitude returned -480.0 at 20 Hz", ValueError),
        ("magnitude", lambda _, p, f: None, "return one magnitude for each", ValueError),
        ("magnitude", lambda _, p, f: 0 * f, "the magnitude is 0", None),
        ("magnitude", lambda _, p, f: 1e300 * f, "too large", None),
        ("voice", fail, "LookupError: no such surface", LookupError),
        ("voice", lambda *_: None, "has no render", TypeError),
        ("render", fail, "LookupError: no such surface", LookupError),
        ("render", lambda _, n: np.zeros(n + 1), "return one number for each", ValueError),
        ("render", lambda _, n: np.zeros((n, 1)), "return one number for each", ValueError),
        ("render", lambda _, n: 0.0, "return one number for each", ValueError),
        ("render", lambda _, n: np.full(n, np.nan), "render returned nan at sample 0", ValueError),
        ("render", lambda _, n: np.full(n, 1e39), "render returned inf at sample 0", ValueError),
        ("render", lambda _, n: ["x"] * n, "could not convert", ValueError),
    ],
)
def test_an_error_of_python_is_the_cause_of_a_model_error(
    place: pathlib.Path, method: str, returned: Any, message: str, cause: type[Exception] | None
) -> None:
    model = type("Broken", (Counter,), {})
    if method == "render":
        model.Voice = type("Voice", (Counter.Voice,), {"render": returned})
    else:
        setattr(model, method, returned)
    htex.register_model(model)
    for models in ["plateau", ["ar", "plateau"]]:
        with pytest.raises(htex.ModelError) as raised:
            htex.fit(place / "rec.csv", models=models)
        assert message in str(raised.value) and ID in str(raised.value)
        assert type(raised.value.__cause__) is (cause or type(None))


def test_a_voice_that_fails_continues_afterwards(place: pathlib.Path) -> None:
    class Sometimes(Counter):
        class Voice(Counter.Voice):
            def render(self, n: int) -> np.ndarray:
                if n == 13:
                    raise OverflowError("thirteen")
                return super().render(n)

    htex.register_model(Sometimes)
    voice = htex.fit(place / "rec.csv", models="plateau").texture.voice()
    assert voice.render(100).any()
    with pytest.raises(htex.ModelError, match="voice_render: OverflowError: thirteen") as raised:
        voice.render(13)
    assert isinstance(raised.value.__cause__, OverflowError)
    out = np.ones(13, dtype=np.float32)
    with pytest.raises(htex.ModelError):
        voice.render_into(out)
    assert not out.any()
    assert voice.render(100).any()


def test_an_interrupt_stays_an_interrupt(place: pathlib.Path) -> None:
    def interrupt(*_: Any) -> Any:
        raise KeyboardInterrupt

    htex.register_model(type("Stopped", (Plateau,), {"fit": interrupt}))
    with pytest.raises(KeyboardInterrupt):
        htex.fit(place / "rec.csv", models="plateau")


def test_unusable_classes_are_refused() -> None:
    for attributes, error in [
        ({"id": "plateau"}, htex.OptionError),
        ({"id": "org.htex.ar"}, htex.OptionError),
        ({"id": 7}, htex.OptionError),
        ({"version": "new"}, htex.OptionError),
        ({"fields": []}, htex.OptionError),
        ({"fields": ["low_hz"]}, TypeError),
        ({"fields": [htex.Field("x", "1", 1, 0)]}, htex.OptionError),
        ({"fields": [htex.Field("x", "1", np.nan, 0)]}, htex.OptionError),
        ({"fields": [htex.Field("x", "1", 0, 1)] * 2}, htex.OptionError),
        ({"fields": [htex.Field("x", "1", 0, 1, most=-1)]}, htex.OptionError),
        ({"__init__": fail}, LookupError),
    ]:
        with pytest.raises(error):
            htex.register_model(type("Unusable", (Plateau,), attributes))
    with pytest.raises(TypeError, match="give the class itself"):
        htex.register_model(Plateau())  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="has no `id`"):
        htex.register_model(type("Nothing", (), {}))
    assert all(model["id"].startswith("org.htex.") for model in htex.models())


def test_a_model_replaces_that_of_its_id(place: pathlib.Path) -> None:
    htex.register_model(Plateau)
    old = htex.fit(place / "rec.csv", models="plateau").texture
    htex.register_model(Counter)
    assert sum(model["id"] == ID for model in htex.models()) == 1
    new = htex.fit(place / "rec.csv", models="plateau").texture
    assert new.parameters()["high_hz"] == 0.5 and old.parameters()["high_hz"] > 20


def test_threads_play_models_of_python(place: pathlib.Path) -> None:
    htex.register_model(Counter)
    texture = htex.fit(place / "rec.csv", models="plateau").texture
    voice, parts = texture.voice(), []
    threads = [threading.Thread(target=lambda: parts.append(voice.render(7000))) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({part.tobytes() for part in parts}) == 1 and len(parts) == 6
