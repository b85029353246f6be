"""The paper's figures, drawn from an analysis: SVG for pages, PDF for papers."""

from __future__ import annotations

import io
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from .regression import MOST, bank
from .results import AnalysisDict
from .text import level_names, stars

#: Colours of models: the palette of Okabe and Ito, which colour-blind readers can tell apart.
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#b8a200")
#: Makes equal numbers give equal files: ids come from a constant, there is no date, and text stays
#: text.
_STYLE: Any = {
    "svg.hashsalt": "htex",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "font.size": 9,
    "axes.spines.top": False,
}


def figures(result: AnalysisDict) -> dict[str, Figure]:
    """Return all figures by their file names."""
    with matplotlib.rc_context({**_STYLE, "axes.spines.right": False}):
        found = _ratings(result)
        if result["equivalence"]["pairs"]:
            found["equivalence"] = _equivalence(result)
        if "spectral_correlation" in result:
            found.update(_correlations(result))
        if "best_bands" in result:
            found["bands"] = _bands(result)
        return found


def to_svg(figure: Figure, title: str) -> str:
    """Return the figure as an SVG element for a page."""
    svg = _saved(figure, "svg", {"Date": None, "Creator": None}).decode()
    return f'<svg role="img" aria-label="{title}"' + svg[svg.index("<svg") + 4 :]


def to_pdf(figure: Figure) -> bytes:
    """Return the figure as a PDF."""
    return _saved(figure, "pdf", {"CreationDate": None})


def _saved(figure: Figure, form: str, metadata: dict[str, None]) -> bytes:
    buffer = io.BytesIO()
    with matplotlib.rc_context(_STYLE):
        figure.savefig(buffer, format=form, metadata=metadata)
    return buffer.getvalue()


def _new(rows: int = 1, columns: int = 1, width: float = 4.6, height: float = 3.1) -> tuple[Figure, Any]:
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False).ravel()


def _ratings(result: AnalysisDict) -> dict[str, Figure]:
    """Draw the paper's figures 3B and S5: ratings by model, for all textures together and for each
    texture. In a study with one model, draw ratings by texture.
    """
    name, levels, key = level_names(result)
    overall: Any = result.get("means_texture", result["means_model"])
    groups = {"": (overall, result[key])}  # type: ignore[literal-required]
    if name == "Models" and len(result["textures"]) > 1:
        for texture in result["textures"]:
            means = [mean for mean in result["means"] if mean["texture"] == texture]
            groups[texture] = (means, result["pairs_by_texture"].get(texture, []))
    axis = _limits(value for means, _ in groups.values() for mean in means for value in mean["by_participant"])
    return {
        f"ratings-{texture or 'all'}": _strips(means, pairs, levels, texture, "mean rating", axis)
        for texture, (means, pairs) in groups.items()
    }


def _correlations(result: AnalysisDict) -> dict[str, Figure]:
    """Draw the paper's figure 3A: the correlation of felt spectra with recorded spectra."""
    found = result["spectral_correlation"]
    axis = _limits(value for mean in [*found["means"], *found["means_model"]] for value in mean["by_participant"])
    groups = {"": found["means_model"]}
    if len(result["textures"]) > 1:
        groups.update({t: [mean for mean in found["means"] if mean["texture"] == t] for t in result["textures"]})
    return {
        f"correlation-{texture or 'all'}": _strips(means, [], result["models"], texture, "spectral correlation", axis)
        for texture, means in groups.items()
        if means
    }


def _limits(values: Any) -> tuple[float, float]:
    """Return the axis range that all plots of a figure share."""
    numbers = list(values) or [0.0, 1.0]
    margin = 0.05 * max(max(numbers) - min(numbers), 1e-9)
    return min(numbers) - margin, max(numbers) + margin


def _strips(means: Any, pairs: Any, levels: list[str], texture: str, label: str, limits: tuple[float, float]) -> Figure:
    """Draw one column per level: a dot for each participant, a diamond for their mean, their
    distribution in the background, and brackets over levels that differ.
    """
    figure, (ax,) = _new(width=max(4.6, 0.42 * len(levels) + 1.4))
    key = "model" if means and means[0].get("model") in levels else "texture"
    for mean in means:
        index, values = levels.index(mean[key]), np.array(mean["by_participant"])
        color = _COLORS[index % len(_COLORS)]
        if len(values) > 1 and np.ptp(values) > 1e-9:
            body = ax.violinplot([values], [index], widths=0.8, showextrema=False)["bodies"][0]
            body.set(facecolor=color, alpha=0.22, edgecolor="none")
        spread = 0.22 * (np.arange(len(values)) * 0.618 % 1 - 0.5)
        ax.plot(index + spread, values, "o", color=color, markersize=3, alpha=0.8)
        ax.plot(index, mean["mean"], "D", color="white", markeredgecolor="#222", markersize=6)
    _brackets(ax, pairs, levels, limits)
    turned = len(levels) > 8 or max(map(len, levels)) > 12
    ax.set_xticks(range(len(levels)), levels, rotation=40 if turned else 0, ha="right" if turned else "center")
    ax.set(title=texture or "All textures", ylabel=label, xlim=(-0.6, len(levels) - 0.4))
    return figure


