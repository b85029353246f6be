//! The summary of an asset, as JSON and as a table.

use std::fmt::Write;
use std::path::Path;

use htex_author::{FeltError, FeltShare, GridReport};
use htex_base::finding::plain;
use htex_format::{
    AtCondition, Condition, Contact, How, Ingredient, Law, LeftOut, Made, Measure, Quality,
    Quantity, Representation, StoredField, Triangle,
};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::columns::{Column, cells, columns, headings};

/// The summary of an asset that `fit` and `info` print.
///
/// The manifest is not flattened into it, because its JSON differs. In the summary, `name` precedes
/// `htex`, empty `tags` and a false `simulated` are written, the band is a list, and plugins and
/// representations include their sizes and numbers.
#[derive(Serialize)]
pub(crate) struct AssetSummary {
    pub(crate) asset: String,
    pub(crate) bytes: u64,
    name: String,
    htex: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    license: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    author: Option<String>,
    tags: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    description: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    doi: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensor: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    finger: Option<String>,
    contact: Contact,
    /// The stated law, else the assumed one.
    law: Law,
    simulated: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    made: Option<Made>,
    quantity: Quantity,
    unit: &'static str,
    band_hz: [f64; 2],
    conditions: Vec<Condition>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    plugins: Vec<PluginSummary>,
    pub(crate) representations: Vec<RepresentationSummary>,
    /// After a fit: the grid in which the conditions were collected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) grid: Option<GridReport>,
    pub(crate) repeatability_rms_db: Option<f64>,
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
}

/// A model embedded in the asset.
#[derive(Serialize)]
struct PluginSummary {
    model: String,
    version: String,
    bytes: usize,
    blake3: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    signed_by: Option<String>,
}

/// One representation. The keys of its first condition are at the same level as its own keys.
#[derive(Serialize)]
pub(crate) struct RepresentationSummary {
    pub(crate) model: String,
    model_version: String,
    pub(crate) payload_bytes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fit_ms: Option<f64>,
    /// The stored triangles, in which players interpolate.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    triangles: Vec<Triangle>,
    #[serde(flatten)]
    pub(crate) first: AtSummary,
    /// All conditions, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    at: Vec<AtSummary>,
}

/// A representation at one condition.
#[derive(Clone, Serialize)]
pub(crate) struct AtSummary {
    condition: usize,
    parameters: Map<String, Value>,
    level_rms: f64,
    #[serde(flatten)]
    pub(crate) quality: Option<Quality>,
    /// After a fit: the part of the difference that can be felt.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) felt: Option<FeltError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<LeftOut>,
}

impl AssetSummary {
    pub(crate) fn new(file: &Path, bytes: u64, asset: &htex_format::Asset) -> Self {
        let manifest = &asset.manifest;
        let representations = manifest
            .representations
            .iter()
            .zip(&asset.parameters)
            .enumerate()
            .filter_map(|(i, (r, sets))| {
                RepresentationSummary::new(r, sets, asset.payload_bytes(i))
            })
            .collect();
        Self {
            asset: file.display().to_string(),
            bytes,
            name: manifest.name.clone(),
            htex: manifest.htex.clone(),
            license: manifest.license.clone(),
            author: manifest.author.clone(),
            tags: manifest.tags.clone(),
            description: manifest.description.clone(),
            source: manifest.source.clone(),
            doi: manifest.doi.clone(),
            sensor: manifest.sensor.clone(),
            finger: manifest.finger.clone(),
            contact: manifest.contact,
            law: manifest.law(),
            simulated: manifest.provenance.simulated,
            made: manifest.provenance.made.clone(),
            quantity: manifest.quantity,
            unit: manifest.quantity.unit(),
            band_hz: [manifest.band.low_hz, manifest.band.high_hz],
            conditions: manifest.conditions.clone(),
            plugins: plugins(asset),
            representations,
            grid: None,
            repeatability_rms_db: manifest.conditions.first().and_then(|c| c.repeatability_rms_db),
            warnings: manifest.provenance.warnings.clone(),
            notes: asset.notes.iter().map(|note| note.message.clone()).collect(),
        }
    }

    /// Adds the felt part of the differences, by representation and condition.
    pub(crate) fn with_felt(mut self, felt: &[Vec<Option<FeltError>>]) -> Self {
        for (representation, felt) in self.representations.iter_mut().zip(felt) {
            representation.first.felt = felt.first().copied().flatten();
            for (at, felt) in representation.at.iter_mut().zip(felt) {
                at.felt = *felt;
            }
        }
        self
    }

