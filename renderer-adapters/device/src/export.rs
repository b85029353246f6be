//! The macros that generate the C functions of devices and sources.

/// Generates the C functions of an [`Adapter`](crate::Adapter) that implements `Default`, as the
/// table `pub static TABLE`.
///
/// With `symbols: "FEATURE"`, the functions are also exported under their C names (`htex_device_…`)
/// when the crate is built with that Cargo feature. Use this for a native library, where one binary
/// holds one adapter. A panic becomes a status code.
///
/// ```
/// # #![allow(clippy::needless_doctest_main)]
/// # use htex_device::*;
/// # use std::sync::LazyLock;
/// #[derive(Default)]
/// pub struct Nowhere;
/// # static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
/// #     id: "org.example.nowhere".to_owned(), name: "Nowhere".to_owned(),
/// #     version: "1.0.0".to_owned(), summary: "Takes nothing.".to_owned(),
/// #     settings: vec![], profiles: vec![], mapping: None,
/// # });
/// # impl Adapter for Nowhere {
/// #     fn descriptor(&self) -> &Descriptor { &DESCRIPTOR }
/// #     fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> { Ok(vec![]) }
/// #     fn capabilities(&self, _: &Settings) -> Result<Capabilities, DeviceError> {
/// #         Err(DeviceError::Missing("there is none".to_owned()))
/// #     }
/// #     fn open(&self, s: &Settings, _: &StreamFormat) -> Result<Box<dyn Device>, DeviceError> {
/// #         self.capabilities(s).map(|_| unreachable!())
/// #     }
/// # }
/// htex_device::export_device!(Nowhere, symbols: "plugin");
/// fn main() -> Result<(), DeviceError> {
///     let adapter = NativeAdapter::from_table("nowhere", &TABLE)?;
///     assert_eq!(adapter.descriptor().short_name(), "nowhere");
///     Ok(())
/// }
/// ```
#[macro_export]
macro_rules! export_device {
    ($adapter:ty, symbols: $feature:literal) => {
        static HTEX_DEVICE_STATE: $crate::shim::State<$adapter> = $crate::shim::State::new();

        /// The device's C functions.
        pub static TABLE: $crate::abi::DeviceTable = $crate::abi::DeviceTable {
            abi_version: htex_device_exports::htex_device_abi_version,
            descriptor: htex_device_exports::htex_device_descriptor,
            last_error: htex_device_exports::htex_device_last_error,
            endpoints: htex_device_exports::htex_device_endpoints,
            capabilities: htex_device_exports::htex_device_capabilities,
            open: htex_device_exports::htex_device_open,
            write: htex_device_exports::htex_device_write,
            status: htex_device_exports::htex_device_status,
            finish: htex_device_exports::htex_device_finish,
            close: htex_device_exports::htex_device_close,
            extension: htex_device_exports::htex_device_extension,
        };

        /// The C functions under their ABI names. `htex_device::abi` documents each one.
        #[allow(missing_docs, clippy::missing_safety_doc)]
        mod htex_device_exports {
            use super::HTEX_DEVICE_STATE as STATE;
            use $crate::shim::{Input, Output};

            $crate::__common_exports! {
                $feature, STATE, $crate::abi::ABI_MARKER, htex_device_abi_version,
                htex_device_descriptor, htex_device_last_error, htex_device_endpoints,
                htex_device_extension
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_device_capabilities(
                settings: *const u8,
                settings_len: usize,
                out: *mut u8,
                capacity: usize,
            ) -> i64 {
                // SAFETY: the caller's text and buffer, by the ABI.
                unsafe {
                    STATE.capabilities(
                        Input::new(settings, settings_len),
                        Output::new(out, capacity),
                    )
                }
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_device_open(
                settings: *const u8,
                settings_len: usize,
                rate_hz: f64,
                block_frames: u32,
            ) -> i64 {
                // SAFETY: the caller's text, by the ABI.
                let settings = unsafe { Input::new(settings, settings_len) };
                STATE.open(settings, rate_hz, block_frames)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_device_write(
                device: i64,
                samples: *const f32,
                frames: usize,
                timeout_ms: u32,
            ) -> i64 {
                // SAFETY: the caller's array, by the ABI.
                STATE.write(device, unsafe { Input::new(samples, frames) }, timeout_ms)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_device_status(
                device: i64,
                out: *mut f64,
                capacity: usize,
            ) -> i64 {
                // SAFETY: the caller's buffer, by the ABI.
                STATE.status(device, unsafe { Output::new(out, capacity) })
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_device_finish(device: i64) -> i64 {
                STATE.finish(device)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_device_close(device: i64) -> i64 {
                STATE.close(device)
            }
        }
    };
}

/// The C functions that devices and sources have in common.
#[doc(hidden)]
#[macro_export]
macro_rules! __common_exports {
    (
        $feature:literal, $state:ident, $marker:expr, $abi_version:ident, $descriptor:ident,
        $last_error:ident, $endpoints:ident, $extension:ident
    ) => {
        #[cfg_attr(feature = $feature, unsafe(no_mangle))]
        pub(super) extern "C" fn $abi_version() -> u32 {
            $marker
        }

        #[cfg_attr(feature = $feature, unsafe(no_mangle))]
        pub(super) unsafe extern "C" fn $descriptor(out: *mut u8, capacity: usize) -> i64 {
            // SAFETY: the caller's buffer, by the ABI.
            $state.descriptor(unsafe { $crate::shim::Output::new(out, capacity) })
        }

        #[cfg_attr(feature = $feature, unsafe(no_mangle))]
        pub(super) unsafe extern "C" fn $last_error(out: *mut u8, capacity: usize) -> i64 {
            // SAFETY: the caller's buffer, by the ABI.
            $crate::shim::last_error(unsafe { $crate::shim::Output::new(out, capacity) })
        }

        #[cfg_attr(feature = $feature, unsafe(no_mangle))]
        pub(super) unsafe extern "C" fn $endpoints(out: *mut u8, capacity: usize) -> i64 {
            // SAFETY: the caller's buffer, by the ABI.
            $state.endpoints(unsafe { $crate::shim::Output::new(out, capacity) })
        }

        #[cfg_attr(feature = $feature, unsafe(no_mangle))]
        pub(super) unsafe extern "C" fn $extension(id: *const u8, id_len: usize) -> i64 {
            // SAFETY: the caller's text, by the ABI.
            $crate::shim::extension(unsafe { $crate::shim::Input::new(id, id_len) })
        }
    };
}