def _brackets(ax: Any, pairs: Any, levels: list[str], limits: tuple[float, float]) -> None:
    """Draw brackets over levels that differ significantly after Holm's correction. Neighbouring
    levels come first.

    With more than 8 levels, draw no brackets, because only their stars would be visible.
    """
    low, high = limits
    found = [(levels.index(p["a"]), levels.index(p["b"]), p["p_holm"]) for p in pairs if p.get("p_holm", 1) < 0.05]
    step = 0.09 * (high - low)
    shown = sorted(found, key=lambda f: (f[1] - f[0], f[0])) if len(levels) <= 8 else []
    for rank, (start, end, p) in enumerate(shown):
        y = high + rank * step
        ax.plot([start, start, end, end], [y - step / 4, y, y, y - step / 4], color="#444", linewidth=0.8)
        ax.text((start + end) / 2, y - step / 6, stars(p), ha="center", va="bottom", fontsize=7, color="#222")
    ticks = [tick for tick in ax.get_yticks() if low <= tick <= high]
    ax.set_yticks(ticks)
    ax.set_ylim(low, high + step * (len(shown) + 0.5))


def _equivalence(result: AnalysisDict) -> Figure:
    """Draw the 90 % interval of every difference, and the bound.

    Two levels are equally good if their interval lies within the bound.
    """
    tested = result["equivalence"]
    pairs = tested["pairs"][:60]
    figure, (ax,) = _new(width=6.4, height=0.9 + 0.22 * len(pairs))
    ax.axvspan(-tested["bound"], tested["bound"], color="#009e73", alpha=0.12)
    ax.axvline(0, color="#888", linewidth=0.8)
    for row, pair in enumerate(pairs):
        color = "#009e73" if pair["equivalent"] else "#444"
        ax.plot(pair["ci90"], [row, row], color=color, linewidth=1.6)
        ax.plot(sum(pair["ci90"]) / 2, row, "o", color=color, markersize=4)
    ax.set_yticks(range(len(pairs)), [f"{pair['a']} – {pair['b']}" for pair in pairs])
    ax.set(
        ylim=(len(pairs) - 0.5, -0.5),
        xlabel="difference of ratings, 90 % interval",
        title=f"Within {tested['bound']:g}",
    )
    return figure


def _bands(result: AnalysisDict) -> Figure:
    """Draw the paper's figure 3C: metrics of the regressions over the number of bands, signs of
    overfitting, and the best filter bank.
    """
    figure, axes = _new(2, 3, width=4.1)
    panels: list[tuple[str, str, dict[str, Any]]] = [
        # p-values that are too small for a double are 0, which a logarithmic axis cannot show.
        ("p-value, within", "p-value", {"p": lambda b: max(b["within"]["p"], 1e-300) if "within" in b else None}),
        (
            "Explained variance",
            "r²",
            {"r²": _of("r2"), "adjusted": _of("adjusted_r2"), "cross-validated": _of("cross_validated_r2")},
        ),
        ("F ratio, within", "F", {"F": lambda b: b["within"]["f"] if "within" in b else None}),
        ("Error", "RMSE / z-score", {"RMSE": _of("rmse")}),
        ("Information criteria", "AIC, BIC", {"AIC": _of("aic"), "BIC": _of("bic")}),
    ]
    for ax, (title, label, lines) in zip(axes, panels, strict=False):
        for index, (name, of) in enumerate(lines.items()):
            points = [(band["filters"], of(band)) for band in result["bands"] if of(band) is not None]
            ax.plot(
                [x for x, _ in points], [y for _, y in points], "o-", color=_COLORS[index], label=name, markersize=3
            )
        ax.axvline(result["best_bands"]["bic"], color="#b00020", linestyle="--", linewidth=1, label="lowest BIC")
        ax.set(title=title, xlabel="number of bands", ylabel=label, xticks=range(0, MOST + 1, 5))
        ax.legend(frameon=False, fontsize=7)
    axes[0].set_yscale("log")
    _bank(axes[5], result["best_bands"]["bic"])
    return figure


def _of(name: str) -> Any:
    return lambda band: band.get(name)


def _bank(ax: Any, count: int) -> None:
    """Draw the triangular bands of a filter bank."""
    edges = bank(count)[1]
    for index in range(count):
        ax.plot(edges[index : index + 3], [0, 1, 0], color=_COLORS[index % len(_COLORS)])
    ax.set(title=f"The {count} bands with the lowest BIC", xlabel="frequency / Hz", ylabel="weight", xscale="log")
    ticks = [20, 50, 100, 200, 500, 1000]
    ax.set_xticks(ticks, [str(tick) for tick in ticks])
    ax.minorticks_off()
