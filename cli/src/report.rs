//! The parts of a report on a fitted asset.

use htex_author::report::{Measure, ModelResult, Share, Texture, model_color};
use htex_author::{FeltShare, FittedAsset};
use htex_format::{By, MeasureKind, Quality};
use htex_host::Registry;

use crate::assets::{AssetSummary, fluctuation_lines, motion_text, short_name};
use crate::columns::Column;
use crate::failure::Result;

/// A fitted asset with the data needed for its report.
pub(crate) struct ReportSource<'a> {
    pub(crate) fitted: &'a FittedAsset,
    /// The asset with the models that can play it.
    pub(crate) asset: &'a htex::Texture,
    pub(crate) summary: &'a AssetSummary,
    /// Total size of the recordings' files, bytes.
    pub(crate) recording_bytes: u64,
}

impl ReportSource<'_> {
    /// Returns the texture at each of its recorded conditions.
    pub(crate) fn textures(&self) -> Result<Vec<Texture>, htex::Error> {
        let spectra = self.fitted.spectra.iter().enumerate();
        let recorded = spectra.filter(|(_, spectrum)| spectrum.is_recorded());
        let mut textures: Vec<Texture> = recorded
            .map(|(condition, _)| condition)
            .map(|condition| self.texture(condition))
            .collect::<Result<_, _>>()?;
        if textures.len() > 1 {
            for texture in &mut textures {
                // The name now contains the condition, so it is not shown a second time.
                let condition = std::mem::take(&mut texture.condition);
                texture.name = format!("{}, {condition}", texture.name);
            }
        }
        // The warnings apply to the asset as a whole, so only the first condition shows them.
        for texture in textures.iter_mut().skip(1) {
            texture.warnings.clear();
        }
        Ok(textures)
    }

    pub(crate) fn texture(&self, condition: usize) -> Result<Texture, htex::Error> {
        let (manifest, spectrum) = (self.asset.manifest(), &self.fitted.spectra[condition]);
        let mut models = Vec::new();
        for index in 0..self.summary.representations.len() {
            models.extend(self.model(index, condition)?);
        }
        let known = &manifest.conditions[condition];
        Ok(Texture {
            name: manifest.name.clone(),
            simulated: manifest.provenance.simulated,
            unit: manifest.quantity.unit().to_owned(),
            condition: motion_text(known),
            law: format!(
                "contact: {}; outside the recorded motions: {}",
                manifest.contact.name(),
                manifest.law()
            ),
            fluctuation: manifest
                .fluctuation
                .map(|fluctuation| fluctuation_lines(&fluctuation).join("; "))
                .unwrap_or_default(),
            recording_bytes: self.recording_bytes,
            asset_bytes: self.summary.bytes,
            repeatability_rms_db: known.repeatability_rms_db,
            frequency_hz: spectrum.frequency_hz.clone(),
            recorded: spectrum.magnitude.clone(),
            models,
            warnings: manifest.provenance.warnings.clone(),
        })
    }

    /// Returns a model's curve and measures at a condition; `None` if the model was not fitted at
    /// this condition.
    fn model(&self, index: usize, condition: usize) -> Result<Option<ModelResult>, htex::Error> {
        let Some((stated, at)) =
            self.summary.conditions(index).find(|(stated, _)| stated.condition == condition)
        else {
            return Ok(None);
        };
        let representation = &self.summary.representations[index];
        let quality = stated.quality.as_ref();
        let known = &self.asset.manifest().conditions[condition];
        let motion = known
            .speed_mm_s
            .zip(known.force_n)
            .map(|(speed, force)| htex::Motion::new(speed, force));
        let grid = &self.fitted.spectra[condition].frequency_hz;
        let playable = self.asset.representation(&representation.model[..])?;
        let loaded = playable.model()?;
        let name = short_name(&representation.model);
        let descriptor = loaded.descriptor();
        Ok(Some(ModelResult {
            model: descriptor.name.clone(),
            magnitude: playable.magnitude(motion, grid)?,
            measured: tables().iter().map(|t| at.measured(stated, t.0)).collect(),
            note: note(quality),
            band_error_db: quality.map_or(Vec::new(), |q| q.band_error_db.to_vec()),
            payload_bytes: representation.payload_bytes,
            lines: descriptor.is_sum_of_sines().then(|| at.lines(stated.level_rms)),
            color: model_color(name, &Registry::builtin_names()).to_owned(),
            short_name: name.to_owned(),
        }))
    }
}

/// Returns the tables of measures in a report: the column and the measure of each table.
fn tables() -> Vec<(Column, Measure)> {
    let held_out = Measure {
        caption: "Held-out error: third octaves of the blocks of time to which a model was not fitted, RMS in dB (0 is \
                  the best, light)"
            .to_owned(),
        is_correlation: false,
        repeats: false,
    };
    let mut tables = vec![(Column::HeldOutDb, held_out)];
    for measure in htex_format::Measure::of_both() {
        let row = measure.row();
        let kinds = [
            (By::Magnitude, "fitted magnitude", row.caption),
            (By::Samples, "rendered samples", row.caption.filter(|_| row.played.is_some())),
        ];
        for (by, what, caption) in kinds {
            tables.extend(caption.map(|caption| {
                let table = Measure {
                    caption: caption.replace("{}", what),
                    is_correlation: row.judged == MeasureKind::Correlation,
                    repeats: measure == htex_format::Measure::NineBand,
                };
                (Column::InSample(measure, by), table)
            }));
        }
    }
    tables
}

/// Returns the measures of a texture report, as used in [`ReportSource::textures`].
pub(crate) fn measures() -> Vec<Measure> {
    tables().into_iter().map(|(_, table)| table).collect()
}

/// Returns the correlation and nine-band error that are shown below a spectrum.
fn note(quality: Option<&Quality>) -> String {
    let value = |measure, decimals| {
        let value = quality.and_then(|q| q.get(measure));
        htex_author::report::fixed(value.unwrap_or(f64::NAN), decimals)
    };
    let r = value(htex_format::Measure::SpectralCorrelation, 2);
    format!("r = {r}, error {} dB RMS", value(htex_format::Measure::NineBand, 1))
}

/// For each model, counts the pairs of a texture and one of its conditions: all pairs, the pairs
/// with an error below the difference threshold, and the pairs with an error within the recording's
/// repeatability.
pub(crate) fn shares<'a>(summaries: impl IntoIterator<Item = &'a AssetSummary>) -> Vec<Share> {
    let mut shares: Vec<(String, FeltShare)> = Vec::new();
    for summary in summaries {
        for representation in &summary.representations {
            let model = short_name(&representation.model);
            // A list instead of a map, so that the models stay in the order of the assets.
            let at = match shares.iter().position(|(known, _)| known == model) {
                Some(at) => at,
                None => {
                    shares.push((model.to_owned(), FeltShare::default()));
                    shares.len() - 1
                }
            };
            let felt = representation.at.iter().filter_map(|at| at.felt.as_ref());
            felt.for_each(|felt| shares[at].1.count(felt));
        }
    }
    let share = |(short_name, share): (String, FeltShare)| Share {
        short_name,
        textures: share.textures,
        below_detection_threshold: share.below_detection_threshold,
        below_difference_threshold: share.below_difference_threshold,
        below_if_sensitive: share.below_if_sensitive,
        within_repeatability: share.within_repeatability,
    };
    shares.into_iter().map(share).collect()
}
