"""The analysis of a study: golden numbers, pages and schema, tables as laboratories store them, and
the command."""

from __future__ import annotations

import io
import json
import os
import pathlib
import subprocess
import sys
from typing import Any

import numpy as np
import pandas as pd
import pytest

from htex import study
from htex.study import rules, tables
from htex.study.cli import run
from htex.study.equivalence import wilcoxon
from htex.study.ratings import read_ratings
from htex.study.results import schema

ROOT = pathlib.Path(__file__).resolve().parents[4]
GOLDEN = ROOT / "tests/golden/study"
HEADER = "participant,texture,model,repetition,rating\n"
SMALL = "a,t,m,1,3\na,t,n,1,4\nb,t,m,1,2\nb,t,n,1,4\n"


def agree(expected: Any, got: Any, at: str, rtol: float, atol: float) -> int:
    """Compare all values in ``expected``, and count the numbers."""
    if isinstance(expected, dict):
        return sum(agree(value, got.get(key), f"{at}.{key}", rtol, atol) for key, value in expected.items())
    if isinstance(expected, list):
        assert len(got) == len(expected), at
        return sum(agree(value, got[i], f"{at}.{i}", rtol, atol) for i, value in enumerate(expected))
    if isinstance(expected, (int, float)) and not isinstance(expected, bool):
        assert got is not None and abs(got - expected) <= atol + rtol * abs(expected), f"{at}: {got} is not {expected}"
        return 1
    assert got == expected, at
    return 0


def ask(*words: object) -> tuple[int, str, str]:
    """Run the command in this process. Return its exit status, standard output and standard
    error."""
    out, err = io.TextIOWrapper(io.BytesIO(), encoding="utf-8"), io.StringIO()
    before, (sys.stdout, sys.stderr) = (sys.stdout, sys.stderr), (out, err)
    try:
        status = run([str(word) for word in words])
        assert status is not None
    except SystemExit as exit:
        status = int(exit.code or 0)
    finally:
        sys.stdout, sys.stderr = before
    out.flush()
    return status, out.buffer.getvalue().decode(), err.getvalue()  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def golden() -> study.Analysis:
    """The analysis of the golden study."""
    return study.analyse(GOLDEN / "ratings.csv", GOLDEN / "spectra.csv")


def test_every_number_agrees_with_the_reference_programs(golden: study.Analysis) -> None:
    reference = json.loads((GOLDEN / "study.json").read_text())
    got = json.loads(golden.to_json())
    assert agree(reference["expected"], got, "", reference["rtol"], reference["atol"]) > 1100
    assert golden.findings == [] and all(got["methods"].get(key) for key in reference["expected"])


def test_the_mixed_model_of_complete_ratings_is_the_anova(golden: study.Analysis) -> None:
    result: Any = golden.to_dict()
    for name, effect in result["mixed_model"]["effects"].items():
        test = result["anova_two_way"][name]
        assert effect["f"] == pytest.approx(test["f"], rel=1e-3) and effect["df"] == test["df"]


def test_intraclass_correlations_are_those_of_pingouin(golden: study.Analysis) -> None:
    pingouin = pytest.importorskip("pingouin")
    cells = golden.ratings.cells.assign(condition=lambda c: c["texture"] + c["model"])
    answers = golden.ratings.answers.assign(cell=lambda a: a["participant"] + a["texture"] + a["model"])
    for got, frame, columns in [
        ("participants", cells, ("condition", "participant", "mean")),
        ("repetitions", answers, ("cell", "repetition", "rating")),
    ]:
        icc: Any = golden.to_dict()["reliability"][got]  # type: ignore[literal-required]
        targets, raters, ratings = columns
        table = pingouin.intraclass_corr(frame, targets=targets, raters=raters, ratings=ratings)
        values = table.set_index(table["Type"].str.replace("[(),]", "", regex=True)).iloc[:, :]["ICC"]
        expected = [values.iloc[1], values.iloc[4], values.iloc[2], values.iloc[5]]
        assert [icc[key] for key in ("icc2", "icc2k", "icc3", "icc3k")] == pytest.approx(expected, rel=1e-9)


