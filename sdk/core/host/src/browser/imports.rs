//! The functions that JavaScript provides (`sdk/bindings/web/src/guests.js`) so that the host can
//! run the WASM modules of models, called *guests*.
#![allow(unsafe_code)]

mod raw {
    #[link(wasm_import_module = "htex")]
    unsafe extern "C" {
        /// Compiles a module. Returns the module's handle, or 0 if the compilation fails.
        pub(super) fn module_new(bytes: *const u8, len: usize) -> u32;
        pub(super) fn module_free(module: u32);
        /// Creates an instance and looks up its exports with these names, which are separated by
        /// commas. Returns the instance's handle, or 0 on failure.
        pub(super) fn instance_new(module: u32, names: *const u8, names_len: usize) -> u32;
        pub(super) fn instance_free(instance: u32);
        /// Returns the size of the instance's memory, bytes.
        pub(super) fn instance_memory(instance: u32) -> usize;
        /// Calls the export with this index. `typed` states the types of the `len` arguments and of
        /// the result. Returns 0 if the call returns without a trap.
        pub(super) fn instance_call(
            instance: u32,
            function: u32,
            types: *const u8,
            slots: *const u64,
            len: usize,
            returns: u32,
            result: *mut u64,
        ) -> u32;
        /// Copies bytes from the instance's memory. Returns 0 on success.
        pub(super) fn instance_read(instance: u32, at: u32, to: *mut u8, len: usize) -> u32;
        /// Copies bytes to the instance's memory. Returns 0 on success.
        pub(super) fn instance_write(instance: u32, at: u32, from: *const u8, len: usize) -> u32;
        /// Copies the text of the last failure; returns its length.
        pub(super) fn failure_text(to: *mut u8, capacity: usize) -> usize;
    }
}

/// Returns the text of the last failure.
fn failure() -> String {
    let mut text = vec![0; 1024];
    // SAFETY: a live buffer.
    let len = unsafe { raw::failure_text(text.as_mut_ptr(), text.len()) };
    text.truncate(len);
    String::from_utf8_lossy(&text).into_owned()
}

/// A compiled module, freed when it is dropped.
#[derive(Debug)]
pub(super) struct Guest(u32);

impl Guest {
    pub(super) fn new(bytes: &[u8]) -> Result<Self, String> {
        // SAFETY: a live slice.
        match unsafe { raw::module_new(bytes.as_ptr(), bytes.len()) } {
            0 => Err(failure()),
            module => Ok(Self(module)),
        }
    }

    /// Creates an instance with the functions called `names`, separated by commas.
    pub(super) fn instance(&self, names: &str) -> Result<GuestInstance, String> {
        // SAFETY: a live slice.
        match unsafe { raw::instance_new(self.0, names.as_ptr(), names.len()) } {
            0 => Err(failure()),
            instance => Ok(GuestInstance(instance)),
        }
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        // SAFETY: the handle is live.
        unsafe { raw::module_free(self.0) };
    }
}

/// An instance, freed when it is dropped.
#[derive(Debug)]
pub(super) struct GuestInstance(u32);

/// Error: an argument or result lies outside the instance's memory.
pub(super) struct Outside;

impl GuestInstance {
    pub(super) fn memory_bytes(&self) -> usize {
        // SAFETY: the handle is live.
        unsafe { raw::instance_memory(self.0) }
    }

    /// Calls a function by its index among the names. `typed` states the types of the arguments and
    /// of the result.
    pub(super) fn call(
        &self,
        function: u32,
        types: &[u8],
        slots: &[u64],
        returns: u8,
    ) -> Result<u64, String> {
        debug_assert_eq!(types.len(), slots.len());
        let (len, mut result) = (types.len().min(slots.len()), 0);
        // SAFETY: the slices are live and have this length, and there is a place for the result.
        let failed = unsafe {
            raw::instance_call(
                self.0,
                function,
                types.as_ptr(),
                slots.as_ptr(),
                len,
                returns.into(),
                &raw mut result,
            )
        };
        match failed {
            0 => Ok(result),
            _ => Err(failure()),
        }
    }

    /// Reads bytes or numbers at an address of the instance's memory.
    pub(super) fn read<T: Number>(&self, at: u32, out: &mut [T]) -> Result<(), Outside> {
        // SAFETY: a live slice of numbers; every bit pattern is a valid number.
        let failed =
            unsafe { raw::instance_read(self.0, at, out.as_mut_ptr().cast(), size_of_val(out)) };
        if failed == 0 { Ok(()) } else { Err(Outside) }
    }

    /// Writes bytes or numbers at an address of the instance's memory.
    pub(super) fn write<T: Number>(&self, at: u32, from: &[T]) -> Result<(), Outside> {
        // SAFETY: a live slice of numbers.
        let failed =
            unsafe { raw::instance_write(self.0, at, from.as_ptr().cast(), size_of_val(from)) };
        if failed == 0 { Ok(()) } else { Err(Outside) }
    }
}

impl Drop for GuestInstance {
    fn drop(&mut self) {
        // SAFETY: the handle is live.
        unsafe { raw::instance_free(self.0) };
    }
}

/// A number in a module's memory. Both sides use the same byte order, little-endian.
pub(super) trait Number: Copy {}
impl Number for u8 {}
impl Number for f32 {}
impl Number for f64 {}
