//! Native libraries, loaded once and called through a table of their functions.
//!
//! A native library runs with all the rights of this program, so the user decides which ones to
//! load. No library is ever unloaded, because open devices and sources point into it.

use std::path::Path;

use htex_base::native::Symbols;
use serde::de::DeserializeOwned;

use crate::abi::{
    AbiVersion, CloseFn, DescriptorJson, EndpointsJson, ExtensionFn, LastError, MAX_TEXT_BYTES,
};
use crate::{AbiFault, Descriptor, DescriptorError, DeviceError, Endpoint};

/// Size of the buffer in the first call for a text, bytes.
const USUAL_TEXT: usize = 16_384;
/// Maximum number of calls for a text whose length changes from call to call.
const TRIES: usize = 8;

/// The functions of an ABI, for devices or for sources. Only tables of this crate implement it.
pub trait Table: Copy + 'static {
    /// Negative results.
    type Code;
    /// The description of an adapter.
    type About: Clone + DeserializeOwned;
    /// `device` or `source`.
    const KIND: &'static str;
    /// The marker of this host's ABI version.
    const MARKER: u32;
    /// Name of the function that returns the marker.
    const ABI_VERSION: &'static str;

    /// Looks up the functions of a library whose marker has been checked.
    ///
    /// # Safety
    /// The library's functions have the types of the ABI.
    unsafe fn of_symbols(symbols: &Symbols<'_, DeviceError>) -> Result<Self, DeviceError>;

    /// Returns the functions that both ABIs have.
    fn common(&self) -> Common;

    /// Checks the description that a library gives of its adapter.
    fn check(about: &Self::About) -> Result<(), DescriptorError>;

    /// Returns the part of the description that device and source adapters have in common.
    fn descriptor_of(about: &Self::About) -> &Descriptor;

    /// Converts a number that crossed the ABI to its code.
    fn code(answer: i64) -> Self::Code;

    /// Converts a code and its text to an error.
    fn incoming(code: Self::Code, text: String, name: &str, library: &str) -> DeviceError;
}

/// The functions that both ABIs have.
#[derive(Clone, Copy)]
pub struct Common {
    pub(crate) abi_version: AbiVersion,
    pub(crate) descriptor: DescriptorJson,
    pub(crate) last_error: LastError,
    pub(crate) endpoints: EndpointsJson,
    pub(crate) close: CloseFn,
    pub(crate) extension: ExtensionFn,
}

/// A library's name and its functions.
#[derive(Clone)]
pub(crate) struct Library<T: 'static> {
    pub(crate) name: String,
    pub(crate) table: &'static T,
}

/// The failure of a call.
pub(crate) enum Trouble<Code> {
    /// The library returned an error code with this text.
    Told(Code, String),
    /// The library returned a result that the ABI does not allow.
    Broken(String),
}

impl<T: Table> Library<T> {
    /// Loads a library and fills the table from its symbols.
    pub(crate) fn load(path: &Path) -> Result<Self, DeviceError> {
        let name = path.display().to_string();
        let error = |fault: AbiFault| DeviceError::Abi { library: name.clone(), fault };
        // SAFETY: running a library's initialisers is what the user asked for by naming it.
        let library = unsafe { htex_base::native::Library::from_file(path) };
        let library = library.map_err(|e| error(AbiFault::NotLoaded(e.to_string())))?;
        let kind = T::KIND;
        let symbols =
            Symbols { library, missing: &|symbol| error(AbiFault::Symbol { symbol, kind }) };
        // SAFETY: the marker comes first, and says that the other symbols have the types of the
        // ABI.
        let abi_version: AbiVersion = unsafe { symbols.get(T::ABI_VERSION)? };
        check_marker::<T>(abi_version()).map_err(&error)?;
        // SAFETY: a library with this marker exports these names with these types.
        let table = unsafe { T::of_symbols(&symbols)? };
        // Leaked, because a library is never unloaded.
        let table: &'static T = Box::leak(Box::new(table));
        Ok(Self { name, table })
    }

    /// Uses a table that is linked into this program.
    pub(crate) fn of_table(name: &str, table: &'static T) -> Result<Self, DeviceError> {
        let library = Self { name: name.to_owned(), table };
        let marker = (table.common().abi_version)();
        check_marker::<T>(marker).map_err(|fault| library.error(fault))?;
        Ok(library)
    }

