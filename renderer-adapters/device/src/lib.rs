//! What a device is: something that takes samples of one quantity at one rate.
//!
//! An [`Adapter`] is a family of devices; [`Adapter::open`] makes a [`Device`]. A device says what
//! it can do ([`Capabilities`]) and refuses what would harm: its limits hold whatever is asked.
//! Nothing here knows what a texture is.

mod adapter;
mod capabilities;
mod descriptor;
mod error;
mod settings;

pub use adapter::{Adapter, Device, Status, StreamFormat};
pub use capabilities::{Capabilities, Quantity, Rates};
pub use descriptor::{Descriptor, Endpoint, Profile, Setting, SettingKind};
pub use error::DeviceError;
pub use settings::Settings;
