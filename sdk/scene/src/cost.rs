//! Run times of models and stages: measured on one machine and stored for later plans.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

/// Costs of models and stages on one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Costs {
    /// Name of the machine, and how the costs were measured.
    pub machine: String,
    /// Model id to the time of one sample of a voice at the model's own rate, nanoseconds.
    pub model_ns: BTreeMap<String, f64>,
    /// Model id to the time of interpolating two parameter sets and retuning a voice, nanoseconds.
    pub retune_ns: BTreeMap<String, f64>,
    /// Stage to the time of one sample at the stage's rate, nanoseconds; for filtering stages without their
    /// multiplications.
    pub stage_ns: BTreeMap<String, f64>,
    /// Time of one multiply-accumulate of a filter, nanoseconds.
    pub mac_ns: f64,
}

impl Costs {
    /// The costs embedded in this crate, measured on its authors' machine.
    pub fn embedded() -> Self {
        serde_json::from_str(include_str!("costs.json")).unwrap_or_else(|_| Self::nothing())
    }

    /// Reads stored costs; `None` if the file is missing or of another version.
    pub fn load(path: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(path).ok()?).ok()
    }

    /// Stores the costs for later plans.
    ///
    /// # Errors
    /// If the file cannot be written.
    #[allow(
        clippy::disallowed_methods,
        reason = "the user's own folder of settings"
    )]
    pub fn save(&self, path: &Path) -> std::io::Result<()> {
        let text = serde_json::to_string_pretty(self)?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        htex_format::write_file(path, text.as_bytes())
    }

    /// Cost of a model; of one that was not measured, the largest known cost.
    pub(crate) fn model(&self, id: &str) -> f64 {
        or_largest(&self.model_ns, id)
    }

    pub(crate) fn retune(&self, id: &str) -> f64 {
        or_largest(&self.retune_ns, id)
    }

    pub(crate) fn stage(&self, name: &str) -> f64 {
        self.stage_ns.get(name).copied().unwrap_or(0.0)
    }

    pub(crate) fn nothing() -> Self {
        Self {
            machine: "not measured".to_owned(),
            model_ns: BTreeMap::new(),
            retune_ns: BTreeMap::new(),
            stage_ns: BTreeMap::new(),
            mac_ns: 0.0,
        }
    }
}

fn or_largest(costs: &BTreeMap<String, f64>, id: &str) -> f64 {
    let largest = || costs.values().copied().fold(0.0, f64::max);
    costs.get(id).copied().unwrap_or_else(largest)
}
