"""Test which properties of felt spectra predict ratings: their correlation with the recorded
spectrum, and their energy in bands, by regression.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from .notes import Notes, Undefined, is_constant
from .ratings import Ratings
from .results import BandResult, BestBanks, Correlation, Within
from .spectra import GRID_HZ, Spectra

#: Largest number of bands, as in the paper.
MOST = 20


def correlations(ratings: Ratings, spectra: Spectra, notes: Notes) -> tuple[np.ndarray, list[Correlation]]:
    """Correlate every felt spectrum with its texture's recorded spectrum (Pearson).

    Return the correlations as an array with the shape of the mean ratings, and as a list.
    """
    values, cells = np.full(ratings.means.shape, np.nan), []
    for index in map(tuple, np.argwhere(~np.isnan(spectra.felt[..., 0]))):
        participant, texture, model = index
        cell = Correlation(
            participant=ratings.participants[participant],
            texture=ratings.textures[texture],
            model=ratings.models[model],
        )
        felt, recorded = spectra.felt[index], spectra.recorded[texture]
        if is_constant(felt) or is_constant(recorded):
            group = f"spectral_correlation.{cell['participant']}.{cell['texture']}.{cell['model']}"
            notes.add(group, "CONSTANT", "all values are equal, so a correlation is not defined")
        else:
            values[index] = cell["correlation"] = float(np.clip(stats.pearsonr(felt, recorded).statistic, -1, 1))
        cells.append(cell)
    return values, cells


@dataclass
class Rows:
    """The data of the regressions. There is a row for each condition for which a participant has a
    rating and a felt spectrum."""

    #: z-scores of the energy differences between felt and recorded spectra, indexed by row, then
    #: frequency bin.
    differences: np.ndarray
    #: z-scores of the ratings.
    ratings: np.ndarray
    #: The participant of each row.
    groups: np.ndarray
    #: Degrees of freedom of the ratings. Each cell contributes one less than its number of
    #: conditions, because its z-scores sum to 0.
    df: int


def rows_of(ratings: Ratings, spectra: Spectra) -> Rows:
    """Standardise within cells. A cell holds all models of one participant and one texture.

    If a study has one model, a cell holds all textures of one participant.
    """
    differences = np.abs(spectra.felt**2 - spectra.recorded[None, :, None, :] ** 2)
    known = ~np.isnan(ratings.means) & ~np.isnan(differences[..., 0])
    features, values, groups, df = [], [], [], 0
    for participant in range(len(ratings.participants)):
        cells = [(participant, texture) for texture in range(len(ratings.textures))]
        for cell in [(participant, slice(None), 0)] if ratings.factor == "texture" else cells:
            conditions = known[cell]
            if conditions.sum() < 2:
                continue
            rated = _standardised(ratings.means[cell][conditions][:, None])[:, 0]
            features.append(_standardised(differences[cell][conditions]))
            values.append(rated)
            groups.append(np.full(len(rated), participant))
            df += len(rated) - 1 if rated.any() else 0
    if not values:
        return Rows(np.empty((0, len(GRID_HZ))), np.empty(0), np.empty(0, dtype=int), 0)
    return Rows(np.concatenate(features), np.concatenate(values), np.concatenate(groups), df)


def _standardised(columns: np.ndarray) -> np.ndarray:
    """Return z-scores (n - 1) of each column; zeros if all values are equal."""
    centred = columns - columns.mean(axis=0)
    squares, largest = (centred**2).sum(axis=0), np.abs(columns).max(axis=0)
    constant = squares <= (largest * 1e-13) ** 2 * len(columns)
    return np.where(constant, 0.0, centred / np.sqrt(np.where(constant, 1.0, squares / (len(columns) - 1))))


def bank(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a bank of triangular bands over logarithmic frequency, each overlapping its neighbours
    by half: the weights by bin and band, and the edges in hertz.
    """
    edges = np.arange(count + 2)
    axis = np.log(GRID_HZ / GRID_HZ[0]) / np.log(GRID_HZ[-1] / GRID_HZ[0]) * (count + 1)
    weights = np.clip(1 - np.abs(axis[:, None] - edges[None, 1:-1]), 0, None)
    return weights, GRID_HZ[0] * (GRID_HZ[-1] / GRID_HZ[0]) ** (edges / (count + 1))


def bands(rows: Rows, notes: Notes) -> tuple[list[BandResult], BestBanks | None]:
    """Regress ratings on the energy differences in 1 to 20 bands."""
    results = []
    for count in range(1, MOST + 1):
        weights, edges = bank(count)
        predictors = rows.differences @ weights
        result = notes.take(f"bands.{count}", lambda p=predictors: regression(p, rows))  # type: ignore[misc]
        if result is None:
            continue
        result.update({"filters": count, "edges_hz": edges.tolist()})
        checked = notes.take(
            f"bands.{count}.cross_validated_r2",
            lambda p=predictors: cross_validated_r2(p, rows.ratings, rows.groups),  # type: ignore[misc]
        )
        if checked is not None:
            result["cross_validated_r2"] = checked
        results.append(result)
    best = _best(results, rows.ratings)
    if best and not best["better_than_none"]:
        message = f"the best bank ({best['bic']} bands) has a higher BIC than the mean alone: the bands do not explain the ratings"
        notes.add("best_bands", "BANDS_EXPLAIN_NOTHING", message)
    return results, best