    /// Adds a warning for the reader.
    pub(crate) fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// Formats the summary as text.
    pub(crate) fn to_text(&self) -> String {
        let mut text = format!("{}: {} bytes\n", plain(&self.asset), self.bytes);
        let kind = if self.simulated { " (simulated)" } else { "" };
        let _ = writeln!(
            text,
            "{}{kind}, {} in {}, {} to {} Hz{}{}",
            plain(&self.name),
            self.quantity.words(),
            self.unit,
            self.band_hz[0],
            self.band_hz[1],
            self.author.as_ref().map(|a| format!(", by {}", plain(a))).unwrap_or_default(),
            self.license.as_ref().map(|l| format!(", licence {}", plain(l))).unwrap_or_default(),
        );
        text += &self.made.as_ref().map(made_text).unwrap_or_default();
        text += &self.metadata_text();
        for (i, condition) in self.conditions.iter().enumerate() {
            let _ = writeln!(text, "condition {i}: {}", condition_text(condition));
        }
        for plugin in &self.plugins {
            let signer = plugin.signed_by.as_ref();
            let _ = writeln!(
                text,
                "brings along {} {}, a sandboxed module of {} bytes, {}",
                plugin.model,
                plugin.version,
                plugin.bytes,
                signer.map_or("not signed".to_owned(), |key| format!("signed by {key}"))
            );
        }
        let columns = columns(Measure::of_both());
        let measures = headings(&columns);
        text += &format!("\n  model    cond.       level{measures}  bytes  parameters\n");
        for r in &self.representations {
            for at in r.all() {
                text += &row(r, at, self.quantity, &columns);
            }
        }
        text += &self.triangles_text();
        text += &self.left_out_text();
        for line in self.warnings.iter().chain(&self.notes) {
            let _ = writeln!(text, "note: {}", plain(line));
        }
        text
    }
}

impl AssetSummary {
    /// Lists the metadata of the surface and its recording, one line each.
    fn metadata_text(&self) -> String {
        let tags = Some(self.tags.join(", ")).filter(|tags| !tags.is_empty());
        let lines = [
            ("description", &self.description),
            ("tags", &tags),
            ("source", &self.source),
            ("doi", &self.doi),
            ("sensor", &self.sensor),
            ("finger", &self.finger),
        ];
        let said = lines.into_iter().filter_map(|(name, text)| Some((name, text.as_ref()?)));
        let mut said: String =
            said.map(|(name, text)| format!("{name}: {}\n", plain(text))).collect();
        let _ = writeln!(said, "contact: {}", self.contact.name());
        let _ = writeln!(said, "law outside the recorded motions: {}", self.law);
        said
    }
}

impl AssetSummary {
    /// Says how many triangles each representation stores, for representations that store any.
    fn triangles_text(&self) -> String {
        let stored = self.representations.iter().filter(|r| !r.triangles.is_empty());
        let line = |r: &RepresentationSummary| {
            let count = r.triangles.len();
            format!("  {}: interpolated in {count} stored triangles\n", short_name(&r.model))
        };
        stored.map(line).collect()
    }
}

impl AssetSummary {
    /// Lists each model's error on held-out blocks of time, if known: RMS and largest value over
    /// the conditions.
    fn left_out_text(&self) -> String {
        let measures = LeftOut::measures().filter(|m| m.row().column.is_some());
        let mut text = String::new();
        for r in &self.representations {
            let all: Vec<LeftOut> = r.at.iter().filter_map(|at| at.left_out).collect();
            if all.is_empty() {
                continue;
            }
            if text.is_empty() {
                let headings: String = measures.clone().map(left_out_heading).collect();
                text += &format!("\n  model    left out{headings}\n");
            }
            let _ = write!(text, "  {:8} {:>8}", short_name(&r.model), all.len());
            for measure in measures.clone() {
                let of = all.iter().filter_map(|one| one.0.get(measure));
                text += &spread_cells(measure, Spread::of(of));
            }
            text.push('\n');
        }
        text
    }
}

fn left_out_heading(measure: Measure) -> String {
    let column = measure.row().column.unwrap_or_default();
    format!("  {column}: RMS  largest")
}

/// Returns the table cells under [`left_out_heading`].
fn spread_cells(measure: Measure, spread: Option<Spread>) -> String {
    // Each cell has two spaces before it, and the second one is as wide as `largest`.
    let width = left_out_heading(measure).len() - "    largest".len();
    match spread {
        Some(Spread { rms, largest }) => format!("  {rms:>width$.2}  {largest:>7.2}"),
        None => format!("  {:>width$}  {:>7}", "-", "-"),
    }
}

/// The RMS and the largest value of some errors.
struct Spread {
    rms: f64,
    largest: f64,
}

