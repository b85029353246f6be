"""The subcommands ``htex study analyse`` and ``htex study power``. Only the Python package
implements them.
"""

from __future__ import annotations

import argparse
import json
import os
import pathlib
import sys
import unicodedata
from collections.abc import Callable

from .results import schema
from .rules import RULES, Finding, TableError, explain

_ANALYSE = """\
Analyse the ratings of a study, and what was felt: means, paired comparisons, equivalence, ANOVA, Friedman, a mixed model and
reliability, overall and by texture. With --spectra: correlation of felt with recorded spectra, and regression of ratings on
differences of energy in 1 to 20 bands. What the data do not allow is named in the notes, and assumptions that fail beside the
result. Each number has its method beside it."""

_POWER = """\
Find out how many participants a study needs, or what it finds with a given number: the F-test of repeated measures within factors of
G*Power 3.1, for one group."""


def run(words: list[str]) -> int | None:
    """Run a command that Python implements, and return its exit status. Return None for any other
    command.
    """
    command = _command(words)
    if command is None:
        return None
    try:
        status = command()
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        # It is not an error if the reader of the output has ended (`| head`).
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 0
    except TableError as error:
        return _fail(str(error))
    except ImportError as error:
        return _fail(str(error))
    except OSError as error:
        return _fail(f"cannot use {error.filename}: {error.strerror}")


def _command(words: list[str]) -> Callable[[], int] | None:
    if words[:2] == ["study", "analyse"]:
        return lambda: _analyse(words[2:])
    if words[:2] == ["study", "power"]:
        return lambda: _power(words[2:])
    if words == ["schema", "study-analysis"]:
        return lambda: _say(json.dumps(schema(), indent=2, sort_keys=True, ensure_ascii=False))
    if len(words) == 2 and words[0] == "explain" and (text := explain(words[1])):
        return lambda: _say(text.rstrip("\n"))
    return None


def rules() -> str:
    """Return the codes of findings in tables, as ``htex explain`` lists them."""
    return "".join(f"{rule.code:36} {rule.summary}\n" for rule in RULES)


def _analyse(words: list[str]) -> int:
    arguments = _analyse_parser().parse_args(_joined(words))
    from . import analyse

    try:
        analysis = analyse(
            arguments.ratings,
            arguments.spectra,
            scale=arguments.scale,
            bound=arguments.bound,
            columns={ours: theirs for pairs in arguments.map for ours, theirs in pairs},
            leave_out_incomplete=arguments.leave_out_incomplete,
        )
    except TableError as error:
        if not arguments.json:
            raise
        _say_json({"file": error.table, "valid": False, "findings": [finding._asdict() for finding in error.findings]})
        return 1
    for sheet, name in ((analysis.ratings, arguments.ratings), (analysis.spectra, arguments.spectra)):
        _tell(sheet.findings if sheet else [], name)
    if arguments.output:
        inputs = [path for path in (arguments.ratings, arguments.spectra) if path]
        if said := _overwritten(pathlib.Path(arguments.output), inputs):
            return _fail(said)
        analysis.save(arguments.output, _again(arguments))
    return _say(analysis.to_json() if arguments.json else str(analysis).rstrip("\n"))


def _power(words: list[str]) -> int:
    arguments = _power_parser().parse_args(words)
    from . import power

    json_wanted = vars(arguments).pop("json")
    try:
        found = power(**vars(arguments))
    except ValueError as error:
        return _fail(str(error), 2)
    except LookupError as error:
        return _fail(error.args[0])
    return _say_json(found.to_dict()) if json_wanted else _say(str(found))


def _parser(name: str, description: str) -> argparse.ArgumentParser:
    return argparse.ArgumentParser(prog=f"htex study {name}", description=description, allow_abbrev=False)


def _analyse_parser() -> argparse.ArgumentParser:
    parser = _parser("analyse", _ANALYSE)
    add = parser.add_argument
    add(
        "--ratings",
        metavar="TABLE",
        required=True,
        help="ratings: CSV (with commas, semicolons or tabs) or .xlsx, with the columns participant, texture, model, rating, and repetition if there are several; or a column for each condition",
    )
    add(
        "--spectra",
        metavar="TABLE",
        help="felt spectra: participant, texture, model, and magnitudes at 20, 25, ..., 1000; lines of the model `recorded` have the spectra of the real textures",
    )
    add(
        "--map",
        metavar="OURS=THEIRS",
        action="append",
        type=_pairs,
        default=[],
        help="the name that a column has, such as rating=Bewertung; several are separated by commas",
    )
    add(
        "--scale",
        metavar="MIN-MAX",
        type=_scale,
        help="the scale of the ratings, such as 0-6: ratings outside are errors",
    )
    add(
        "--bound",
        metavar="B",
        type=_positive,
        default=0.5,
        help="largest difference of ratings that does not matter, for the tests of equivalence [default: 0.5]",
    )
    add(
        "--leave-out-incomplete",
        action="store_true",
        help="leave participants who have not rated every model in every texture out of everything, with a warning",
    )
    add(
        "-o",
        "--output",
        metavar="DIR",
        help="folder of the results: report.html, analysis.json, tables as CSV, figures as SVG and PDF",
    )
    add("--json", action="store_true", help="print JSON (its JSON Schema: `htex schema study-analysis`)")
    return parser


