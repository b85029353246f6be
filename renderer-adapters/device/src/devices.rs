//! The devices that a program can find.

use std::sync::Arc;

use crate::abi::DeviceTable;
use crate::registry::{AdapterKind, Known, Registry};
use crate::{Adapter, Descriptor, DeviceError, Endpoint, NativeAdapter};

/// Device adapters, by id and by short name.
pub type Devices = Registry<dyn Adapter>;
/// A device adapter that was found.
pub type KnownDevice = Known<dyn Adapter>;

impl AdapterKind for dyn Adapter {
    type Table = DeviceTable;
    const WORD: &'static str = "device";
    const VARIABLE: &'static str = "HTEX_DEVICE_PATH";
    const FOLDER: &'static str = "htex/devices";

    fn about(&self) -> &Descriptor {
        self.descriptor()
    }

    fn connected(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.endpoints()
    }

    fn of_native(native: NativeAdapter) -> Arc<Self> {
        Arc::new(native)
    }

    fn unknown(wanted: String, known: String) -> DeviceError {
        DeviceError::Unknown { wanted, known }
    }
}
