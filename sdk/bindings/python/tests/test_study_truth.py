"""The analysis of made-up studies whose true effects are known, and of random tables."""

from __future__ import annotations

import io
import json
import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from htex import study
from htex.study import regression, tests
from htex.study.anova import helmert
from htex.study.equivalence import tost
from htex.study.notes import Notes, Undefined
from htex.study.ratings import Ratings, read_ratings
from htex.study.regression import Rows, bank, rows_of
from htex.study.spectra import GRID_HZ, Spectra

PEOPLE, TEXTURES, MODELS = 14, 5, 5


def rated(random: np.random.Generator, effect: float = 0.0) -> Ratings:
    """Ratings of a study in which each model is better than the one before it by ``effect``."""
    shape = (PEOPLE, TEXTURES, MODELS)
    means = random.normal(size=shape) + random.normal(size=(PEOPLE, 1, 1)) + effect * np.arange(MODELS)
    names = [[f"{kind}{index:02}" for index in range(size)] for kind, size in zip("ptm", shape, strict=True)]
    index = pd.MultiIndex.from_product(names, names=["participant", "texture", "model"])
    return read_ratings(pd.DataFrame({"rating": means.ravel()}, index=index))


def felt(random: np.random.Generator) -> Spectra:
    """Felt spectra whose bins differ from a flat recording independently."""
    spectra = 0.01 * np.exp(0.5 * random.normal(size=(PEOPLE, TEXTURES, MODELS, len(GRID_HZ))))
    return Spectra(np.full((TEXTURES, len(GRID_HZ)), 0.01), spectra, [])


def test_the_regression_rejects_one_null_study_in_twenty() -> None:
    """False positives among 1000 studies, with nine and with 20 bands: 12.8 and 19.7 % if z-scores
    are treated as independent, 4.2 and 6.4 % with the test within cells."""
    random, studies = np.random.default_rng(1), 300
    before, after = {9: 0, 20: 0}, {9: 0, 20: 0}
    for _ in range(studies):
        rows = rows_of(rated(random), felt(random))
        for count in before:
            result: Any = regression.regression(rows.differences @ bank(count)[0], rows)
            before[count] += result["p"] < 0.05
            after[count] += result["within"]["p"] < 0.05
    assert before[9] > 0.09 * studies and before[20] > 0.13 * studies, before
    assert all(0.02 * studies <= found <= 0.08 * studies for found in after.values()), after


def test_normality_is_that_of_residuals() -> None:
    """If models differ, the distribution of cell means has two peaks. In 40 studies, the normality
    test of cell means fails in all, the test of residuals in one."""
    random, cells, residuals = np.random.default_rng(2), 0, 0
    for _ in range(40):
        table = random.normal(size=(PEOPLE, MODELS)) * 0.3 + np.array([0, 4, 0, 4, 4])
        notes = Notes()
        cells += tests.normality(table, "", "", notes)["shapiro_p"] < 0.05
        residuals += tests.normality(tests.residuals(table), "", "", notes)["shapiro_p"] < 0.05
    assert cells == 40 and residuals <= 5, (cells, residuals)


def test_nine_planted_bands_are_found_and_noise_has_none() -> None:
    """Among 40 studies that are made from nine bands, nine bands are preferred in 40. Among 40
    studies with noise, no bands are preferred in 39, and 20 bands predict worse than the mean in
    40."""
    random, nine, none, negative = np.random.default_rng(3), 0, 0, 0
    weights = bank(9)[0]
    sizes = np.where(np.arange(9) % 2, 1, -1) / np.linalg.norm(weights, axis=0)
    for _ in range(20):
        noise = rows_of(rated(random), felt(random))
        signal = noise.differences @ weights @ sizes / 3
        planted = signal + random.normal(size=len(signal))
        cells = planted.reshape(-1, MODELS)
        planted = ((cells - cells.mean(axis=1, keepdims=True)) / cells.std(axis=1, ddof=1, keepdims=True)).ravel()
        best: Any = regression.bands(Rows(noise.differences, planted, noise.groups, noise.df), Notes())[1]
        nine += best["bic"] == 9 and best["better_than_none"]
        found, best = regression.bands(noise, Notes())
        none += not best["better_than_none"]
        negative += found[-1]["cross_validated_r2"] < 0
    assert nine >= 19 and none >= 17 and negative >= 18, (nine, none, negative)