def _power_parser() -> argparse.ArgumentParser:
    parser = _parser("power", _POWER)
    add = parser.add_argument
    add(
        "--effect",
        metavar="F",
        type=float,
        required=True,
        help="effect size: Cohen's f; 0.1 is small, 0.25 medium, 0.4 large",
    )
    add(
        "--measurements",
        metavar="M",
        type=int,
        required=True,
        help="measurements of each participant: textures times models",
    )
    goal = parser.add_mutually_exclusive_group()
    goal.add_argument(
        "--power", metavar="P", type=float, help="power to reach: the probability of finding the effect [default: 0.8]"
    )
    goal.add_argument(
        "--participants", metavar="N", type=int, help="compute the power of this many participants instead"
    )
    add("--alpha", metavar="A", type=float, default=0.05, help="significance level [default: 0.05]")
    add(
        "--correlation",
        metavar="R",
        type=float,
        default=0.5,
        help="correlation among the measurements of a participant [default: 0.5]",
    )
    add(
        "--epsilon",
        metavar="E",
        type=float,
        default=1.0,
        help="correction for nonsphericity, 1 / (M - 1) to 1 [default: 1]",
    )
    add("--json", action="store_true", help="print JSON")
    return parser


def _joined(words: list[str]) -> list[str]:
    """Join ``--scale`` and its value into one word, because the value may begin with a minus
    sign."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] == "--scale":
            joined[-1] = f"--scale={word}"
        else:
            joined.append(word)
    return joined


def _scale(text: str) -> tuple[float, float]:
    """Parse ``0-6``. The lower end may be negative."""
    dash = text.find("-", 1)
    try:
        low, high = float(text[:dash]), float(text[dash + 1 :])
    except ValueError:
        low = high = 0.0
    if dash < 0 or not low < high < float("inf") or low == float("-inf"):
        raise argparse.ArgumentTypeError("it looks like 0-6: the lowest and the highest rating")
    return low, high


def _positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("it is above 0")
    return value


def _pairs(text: str) -> list[tuple[str, str]]:
    pairs = [part.partition("=") for part in text.split(",")]
    if not all(ours.strip() and theirs.strip() for ours, _, theirs in pairs):
        raise argparse.ArgumentTypeError("it looks like rating=Bewertung: htex's name, then the column's name")
    return [(ours.strip(), theirs.strip()) for ours, _, theirs in pairs]


def _overwritten(folder: pathlib.Path, inputs: list[str]) -> str | None:
    """Return an error text if the results would overwrite an input, otherwise None."""
    for path in map(pathlib.Path, inputs):
        if path.resolve().parent == folder.resolve() and path.name in _NAMES:
            return f"{path} is an input, and the results would overwrite it; choose another folder"
    return None


_NAMES = {
    f"{name}.csv"
    for name in ("cell-means", "means", "pairs", "equivalence", "effects", "spectral-correlation", "bands")
}


def _again(arguments: argparse.Namespace) -> str:
    """Return the command line that makes the same report again."""
    words = ["htex study analyse --ratings", arguments.ratings]
    words += ["--spectra", arguments.spectra] if arguments.spectra else []
    words += ["--map " + ",".join(f"{ours}={theirs}" for ours, theirs in pairs) for pairs in arguments.map]
    words += ["--leave-out-incomplete"] if arguments.leave_out_incomplete else []
    words += ["--scale {:g}-{:g}".format(*arguments.scale)] if arguments.scale else []
    words += [f"--bound {arguments.bound:g}", "-o", arguments.output]
    return " ".join(words)


def _tell(findings: list[Finding], file: str) -> None:
    for finding in findings:
        sys.stderr.write(_plain(f"htex: {finding.severity}: {file}: {finding}") + "\n")


def _fail(message: str, status: int = 1) -> int:
    sys.stderr.write("\n".join(_plain(line) for line in f"htex: {message}".split("\n")) + "\n")
    return status


def _say(text: str) -> int:
    data = "\n".join(_plain(line) for line in text.split("\n")) + "\n"
    sys.stdout.buffer.write(data.encode("utf-8", "replace"))
    return 0


def _say_json(value: object) -> int:
    return _say(json.dumps(value, ensure_ascii=False, separators=(",", ":")))


def _plain(line: str) -> str:
    """Return a line with escaped control characters, because it may quote untrusted tables."""
    return "".join(f"\\u{{{ord(c):x}}}" if unicodedata.category(c) in ("Cc", "Cf", "Cs") else c for c in line)
