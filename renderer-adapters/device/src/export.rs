//! The macro that exports an adapter.

/// The macro takes a type that implements [`Adapter`](crate::Adapter) and `Default`. It generates
/// the C functions of the ABI, and the table `pub static TABLE`, which lists these functions.
///
/// If you pass `symbols: "FEATURE"` and build the crate with that Cargo feature, the macro also
/// exports the function `htex_device_adapter`, which returns the table. A host calls this function
/// to load the adapter of a native library. Therefore, a library holds exactly one adapter. A panic
/// in the adapter becomes a status code.
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
/// #     ..Descriptor::default()
/// # });
/// # impl Adapter for Nowhere {
/// #     fn descriptor(&self) -> &Descriptor { &DESCRIPTOR }
/// #     fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> { Ok(vec![]) }
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
        impl $crate::shim::Export for $adapter {
            fn state() -> &'static $crate::shim::State<Self> {
                static STATE: $crate::shim::State<$adapter> = $crate::shim::State::new();
                &STATE
            }
        }

        /// The device's C functions.
        pub static TABLE: $crate::abi::DeviceTable = $crate::shim::table::<$adapter>();

        #[cfg(feature = $feature)]
        const _: () = {
            #[unsafe(no_mangle)]
            extern "C" fn htex_device_adapter() -> *const $crate::abi::DeviceTable {
                &TABLE
            }
        };
    };
}