def test_equivalence_is_found_where_it_is_and_only_there() -> None:
    """If the difference is equal to the bound, equivalence is claimed in one of twenty studies;
    without a difference, in nearly all."""
    random, at_bound, equal = np.random.default_rng(4), 0, 0
    for _ in range(400):
        a, b = random.normal(3, 0.4, (2, 30))
        equal += tost(a, b, 0.5)["p_tost"] < 0.05
        at_bound += tost(a + 0.5, b, 0.5)["p_tost"] < 0.05
    assert equal > 380 and 8 <= at_bound <= 32, (equal, at_bound)


def test_cross_validation_predicts_each_group_from_the_others() -> None:
    """Compute the value by its definition. One predictor depends on others, groups have different
    sizes, and their rows are mixed."""
    random = np.random.default_rng(5)
    x = random.normal(size=(90, 4))
    x = np.column_stack([x, 2 * x[:, 0] - x[:, 2]])
    y = 5 + x[:, 1] - 0.5 * x[:, 4] + random.normal(size=90)
    groups = 3 * (np.arange(90) ** 2 % 7)
    errors = baseline = 0.0
    for group in np.unique(groups):
        known, unseen = groups != group, groups == group
        solution = np.linalg.lstsq(np.column_stack([np.ones(known.sum()), x[known]]), y[known], rcond=None)[0]
        errors += ((y[unseen] - solution[0] - x[unseen] @ solution[1:]) ** 2).sum()
        baseline += ((y[unseen] - y[known].mean()) ** 2).sum()
    assert regression.cross_validated_r2(x, y, groups) == pytest.approx(1 - errors / baseline, abs=1e-10)


def test_contrasts_are_orthonormal() -> None:
    for levels in range(2, 9):
        rows = helmert(levels)
        assert np.allclose(rows @ rows.T, np.eye(levels - 1)) and np.allclose(rows.sum(axis=1), 0)


NUMBERS = st.floats(-5, 5).map(lambda value: round(value, 3))


@settings(deadline=None)
@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=3, max_size=20))
def test_f_is_the_square_of_t(values: list[tuple[float, float]]) -> None:
    """With two conditions, an ANOVA is a paired t-test. Intervals and p-values lead to the same
    decision."""
    from htex.study.anova import one_way

    table = np.array(values)
    anova = one_way(table, "", Notes())
    try:
        pair = tests.paired_t(*table.T)
    except Undefined:
        assert anova is None
        return
    assert anova is not None and anova["f"] == pytest.approx(pair["t"] ** 2, rel=1e-6, abs=1e-9)
    assert anova["p"] == pytest.approx(pair["p"], abs=1e-6)
    low, high = pair["ci95"]
    assert (pair["p"] < 0.05) == (low > 0 or high < 0) or pair["p"] == pytest.approx(0.05, abs=1e-9)


