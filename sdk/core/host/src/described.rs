//! Models for which the host has only the descriptor, and not the code.

use std::path::Path;
use std::sync::Arc;

use htex_base::native::description::read_descriptor as read_description;
use htex_model::abi::ABI_MARKER;
use htex_model::{Band, FitInput, Status};

use crate::descriptor::read_descriptor;
use crate::raw::{RawModel, RawVoice};
use crate::{HostError, LoadedModel, Origin};

/// Says why no call succeeds.
const WHY: &[u8] = b"only the model's descriptor was read";

/// Returns a model that has only the descriptor in a plugin file. Returns `None` if the file
/// contains no descriptor.
pub(crate) fn model(path: &Path) -> Result<Option<LoadedModel>, HostError> {
    let json = read_description(path).map_err(HostError::loading(path.display()))?;
    let Some(json) = json else { return Ok(None) };
    let descriptor = read_descriptor(&json).map_err(|error| HostError::Broken {
        model: path.display().to_string(),
        call: "descriptor",
        what: error.to_string(),
    })?;
    let is_module = path.extension().is_some_and(|extension| extension == "wasm");
    let origin = if is_module { Origin::Wasm } else { Origin::Native };
    Ok(Some(LoadedModel::of(origin(path.to_owned()), descriptor, Arc::new(Described))))
}

/// A model whose functions cannot be called.
struct Described;

fn refuse() -> i64 {
    Status::Failed as i64
}

impl RawModel for Described {
    fn abi_version(&self) -> u32 {
        ABI_MARKER
    }
    fn descriptor(&self, _: &mut [u8]) -> i64 {
        refuse()
    }
    fn last_error(&self, out: &mut [u8]) -> i64 {
        let len = WHY.len().min(out.len());
        out[..len].copy_from_slice(&WHY[..len]);
        WHY.len() as i64
    }
    fn fit(&self, _: &FitInput<'_>, _: &mut [f64], _: &mut f64) -> i64 {
        refuse()
    }
    fn magnitude(&self, _: &[f64], _: Band, _: &[f64], _: &mut [f64]) -> i64 {
        refuse()
    }
    fn interpolate(&self, _: &[f64], _: &[f64], _: &mut [f64]) -> i64 {
        refuse()
    }
    fn extension(&self, _: &[u8]) -> i64 {
        0
    }
    fn follows_motion(&self) -> bool {
        false
    }
    fn voice_rate(&self, _: &[f64], _: Band, _: f64) -> f64 {
        0.0
    }
    fn voice_new(&self, _: &[f64], _: Band, _: f64, _: u64) -> Result<Box<dyn RawVoice>, i64> {
        Err(refuse())
    }
}
