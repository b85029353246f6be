//! Describes the models of a new texture. For each model, the description states how much of the
//! difference between the model and the fitted data a fingertip can feel.

use htex_author::FeltError;
use htex_format::{Asset, HeldOut, LeftOut, Quality};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Model<'a> {
    model: &'a str,
    bytes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fit_ms: Option<f64>,
    felt: Option<FeltError>,
    at: Vec<At<'a>>,
}

#[derive(Serialize)]
struct At<'a> {
    condition: usize,
    level_rms: f64,
    #[serde(flatten)]
    held_out: Option<HeldOut>,
    quality: Option<&'a Quality>,
    left_out: Option<LeftOut>,
    felt: Option<FeltError>,
}

/// Describes the models of an asset. `felt` has an entry for each representation at each condition.
pub(super) fn represented<'a>(asset: &'a Asset, felt: &[Vec<Option<FeltError>>]) -> Vec<Model<'a>> {
    let of = |(i, representation): (usize, &'a htex_format::Representation)| {
        let felt = felt.get(i).map_or(&[][..], Vec::as_slice);
        let at = representation.at.iter().enumerate();
        Model {
            model: &representation.model,
            bytes: asset.payload_bytes(i),
            fit_ms: None,
            felt: felt.iter().flatten().copied().reduce(FeltError::worse),
            at: at
                .map(|(k, at)| At {
                    condition: at.condition,
                    level_rms: at.level_rms,
                    held_out: asset.manifest.held_out(at),
                    quality: at.quality.as_ref(),
                    left_out: at.left_out,
                    felt: felt.get(k).copied().flatten(),
                })
                .collect(),
        }
    };
    let representations = asset.manifest.representations.iter();
    representations.enumerate().map(of).collect()
}

/// Returns the ids of the models. The model whose difference is felt least comes first.
pub(super) fn ranked<'a>(models: &[Model<'a>]) -> Vec<&'a str> {
    let mut ranked: Vec<(f64, &str)> = Vec::new();
    for Model { model, felt, .. } in models {
        let error_db = felt.map_or(f64::INFINITY, |felt| felt.error_rms_db);
        let behind = ranked.partition_point(|(other, _)| *other <= error_db);
        ranked.insert(behind, (error_db, model));
    }
    ranked.into_iter().map(|(_, model)| model).collect()
}
