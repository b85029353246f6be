//! The analysis as a whole.

use std::collections::BTreeMap;

use htex_statistics::{Power, StatisticsError, Table, TwoFactors};
use serde_json::Value;

use super::analysis::{ANALYSIS, Analysis, CellMean, Mean};
use super::correlation::{correlate, mean};
use super::inference::{Notes, anova_of, friedman_of, normality_of, pairs_of, two_way};
use super::ratings::Ratings;
use super::results::PowerRow;
use super::spectra::Spectra;
use super::{bands, methods};

/// A medium effect (Cohen 1988), which the paper plans for.
const MEDIUM_F: f64 = 0.25;

/// The JSON Schema of analyses: `spec/schemas/study-analysis-1.json`.
pub fn analysis_schema() -> Value {
    htex_schema::document::<Analysis>("study-analysis-1.json", "Analysis of a rating study")
}

/// Analyses ratings, and felt spectra if there are some. `program` names what analysed, in the result.
pub fn analyse(ratings: &Ratings, spectra: Option<&Spectra>, program: &str) -> Analysis {
    let mut notes = Notes::default();
    let mut analysis = about(ratings, program);
    overall(ratings, &mut analysis, &mut notes);
    for texture in 0..ratings.textures.len() {
        in_texture(ratings, texture, &mut analysis, &mut notes);
    }
    analysis.power = power(ratings, &mut notes);
    if let Some(spectra) = spectra {
        analysis.spectral_correlation = Some(correlate(ratings, spectra, &mut notes));
        (analysis.bands, analysis.best_bands) = bands::fit(ratings, spectra, &mut notes);
    }
    analysis.notes = notes.0;
    analysis
}

fn overall(ratings: &Ratings, analysis: &mut Analysis, notes: &mut Notes) {
    let factors = two_factors(ratings);
    if let Ok(table) = factors.clone().and_then(|factors| factors.marginal(1)) {
        analysis.anova_model = anova_of(&table, "anova_model", notes);
        analysis.friedman = friedman_of(&table, "friedman", notes);
        analysis.pairs_model = pairs_of(&table, &ratings.models, "pairs_model", notes);
        analysis.means_model = means(&table, None, &ratings.models);
    }
    analysis.anova_two_way = two_way(factors, notes);
    analysis.normality = normality_of(&ratings.means(), "normality", notes);
}

fn in_texture(ratings: &Ratings, texture: usize, analysis: &mut Analysis, notes: &mut Notes) {
    let name = &ratings.textures[texture];
    let Ok(table) = texture_table(ratings, texture) else {
        return;
    };
    let group = |kind: &str| format!("{kind}.{name}");
    let own = |value| (name.clone(), value);
    let anova = anova_of(&table, &group("anova_by_texture"), notes);
    analysis
        .anova_by_texture
        .extend(anova.map(|test| (name.clone(), test)));
    let friedman = friedman_of(&table, &group("friedman_by_texture"), notes);
    analysis
        .friedman_by_texture
        .extend(friedman.map(|test| (name.clone(), test)));
    let pairs = pairs_of(&table, &ratings.models, &group("pairs_by_texture"), notes);
    analysis.pairs_by_texture.extend([own(pairs)]);
    let normality = normality_of(table.values(), &group("normality_by_texture"), notes);
    analysis
        .normality_by_texture
        .insert(name.clone(), normality);
    analysis
        .means
        .extend(means(&table, Some(name), &ratings.models));
}

/// Participants by textures and models.
fn two_factors(ratings: &Ratings) -> Result<TwoFactors, StatisticsError> {
    let levels = [ratings.textures.len(), ratings.models.len()];
    TwoFactors::new(ratings.participants.len(), levels, ratings.means())
}

/// Participants by models in one texture.
fn texture_table(ratings: &Ratings, texture: usize) -> Result<Table, StatisticsError> {
    let (people, models) = (ratings.participants.len(), ratings.models.len());
    let row = |p: usize| (0..models).map(move |m| ratings.mean(p, texture, m));
    Table::new(people, models, (0..people).flat_map(row).collect())
}

fn means(table: &Table, texture: Option<&str>, models: &[String]) -> Vec<Mean> {
    let one = |(level, model): (usize, &String)| mean(texture, model, table.column(level));
    models.iter().enumerate().filter_map(one).collect()
}

/// Power from 4 participants, or from 2 in smaller studies, to those of the study.
fn power(ratings: &Ratings, notes: &mut Notes) -> Vec<PowerRow> {
    let measurements = ratings.textures.len() * ratings.models.len();
    let plan = Power::new(MEDIUM_F, measurements);
    let people = ratings.participants.len();
    let first = if people < 4 { 2 } else { 4 };
    let mut rows = Vec::new();
    for participants in first..=people.max(first).min(first + 200) {
        let Some(found) = notes.take("power", plan.with_participants(participants)) else {
            break;
        };
        rows.push(PowerRow {
            participants,
            measurements,
            effect_f: plan.effect_f,
            alpha: plan.alpha,
            correlation: plan.correlation,
            epsilon: plan.epsilon,
            power: found.power,
        });
    }
    rows
}

fn about(ratings: &Ratings, program: &str) -> Analysis {
    Analysis {
        analysis: ANALYSIS.to_owned(),
        program: program.to_owned(),
        participants: ratings.participants.clone(),
        simulated: ratings.simulated.clone(),
        textures: ratings.textures.clone(),
        models: ratings.models.clone(),
        repetitions: ratings.repetitions,
        methods: methods::all(),
        notes: Vec::new(),
        cell_means: cell_means(ratings),
        means_model: Vec::new(),
        means: Vec::new(),
        normality: Default::default(),
        normality_by_texture: BTreeMap::new(),
        anova_model: None,
        anova_by_texture: BTreeMap::new(),
        anova_two_way: BTreeMap::new(),
        friedman: None,
        friedman_by_texture: BTreeMap::new(),
        pairs_model: Vec::new(),
        pairs_by_texture: BTreeMap::new(),
        power: Vec::new(),
        spectral_correlation: None,
        bands: Vec::new(),
        best_bands: None,
    }
}

fn cell_means(ratings: &Ratings) -> Vec<CellMean> {
    let mut cells = Vec::new();
    for (p, participant) in ratings.participants.iter().enumerate() {
        for (t, texture) in ratings.textures.iter().enumerate() {
            for (m, model) in ratings.models.iter().enumerate() {
                cells.push(CellMean {
                    participant: participant.clone(),
                    texture: texture.clone(),
                    model: model.clone(),
                    repetitions: ratings.count(p, t, m),
                    mean: ratings.mean(p, t, m),
                });
            }
        }
    }
    cells
}
