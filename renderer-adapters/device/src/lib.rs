//! Output devices and input sources: a device takes samples of one quantity at one rate, a source delivers samples of channels.
//!
//! An [`Adapter`] is a family of devices; [`Adapter::open`] makes a [`Device`]. A device reports
//! its [`Capabilities`] and enforces its limits on every sample.
//! This crate does not depend on textures.
//!
//! A [`Source`] is the reverse, an input: it delivers samples of several channels. [`Sources`] knows the families of sources that
//! are linked into a program.
//!
//! An adapter is built in, or a native library behind the flat C functions of [`abi`]
//! ([`NativeAdapter`]); [`Devices`] finds both. A Rust author implements the traits and calls
//! [`export_device!`].

pub mod abi;
mod adapter;
mod capabilities;
mod crossing;
mod descriptor;
mod devices;
mod error;
mod export;
mod handles;
mod library;
mod native;
#[cfg(feature = "schemars")]
mod schemas;
mod settings;
pub mod shim;
mod source;
mod sources;

pub use adapter::{Adapter, Device, Status, StreamFormat};
pub use capabilities::{Capabilities, CapabilitiesError, Quantity, Rates};
pub use descriptor::{
    Descriptor, DescriptorError, Endpoint, FromScene, Profile, Setting, SettingFault, SettingKind,
};
pub use devices::{DeviceNote, DeviceOrigin, DeviceSearch, Devices, KnownDevice};
pub use error::{AbiFault, DeviceError};
pub use native::{NativeAdapter, NativeDevice};
#[cfg(feature = "schemars")]
pub use schemas::schemas;
pub use settings::{Ignored, Settings, Stated};
pub use source::{Channel, Delivered, Source, SourceAdapter};
pub use sources::Sources;
