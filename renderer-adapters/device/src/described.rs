//! Devices of which the program has only the descriptor, not the code.

use std::path::Path;
use std::sync::Arc;

use htex_base::native::description::read_descriptor;

use crate::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Input, LibraryFault, Output,
    Settings, StreamFormat,
};

/// Returns the adapter of a library by the descriptor beside it; `None` if there is none.
pub(crate) fn adapter(library: &Path) -> Result<Option<Arc<dyn Adapter>>, DeviceError> {
    let name = library.display().to_string();
    let failed = |what: String| DeviceError::File { path: name.clone(), what };
    let json = read_descriptor(library).map_err(|error| failed(error.to_string()))?;
    let Some(json) = json else { return Ok(None) };
    let descriptor: Descriptor =
        serde_json::from_str(&json).map_err(|error| failed(error.to_string()))?;
    descriptor.check()?;
    Ok(Some(Arc::new(Described { descriptor, library: name })))
}

/// An adapter that cannot be opened.
struct Described {
    descriptor: Descriptor,
    library: String,
}

impl Described {
    fn refuse(&self) -> DeviceError {
        let what = "only its descriptor was read".to_owned();
        DeviceError::Library { library: self.library.clone(), fault: LibraryFault::Load, what }
    }
}

impl Adapter for Described {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(Vec::new())
    }

    fn capabilities(&self, _: &Settings) -> Result<Capabilities, DeviceError> {
        Err(self.refuse())
    }

    fn open_output(&self, _: &Settings, _: &StreamFormat) -> Result<Box<dyn Output>, DeviceError> {
        Err(self.refuse())
    }

    fn open_input(&self, _: &Settings) -> Result<Box<dyn Input>, DeviceError> {
        Err(self.refuse())
    }
}