def test_nemenyi_names_the_pairs_of_friedman(golden: study.Analysis) -> None:
    """Compute the test by its definition: mean ranks, and their studentised range."""
    from scipy import stats

    table = golden.ratings.marginal("model").round(9)
    ranks = stats.rankdata(table, axis=1).mean(axis=0)
    n, k = table.shape
    for pair in golden.to_dict()["nemenyi"]:
        i, j = (golden.ratings.models.index(pair[side]) for side in ("a", "b"))  # type: ignore[literal-required]
        q = abs(ranks[i] - ranks[j]) / np.sqrt(k * (k + 1) / (6 * n))
        assert pair["p"] == pytest.approx(stats.studentized_range.sf(q * np.sqrt(2), k, np.inf), abs=1e-6)


def test_wilcoxons_test_is_that_of_scipy() -> None:
    from scipy import stats

    random = np.random.default_rng(3)
    for size in (1, 2, 5, 9, 13, 14, 30):
        for differences in (random.normal(size=size), random.integers(-3, 4, size) / 2):
            expected = stats.wilcoxon(differences)
            assert wilcoxon(differences) == pytest.approx((expected.statistic, expected.pvalue), abs=1e-12)


def test_the_result_is_what_the_schema_says(golden: study.Analysis) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    closed = json.loads(
        json.dumps(schema()).replace(
            '"type": "object", "description"', '"additionalProperties": false, "type": "object", "description"'
        )
    )
    for analysis in (golden, study.analyse((HEADER + SMALL).encode())):
        jsonschema.validate(json.loads(analysis.to_json()), closed)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("spec/analysis-findings.md", rules.findings_page()),
        (
            "spec/schemas/study-analysis-1.json",
            json.dumps(schema(), indent=2, sort_keys=True, ensure_ascii=False) + "\n",
        ),
    ],
)
def test_generated_files_are_fresh(name: str, text: str) -> None:
    path = ROOT / name
    if os.environ.get("HTEX_GENERATE") == "1":
        path.write_text(text, encoding="utf-8")
    assert path.read_text(encoding="utf-8") == text, (
        f"{name} is stale: run `HTEX_GENERATE=1 pytest sdk/bindings/python -k generated`"
    )


def test_the_files_hold_the_same_and_the_page_is_one_file(golden: study.Analysis, tmp_path: pathlib.Path) -> None:
    golden.save(tmp_path, "htex study analyse")
    assert json.loads((tmp_path / "analysis.json").read_text()) == json.loads(golden.to_json())
    page = (tmp_path / "report.html").read_text()
    assert not any(word in page for word in ("<script", "src=", ' href="http', "NaN", "None"))
    # The figures are ratings and correlations, each for all textures and for five; equivalence; and
    # the regressions.
    assert page.count('role="img"') == 6 + 6 + 2
    assert len(list((tmp_path / "figures").glob("*.svg"))) == len(list((tmp_path / "figures").glob("*.pdf"))) == 14
    assert len(pd.read_csv(tmp_path / "pairs.csv")) == 10 + 5 * 10
    # The command follows no link in the folder.
    linked, outside = tmp_path / "linked", tmp_path / "outside"
    linked.mkdir()
    outside.mkdir()
    (outside / "victim").write_text("precious")
    (linked / "report.html").symlink_to(outside / "victim")
    (linked / "figures").symlink_to(outside)
    with pytest.raises(PermissionError, match="symbolic link"):
        golden.save(linked)
    assert [file.name for file in outside.iterdir()] == ["victim"]
    assert (outside / "victim").read_text() == "precious"
    again = study.Analysis(golden.ratings, golden.spectra, 0.5).files("htex study analyse")
    assert all((tmp_path / name).read_bytes() == data for name, data in again.items())


