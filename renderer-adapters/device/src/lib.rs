//! Output devices and input sources: a device plays samples of one quantity at one rate, a source
//! delivers samples of several channels.
//!
//! An [`Adapter`] stands for a family of devices, such as all sound cards. [`Adapter::open`]
//! returns an open [`Device`]. A device reports its [`Capabilities`] and enforces its limits on
//! every sample. This crate does not depend on textures.
//!
//! A [`Source`] is the opposite, an input. A [`SourceAdapter`] stands for a family of sources.
//!
//! An adapter is either built into the program or a native library behind the plain C functions of
//! [`abi`] or [`source::abi`] ([`NativeAdapter`], [`NativeSourceAdapter`]). [`Devices`] and
//! [`Sources`] find both kinds. To write an adapter in Rust, implement the traits and call
//! [`export_device!`] or [`export_source!`].
//!
//! Models run in a sandbox. Devices do not, for two reasons: a device need not produce the same
//! bits everywhere, and a WASM sandbox without imports cannot reach any hardware. Built-in adapters
//! are therefore called directly. Their errors have the same types as the errors of a library.
//!
//! A device checks all samples of a call against its limits before it outputs any of them. A
//! voltage device that states no limit is not loaded. After an error the output is at zero and
//! stays there. The mean voltage of a display is limited as well ([`DirectVoltage`]).
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
pub mod guardian;
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
