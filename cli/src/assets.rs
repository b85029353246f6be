//! The summary of an asset, as JSON and as a table. Also reads and writes the files of assets.

use std::fmt::{Display, Formatter, Write as _};
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use htex_author::settings::Metadata;
use htex_author::{FeltError, GridReport, REPEATABILITY_BOUND};
use htex_base::files::AtFile;
use htex_base::finding::plain;
use htex_format::{
    Asset, AtCondition, Condition, Fluctuation, HeldOut, How, Ingredient, Law, LeftOut, Limits,
    Made, Manifest, Measure, StoredField,
};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::columns::{Column, Errors, cells, columns, headings};
use crate::failure::Result;
use crate::grid::grid_text;
use crate::keys::Signer;
use crate::output::{show, warn, write_file};

/// The summary of an asset, which commands print when they make or show an asset: its manifest, and
/// values computed from the asset.
#[derive(Serialize)]
pub(crate) struct AssetSummary {
    asset: String,
    pub(crate) bytes: u64,
    pub(crate) manifest: Manifest,
    /// The law that the manifest states, or else the law that htex assumes.
    law: Law,
    /// Sizes of the embedded models, bytes, in the manifest's order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    plugin_bytes: Vec<usize>,
    /// The values computed for each representation, in the manifest's order.
    pub(crate) representations: Vec<RepresentationSummary>,
    /// After a fit on a grid: the grid of speeds and forces to which the conditions belong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) grid: Option<GridReport>,
    /// Warnings that the manifest does not contain.
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
    /// Who signed the file; left out if there is no signature beside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) signer: Option<Signer>,
    /// Whether the text leaves out the manifest's warnings, because they were already printed.
    #[serde(skip)]
    pub(crate) is_warned: bool,
}

/// The values computed for a representation, which is one fitted model of the asset.
#[derive(Serialize)]
pub(crate) struct RepresentationSummary {
    pub(crate) model: String,
    pub(crate) payload_bytes: usize,
    /// After a fit: the time that the fit took, milliseconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fit_ms: Option<f64>,
    /// The values computed at each condition, in the order of the manifest's `at`.
    pub(crate) at: Vec<AtSummary>,
}

/// The values computed for a representation at one condition.
#[derive(Serialize)]
pub(crate) struct AtSummary {
    parameters: Map<String, Value>,
    /// The error on blocks of time to which the model was not fitted, if the asset states it.
    #[serde(flatten)]
    pub(crate) held_out: Option<HeldOut>,
    /// After a fit: the part of the error that a fingertip can feel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) felt: Option<FeltError>,
}

impl AssetSummary {
    pub(crate) fn new(file: &Path, bytes: u64, asset: &Asset) -> Self {
        let manifest = Manifest { htex: asset.manifest.lowest_version(), ..asset.manifest.clone() };
        let all = manifest.representations.iter().zip(&asset.parameters).enumerate();
        let representations = all.map(|(i, (representation, sets))| RepresentationSummary {
            model: representation.model.clone(),
            payload_bytes: asset.payload_bytes(i),
            fit_ms: None,
            at: sets
                .iter()
                .zip(&representation.at)
                .map(|(set, at)| AtSummary {
                    parameters: parameters_by_name(&representation.fields, set),
                    held_out: manifest.held_out(at),
                    felt: None,
                })
                .collect(),
        });
        Self {
            asset: file.display().to_string(),
            bytes,
            representations: representations.collect(),
            law: manifest.law(),
            manifest,
            plugin_bytes: asset.plugins.iter().map(|module| module.len()).collect(),
            grid: None,
            warnings: Vec::new(),
            notes: asset.notes.iter().map(|note| note.message.clone()).collect(),
            signer: None,
            is_warned: false,
        }
    }

    /// Adds the felt part of each error, by representation and condition.
    pub(crate) fn with_felt(mut self, felt: &[Vec<Option<FeltError>>]) -> Self {
        for (representation, felt) in self.representations.iter_mut().zip(felt) {
            for (at, felt) in representation.at.iter_mut().zip(felt) {
                at.felt = *felt;
            }
        }
        self
    }

