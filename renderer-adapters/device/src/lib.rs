//! Output devices and input sources: a device takes samples of one quantity at one rate, a source
//! delivers samples of channels.
//!
//! An [`Adapter`] is a family of devices; [`Adapter::open`] makes a [`Device`]. A device reports
//! its [`Capabilities`] and enforces its limits on every sample.
//! This crate does not depend on textures.
//!
//! A [`Source`] is the reverse, an input: it delivers samples of several channels. Its family is a
//! [`SourceAdapter`].
//!
//! An adapter is built in, or a native library behind the flat C functions of [`abi`] or
//! [`source::abi`] ([`NativeAdapter`], [`NativeSourceAdapter`]); [`Devices`] and [`Sources`] find
//! both. A Rust author implements the traits and calls [`export_device!`] or [`export_source!`].
//!
//! Built-in adapters are called directly, unlike models: a device need not give the same bits in a
//! sandbox, and its errors keep their kind either way. There is no device in WASM, since a sandbox
//! without imports reaches no hardware.
//!
//! A device enforces its limits on every sample before it outputs any sample of a call, and a
//! voltage without a limit is not loaded. After an error its output is at zero, and stays there.
//! The mean of a display's voltage is limited, too ([`DirectVoltage`]).
#![warn(missing_docs)]

pub mod abi;
mod adapter;
mod capabilities;
mod crossing;
mod descriptor;
mod devices;
mod direct;
mod error;
mod export;
mod exported;
mod handles;
mod library;
mod loaded;
mod native;
mod probe;
mod registry;
#[cfg(feature = "schemars")]
mod schemas;
mod settings;
pub mod shim;
pub mod source;

pub use adapter::{Adapter, Device, Status, StreamFormat};
pub use capabilities::{Capabilities, CapabilitiesError, Quantity, RATE_PER_CARRIER, Rates};
pub use descriptor::{
    Descriptor, DescriptorError, Endpoint, FromScene, Mapping, Profile, Setting, SettingFault,
    SettingKind,
};
pub use devices::{Devices, KnownDevice};
pub use direct::{DIRECT_LIMIT_V, DIRECT_SETTING, DIRECT_WINDOW_S, DirectVoltage, Excess};
pub use error::{AbiFault, DeviceError};
pub use loaded::Native;
pub use native::{NativeAdapter, NativeDevice};
pub use registry::{AdapterKind, Known, Note, Origin, Registry, Search};
#[cfg(feature = "schemars")]
pub use schemas::{schemas, source_schemas};
pub use settings::{Ignored, Settings, Stated};
pub use source::{
    Channel, Delivered, KnownSource, NativeSource, NativeSourceAdapter, Source, SourceAdapter,
    SourceDescriptor, SourceStream, SourceStreamError, Sources,
};
