//! The macro that generates a source's C functions.

/// Generates the C functions of a [`SourceAdapter`](crate::SourceAdapter) that implements
/// `Default`, as the table `pub static SOURCE_TABLE`.
///
/// With `symbols: "FEATURE"`, the functions are also exported under their C names (`htex_source_…`)
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
/// #     version: "1.0.0".to_owned(), summary: "Delivers nothing.".to_owned(),
/// #     settings: vec![Setting {
/// #         name: "port".to_owned(), kind: SettingKind::Text, default: Some(String::new()),
/// #         live_default: None, from_scene: FromScene::Never, description: "The port.".to_owned(),
/// #     }],
/// #     profiles: vec![], mapping: None,
/// # });
/// # impl SourceAdapter for Nowhere {
/// #     fn descriptor(&self) -> &Descriptor { &DESCRIPTOR }
/// #     fn target(&self) -> &str { "port" }
/// #     fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> { Ok(vec![]) }
/// #     fn open(&self, _: &Settings) -> Result<Box<dyn Source>, DeviceError> {
/// #         Err(DeviceError::Missing("there is none".to_owned()))
/// #     }
/// # }
/// htex_device::export_source!(Nowhere, symbols: "plugin");
/// fn main() -> Result<(), DeviceError> {
///     let adapter = NativeSourceAdapter::from_table("nowhere", &SOURCE_TABLE)?;
///     assert_eq!(adapter.target(), "port");
///     Ok(())
/// }
/// ```
#[macro_export]
macro_rules! export_source {
    ($adapter:ty, symbols: $feature:literal) => {
        static HTEX_SOURCE_STATE: $crate::source::shim::State<$adapter> =
            $crate::source::shim::State::new();

        /// The source's C functions.
        pub static SOURCE_TABLE: $crate::source::abi::SourceTable =
            $crate::source::abi::SourceTable {
                abi_version: htex_source_exports::htex_source_abi_version,
                descriptor: htex_source_exports::htex_source_descriptor,
                last_error: htex_source_exports::htex_source_last_error,
                endpoints: htex_source_exports::htex_source_endpoints,
                open: htex_source_exports::htex_source_open,
                stream: htex_source_exports::htex_source_stream,
                start: htex_source_exports::htex_source_start,
                read: htex_source_exports::htex_source_read,
                stop: htex_source_exports::htex_source_stop,
                close: htex_source_exports::htex_source_close,
                extension: htex_source_exports::htex_source_extension,
            };

        /// The C functions under their ABI names. `htex_device::source::abi` documents each one.
        #[allow(missing_docs, clippy::missing_safety_doc)]
        mod htex_source_exports {
            use super::HTEX_SOURCE_STATE as STATE;
            use $crate::source::shim::{Input, Output};

            $crate::__common_exports! {
                $feature, STATE, $crate::source::abi::ABI_MARKER, htex_source_abi_version,
                htex_source_descriptor, htex_source_last_error, htex_source_endpoints,
                htex_source_extension
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_source_open(
                settings: *const u8,
                settings_len: usize,
            ) -> i64 {
                // SAFETY: the caller's text, by the ABI.
                STATE.open(unsafe { Input::new(settings, settings_len) })
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_source_stream(
                source: i64,
                out: *mut u8,
                capacity: usize,
            ) -> i64 {
                // SAFETY: the caller's buffer, by the ABI.
                STATE.stream(source, unsafe { Output::new(out, capacity) })
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_source_start(source: i64) -> i64 {
                STATE.start(source)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_source_read(
                source: i64,
                samples: *mut f64,
                len: usize,
                timeout_ms: u32,
            ) -> i64 {
                // SAFETY: the caller's buffer, by the ABI.
                STATE.read(source, unsafe { Output::new(samples, len) }, timeout_ms)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_source_stop(source: i64) -> i64 {
                STATE.stop(source)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_source_close(source: i64) -> i64 {
                STATE.close(source)
            }
        }
    };
}
