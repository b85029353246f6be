//! Native libraries: loaded once, never unloaded, called through their table.
//!
//! A native library runs with all the rights of this program: which ones to load is the user's
//! decision. None is ever unloaded, since open devices point into them.

use std::path::Path;

use crate::abi::{
    ABI_MARKER, AbiVersion, CapabilitiesJson, CloseFn, Code, DescriptorJson, DeviceTable,
    EndpointsJson, ExtensionFn, FinishFn, LastError, MAX_TEXT_BYTES, OpenFn, StatusFn, WriteFn,
};
use crate::{AbiFault, DeviceError};

/// Size of the buffer for a text at the first call, bytes.
const USUAL_TEXT: usize = 16_384;
/// Most calls for a text whose length changes in between.
const TRIES: usize = 8;

/// A library's name and its functions.
#[derive(Clone)]
pub(crate) struct Library {
    pub(crate) name: String,
    pub(crate) table: &'static DeviceTable,
}

/// The failure of a call.
pub(crate) enum Trouble {
    /// A code and its text.
    Told(Code, String),
    /// A result that the ABI does not allow.
    Broken(String),
}

impl Library {
    /// Loads a library and fills a table from its symbols.
    pub(crate) fn load(path: &Path) -> Result<Self, DeviceError> {
        let name = path.display().to_string();
        let error = |fault: AbiFault| DeviceError::Abi {
            library: name.clone(),
            fault,
        };
        // SAFETY: running a library's initialisers is what the user asked for by naming it.
        let library = unsafe { htex_native::Library::from_file(path) };
        let library = library.map_err(|e| error(AbiFault::NotLoaded(e.to_string())))?;
        // SAFETY: the marker comes first, and says that the other symbols have these types.
        let abi_version: AbiVersion =
            unsafe { symbol(library, "htex_device_abi_version", &error)? };
        check_marker(abi_version()).map_err(&error)?;
        // SAFETY: a library with this marker exports these names with these types.
        let table = unsafe {
            DeviceTable {
                abi_version,
                descriptor: symbol::<DescriptorJson>(library, "htex_device_descriptor", &error)?,
                last_error: symbol::<LastError>(library, "htex_device_last_error", &error)?,
                endpoints: symbol::<EndpointsJson>(library, "htex_device_endpoints", &error)?,
                capabilities: symbol::<CapabilitiesJson>(
                    library,
                    "htex_device_capabilities",
                    &error,
                )?,
                open: symbol::<OpenFn>(library, "htex_device_open", &error)?,
                write: symbol::<WriteFn>(library, "htex_device_write", &error)?,
                status: symbol::<StatusFn>(library, "htex_device_status", &error)?,
                finish: symbol::<FinishFn>(library, "htex_device_finish", &error)?,
                close: symbol::<CloseFn>(library, "htex_device_close", &error)?,
                extension: symbol::<ExtensionFn>(library, "htex_device_extension", &error)?,
            }
        };
        let table: &'static DeviceTable = Box::leak(Box::new(table));
        Ok(Self { name, table })
    }

    /// Uses a table of this program.
    pub(crate) fn of_table(name: &str, table: &'static DeviceTable) -> Result<Self, DeviceError> {
        let library = Self {
            name: name.to_owned(),
            table,
        };
        check_marker((table.abi_version)()).map_err(|fault| library.error(fault))?;
        Ok(library)
    }

    /// Reads a text of unknown length, which may change between two calls.
    pub(crate) fn text(
        &self,
        mut call: impl FnMut(*mut u8, usize) -> i64,
    ) -> Result<String, Trouble> {
        let mut bytes = vec![0; USUAL_TEXT];
        for _ in 0..TRIES {
            let len = self.count(call(bytes.as_mut_ptr(), bytes.len()))?;
            if len > MAX_TEXT_BYTES {
                let what = format!("a text of {len} bytes; {MAX_TEXT_BYTES} are allowed");
                return Err(Trouble::Broken(what));
            }
            if len <= bytes.len() {
                bytes.truncate(len);
                return String::from_utf8(bytes).map_err(|e| Trouble::Broken(e.to_string()));
            }
            bytes.resize(len, 0);
        }
        Err(Trouble::Broken("a text that grows at each call".to_owned()))
    }

    /// A count, or the failure of a negative result.
    pub(crate) fn count(&self, answer: i64) -> Result<usize, Trouble> {
        if answer < 0 {
            return Err(Trouble::Told(Code::from_answer(answer), self.last_error()));
        }
        usize::try_from(answer).map_err(|_| Trouble::Broken(format!("it returned {answer}")))
    }

    /// The text of this thread's last error.
    fn last_error(&self) -> String {
        let mut bytes = vec![0; USUAL_TEXT];
        // SAFETY: a live buffer of this length.
        let len = unsafe { (self.table.last_error)(bytes.as_mut_ptr(), bytes.len()) };
        bytes.truncate(usize::try_from(len).unwrap_or(0));
        match String::from_utf8_lossy(&bytes) {
            text if text.is_empty() => "no reason given".to_owned(),
            text => text.into_owned(),
        }
    }

    /// The error of a result that the ABI does not allow.
    pub(crate) fn broken(&self, what: impl Into<String>) -> DeviceError {
        self.error(AbiFault::Call(what.into()))
    }

    /// The error of a fault of this library.
    pub(crate) fn error(&self, fault: AbiFault) -> DeviceError {
        DeviceError::Abi {
            library: self.name.clone(),
            fault,
        }
    }
}

fn check_marker(marker: u32) -> Result<(), AbiFault> {
    match marker >> 8 == ABI_MARKER >> 8 {
        true => Ok(()),
        false => Err(AbiFault::Marker(marker)),
    }
}

/// The address of a symbol.
///
/// # Safety
/// The symbol has the type `T`.
unsafe fn symbol<T: Copy>(
    library: htex_native::Library,
    name: &'static str,
    error: &impl Fn(AbiFault) -> DeviceError,
) -> Result<T, DeviceError> {
    // SAFETY: the caller's promise.
    let found = unsafe { library.symbol(name) };
    found.ok_or_else(|| error(AbiFault::Symbol(name)))
}