def test_text_and_page_show_within_and_the_residuals(golden: study.Analysis) -> None:
    page = golden.to_html()
    assert "   12.50   1.4e-16" in str(golden) and "<td>12.50</td><td>1.4e-16</td>" in page, (
        "F and p of nine bands within"
    )
    assert "15.68" not in str(golden) and "<td>15.68</td>" not in page, "F as if values were independent"
    for text in (str(golden), page):
        assert "W = 0.9693" in text and "W = 0.9562" not in text, (
            "Shapiro's W: of the residuals, and not of the cell means"
        )
        assert "sphericity fails (Mauchly" in text


def lines(frame: pd.DataFrame, separator: str, decimal: str = ".") -> bytes:
    """A table as CSV."""
    return frame.to_csv(index=False, sep=separator, decimal=decimal).encode()


def test_tables_as_laboratories_have_them(tmp_path: pathlib.Path) -> None:
    long = pd.read_csv(GOLDEN / "ratings.csv").query("participant < 'p05'").assign(rating=lambda t: t["rating"] + 0.5)
    expected = read_ratings(long)
    wide = long.pivot(index=["participant", "texture", "repetition"], columns="model", values="rating").reset_index()
    flat = long.assign(condition=long["texture"] + "/" + long["model"])
    flat = flat.pivot(index=["participant", "repetition"], columns="condition", values="rating").reset_index()
    german = long.rename(columns={"participant": "Person", "rating": "Bewertung"})
    long.to_excel(tmp_path / "ratings.xlsx", index=False)
    unnumbered = long.drop(columns="repetition").sample(frac=1, random_state=1)
    for table, columns in [
        (lines(long, ";", ","), None),
        (lines(long, "\t"), None),
        (b"\xef\xbb\xbf" + lines(long, ",").replace(b"\n", b"\r\n"), None),
        (lines(long, "\t").decode().encode("utf-16"), None),
        (lines(wide, ";", ","), None),
        (flat, None),
        (lines(german, ";", ","), {"participant": "person", "rating": "Bewertung"}),
        (tmp_path / "ratings.xlsx", None),
        (long.sample(frac=1, random_state=2), None),
    ]:
        pd.testing.assert_frame_equal(read_ratings(table, renamed=columns).answers, expected.answers)
    pd.testing.assert_frame_equal(read_ratings(unnumbered).cells, expected.cells)


def test_cells_that_begin_like_formulas_are_text() -> None:
    table = pd.read_csv(GOLDEN / "ratings.csv")
    starts = ["=", "+", "-", "@"]
    names = {name: f"{starts[i % 4]}HYPERLINK({i})" for i, name in enumerate(sorted(table["texture"].unique()))}
    models = {name: f"{starts[i % 4]}cmd({i})" for i, name in enumerate(sorted(table["model"].unique()))}
    evil = table.assign(texture=table["texture"].map(names), model=table["model"].map(models))
    seen = set()
    for name, data in study.analyse(evil).files().items():
        if name.endswith(".csv"):
            frame = pd.read_csv(io.BytesIO(data), dtype=str, keep_default_na=False)
            for cell in [*frame.columns, *frame.to_numpy().ravel()]:
                if "HYPERLINK" in cell or "cmd(" in cell:
                    assert not cell.startswith(tuple(starts)), (name, cell)
                    seen.add(cell)
    assert len(seen) >= len(names) + len(models)