    /// Reads and checks the library's description of its adapter.
    pub(crate) fn about(&self) -> Result<T::About, DeviceError> {
        let wrong = |what: String| self.error(AbiFault::Descriptor(what));
        // SAFETY: the buffer is live and of this length, by `Self::text`.
        let json = self
            .text(|out, len| unsafe { (self.table.common().descriptor)(out, len) })
            .map_err(|trouble| match trouble {
                Trouble::Told(_, text) | Trouble::Broken(text) => wrong(text),
            })?;
        let about = serde_json::from_str(&json).map_err(|e| wrong(e.to_string()))?;
        T::check(&about).map_err(|error| wrong(error.to_string()))?;
        Ok(about)
    }

    /// Lists the connected devices or sources.
    pub(crate) fn endpoints(&self, adapter: &str) -> Result<Vec<Endpoint>, DeviceError> {
        // SAFETY: the buffer is live and of this length, by `Self::text`.
        self.json(adapter, "endpoints", |out, len| unsafe {
            (self.table.common().endpoints)(out, len)
        })
    }

    /// Whether the library has the extension `id`.
    pub(crate) fn has_extension(&self, id: &str) -> Result<bool, DeviceError> {
        // SAFETY: a live text.
        match unsafe { (self.table.common().extension)(id.as_ptr(), id.len()) } {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.broken(format!("extension `{id}`: it returns {other}"))),
        }
    }

    /// Parses the JSON that a call returns. `adapter` is the adapter's name, `name` the name of the
    /// call.
    pub(crate) fn json<V: DeserializeOwned>(
        &self,
        adapter: &str,
        name: &str,
        call: impl FnMut(*mut u8, usize) -> i64,
    ) -> Result<V, DeviceError> {
        let json = self.text(call).map_err(|trouble| self.trouble(adapter, name, trouble))?;
        serde_json::from_str(&json).map_err(|e| self.broken(format!("{name}: {e}")))
    }

    /// Checks a status, which must be 0.
    pub(crate) fn done(&self, adapter: &str, call: &str, answer: i64) -> Result<(), DeviceError> {
        match self.count(answer) {
            Ok(0) => Ok(()),
            Ok(other) => Err(self.broken(format!("{call}: it returned {other}"))),
            Err(trouble) => Err(self.trouble(adapter, call, trouble)),
        }
    }

    /// Reads a text of unknown length, which may change between two calls.
    pub(crate) fn text(
        &self,
        mut call: impl FnMut(*mut u8, usize) -> i64,
    ) -> Result<String, Trouble<T::Code>> {
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

    /// Interprets a result as a count. A negative one is a failure.
    pub(crate) fn count(&self, answer: i64) -> Result<usize, Trouble<T::Code>> {
        if answer < 0 {
            return Err(Trouble::Told(T::code(answer), self.last_error()));
        }
        usize::try_from(answer).map_err(|_| Trouble::Broken(format!("it returned {answer}")))
    }

    /// Reads the text of this thread's last error.
    pub(crate) fn last_error(&self) -> String {
        let mut bytes = vec![0; USUAL_TEXT];
        // SAFETY: a live buffer of this length.
        let len = unsafe { (self.table.common().last_error)(bytes.as_mut_ptr(), bytes.len()) };
        bytes.truncate(usize::try_from(len).unwrap_or(0));
        // A longer text was cut, perhaps inside a character.
        match String::from_utf8_lossy(&bytes) {
            text if text.is_empty() => "no reason given".to_owned(),
            text => text.into_owned(),
        }
    }

    /// Converts the failure of a call to an error. `adapter` is the adapter's name.
    pub(crate) fn trouble(
        &self,
        adapter: &str,
        call: &str,
        trouble: Trouble<T::Code>,
    ) -> DeviceError {
        match trouble {
            Trouble::Told(code, text) => T::incoming(code, text, adapter, &self.name),
            Trouble::Broken(what) => self.broken(format!("{call}: {what}")),
        }
    }

    /// Returns the error for a result that the ABI does not allow.
    pub(crate) fn broken(&self, what: impl Into<String>) -> DeviceError {
        self.error(AbiFault::Call(what.into()))
    }

    fn error(&self, fault: AbiFault) -> DeviceError {
        DeviceError::Abi { library: self.name.clone(), fault }
    }
}

fn check_marker<T: Table>(marker: u32) -> Result<(), AbiFault> {
    // The lowest byte is the minor version, which may differ.
    if marker >> 8 == T::MARKER >> 8 {
        Ok(())
    } else {
        Err(AbiFault::Marker { marker, kind: T::KIND, major: (T::MARKER >> 8) & 0xff })
    }
}
