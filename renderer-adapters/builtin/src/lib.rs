//! The built-in devices, one per module. To make an adapter available in the command line, in
//! Python and in C, add it to [`devices`].
//!
//! [`motor`] is the common part of outputs that receive a level and a frequency per block instead
//! of samples.
//!
//! ```
//! use htex_device::Devices;
//! let devices = Devices::new(htex_device_builtin::devices());
//! assert_eq!(devices.find_output("file")?.descriptor().id, "org.htex.file");
//! # Ok::<(), htex_device::DeviceError>(())
//! ```
#![deny(unsafe_code)] // Allowed where a driver is called.

// Tests of the buffers need no sound card.
#[cfg(any(test, feature = "audio"))]
pub mod audio;
#[cfg(not(target_family = "wasm"))]
pub mod channels;
#[cfg(feature = "daq")]
pub mod daq;
#[cfg(not(target_family = "wasm"))]
mod driver;
pub mod file;
// In a web page, there are neither libraries to load nor threads that keep a clock.
#[cfg(not(target_family = "wasm"))]
pub mod motor;
#[cfg(all(feature = "openxr", not(target_family = "wasm")))]
pub mod parametric;
#[cfg(not(target_family = "wasm"))]
pub mod sdl;

use std::sync::Arc;

use htex_device::Adapter;

/// Returns the devices in display order: outputs, then inputs.
pub fn devices() -> Vec<Arc<dyn Adapter>> {
    vec![
        Arc::new(file::FileAdapter),
        #[cfg(feature = "daq")]
        Arc::new(daq::Daq),
        #[cfg(feature = "audio")]
        Arc::new(audio::Audio),
        #[cfg(not(target_family = "wasm"))]
        Arc::new(channels::Channels),
        #[cfg(not(target_family = "wasm"))]
        Arc::new(sdl::Sdl),
        #[cfg(all(feature = "openxr", not(target_family = "wasm")))]
        Arc::new(parametric::Parametric),
        #[cfg(feature = "daq")]
        Arc::new(daq::DaqInput),
        #[cfg(feature = "audio")]
        Arc::new(audio::AudioInput),
    ]
}

/// A device that is built in only with a Cargo feature: an output, or an output and an input with
/// the same name.
#[derive(Debug, Clone, Copy)]
pub struct Optional {
    pub id: &'static str,
    /// What the output plays, in one word that messages use.
    pub what: &'static str,
    pub feature: &'static str,
    /// The Linux package that is needed to build the device, if any.
    pub package: Option<&'static str>,
    /// Whether this program was built with the feature.
    pub is_built: bool,
}

/// The device that plays a texture as sound.
pub const SOUND: Optional = Optional {
    id: "org.htex.audio",
    what: "sound",
    feature: "audio",
    package: Some("libasound2-dev"),
    is_built: cfg!(feature = "audio"),
};

/// The device that plays a texture on controllers behind OpenXR.
pub const OPENXR: Optional = Optional {
    id: "org.htex.parametric",
    what: "OpenXR",
    feature: "openxr",
    package: None,
    is_built: cfg!(feature = "openxr"),
};

impl Optional {
    /// Returns the optional device with this name (short name or id), but only if this program was
    /// built without it.
    pub fn left_out(name: &str) -> Option<Self> {
        let named = |one: &Self| [one.id, one.short_name()].contains(&name);
        [SOUND, OPENXR].into_iter().find(|one| !one.is_built && named(one))
    }

    /// Returns the last part of the device's id.
    pub fn short_name(&self) -> &'static str {
        self.id.rsplit('.').next().unwrap_or(self.id)
    }
}
