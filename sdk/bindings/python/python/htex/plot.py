"""Plot spectra and trade-offs. The plots need matplotlib (``pip install htex[plot]``)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ._data import Processed, Spectrum, Tradeoff
from ._htex import Texture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
else:
    try:
        from matplotlib.axes import Axes
    except ImportError:
        Axes = Any


def spectrum(spectrum: Spectrum | Processed, *, ax: Axes | None = None, label: str | None = None) -> Axes:
    """Draw the magnitudes of a spectrum over frequency, both on logarithmic axes."""
    if isinstance(spectrum, Processed):
        spectrum = spectrum.spectrum
    ax = _axes(ax)
    ax.loglog(spectrum.frequency_hz, spectrum.magnitude, label=label)
    frequencies(ax)
    ax.set_ylabel(f"magnitude / {spectrum.unit}")
    if label is not None:
        ax.legend()
    return ax


def frequencies(ax: Axes) -> None:
    """Make the horizontal axis a frequency axis: logarithmic, with ticks at 20, 50, 100 Hz and so
    on.
    """
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    ax.set_xscale("log")
    ax.set_xlabel("frequency / Hz")
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def texture(
    texture: Texture,
    *,
    models: Iterable[str] | None = None,
    reference: Spectrum | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the spectra of a texture's models and, if ``reference`` is given, a recorded
    spectrum."""
    ax = _axes(ax)
    if reference is not None:
        spectrum(reference, ax=ax, label="recording")
    for model in texture.models if models is None else models:
        spectrum(texture.spectrum(model=model), ax=ax, label=model.rsplit(".", 1)[-1])
    ax.set_title(texture.name)
    return ax


def tradeoff(
    tradeoff: Tradeoff, *, x: str = "bytes", y: str = "held_out_error", ax: Axes | None = None
) -> Axes:
    """Draw one column of a trade-off over another, with a colour for each model."""
    ax = _axes(ax)
    columns = tradeoff.columns
    for model in dict.fromkeys(columns["model"]):
        rows = [i for i, name in enumerate(columns["model"]) if name == model]
        ax.scatter([columns[x][i] for i in rows], [columns[y][i] for i in rows], label=model, s=12)
    ax.set_xscale("log")
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    ax.legend()
    return ax


def _axes(ax: Axes | None) -> Any:
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plots need matplotlib; install it with `pip install htex[plot]`") from error
    return pyplot.subplots()[1]
