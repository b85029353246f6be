//! Settings of reading recordings.

use std::collections::BTreeMap;
use std::path::PathBuf;

use htex_format::Quantity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::SettingsError;
use crate::{Averaging, SegmentChoice, SpectrumOptions};
use htex_recording::read_response;
use htex_recording::{ColumnMap, ReadOptions, Tracker};

/// Settings of reading recordings; an absent one has its default.
///
/// ```
/// use htex_author::settings::ReadingSettings;
/// let settings = ReadingSettings { rate_hz: Some(20_000.0), ..Default::default() };
/// assert_eq!(settings.read_options(1)?[0].rate_hz, Some(20_000.0));
/// assert_eq!(settings.recorded()["rate"], "20000");
/// # Ok::<(), htex_author::settings::SettingsError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ReadingSettings {
    /// Sampling rate, hertz, where the file does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Names and scales of columns: [`ColumnMap`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// Files of trackers with the finger's motion, one for each recording, or one for all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub trackers: Vec<PathBuf>,
    /// Names and scales of the trackers' columns: [`ColumnMap`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracker_map: Option<String>,
    /// Quantity of the texture's signal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quantity: Option<Quantity>,
    /// Value of a full-scale sample, in the quantity's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// File of the setup's response, which spectra are divided by.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<PathBuf>,
    /// Start of the part to read, seconds of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_s: Option<f64>,
    /// End of the part to read, seconds of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
    /// Limit on the numbers kept in memory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most_values: Option<usize>,
    /// Method of choosing segments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segments: Option<SegmentChoice>,
    /// Method of averaging segments.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub averaging: Option<Averaging>,
}

impl ReadingSettings {
    /// Returns these settings, and where they are absent those of `under`.
    #[must_use]
    pub fn over(self, under: Self) -> Self {
        Self {
            rate_hz: self.rate_hz.or(under.rate_hz),
            map: self.map.or(under.map),
            trackers: match self.trackers.is_empty() {
                true => under.trackers,
                false => self.trackers,
            },
            tracker_map: self.tracker_map.or(under.tracker_map),
            quantity: self.quantity.or(under.quantity),
            scale: self.scale.or(under.scale),
            response: self.response.or(under.response),
            from_s: self.from_s.or(under.from_s),
            to_s: self.to_s.or(under.to_s),
            most_values: self.most_values.or(under.most_values),
            segments: self.segments.or(under.segments),
            averaging: self.averaging.or(under.averaging),
        }
    }

    /// Returns the options of reading each of `count` recordings.
    ///
    /// # Errors
    /// When a map of columns cannot be read, or there are neither one nor `count` trackers.
    pub fn read_options(&self, count: usize) -> Result<Vec<ReadOptions>, SettingsError> {
        let options = ReadOptions::default()
            .with_rate_hz(self.rate_hz)
            .with_map(parsed("map", self.map.as_deref())?)
            .with_quantity(self.quantity.unwrap_or_default())
            .with_scale(self.scale)
            .with_from_s(self.from_s)
            .with_to_s(self.to_s)
            .with_most_values(self.most_values);
        let map = parsed("tracker_map", self.tracker_map.as_deref())?;
        let tracked = |file: &PathBuf| {
            let tracker = Tracker::new(file).with_map(map.clone());
            options.clone().with_tracker(tracker)
        };
        match &self.trackers[..] {
            [] => Ok(vec![options; count]),
            [one] => Ok(vec![tracked(one); count]),
            all if all.len() == count => Ok(all.iter().map(tracked).collect()),
            all => Err(SettingsError::Trackers {
                trackers: all.len(),
                recordings: count,
            }),
        }
    }

    /// Returns the options of computing spectra; reads the response.
    ///
    /// # Errors
    /// When the response cannot be read.
    pub fn spectrum_options(&self) -> Result<SpectrumOptions, SettingsError> {
        let response = self.response.as_deref().map(read_response);
        Ok(SpectrumOptions::default()
            .with_segments(self.segments.unwrap_or_default())
            .with_averaging(self.averaging.unwrap_or_default())
            .with_response(
                response
                    .transpose()
                    .map_err(|error| SettingsError::Response(Box::new(error)))?,
            ))
    }

    /// Returns the settings that differ from their defaults, for an asset's provenance, under the names of the command's
    /// flags.
    pub fn recorded(&self) -> BTreeMap<String, String> {
        let number = |value: Option<f64>| value.map(|x| x.to_string());
        let name = |file: &PathBuf| {
            let name = file.file_name();
            name.map(|name| name.to_string_lossy().into_owned())
        };
        let trackers: Vec<String> = self.trackers.iter().filter_map(name).collect();
        let entries = [
            ("rate", number(self.rate_hz)),
            ("map", self.map.clone()),
            (
                "tracker",
                (!trackers.is_empty()).then(|| trackers.join(", ")),
            ),
            ("tracker-map", self.tracker_map.clone()),
            (
                "quantity",
                unless_default(self.quantity, |q| q.name().replace('_', "-")),
            ),
            ("scale", number(self.scale)),
            ("from", number(self.from_s)),
            ("to", number(self.to_s)),
            ("frf", self.response.as_ref().and_then(name)),
            (
                "segments",
                unless_default(self.segments, |s| s.name().to_owned()),
            ),
            (
                "averaging",
                unless_default(self.averaging, |a| a.name().to_owned()),
            ),
        ];
        let said = entries.into_iter();
        said.filter_map(|(key, value)| Some((key.to_owned(), value?)))
            .collect()
    }
}

/// Reads a map of columns.
fn parsed(keyword: &'static str, text: Option<&str>) -> Result<Option<ColumnMap>, SettingsError> {
    let map = text.map(|text| {
        let map = text.parse::<ColumnMap>();
        map.map_err(|error| SettingsError::Map {
            keyword,
            text: text.to_owned(),
            error: Box::new(error),
        })
    });
    map.transpose()
}

/// Returns the name of a choice if it is not the default.
fn unless_default<T: Default + PartialEq>(
    value: Option<T>,
    name: impl Fn(&T) -> String,
) -> Option<String> {
    value
        .filter(|value| *value != T::default())
        .as_ref()
        .map(name)
}
