"""Plans and samples of scenes are equal to those of the command."""

from __future__ import annotations

import json
import pathlib

import numpy as np
import pytest
from conftest import command
from scipy.io import wavfile

import htex


def scene(place: pathlib.Path, **more: object) -> pathlib.Path:
    content = {
        "htex_scene": "1.0",
        "surfaces": [{"asset": "cloth.htex", "representation": "ar"}],
        "motion": {"constant": {"speed_mm_s": 80, "force_n": 0.4}},
        "duration_s": 1.0,
        **more,
    }
    path = place / "s.scene.json"
    path.write_text(json.dumps(content))
    return path


def test_plan_and_samples_are_those_of_the_command(place: pathlib.Path) -> None:
    path = scene(place, seed=3)
    opened = htex.Scene(path)
    assert opened.unit == "N" and "Scene" in repr(opened)
    plan = opened.plan()
    assert plan == json.loads(command("plan", path, "--json", cwd=place).stdout)
    assert opened.rate_hz == plan["rate_hz"]
    command("render", path, "-o", "scene.wav", cwd=place)
    expected = wavfile.read(place / "scene.wav")[1]
    assert opened.render().tobytes() == expected.astype(np.float32).tobytes()
    assert len(opened.render(seconds=0.25)) == int(0.25 * opened.rate_hz)


def test_a_scene_is_rendered_at_a_motion(place: pathlib.Path) -> None:
    opened = htex.Scene(scene(place))
    speed = np.concatenate([np.full(300, 80.0), np.zeros(300), np.full(300, -80.0)])
    samples = opened.render_path(speed, 0.4, block=64)
    assert len(samples) == 900 * 64
    rms = [float(np.sqrt(np.mean(part**2))) for part in np.split(samples, 3)]
    # The finger rests in the middle third; its end is silent.
    assert rms[0] > 0 and rms[2] > 0
    assert not samples[500 * 64 : 600 * 64].any()
    again = opened.render_path(speed, 0.4, block=64)
    assert samples.tobytes() == again.tobytes()


def test_unusable_scenes_are_refused(place: pathlib.Path) -> None:
    with pytest.raises(FileNotFoundError):
        htex.Scene(place / "missing.scene.json")
    for more in [{"surfaces": []}, {"surfaces": [{"asset": "missing.htex"}]}, {"speed": 1}]:
        with pytest.raises(htex.SceneError):
            htex.Scene(scene(place, **more))
    (place / "bad.scene.json").write_bytes(b"{")
    with pytest.raises(htex.SceneError):
        htex.Scene(place / "bad.scene.json")
    with pytest.raises(htex.SceneError):
        htex.Scene(scene(place), device="none")
    live = htex.Scene(scene(place, motion="live"))
    with pytest.raises(htex.SceneError):
        live.render(1.0)
    opened = htex.Scene(scene(place))
    with pytest.raises(htex.OptionError):
        opened.render(seconds=float("nan"))
    with pytest.raises(htex.OptionError):
        opened.render_path([80.0], [0.4], x_mm=[1.0])
    with pytest.raises(htex.MotionError, match="block 1"):
        opened.render_path([80.0, np.nan], 0.4)
