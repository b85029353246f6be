//! Adapters of native libraries and their open handles: the part that devices and sources share.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use crate::abi::CloseFn;
use crate::library::{Library, Table, Trouble};
use crate::{Descriptor, DeviceError, Settings};

/// The adapter of a native library: [`NativeAdapter`](crate::NativeAdapter) or
/// [`NativeSourceAdapter`](crate::NativeSourceAdapter). Cheap to clone.
#[derive(Clone)]
pub struct Native<T: Table> {
    pub(crate) about: Arc<T::About>,
    pub(crate) library: Library<T>,
}

impl<T: Table> fmt::Debug for Native<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (id, library) = (&self.described().id, &self.library.name);
        f.debug_tuple("Native").field(id).field(library).finish()
    }
}

impl<T: Table> Native<T> {
    /// Loads a native library, which runs with all the rights of this program.
    ///
    /// # Errors
    /// When the file is not a library for this machine, does not follow this ABI, or has an invalid
    /// descriptor.
    pub fn load(path: &Path) -> Result<Self, DeviceError> {
        Self::new(Library::load(path)?)
    }

    /// Creates an adapter from a table that is linked into this program. `name` identifies it in
    /// messages.
    ///
    /// # Errors
    /// The errors of [`Self::load`].
    pub fn from_table(name: &str, table: &'static T) -> Result<Self, DeviceError> {
        Self::new(Library::of_table(name, table)?)
    }

    fn new(library: Library<T>) -> Result<Self, DeviceError> {
        let about = Arc::new(library.about()?);
        Ok(Self { about, library })
    }

    /// Whether the library has the extension `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`).
    ///
    /// # Errors
    /// When the result is neither 0 nor 1.
    pub fn has_extension(&self, id: &str) -> Result<bool, DeviceError> {
        self.library.has_extension(id)
    }

    pub(crate) fn described(&self) -> &Descriptor {
        T::descriptor_of(&self.about)
    }

    pub(crate) fn name(&self) -> &str {
        &self.described().name
    }

    /// Writes the settings in the form in which they cross the ABI.
    pub(crate) fn lines(&self, settings: &Settings) -> String {
        settings.to_lines(self.described())
    }

    pub(crate) fn error(&self, call: &str, trouble: Trouble<T::Code>) -> DeviceError {
        self.library.trouble(self.name(), call, trouble)
    }

    /// Interprets the result of an opening call.
    pub(crate) fn opened(&self, answer: i64) -> Result<Opened<T>, Trouble<T::Code>> {
        match self.library.count(answer)? {
            0 => Err(Trouble::Broken("the handle is 0".to_owned())),
            _ => Ok(Opened { adapter: self.clone(), handle: answer, closed: false }),
        }
    }
}

/// An open device or source. Dropping it closes it.
pub(crate) struct Opened<T: Table> {
    pub(crate) adapter: Native<T>,
    pub(crate) handle: i64,
    closed: bool,
}

impl<T: Table> fmt::Debug for Opened<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut tuple = f.debug_tuple("Opened");
        tuple.field(&self.adapter).field(&self.handle).finish()
    }
}

impl<T: Table> Opened<T> {
    pub(crate) fn table(&self) -> &'static T {
        self.adapter.library.table
    }

    /// Calls a function that takes the handle and must return 0.
    pub(crate) fn done(&self, call: &str, function: CloseFn) -> Result<(), DeviceError> {
        let answer = function(self.handle);
        self.adapter.library.done(self.adapter.name(), call, answer)
    }

    /// Closes the device or source but keeps its handle, for checkers.
    pub(crate) fn close(&mut self) -> Result<(), DeviceError> {
        self.closed = true;
        self.done("close", self.table().common().close)
    }
}

impl<T: Table> Drop for Opened<T> {
    fn drop(&mut self) {
        if !self.closed {
            // A drop cannot return the error of closing.
            (self.table().common().close)(self.handle);
        }
    }
}