def test_a_missing_cell_does_not_end_the_analysis() -> None:
    table = pd.read_csv(GOLDEN / "ratings.csv")
    one = (table["participant"] == "p03") & (table["texture"] == "vinyl") & (table["model"] == "ar")
    for missing in (table[~one], table.assign(rating=table["rating"].mask(one))):
        analysis = study.analyse(missing, GOLDEN / "spectra.csv")
        result: Any = analysis.to_dict()
        assert "RATINGS_CELL_MISSING" in {finding.code for finding in analysis.findings}
        assert result["anova_model"]["df"] == (4, 48) and result["anova_by_texture"]["sandpaper"]["df"] == (4, 52)
        assert {pair["df"] for pair in result["pairs_by_texture"]["vinyl"]} == {12, 13}
        assert len(result["cell_means"]) == 349 and result["mixed_model"]["effects"]["model"]["p"] < 0.001
        assert result["bands"][8]["within"]["df"] == (9, 270)
    left_out = study.analyse(table[~one], leave_out_incomplete=True)
    assert len(left_out.to_dict()["participants"]) == 13
    assert {finding.code for finding in left_out.findings} == {"RATINGS_LEFT_OUT"}
    text = lines(table.assign(rating=table["rating"].mask(one)), ";").replace(b";;", b";NA;")
    assert study.analyse(text).to_dict()["anova_model"]["df"] == (4, 48)


def test_one_factor_is_analysed() -> None:
    """With 25 textures and one model, tests with two factors are named in the notes, and tests with
    one factor are computed."""
    random = np.random.default_rng(5)
    cells = [(f"p{p:02}", f"t{t:02}") for p in range(12) for t in range(25)]
    table = pd.DataFrame(cells, columns=["participant", "texture"])
    table["rating"] = [4 + 0.1 * int(t[1:]) + random.normal() for t in table["texture"]]
    analysis = study.analyse(table)
    result: Any = analysis.to_dict()
    assert result["models"] == ["all"] and len(result["pairs_texture"]) == 300
    assert result["anova_texture"]["p_gg"] < 0.01 and result["friedman_texture"]["p"] < 0.01
    assert result["mixed_model"]["effects"]["texture"]["f"] == pytest.approx(result["anova_texture"]["f"], rel=1e-3)
    assert {note["code"] for note in result["notes"]} >= {"TOO_FEW_LEVELS", "SPHERICITY_UNDEFINED"}
    assert "anova_model" not in result and analysis.figures["ratings-all"] is not None
    assert str(analysis).index("Textures compared") < str(analysis).index("ANOVA")
    spectra = _spectra(
        {(p, t, "all"): random.uniform(0, 1, 197) for p, t in cells}, sorted({t for _, t in cells}), random
    )
    felt: Any = study.analyse(table, spectra).to_dict()
    assert felt["bands"][0]["within"]["df"] == (1, 12 * 24 - 1)


def _spectra(felt: dict[tuple[str, str, str], Any], textures: list[str], random: np.random.Generator) -> pd.DataFrame:
    recorded = {("recorded", texture, "recorded"): random.uniform(0, 1, 197) for texture in textures}
    rows = [(*cell, *values) for cell, values in {**recorded, **felt}.items()]
    return pd.DataFrame(rows, columns=["participant", "texture", "model", *range(20, 1001, 5)])


@pytest.mark.parametrize(
    ("row", "code", "pointer", "message"),
    [
        ("a,t,o,1,good\n", "RATING_INVALID", "/6/rating", "line 6, column 5 (`rating`): `good`"),
        ("b,t,o,1,1e99\n", "RATING_INVALID", "/6/rating", "`1e99` is not a number"),
        ("b,t,o,1,1_0\n", "RATING_INVALID", "/6/rating", "`1_0` is not a number"),
        (",t,n,1,4\n", "TABLE_NAME_EMPTY", "/6/participant", "line 6, column 1"),
        ("b,t,n,4\n", "TABLE_FIELDS", "/6", "line 6: it has 4 fields, and the header has 5"),
        ("b,t,m,1,4\n", "RATING_DUPLICATE", "/6/repetition", "line 6, column 4"),
    ],
)
def test_bad_lines_have_codes_and_places(
    tmp_path: pathlib.Path, row: str, code: str, pointer: str, message: str
) -> None:
    path = tmp_path / "r.csv"
    path.write_text(HEADER + SMALL + row)
    status, _, said = ask("study", "analyse", "--ratings", path, "-o", tmp_path / "out")
    assert status == 1 and code in said and message in said and not (tmp_path / "out").exists()
    status, text, _ = ask("study", "analyse", "--ratings", path, "--json")
    report = json.loads(text)
    assert (status, report["valid"], report["file"]) == (1, False, str(path))
    assert (code, pointer) in [(finding["code"], finding["pointer"]) for finding in report["findings"]]
    assert ask("explain", code.lower())[0] == 0


