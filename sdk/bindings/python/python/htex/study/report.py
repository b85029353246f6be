"""Write an analysis as a self-contained HTML page: the figures of the paper, every test, and its
method."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from . import text
from .figures import to_svg
from .frames import effects, ranks
from .results import AnalysisDict
from .text import Table

_STYLE = """\
body { margin: 0 auto; padding: 20px 24px 48px; max-width: 1240px; background: #fff; color: #222;
  font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 26px; } h2 { font-size: 20px; margin-top: 36px; padding-top: 12px; border-top: 1px solid #ddd; }
p, ul { max-width: 84ch; } ul { padding-left: 22px; }
.notice { padding: 8px 12px; border-left: 4px solid #b37a00; background: #fff8e6; }
.fails { color: #8a3b00; } .method { color: #555; font-size: 13px; }
pre { padding: 10px 12px; background: #f5f5f5; border: 1px solid #ddd; white-space: pre-wrap; overflow-wrap: anywhere; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(440px, 100%), 1fr)); gap: 12px; }
figure { margin: 0; } .wide { grid-column: 1 / -1; } figure svg { display: block; max-width: 100%; height: auto; }
.scroll { overflow-x: auto; margin: 10px 0; } summary { cursor: pointer; font-weight: 600; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding-bottom: 6px; color: #444; }
th, td { border: 1px solid #d4d4d4; padding: 4px 8px; text-align: right; } th { background: #f7f7f7; }
th[scope="row"], td.note { text-align: left; } td.note { max-width: 26em; }
@media print { figure, tr { break-inside: avoid; } details > * { display: block; } }
"""

_RATINGS = (
    "A dot is a participant's mean rating, a diamond the mean over participants, the shape behind them the distribution. Brackets "
    "join what differs: * p < 0.05, ** p < 0.01, *** p < 0.001, paired t-tests with Holm's correction for the pairs of a picture."
)
_EQUIVALENCE = (
    "If no difference was found, there may still be one. An interval within the green bound says that two conditions are as "
    "good as each other."
)
_BANDS = (
    "p comes from the test that counts the degrees of freedom used up by z-scores within a participant and texture."
)


class Picture(NamedTuple):
    """A figure as an element of the page."""

    svg: str
    is_wide: bool


def picture(name: str, figure: Figure) -> Picture:
    """Draw a figure."""
    return Picture(to_svg(figure, escape(name)), figure.get_figwidth() > 5)


def to_html(result: AnalysisDict, figures: dict[str, Picture], command: str) -> str:
    """Return the page as HTML. ``command`` is the command that makes the page again."""
    parts = [f"<h1>Analysis of a rating study</h1>{_paragraph(text.heading(result) + '.')}"]
    if result["simulated"]:
        said = "Simulated participants are among those analysed: these numbers say nothing about people."
        parts.append(f'<p class="notice">{said}</p>')
    parts += _ratings(result, figures)
    parts += _comparisons(result, figures)
    parts += _tests(result)
    parts += _spectra(result, figures)
    parts += _end(result)
    again = _heading("How this page was made") + f"<pre>{escape(command)}</pre>" + _paragraph(result["program"])
    head = '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Analysis of a rating study</title>'
    return f"{head}\n<style>\n{_STYLE}</style></head>\n<body>\n" + "\n".join([*parts, again]) + "\n</body></html>\n"


def _ratings(result: AnalysisDict, figures: dict[str, Picture]) -> Iterable[str]:
    yield _heading("Ratings") + _paragraph(_RATINGS) + _figures(figures, "ratings-")
    rows = text.means_table(result, result["means"], result["means_model"])
    yield _table("Mean rating (standard deviation between participants)", rows) + _method(result, "means")


def _comparisons(result: AnalysisDict, figures: dict[str, Picture]) -> Iterable[str]:
    name, _, key = text.level_names(result)
    overall: Any = result[key]  # type: ignore[literal-required]
    yield _heading(f"{name} compared")
    long = len(overall) > 40
    table = _table("Paired t-tests", text.pair_table(overall), names=2)
    yield _details(f"{len(overall)} pairs", table) if long else table
    for texture, pairs in result["pairs_by_texture"].items() if len(result["textures"]) > 1 else ():
        yield _details(texture, _table(texture, text.pair_table(pairs), names=2))
    yield _method(result, key)
    yield _heading(f"{name} as good as each other") + _paragraph(_EQUIVALENCE) + _figures(figures, "equivalence")
    bound = result["equivalence"]["bound"]
    table = _table(f"Within {bound:g}, and tests of ranks", text.equivalence_table(result), names=2)
    yield (
        (_details("All pairs", table) if long else table) + _method(result, "equivalence") + _method(result, "nemenyi")
    )


def _tests(result: AnalysisDict) -> Iterable[str]:
    yield _heading("Effects")
    yield _list(f"{text.effect_name(t, e)}: {text.anova(test)}" for t, e, test in effects(result)) + _method(
        result, "anova_two_way", "anova_model", "anova_texture"
    )
    yield _list(f"{text.effect_name(t, e)}: {text.friedman(test)}" for t, e, test in ranks(result)) + _method(
        result, "friedman", "friedman_texture"
    )
    yield (
        _paragraph("Normality of the residuals:")
        + _list(text.normalities(result))
        + _method(result, "normality_of_residuals")
    )
    if mixed := text.mixed(result):
        yield _heading("Effects by a mixed model of all ratings") + _list(mixed) + _method(result, "mixed_model")
    if rows := text.reliability_table(result):
        yield _heading("Reliability") + _table("Intraclass correlations", rows) + _method(result, "reliability")


def _spectra(result: AnalysisDict, figures: dict[str, Picture]) -> Iterable[str]:
    if "spectral_correlation" in result:
        found = result["spectral_correlation"]
        yield _heading("Spectral correlation of felt with recorded") + _figures(figures, "correlation-")
        rows = text.means_table(result, found["means"], found["means_model"])
        yield _table("Mean correlation (standard deviation between participants)", rows)
        yield _method(result, "spectral_correlation")
    if "best_bands" in result:
        yield _heading("Ratings by differences of energy in bands") + _paragraph(
            f"The {text.best_sentence(result)}. {_BANDS}"
        )
        yield _figures(figures, "bands") + _table("Regressions by number of bands", text.band_table(result))
        yield _method(result, "bands") + _method(result, "best_bands")


def _end(result: AnalysisDict) -> Iterable[str]:
    if result["power"]:
        rows = [
            ["participants", "power"],
            *([str(row["participants"]), f"{row['power']:.4f}"] for row in result["power"]),
        ]
        yield _heading("Power for a medium effect") + _details("Power by number of participants", _table("", rows))
        yield _method(result, "power")
    if result["notes"]:
        lines = (f"{note['group']} ({note['code']}): {note['message']}" for note in result["notes"])
        yield _heading("Notes") + _list(lines)


def _heading(title: str) -> str:
    return f"<h2>{escape(title)}</h2>"


def _paragraph(sentence: str) -> str:
    return f"<p>{escape(sentence)}</p>"


def _method(result: AnalysisDict, *keys: str) -> str:
    """Return the method of the first group that exists, to show below its numbers."""
    found = [key for key in keys if result.get(key)]
    return f'<p class="method">Method: {escape(result["methods"][found[0]])}</p>' if found else ""


def _list(lines: Iterable[str]) -> str:
    """Return sentences as a list, with failed assumptions highlighted."""
    items = (line.partition("; BUT ") for line in lines)
    texts = [f"<li>{escape(said)}{_fails(fails)}</li>" for said, _, fails in items]
    return f"<ul>{''.join(texts)}</ul>" if texts else ""


def _fails(sentence: str) -> str:
    return f' <strong class="fails">But {escape(sentence.replace("BUT ", ""))}.</strong>' if sentence else ""


def _details(title: str, body: str) -> str:
    return f"<details><summary>{escape(title)}</summary>{body}</details>"


def _figures(figures: dict[str, Picture], *prefixes: str) -> str:
    found = [figure for name, figure in figures.items() if name.startswith(prefixes)]
    wide = ' class="wide"'
    items = [f"<figure{wide if figure.is_wide else ''}>{figure.svg}</figure>" for figure in found]
    return f'<div class="figures">{"".join(items)}</div>' if items else ""


def _table(caption: str, rows: Table, names: int = 1) -> str:
    """Return a table whose first ``names`` columns name the row."""
    if not rows:
        return ""
    head = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in rows[0])
    lines = [f"<tr>{''.join(_cell(i < names, cell) for i, cell in enumerate(row))}</tr>" for row in rows[1:]]
    return (
        f'<div class="scroll"><table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(lines)}</tbody></table></div>"
    )


def _cell(is_name: bool, cell: str) -> str:
    if cell.startswith("BUT "):
        return f'<td class="note fails">{escape(cell[4:].replace("; BUT ", "; "))}</td>'
    return f'<th scope="row">{escape(cell)}</th>' if is_name else f"<td>{escape(cell)}</td>"
