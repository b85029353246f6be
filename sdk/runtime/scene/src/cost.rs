//! Run times of models and stages, measured on one machine and stored for later plans.

use std::collections::BTreeMap;
use std::path::Path;

use htex_dsp::resample::Work;
use serde::{Deserialize, Serialize};

/// Costs of models and stages on one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Costs {
    /// Name of the machine, and how the costs were measured.
    pub machine: String,
    /// Time to render one sample of a voice at the model's own rate, nanoseconds, for each model
    /// id.
    pub model_ns: BTreeMap<String, f64>,
    /// For each model id, the time in nanoseconds to interpolate between two parameter sets and to
    /// retune a voice to the result.
    pub retune_ns: BTreeMap<String, f64>,
    /// Time to process one sample at the stage's rate, nanoseconds, for each stage.
    pub stage_ns: BTreeMap<String, f64>,
    /// Time to process one sample, nanoseconds, for each stage that a scene has switched on
    /// although the stage changes no samples. Interpolation and crossfades are not listed and count
    /// as 0.
    pub neutral_ns: BTreeMap<String, f64>,
    /// Times that the renderer itself takes per sample, nanoseconds: first for a scene in which
    /// nothing changes, then for a scene whose motion is read before every block.
    pub renderer_ns: [f64; 2],
    /// Cost of the compensation filter, when a resampler requests short blocks from it.
    pub compensation: FilterCost,
    /// Cost of a conversion that raises the sample rate by an integer factor.
    pub whole: FilterCost,
    /// Cost of a conversion between other sample rates.
    pub rational: FilterCost,
}

/// The cost of a filter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilterCost {
    /// Time for each sample in addition to the multiplications, nanoseconds.
    pub sample_ns: f64,
    /// Time of one multiply-accumulate, nanoseconds.
    pub mac_ns: f64,
}

impl FilterCost {
    /// Returns the time in which filters produce `samples` samples with `macs`
    /// multiply-accumulates, nanoseconds.
    pub(crate) fn time_ns(self, samples: f64, macs: f64) -> f64 {
        samples * self.sample_ns + macs * self.mac_ns
    }
}

impl Costs {
    /// The costs embedded in this crate, measured on its authors' machine.
    pub fn embedded() -> Self {
        serde_json::from_str(include_str!("costs.json")).unwrap_or_else(|_| Self::nothing())
    }

    /// Reads stored costs. Returns `None` if the file cannot be read, or if its fields are not
    /// exactly the fields of this version.
    pub fn load(path: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(path).ok()?).ok()
    }

    /// Stores the costs for later plans.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    #[allow(clippy::disallowed_methods, reason = "the user's own folder of settings")]
    pub fn save(&self, path: &Path) -> std::io::Result<()> {
        let text = serde_json::to_string_pretty(self)?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        htex_format::write_file(path, text.as_bytes())
    }

    /// Returns the cost of a model. For a model that was not measured, returns the largest known
    /// cost.
    pub(crate) fn model(&self, id: &str) -> f64 {
        or_largest(&self.model_ns, id)
    }

    pub(crate) fn retune(&self, id: &str) -> f64 {
        or_largest(&self.retune_ns, id)
    }

    pub(crate) fn stage(&self, name: &str) -> f64 {
        self.stage_ns.get(name).copied().unwrap_or(0.0)
    }

    /// Returns the cost of a rate conversion, per sample of its output.
    pub(crate) fn resampling(&self, work: Work) -> f64 {
        let Work { whole, rational } = work;
        self.whole.time_ns(whole.samples, whole.macs)
            + self.rational.time_ns(rational.samples, rational.macs)
    }

    pub(crate) fn neutral(&self, name: &str) -> f64 {
        self.neutral_ns.get(name).copied().unwrap_or(0.0)
    }

    pub(crate) fn nothing() -> Self {
        Self {
            machine: "not measured".to_owned(),
            model_ns: BTreeMap::new(),
            retune_ns: BTreeMap::new(),
            stage_ns: BTreeMap::new(),
            neutral_ns: BTreeMap::new(),
            renderer_ns: [0.0; 2],
            compensation: FilterCost::default(),
            whole: FilterCost::default(),
            rational: FilterCost::default(),
        }
    }
}

fn or_largest(costs: &BTreeMap<String, f64>, id: &str) -> f64 {
    let largest = || costs.values().copied().fold(0.0, f64::max);
    costs.get(id).copied().unwrap_or_else(largest)
}