@pytest.mark.parametrize(
    ("table", "code"),
    [
        (b"participant,texture,model,repetition,mark\na,t,m,1,2\n", "TABLE_COLUMN_MISSING"),
        (HEADER.encode(), "TABLE_EMPTY"),
        (b"", "TABLE_EMPTY"),
        (HEADER.encode() + b"a,t,\xff,1,2\n", "TABLE_NOT_UTF8"),
        (b"participant,texture,model,repetition,rating,rating\na,t,m,1,2,3\n", "TABLE_COLUMN_DUPLICATE"),
        (b"PK\x03\x04 and no more", "TABLE_XLSX_INVALID"),
        (
            (HEADER + SMALL).replace("repetition", "attribute").replace("b,t,n,1", "b,t,n,2").encode(),
            "RATINGS_ATTRIBUTES",
        ),
        ((HEADER + SMALL).replace("repetition", "hidden_reference").encode(), "RATINGS_NONE_COMPLETE"),
        ((HEADER + "".join(f"a,t{i},m,1,2\n" for i in range(1001))).encode(), "RATINGS_TOO_MANY_CONDITIONS"),
    ],
)
def test_bad_tables_have_codes(table: bytes, code: str) -> None:
    with pytest.raises(study.TableError) as refused:
        study.analyse(table)
    assert code in {finding.code for finding in refused.value.findings}


def test_a_table_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "LARGEST", 1000)
    with pytest.raises(study.TableError, match="TABLE_TOO_LARGE"):
        study.analyse(GOLDEN / "ratings.csv")


def test_bad_spectra_have_codes() -> None:
    ratings, random = (HEADER + SMALL).encode(), np.random.default_rng(1)
    cells = {("a", "t", "m"): 2.0, ("a", "t", "n"): 2.0, ("b", "t", "m"): 2.0, ("b", "t", "n"): 2.0}
    felt = {cell: np.full(197, value) for cell, value in cells.items()}
    whole = _spectra(felt, ["t"], random)
    negative = whole.copy()
    negative.iloc[2, 3] = -1
    gap = whole.copy()
    gap.iloc[2, 3] = None
    for table, code in [
        (whole.iloc[1:], "SPECTRA_RECORDED_MISSING"),
        (negative, "SPECTRA_MAGNITUDE_INVALID"),
        (pd.concat([whole, whole.iloc[[2]]]), "SPECTRA_DUPLICATE"),
        (whole.iloc[:, :5], "SPECTRA_GRID_INVALID"),
    ]:
        with pytest.raises(study.TableError, match=code):
            study.analyse(ratings, table)
    for table, found in [
        (whole.iloc[:-1], {"SPECTRA_CELL_MISSING"}),
        (gap, {"SPECTRA_CELL_MISSING", "SPECTRA_MAGNITUDE_MISSING"}),
    ]:
        assert {finding.code for finding in study.analyse(ratings, table).findings} == found
    # Equal spectra explain nothing, so the notes name the regressions as missing.
    result: Any = study.analyse(ratings, whole).to_dict()
    assert ("bands.1", "NO_PREDICTOR") in [
        (note["group"], note["code"]) for note in result["notes"]
    ] and "bands" not in result