    /// Returns a representation's conditions: what the manifest states about each, and the values
    /// computed for it.
    pub(crate) fn conditions(
        &self,
        index: usize,
    ) -> impl Iterator<Item = (&AtCondition, &AtSummary)> {
        let (stated, computed) =
            (&self.manifest.representations[index], &self.representations[index]);
        stated.at.iter().zip(&computed.at)
    }
}

impl Display for AssetSummary {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Manifest { quantity, provenance, band, .. } = &self.manifest;
        writeln!(f, "{}: {} bytes", plain(&self.asset), self.bytes)?;
        let kind = if provenance.simulated { " (simulated)" } else { "" };
        let said = |words: &str, text: &Option<String>| {
            text.as_ref().map(|text| format!(", {words} {}", plain(text))).unwrap_or_default()
        };
        writeln!(
            f,
            "{}{kind}, {} in {}, {} to {} Hz{}{}",
            plain(&self.manifest.name),
            quantity.words(),
            quantity.unit(),
            band.low_hz,
            band.high_hz,
            said("by", &self.manifest.author),
            said("licence", &self.manifest.license),
        )?;
        f.write_str(&provenance.made.as_ref().map(made_text).unwrap_or_default())?;
        self.metadata(f)?;
        for (i, condition) in self.manifest.conditions.iter().enumerate() {
            writeln!(f, "condition {i}: {}", condition_text(condition))?;
        }
        for (plugin, bytes) in self.manifest.plugins.iter().zip(&self.plugin_bytes) {
            let signer = plugin.signature.as_ref();
            let signer = signer
                .map_or("not signed".to_owned(), |key| format!("signed by {}", key.public_key));
            let (model, version) = (&plugin.model, &plugin.version);
            writeln!(
                f,
                "brings along {model} {version}, a sandboxed module of {bytes} bytes, {signer}"
            )?;
        }
        self.table(f)?;
        for (stated, r) in self.manifest.representations.iter().zip(&self.representations) {
            if !stated.triangles.is_empty() {
                let (name, count) = (short_name(&r.model), stated.triangles.len());
                writeln!(f, "  {name}: interpolated in {count} stored triangles")?;
            }
        }
        self.left_out(f)?;
        let warnings = (!self.is_warned).then_some(&provenance.warnings).into_iter().flatten();
        for line in warnings.chain(&self.warnings).chain(&self.notes) {
            writeln!(f, "note: {}", plain(line))?;
        }
        self.grid.as_ref().map_or(Ok(()), |grid| f.write_str(&grid_text(grid)))
    }
}

impl AssetSummary {
    /// Lists the metadata of the surface and its recording, one line each.
    fn metadata(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Manifest { description, tags, source, doi, sensor, finger, contact, .. } =
            &self.manifest;
        let tags = Some(tags.join(", ")).filter(|tags| !tags.is_empty());
        let lines = [
            ("description", description),
            ("tags", &tags),
            ("source", source),
            ("doi", doi),
            ("sensor", sensor),
            ("finger", finger),
        ];
        for (name, text) in lines {
            if let Some(text) = text {
                writeln!(f, "{name}: {}", plain(text))?;
            }
        }
        if let Some(signer) = &self.signer {
            writeln!(f, "{}", plain(&signer.to_string()))?;
        }
        writeln!(f, "contact: {}", contact.name())?;
        writeln!(f, "law outside the recorded motions: {}", self.law)?;
        let mut lines = self.manifest.fluctuation.iter().flat_map(fluctuation_lines);
        lines.try_for_each(|line| writeln!(f, "{line}"))
    }