@st.composite
def studies(draw: Any) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Ratings are whole numbers, and spectra have few different magnitudes, so there are ties,
    constants and missing values."""
    people, textures, models = (draw(st.integers(1, most)) for most in (5, 3, 4))
    cells = [(f"p{p}", f"t{t}", f"m{m}") for p in range(people) for t in range(textures) for m in range(models)]
    values = draw(st.lists(st.integers(0, 3), min_size=len(cells), max_size=len(cells)))
    holes = draw(st.sets(st.integers(0, len(cells) - 1), max_size=len(cells) // 3))
    table = [
        (*cell, value) for index, (cell, value) in enumerate(zip(cells, values, strict=True)) if index not in holes
    ]
    spectra = [*cells, *(("recorded", f"t{t}", "recorded") for t in range(textures))]
    few = draw(st.lists(st.integers(0, 2), min_size=1, max_size=40))
    magnitudes = np.resize(few, (len(spectra), len(GRID_HZ)))
    keys = ["participant", "texture", "model"]
    frame = pd.concat(
        [pd.DataFrame(spectra, columns=keys), pd.DataFrame(magnitudes, columns=GRID_HZ.astype(int))], axis=1
    )
    return pd.DataFrame(table, columns=[*keys, "rating"]), frame


SLOW = settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))


@SLOW
@given(studies())
def test_no_number_is_nan(tables: tuple[pd.DataFrame, pd.DataFrame]) -> None:
    analysis = study.analyse(*tables)
    found = json.loads(analysis.to_json())
    assert "null" not in analysis.to_json()
    text = str(analysis)
    assert not any(word in text for word in ("nan", " inf", "None"))
    assert found["notes"] == analysis.to_dict()["notes"]
    for frame in analysis.frames.values():
        assert not np.isinf(frame.select_dtypes("number").to_numpy(dtype=float)).any()


@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.binary(max_size=300), st.text("abc,;\t19.\"'\n\r-NAé\0", max_size=200))
def test_any_bytes_are_read_or_refused(data: bytes, text: str) -> None:
    for table in (data, b"participant,texture,model,repetition,rating\n" + text.encode(), b"PK\x03\x04" + data):
        try:
            ratings = read_ratings(table)
        except study.TableError as refused:
            assert any(finding.severity == "error" for finding in refused.findings)
        else:
            assert all(map(math.isfinite, ratings.cells["mean"]))


@settings(deadline=None)
@given(
    st.lists(st.lists(st.text('xyz ,;\t"|/9', min_size=1, max_size=5), min_size=3, max_size=3), min_size=1, max_size=8)
)
def test_names_are_kept_whatever_separates_fields(rows: list[list[str]]) -> None:
    rows = [[f"n{name}".strip() for name in row] for row in rows]
    frame = pd.DataFrame(
        [[*row, index + 1, 2.5] for index, row in enumerate(rows)],
        columns=["participant", "texture", "model", "repetition", "rating"],
    )
    for separator in (",", ";", "\t"):
        buffer = io.StringIO()
        frame.to_csv(buffer, sep=separator, index=False, quoting=2)
        ratings = read_ratings(buffer.getvalue().encode())
        assert set(map(tuple, ratings.answers[["participant", "texture", "model"]].to_numpy())) == set(map(tuple, rows))


@pytest.mark.parametrize(
    ("people", "rating", "group", "code"),
    [
        ("a", lambda p, m: m, "anova_model", "TOO_FEW_PARTICIPANTS"),
        ("ab", lambda p, m: p + m * m, "anova_model", "NO_ERROR_VARIANCE"),
        ("abc", lambda p, m: p, "friedman", "ALL_TIED"),
        ("abc", lambda p, m: 3, "normality", "CONSTANT"),
        ("ab", lambda p, m: p * m, "anova_model", "SPHERICITY_UNDEFINED"),
        ("abcd", lambda p, m: p * m % 4, "anova_two_way", "TOO_FEW_LEVELS"),
    ],
)
def test_degenerate_studies_are_named(people: str, rating: Any, group: str, code: str) -> None:
    rows = [(name, "t", f"m{m}", rating(p, m)) for p, name in enumerate(people) for m in range(3)]
    analysis = study.analyse(pd.DataFrame(rows, columns=["participant", "texture", "model", "rating"]))
    assert (group, code) in [(note["group"], note["code"]) for note in analysis.to_dict()["notes"]]
    assert analysis.files()["report.html"]