def test_ratings_off_the_scale_are_named_with_their_lines(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "r.csv"
    path.write_text(HEADER + "a,t,m,1,3\na,t,n,1,7\nb,t,m,1,-1\nb,t,n,1,6\n")
    assert ask("study", "analyse", "--ratings", path, "--scale", "-1-7")[0] == 0
    status, _, said = ask("study", "analyse", "--ratings", path, "--scale", "0-6")
    assert status == 1 and said.count("RATING_OFF_SCALE") == 2 and "7 is not on the scale from 0 to 6" in said
    for wrong in ("6", "6-0", "a-b", ""):
        assert ask("study", "analyse", "--ratings", path, "--scale", wrong)[0] == 2
    assert ask("study", "analyse", "--ratings", path, "--bound", "0")[0] == 2
    assert ask("study", "analyse", "--ratings", path, "--map", "rating")[0] == 2
    assert ask("study", "analyse", "--ratings", tmp_path / "none.csv")[0] == 1


def test_simulated_participants_are_named_everywhere() -> None:
    table = (
        (HEADER + SMALL)
        .replace("rating\n", "rating,simulated\n")
        .replace("3\n", "3,yes\n")
        .replace("2\n", "2,no\n")
        .replace("4\n", "4,no\n")
    )
    analysis = study.analyse(table.encode())
    assert {finding.code for finding in analysis.findings} == {"RATINGS_SIMULATED"}
    assert "1 SIMULATED" in str(analysis) and "say nothing about people" in analysis.to_html()


def test_results_overwrite_no_input(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "means.csv"
    path.write_text(HEADER + SMALL)
    status, _, said = ask("study", "analyse", "--ratings", path, "-o", tmp_path)
    assert status == 1 and "overwrite" in said and path.read_text() == HEADER + SMALL


def test_the_papers_power_analysis_gives_eight_participants() -> None:
    plan = ("study", "power", "--effect", "0.25", "--measurements", "25", "--json")
    found = json.loads(ask(*plan)[1])
    assert list(found) == [
        "participants",
        "power",
        "effect_f",
        "measurements",
        "alpha",
        "correlation",
        "epsilon",
        "lambda",
        "df",
        "critical_f",
        "method",
    ]
    assert (found["participants"], found["power"]) == (8, pytest.approx(0.801_578_953_388_535_4, abs=1e-9))
    assert study.power(0.25, 25, participants=14).power == pytest.approx(0.987_540_231_698_149_3, abs=1e-9)
    for wrong in (
        ["--alpha", "0"],
        ["--correlation", "1"],
        ["--epsilon", "2"],
        ["--power", "1"],
        ["--participants", "1"],
        ["--alpha", "NaN"],
    ):
        assert ask(*plan, *wrong)[0] == 2, wrong
    status, _, said = ask("study", "power", "--effect", "0.00001", "--measurements", "2")
    assert status == 1 and "100000 participants" in said
    assert study.power(100, 2, participants=100_000).power == 1


def test_other_commands_are_not_answered_here() -> None:
    for words in (["study", "run"], ["explain", "LICENSE_MISSING"], ["schema"], [], ["--version"]):
        assert run(words) is None


def test_the_command_says_how_to_have_pandas() -> None:
    program = "import sys; sys.modules['pandas'] = None; from htex.study.cli import run; sys.exit(run(sys.argv[1:]))"
    words = ["study", "analyse", "--ratings", "r.csv"]
    said = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True)
    assert said.returncode == 1 and said.stderr == "htex: studies need pandas; `pip install htex[lab]` brings it\n"


def test_pingouin_is_not_imported_by_the_package() -> None:
    program = "import sys, htex.study, htex.study.study, htex.study.mixed; assert 'pingouin' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)
    package = pathlib.Path(study.__file__).parent
    assert not any("import pingouin" in path.read_text() for path in package.glob("*.py"))


def test_answers_are_counted_by_participant_texture_and_model() -> None:
    ratings = read_ratings(GOLDEN / "ratings.csv")
    assert ratings.means.shape == (14, 5, 5) and ratings.repetitions == 5 and len(ratings.answers) == 1750