impl Spread {
    /// Computes them; `None` if there are no errors.
    fn of(errors: impl Iterator<Item = f64>) -> Option<Self> {
        let errors: Vec<f64> = errors.collect();
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        (!errors.is_empty()).then(|| Self {
            rms: (squares / errors.len() as f64).sqrt(),
            largest: errors.iter().copied().fold(0.0, f64::max),
        })
    }
}

impl RepresentationSummary {
    /// Returns the representation at all its conditions.
    fn all(&self) -> &[AtSummary] {
        if self.at.is_empty() { std::slice::from_ref(&self.first) } else { &self.at }
    }

    /// Counts the conditions whose difference is below the difference threshold, and those whose
    /// difference is within the variation of their recording.
    pub(crate) fn count(&self, share: &mut FeltShare) {
        let felt = self.all().iter().filter_map(|at| at.felt.as_ref());
        felt.for_each(|felt| share.count(felt));
    }

    pub(crate) fn at(&self, condition: usize) -> Option<&AtSummary> {
        // `at` is empty if there is only one condition.
        let all = self.at.iter().chain([&self.first]);
        all.into_iter().find(|at| at.condition == condition)
    }
}

/// Lists the models embedded in an asset. The signatures of a valid asset are valid.
fn plugins(asset: &htex_format::Asset) -> Vec<PluginSummary> {
    let both = asset.manifest.plugins.iter().zip(&asset.plugins);
    both.map(|(plugin, module)| PluginSummary {
        model: plugin.model.clone(),
        version: plugin.version.clone(),
        bytes: module.len(),
        blake3: plugin.blake3.clone(),
        signed_by: plugin.signature.as_ref().map(|s| s.public_key.clone()),
    })
    .collect()
}

fn row(
    r: &RepresentationSummary,
    at: &AtSummary,
    quantity: Quantity,
    columns: &[Column],
) -> String {
    let parameters: Vec<String> =
        at.parameters.iter().map(|(k, v)| parameter_text(&plain(k), v)).collect();
    format!(
        "  {:8} {:>5}  {:>10}{}  {:>5}  {}\n",
        short_name(&r.model),
        at.condition,
        quantity.text(at.level_rms),
        cells(columns, |column| at.measured(column)),
        r.payload_bytes,
        parameters.join(" ")
    )
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

/// Describes a condition's speed, force and repeatability, as far as they are known.
fn condition_text(condition: &Condition) -> String {
    let mut text = motion_text(condition);
    match condition.segments {
        Some(0) => text += ", computed between recorded speeds",
        Some(segments) => {
            let _ = write!(text, ", {segments} segments");
        }
        None => {}
    }
    if let Some(db) = condition.repeatability_rms_db {
        let _ = write!(text, ", the recording itself repeats within {db:.2} dB");
    }
    text
}

/// Describes how an asset was made without a recording.
fn made_text(made: &Made) -> String {
    let part = |of: &Ingredient| format!("{} of {}", of.weight, plain(&of.name));
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

impl RepresentationSummary {
    /// Summarises a representation; `None` if it has no conditions, which is invalid.
    fn new(r: &Representation, sets: &[Vec<f64>], payload_bytes: usize) -> Option<Self> {
        let at: Vec<AtSummary> =
            r.at.iter().zip(sets).map(|(at, set)| AtSummary::new(at, &r.fields, set)).collect();
        Some(Self {
            model: r.model.clone(),
            model_version: r.model_version.clone(),
            payload_bytes,
            fit_ms: None,
            triangles: r.triangles.clone(),
            first: at.first()?.clone(),
            at: if at.len() > 1 { at } else { Vec::new() },
        })
    }
}

impl AtSummary {
    fn new(at: &AtCondition, fields: &[StoredField], flat: &[f64]) -> Self {
        Self {
            condition: at.condition,
            parameters: named_parameters(fields, flat),
            level_rms: at.level_rms,
            quality: at.quality.clone(),
            felt: None,
            left_out: at.left_out,
        }
    }
}

/// Groups a flat array of parameters by the names of its fields.
pub(crate) fn named_parameters(fields: &[StoredField], mut flat: &[f64]) -> Map<String, Value> {
    let mut named = Map::new();
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
        named.insert(field.name.clone(), value);
    }
    named
}

impl AtSummary {
    /// Returns the value for a column of a table.
    pub(crate) fn measured(&self, column: Column) -> Option<f64> {
        column.of(self.quality.as_ref(), self.felt.as_ref())
    }

    /// Returns the lines of a model that is a sum of sines, as pairs of hertz and newtons.
    pub(crate) fn lines(&self) -> Vec<(f64, f64)> {
        let list = |name: &str| {
            let values = self.parameters.get(name).and_then(Value::as_array);
            values.into_iter().flatten().filter_map(Value::as_f64)
        };
        list("frequency_hz").zip(list("amplitude").map(|a| a * self.level_rms)).collect()
    }
}
