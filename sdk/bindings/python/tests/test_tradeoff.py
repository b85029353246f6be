"""Trade-offs as tables, and plots."""

from __future__ import annotations

import pathlib

import pytest

import htex


def test_a_sweep_is_a_table(place: pathlib.Path) -> None:
    pandas = pytest.importorskip("pandas")
    found = htex.tradeoff(place / "rec.csv", models="sbeta", quick=True, segments="windows")
    table = pandas.DataFrame(found.columns)
    assert set(table["model"]) == {"sbeta", "quantised-spectrum", "recording"}
    assert (table["bytes"] > 0).all() and table["on_front"].any()
    fit = htex.fit(place / "rec.csv", models="sbeta", segments="windows").table()
    error = table[(table["model"] == "sbeta")]["band_error_rms_db"]
    assert (abs(error - fit["band_error_rms_db"][0]) < 1e-3).any()
    assert found.about["error"] == "held_out"
    recording = table[table["model"] == "recording"]
    assert (recording["held_out_error"] == 1.0).all()
    floor_db = found.about["recordings"][0]["floor_db"]
    assert (table["held_out_error_db"] / table["held_out_error"] - floor_db).abs().max() < 1e-9
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from htex import plot

    axes = plot.tradeoff(found)
    assert len(axes.collections) == 3
    with pytest.raises(htex.OptionError):
        htex.tradeoff(place / "rec.csv", error="loudness")  # type: ignore[arg-type]


def test_spectra_are_drawn(texture: htex.Texture, place: pathlib.Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from htex import plot

    found = htex.process(place / "rec.csv")
    axes = plot.texture(texture, reference=found.spectrum)
    assert len(axes.lines) == 1 + len(texture.models)
    assert axes.get_ylabel() == "magnitude / N"
    axes.set_xlim(20, 1000)
    axes.figure.canvas.draw()
    ticks = [tick.label1.get_text() for tick in axes.xaxis.get_major_ticks() if 20 <= tick.get_loc() <= 1000]
    assert axes.get_xscale() == "log" and ticks == ["20", "50", "100", "200", "500", "1000"]
    assert not any(tick.label1.get_text() for tick in axes.xaxis.get_minor_ticks())
