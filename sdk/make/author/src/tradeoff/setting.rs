//! Settings. A setting has a value for each knob (varied option) of a sweep.

use crate::AuthorError;
use std::collections::BTreeMap;

use htex_host::{Descriptor, Synthesis};
use serde_json::Value;

/// How parameters are stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Keep {
    /// In the precision that the model's descriptor states.
    Model,
    /// In single precision.
    F32,
    /// In double precision.
    F64,
}

/// The values of all knobs for one measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The fit options whose values differ from their defaults, as names and values.
    pub options: Vec<(String, String)>,
    pub synthesis: Synthesis,
    /// How parameters are stored.
    pub store: Keep,
    /// Number of samples that each call of the model renders.
    pub block_samples: usize,
    /// Output sample rate, hertz.
    pub output_rate_hz: f64,
    /// How the model is loaded (`native`, `wasm`); an empty text selects the model's first loader.
    pub loader: String,
}

impl Default for Setting {
    /// Returns the defaults: the model's default fit and voice, in blocks of 256 samples at 20 kHz.
    fn default() -> Self {
        Self {
            options: Vec::new(),
            synthesis: Synthesis::Streamed,
            store: Keep::Model,
            block_samples: 256,
            output_rate_hz: 20_000.0,
            loader: String::new(),
        }
    }
}

impl Setting {
    /// Whether the setting plays like [`Self::default`]. Fit and storage may differ.
    pub(crate) fn plays_as_default(&self) -> bool {
        let other = Self { options: self.options.clone(), store: self.store, ..Self::default() };
        *self == other
    }

    /// Whether the times can be compared with the times of the default setting. The times can be
    /// compared if block size and output rate are the same.
    pub(crate) fn times_compare(&self) -> bool {
        let default = Self::default();
        self.block_samples == default.block_samples && self.output_rate_hz == default.output_rate_hz
    }

    /// Returns the setting with one of [`PLAYING`](crate::tradeoff::knobs::PLAYING) changed.
    pub(crate) fn playing(mut self, name: &str, value: &str) -> Result<Self, AuthorError> {
        let wrong = || AuthorError::Knob { name: name.to_owned(), value: value.to_owned() };
        match (name, value) {
            ("synthesis", _) => self.synthesis = value.parse()?,
            ("store", "f32") => self.store = Keep::F32,
            ("store", "f64") => self.store = Keep::F64,
            ("block_samples", _) => self.block_samples = value.parse().map_err(|_| wrong())?,
            ("output_rate_hz", _) => self.output_rate_hz = value.parse().map_err(|_| wrong())?,
            _ => return Err(wrong()),
        }
        Ok(self)
    }

    /// Returns, as text, the values that differ from their defaults; `default` if there are none.
    pub fn words(&self) -> String {
        let default = Self::default();
        let mut words: Vec<String> = self.options.iter().map(|(n, v)| format!("{n}={v}")).collect();
        let mut say = |is: bool, text: String| is.then(|| words.push(text));
        say(self.synthesis != default.synthesis, self.synthesis.to_string());
        say(self.store != default.store, format!("store={}", self.store_name()));
        let block = self.block_samples;
        say(block != default.block_samples, format!("block_samples={block}"));
        let rate = self.output_rate_hz;
        say(rate != default.output_rate_hz, format!("output_rate_hz={rate}"));
        say(!self.loader.is_empty(), self.loader.clone());
        if words.is_empty() {
            words.push("default".to_owned());
        }
        words.join(" ")
    }

    fn store_name(&self) -> &'static str {
        match self.store {
            Keep::Model => "model",
            Keep::F32 => "f32",
            Keep::F64 => "f64",
        }
    }

    /// Returns the values of all knobs, including those at their defaults.
    pub(crate) fn knobs(&self, descriptor: Option<&Descriptor>) -> BTreeMap<String, Value> {
        let mut knobs = BTreeMap::new();
        for option in descriptor.iter().flat_map(|d| &d.options) {
            let choice = option.choices.get(option.default as usize).cloned();
            let default = choice.map_or(Value::from(option.default), Value::from);
            knobs.insert(option.name.clone(), default);
        }
        for (name, value) in &self.options {
            let number = value.parse::<f64>().map(Value::from);
            knobs.insert(name.clone(), number.unwrap_or_else(|_| Value::from(value.clone())));
        }
        let loader = if self.loader.is_empty() { "first" } else { &self.loader };
        let playing = [
            ("synthesis", Value::from(self.synthesis.to_string())),
            ("store", Value::from(self.store_name())),
            ("block_samples", Value::from(self.block_samples)),
            ("output_rate_hz", Value::from(self.output_rate_hz)),
            ("loader", Value::from(loader)),
        ];
        knobs.extend(playing.map(|(name, value)| (name.to_owned(), value)));
        knobs
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;

    #[test]
    fn words_say_what_is_turned() {
        let setting = Setting::default().playing("synthesis", "loop:2").unwrap();
        assert_eq!(setting.words(), "loop:2");
        assert!(!setting.plays_as_default() && setting.times_compare());
        let stored = Setting::default().playing("store", "f32").unwrap();
        assert!(stored.plays_as_default());
        assert!(Setting::default().playing("block_samples", "many").is_err());
    }
}