def regression(predictors: np.ndarray, rows: Rows) -> BandResult:
    """Fit a least-squares regression with an intercept. Test it with the degrees of freedom that
    remain after z-scoring within cells.
    """
    from statsmodels.regression.linear_model import OLS

    values = rows.ratings
    if len(values) == 0 or is_constant(values):
        raise Undefined("CONSTANT", "all values are equal, so a regression is not defined")
    design = np.column_stack([np.ones(len(values)), predictors])
    kept = _independent(design)
    if len(kept) < 2:
        raise Undefined("NO_PREDICTOR", "no predictor varies, so that there is nothing to regress on")
    if len(kept) >= len(values):
        _too_few_rows(len(values), len(kept))
    fit = OLS(values, design[:, kept]).fit()
    if fit.ssr <= 1e-24 * fit.centered_tss:
        message = "the predictors explain the values exactly: without residuals F, AIC and BIC are not defined"
        raise Undefined("PERFECT_FIT", message)
    coefficients = np.zeros(design.shape[1])
    coefficients[kept] = fit.params
    result = BandResult(
        r2=float(fit.rsquared),
        adjusted_r2=float(fit.rsquared_adj),
        f=float(fit.fvalue),
        df=(float(fit.df_model), float(fit.df_resid)),
        p=float(fit.f_pvalue),
        rmse=float(np.sqrt(fit.mse_resid)),
        aic=float(fit.aic),
        bic=float(fit.bic),
        coefficients=[float(c) for c in coefficients],
    )
    if dependent := [column for column in range(1, design.shape[1]) if column not in kept]:
        result["dependent"] = dependent
    size = len(kept) - 1
    if rows.df > size:
        result["within"] = within(float(fit.ess), float(fit.ssr), size, rows.df - size)
    return result


def within(explained: float, residual: float, size: int, df: int) -> Within:
    """Return the F-test for ``size`` predictors with a residual of ``df`` degrees of freedom."""
    f = (explained / size) / (residual / df)
    return Within(f=f, df=(size, df), p=float(stats.f.sf(f, size, df)))


def _independent(design: np.ndarray) -> list[int]:
    """Return the columns that do not depend on the columns before them (Gram and Schmidt)."""
    basis, kept = np.empty((len(design), 0)), []
    for index, column in enumerate(design.T):
        rest = column - basis @ (basis.T @ column)
        rest -= basis @ (basis.T @ rest)
        size = np.linalg.norm(rest)
        if size > 1e-11 * np.linalg.norm(column) and basis.shape[1] < len(design):
            basis = np.column_stack([basis, rest / size])
            kept.append(index)
    return kept


def cross_validated_r2(predictors: np.ndarray, values: np.ndarray, groups: np.ndarray) -> float:
    """Return the cross-validated R². It predicts each group from all other groups. It is 1 minus
    the squared error of these predictions divided by the squared error of predicting the mean.

    Unlike R², it falls when predictors fit noise, even below 0. To save time, the triangular
    factors of all groups before and after each group are accumulated. Then the time for all folds
    is proportional to the number of rows, instead of rows times groups.
    """
    table = np.column_stack([np.ones(len(values)), predictors, values])
    blocks = [table[groups == group] for group in np.unique(groups)]
    if len(blocks) < 2:
        message = f"{len(blocks)} participants are too few: cross-validation by participants needs at least 2"
        raise Undefined("TOO_FEW_PARTICIPANTS", message)
    before, after = _triangles(blocks), _triangles(blocks[::-1])[::-1]
    errors = baseline = 0.0
    for fold, block in enumerate(blocks):
        known = len(values) - len(block)
        if known <= table.shape[1] - 1:
            _too_few_rows(known, table.shape[1] - 1)
        others = np.vstack([before[fold], after[fold + 1]])
        solution = np.linalg.lstsq(others[:, :-1], others[:, -1], rcond=1e-11)[0]
        centre = (values.sum() - block[:, -1].sum()) / known
        errors += float(((block[:, -1] - block[:, :-1] @ solution) ** 2).sum())
        baseline += float(((block[:, -1] - centre) ** 2).sum())
    return 1 - errors / baseline


def _triangles(blocks: list[np.ndarray]) -> list[np.ndarray]:
    """Return, for each n, the upper triangular factor of all blocks before the n-th.

    Least squares on this factor has the same solution as on the blocks.
    """
    triangles = [np.empty((0, blocks[0].shape[1]))]
    for block in blocks:
        triangles.append(np.asarray(np.linalg.qr(np.vstack([triangles[-1], block]), mode="r")))
    return triangles


def _too_few_rows(rows: int, coefficients: int) -> None:
    message = f"{rows} values are too few for a regression with {coefficients} coefficients, which needs more values than coefficients"
    raise Undefined("TOO_FEW_ROWS", message)


def _best(results: list[BandResult], values: np.ndarray) -> BestBanks | None:
    if not results:
        return None
    n, squares = len(values), float(((values - values.mean()) ** 2).sum())
    none = float(n * (np.log(2 * np.pi * squares / n) + 1) + np.log(n))
    best = BestBanks(
        bic=min(results, key=lambda r: r["bic"])["filters"],
        aic=min(results, key=lambda r: r["aic"])["filters"],
        bic_of_none=none,
        better_than_none=any(r["bic"] < none for r in results),
    )
    if checked := [r for r in results if "cross_validated_r2" in r]:
        best["cross_validated_r2"] = max(checked, key=lambda r: r["cross_validated_r2"])["filters"]
    return best
