//! The sources that are linked into this program.

use std::collections::BTreeMap;
use std::sync::Arc;

use htex_device::{DeviceError, Source, Sources};
use htex_lab::record::Replay;

/// Source adapters, in the order in which they are listed.
fn sources() -> Sources {
    Sources::new(vec![
        Arc::new(Replay),
        Arc::new(htex_device_daq::DaqInput::new()),
    ])
}

/// Opens the source that `NAME:TARGET` names.
pub(crate) fn open(
    text: &str,
    given: &BTreeMap<String, String>,
) -> Result<Box<dyn Source>, DeviceError> {
    sources().open(text, given)
}
