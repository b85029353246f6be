//! Devices, which are outputs or inputs. An output plays samples of one quantity at one rate. An
//! input records samples of several channels.
//!
//! An [`Adapter`] represents a family of devices with the same [`Direction`], such as the outputs
//! of all sound cards. [`Adapter::open_output`] returns an open [`Output`], and
//! [`Adapter::open_input`] returns an open [`Input`]. An output reports its [`Capabilities`] and
//! enforces its limits on every sample. This crate does not depend on textures.
//!
//! An adapter is either built into the program, or it comes from a native library that exports the
//! C functions of [`abi`] ([`NativeAdapter`]). [`Devices`] finds both kinds. To write a native
//! library in Rust, implement the traits and call [`export_device!`].
//!
//! Outputs and inputs share one ABI with one table of functions. Only outputs have `capabilities`,
//! `write` and `status`. Only inputs have `stream`, `start` and `read`.
//!
//! Models run in a sandbox, but devices do not. A sandbox ensures that a model produces the same
//! bits on every computer; a device needs no such guarantee. Also, a WASM sandbox without imports
//! cannot reach any hardware. Therefore, the host calls built-in adapters directly, without a
//! sandbox. Errors of built-in adapters have the same types as errors of native libraries.
//!
//! An output checks all samples of a call against its limits before it plays any of them. The host
//! refuses an output of display voltages that has no limit. After an error the output is at zero
//! and stays there. The mean voltage of a display is also limited ([`DirectVoltage`]).
#![warn(missing_docs)]

pub mod abi;
mod adapter;
mod capabilities;
mod crossing;
#[cfg(feature = "descriptions")]
mod described;
mod descriptor;
mod direct;
mod error;
mod export;
pub mod guardian;
mod handles;
mod native;
mod probe;
mod registry;
#[cfg(feature = "schemars")]
mod schemas;
mod settings;
pub mod shim;
mod stream;

pub use adapter::{Adapter, Input, InputFrames, Output, Status, StreamFormat};
pub use capabilities::{Capabilities, Quantity, RATE_PER_CARRIER, Rates};
pub use descriptor::{
    Descriptor, Direction, Endpoint, FromScene, Mapping, Profile, Setting, SettingKind,
};
pub use direct::{DIRECT_LIMIT_V, DIRECT_SETTING, DirectVoltage, Excess};
pub use error::{DeviceError, LibraryFault};
pub use native::{NativeAdapter, NativeInput, NativeOutput};
pub use registry::{AdapterEntry, Devices, Note, Origin, Search};
#[cfg(feature = "schemars")]
pub use schemas::schemas;
pub use settings::{IgnoredSetting, SettingRequests, Settings};
pub use stream::{Channel, InputStream};
