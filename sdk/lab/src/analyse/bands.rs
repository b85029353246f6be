//! Regression of ratings on differences of spectral energy in bands.

use htex_dsp::Band;
use htex_dsp::bands::BandBank;
use htex_statistics::{
    Matrix, Regression, StatisticsError, cross_validated_r2, regression, z_scores,
};

use super::inference::Notes;
use super::ratings::Ratings;
use super::results::{BandResult, BestBanks};
use super::spectra::Spectra;

/// Largest number of bands: that of the paper.
const MOST: usize = 20;

/// What the regressions are made of: a row for each participant, texture and model.
struct Rows {
    /// z-scores of the differences of energy, by row, then bin.
    differences: Vec<Vec<f64>>,
    /// z-scores of ratings.
    ratings: Vec<f64>,
    /// Index of the participant.
    groups: Vec<usize>,
}

/// Fits the regressions for 1 to 20 bands.
pub(super) fn fit(
    ratings: &Ratings,
    spectra: &Spectra,
    notes: &mut Notes,
) -> (Vec<BandResult>, Option<BestBanks>) {
    let rows = Rows::new(ratings, spectra);
    let mut results = Vec::new();
    for filters in 1..=MOST {
        let result = notes.take(&format!("bands.{filters}"), rows.fit(filters));
        let Some((mut result, predictors)) = result else {
            continue;
        };
        let checked = cross_validated_r2(&predictors, &rows.ratings, &rows.groups);
        let group = format!("bands.{filters}.cross_validated_r2");
        result.cross_validated_r2 = notes.take(&group, checked);
        results.push(result);
    }
    let best = best(&results, &rows.ratings);
    if let Some(best) = best.as_ref().filter(|best| !best.better_than_none) {
        let message = format!(
            "the best bank ({} bands) has a higher BIC than the mean alone: the bands do not explain the ratings",
            best.bic
        );
        notes.add("best_bands", "BANDS_EXPLAIN_NOTHING", message);
    }
    (results, best)
}

impl Rows {
    fn new(ratings: &Ratings, spectra: &Spectra) -> Self {
        let mut rows = Self {
            differences: Vec::new(),
            ratings: Vec::new(),
            groups: Vec::new(),
        };
        for participant in 0..ratings.participants.len() {
            for texture in 0..ratings.textures.len() {
                rows.add(ratings, spectra, participant, texture);
            }
        }
        rows
    }

    /// Adds the models of a participant and texture, standardised over them.
    fn add(&mut self, ratings: &Ratings, spectra: &Spectra, participant: usize, texture: usize) {
        let models = 0..ratings.models.len();
        let recorded = spectra.recorded(texture);
        let difference = |model: usize, bin: usize| {
            let felt = spectra.felt(participant, texture, model)[bin];
            (felt * felt - recorded[bin] * recorded[bin]).abs()
        };
        let mut rows = vec![Vec::with_capacity(recorded.len()); models.len()];
        for bin in 0..recorded.len() {
            let column: Vec<f64> = models.clone().map(|model| difference(model, bin)).collect();
            for (row, score) in rows.iter_mut().zip(standardised(&column)) {
                row.push(score);
            }
        }
        self.differences.extend(rows);
        self.groups.extend(models.clone().map(|_| participant));
        let means: Vec<f64> = models
            .map(|model| ratings.mean(participant, texture, model))
            .collect();
        self.ratings.extend(standardised(&means));
    }

    fn fit(&self, filters: usize) -> Result<(BandResult, Matrix), StatisticsError> {
        let bank = BandBank::new(filters, Band::TACTILE, &Band::TACTILE.grid_hz());
        let mut columns = vec![Vec::with_capacity(self.differences.len()); filters];
        let mut sums = vec![0.0; filters];
        for row in &self.differences {
            bank.filters().apply(row, &mut sums);
            columns
                .iter_mut()
                .zip(&sums)
                .for_each(|(column, sum)| column.push(*sum));
        }
        let predictors = Matrix::new(self.differences.len(), columns)?;
        let fit = regression(&predictors, &self.ratings)?;
        Ok((result(fit, filters, bank.edges_hz()), predictors))
    }
}

/// z-scores, or zeros where all values are equal.
fn standardised(values: &[f64]) -> Vec<f64> {
    z_scores(values).unwrap_or_else(|_| vec![0.0; values.len()])
}

fn result(fit: Regression, filters: usize, edges_hz: &[f64]) -> BandResult {
    BandResult {
        filters,
        r2: fit.r2,
        adjusted_r2: fit.adjusted_r2,
        cross_validated_r2: None,
        f: fit.f,
        df: fit.df,
        p: fit.p,
        rmse: fit.rmse,
        aic: fit.aic,
        bic: fit.bic,
        coefficients: fit.coefficients,
        dependent: fit.dependent.iter().map(|index| index + 1).collect(),
        edges_hz: edges_hz.to_vec(),
    }
}

fn best(results: &[BandResult], ratings: &[f64]) -> Option<BestBanks> {
    let lowest = |of: fn(&BandResult) -> f64| {
        results
            .iter()
            .min_by(|a, b| of(a).total_cmp(&of(b)))
            .map(|best| best.filters)
    };
    let checked = results
        .iter()
        .filter_map(|r| Some((r.cross_validated_r2?, r.filters)));
    let bic_of_none = bic_of_none(ratings);
    let bic = lowest(|r| r.bic)?;
    Some(BestBanks {
        bic,
        aic: lowest(|r| r.aic)?,
        cross_validated_r2: checked
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|best| best.1),
        bic_of_none,
        better_than_none: results.iter().any(|r| r.bic < bic_of_none),
    })
}

/// BIC of a model with the mean alone.
fn bic_of_none(ratings: &[f64]) -> f64 {
    let n = ratings.len() as f64;
    let mean = ratings.iter().sum::<f64>() / n;
    let squares: f64 = ratings.iter().map(|r| (r - mean) * (r - mean)).sum();
    n * (libm::log(2.0 * std::f64::consts::PI * squares / n) + 1.0) + libm::log(n)
}