    /// Lists the level, the measures and the parameters of each representation at each condition.
    fn table(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let columns = columns(Measure::of_both());
        let measures = headings(&columns);
        writeln!(f, "\n  model    cond.       level{measures}  bytes  parameters")?;
        for (i, r) in self.representations.iter().enumerate() {
            for (stated, at) in self.conditions(i) {
                let parameters = at.parameters.iter().map(|(k, v)| parameter_text(&plain(k), v));
                writeln!(
                    f,
                    "  {:8} {:>5}  {:>10}{}  {:>5}  {}",
                    short_name(&r.model),
                    stated.condition,
                    self.manifest.quantity.text(stated.level_rms),
                    cells(&columns, |column| at.measured(stated, column)),
                    r.payload_bytes,
                    Vec::from_iter(parameters).join(" ")
                )?;
            }
        }
        Ok(())
    }

    /// Lists each model's error on held-out blocks of time, if known: RMS and largest value over
    /// the conditions.
    fn left_out(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let measures: Vec<Measure> =
            LeftOut::measures().filter(|m| m.row().column.is_some()).collect();
        let mut has_heading = false;
        for r in &self.manifest.representations {
            let all: Vec<LeftOut> = r.at.iter().filter_map(|at| at.left_out).collect();
            // With one condition, there is nothing to summarise over conditions.
            if all.len() < 2 {
                continue;
            }
            if !has_heading {
                let headings: String = measures.iter().map(|m| left_out_heading(*m)).collect();
                writeln!(f, "\n  model    left out{headings}")?;
            }
            has_heading = true;
            write!(f, "  {:8} {:>8}", short_name(&r.model), all.len())?;
            for measure in &measures {
                let errors = all.iter().filter_map(|one| one.0.get(*measure));
                f.write_str(&spread_cells(*measure, errors.collect()))?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

fn left_out_heading(measure: Measure) -> String {
    let column = measure.row().column.unwrap_or_default();
    format!("  {column}: RMS  largest")
}

/// Returns the table cells under [`left_out_heading`]: the RMS of the errors, and the largest
/// error.
fn spread_cells(measure: Measure, errors: Vec<f64>) -> String {
    // Each cell has two spaces before it, and the second cell is as wide as `largest`.
    let width = left_out_heading(measure).len() - "    largest".len();
    if errors.is_empty() {
        return format!("  {:>width$}  {:>7}", "-", "-");
    }
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let rms = (squares / errors.len() as f64).sqrt();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    format!("  {rms:>width$.2}  {largest:>7.2}")
}

fn parameter_text(name: &str, value: &Value) -> String {
    match value {
        Value::Array(list) => format!("{name}[{}]", list.len()),
        // JSON has no NaN: `Value::from` has made it `null`.
        other => format!("{name}={}", short_number(other.as_f64().unwrap_or(f64::NAN))),
    }
}

fn short_number(x: f64) -> String {
    let text = format!("{x:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Describes a texture's fluctuation and the errors of the fluctuation, as far as they are known.
pub(crate) fn fluctuation_lines(fluctuation: &Fluctuation) -> Vec<String> {
    let Fluctuation { held_out_error_db, halves_error_db, .. } = fluctuation;
    let held_out = held_out_error_db.map(|db| format!("{db:.2} dB held out"));
    let halves =
        halves_error_db.map(|db| format!("{db:.2} dB between the halves of the recordings"));
    let errors = Vec::from_iter(held_out.into_iter().chain(halves)).join(", ");
    let errors = (!errors.is_empty()).then(|| format!("fluctuation error: {errors}"));
    [format!("fluctuation in time: {fluctuation}")].into_iter().chain(errors).collect()
}

/// Describes how much a second recording would differ. `db` is the repeatability of the first
/// recording.
pub(crate) fn repeats(db: f64) -> String {
    let bound = REPEATABILITY_BOUND * db;
    format!(
        "a second recording differs by {db:.2} dB (median), nine in ten by at most {bound:.1} dB"
    )
}

/// Describes a condition's speed, force and repeatability, as far as they are known.
fn condition_text(condition: &Condition) -> String {
    let mut text = motion_text(condition);
    match condition.segments {
        Some(0) => text += ", computed",
        Some(segments) => {
            let _ = write!(text, ", {segments} segments");
        }
        None => {}
    }
    if let Some(db) = condition.repeatability_rms_db {
        let _ = write!(text, ", {}", repeats(db));
    }
    text
}

/// Describes how an asset was made without a recording.
fn made_text(made: &Made) -> String {
    let part = |part: &Ingredient| format!("{} of {}", part.weight, plain(&part.name));
    let parts: Vec<String> = made.from.iter().map(part).collect();
    match made.how {
        How::Parameters => "made by hand of its parameters, of no recording\n".to_owned(),
        How::Mixed => format!("mixed: {}\n", parts.join(", ")),
    }
}

/// Describes a condition's speed and force, as far as they are known.
pub(crate) fn motion_text(condition: &Condition) -> String {
    let part = |value: Option<f64>, unit: &str, what: &str| {
        value.map_or(format!("{what} unknown"), |v| format!("{} {unit}", short_number(v)))
    };
    let speed = part(condition.speed_mm_s, "mm/s", "speed");
    format!("{speed}, {}", part(condition.force_n, "N", "force"))
}

/// Returns the last part of a model's id.
pub(crate) fn short_name(id: &str) -> &str {
    id.rsplit('.').next().unwrap_or(id)
}

/// Groups a flat array of parameters by the names of its fields.
fn parameters_by_name(fields: &[StoredField], mut flat: &[f64]) -> Map<String, Value> {
    let mut parameters = Map::new();
    for field in fields {
        let value = if field.list {
            // In the flat array, a list begins with its length.
            let len = flat.first().map_or(0, |n| *n as usize);
            let list = flat.get(1..=len).unwrap_or_default();
            flat = flat.get(len + 1..).unwrap_or_default();
            Value::from(list)
        } else {
            let value = flat.first().copied().unwrap_or(f64::NAN);
            flat = flat.get(1..).unwrap_or_default();
            Value::from(value)
        };
        parameters.insert(field.name.clone(), value);
    }
    parameters
}

impl AtSummary {
    /// Returns the value for a column of a table.
    pub(crate) fn measured(&self, stated: &AtCondition, column: Column) -> Option<f64> {
        let (quality, felt) = (stated.quality.as_ref(), self.felt.as_ref());
        column.value(Errors { held_out: self.held_out, quality, felt })
    }

    /// Returns the spectral lines of a model that is a sum of sines, as pairs of frequency (Hz) and
    /// amplitude (asset's unit).
    pub(crate) fn lines(&self, level_rms: f64) -> Vec<(f64, f64)> {
        let list = |name: &str| {
            let values = self.parameters.get(name).and_then(Value::as_array);
            values.into_iter().flatten().filter_map(Value::as_f64)
        };
        list("frequency_hz").zip(list("amplitude").map(|a| a * level_rms)).collect()
    }
}

/// Reads the bytes of a file. If the file is too large for an asset, reads only one byte more than
/// is allowed.
pub(crate) fn read_asset(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // With the additional byte, the reader of assets refuses the file and reports the limit, so
    // this function need not report it.
    let most = Limits::default().file_bytes.saturating_add(1);
    File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)).reading(path)?;
    Ok(bytes)
}

/// Writes an asset to a file that the user named, and returns its summary.
pub(crate) fn write_asset(output: &Path, asset: &Asset) -> Result<AssetSummary> {
    let bytes = asset.to_bytes()?;
    write_file(output, &bytes)?;
    Ok(AssetSummary::new(output, bytes.len() as u64, asset))
}

/// Writes an asset, and prints its summary.
pub(crate) fn write_and_show(output: &Path, asset: &Asset, is_json: bool) -> Result {
    show(&write_asset(output, asset)?, is_json)
}

/// Reports the problems that the asset's validation would find in this metadata.
pub(crate) fn check_metadata(metadata: &Metadata) -> Result<()> {
    let warnings: Vec<String> = metadata.check()?.iter().map(|w| format!("--{w}")).collect();
    warn(&warnings);
    Ok(())
}
