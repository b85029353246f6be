//! Correlation of felt spectra with recorded ones.

use htex_statistics::{pearson, summary};

use super::analysis::Mean;
use super::inference::Notes;
use super::methods;
use super::ratings::Ratings;
use super::results::{Correlation, SpectralCorrelation};
use super::spectra::Spectra;

const GROUP: &str = "spectral_correlation";

/// Correlates every felt spectrum with the recorded one of its texture.
pub(super) fn correlate(
    ratings: &Ratings,
    spectra: &Spectra,
    notes: &mut Notes,
) -> SpectralCorrelation {
    let [people, textures, models] =
        [&ratings.participants, &ratings.textures, &ratings.models].map(Vec::len);
    let mut of = |participant: usize, texture: usize, model: usize| {
        let felt = spectra.felt(participant, texture, model);
        let result = pearson(felt, spectra.recorded(texture));
        let group = format!(
            "{GROUP}.{}.{}.{}",
            ratings.participants[participant], ratings.textures[texture], ratings.models[model]
        );
        notes.take(&group, result)
    };
    let mut values = Vec::new();
    for participant in 0..people {
        for texture in 0..textures {
            for model in 0..models {
                values.push((
                    (participant, texture, model),
                    of(participant, texture, model),
                ));
            }
        }
    }
    let cell = |((p, t, m), correlation): &((usize, usize, usize), Option<f64>)| Correlation {
        participant: ratings.participants[*p].clone(),
        texture: ratings.textures[*t].clone(),
        model: ratings.models[*m].clone(),
        correlation: *correlation,
    };
    let at = |p: usize, t: usize, m: usize| values[(p * textures + t) * models + m].1;
    let in_texture = |t: usize, m: usize| {
        let values = (0..people).filter_map(|p| at(p, t, m)).collect();
        mean(Some(&ratings.textures[t]), &ratings.models[m], values)
    };
    let overall = |m: usize| {
        let averaged = |p: usize| average((0..textures).filter_map(|t| at(p, t, m)));
        let values = (0..people).filter_map(averaged).collect();
        mean(None, &ratings.models[m], values)
    };
    let every = (0..textures).flat_map(|t| (0..models).map(move |m| (t, m)));
    SpectralCorrelation {
        cells: values.iter().map(cell).collect(),
        means: every.filter_map(|(t, m)| in_texture(t, m)).collect(),
        means_model: (0..models).filter_map(overall).collect(),
        method: methods::CORRELATION.to_owned(),
    }
}

fn average(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    summary(&values).ok().map(|summary| summary.mean)
}

/// The mean of a condition's values, by participant; `None` if there are none.
pub(super) fn mean(texture: Option<&str>, model: &str, values: Vec<f64>) -> Option<Mean> {
    let summary = summary(&values).ok()?;
    Some(Mean {
        texture: texture.map(str::to_owned),
        model: model.to_owned(),
        count: summary.count,
        mean: summary.mean,
        sd: summary.sd,
        by_participant: values,
    })
}
