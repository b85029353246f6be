//! The structures of `XR_EXT_haptic_parametric`, revision 1 (extension 776), as the OpenXR registry
//! defines them. `openxr-sys` 0.14 does not have them yet.

use std::ffi::c_void;

use openxr_sys::{Bool32, Duration, HapticActionInfo, Result, Session};

/// The extension's name.
pub(crate) const NAME: &std::ffi::CStr = c"XR_EXT_haptic_parametric";
/// `XR_HAPTIC_PARAMETRIC_MAX_POINTS_TRANSIENTS_EXT`: maximum number of points in a frame.
pub(crate) const MOST_POINTS: usize = 500;
/// `XR_HAPTIC_PARAMETRIC_FREQUENCY_MIN_HZ_EXT` and `..._MAX_HZ_EXT`.
pub(crate) const FREQUENCIES_HZ: (f64, f64) = (1.0, 1_000.0);

/// `XrStructureType`: `XR_TYPE_HAPTIC_PARAMETRIC_VIBRATION_EXT` and the two after it.
pub(crate) const VIBRATION: i32 = 1_000_775_000;
pub(crate) const PROPERTIES: i32 = 1_000_775_001;
pub(crate) const SYSTEM_PROPERTIES: i32 = 1_000_775_002;

/// `XrHapticParametricStreamFrameTypeEXT`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Frame(pub(crate) i32);

impl Frame {
    /// The frame is the whole event.
    pub(crate) const WHOLE: Self = Self(0);
    pub(crate) const FIRST: Self = Self(1);
    pub(crate) const INTERMEDIATE: Self = Self(2);
    pub(crate) const LAST: Self = Self(3);
}

/// `XrHapticParametricPointEXT`.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct XrPoint {
    pub(crate) time: Duration,
    pub(crate) value: f32,
}

/// `XrHapticParametricVibrationEXT`.
#[repr(C)]
pub(crate) struct Vibration {
    pub(crate) ty: i32,
    pub(crate) next: *const c_void,
    pub(crate) amplitude_count: u32,
    pub(crate) amplitudes: *const XrPoint,
    pub(crate) frequency_count: u32,
    pub(crate) frequencies: *const XrPoint,
    pub(crate) transient_count: u32,
    pub(crate) transients: *const c_void,
    pub(crate) min_frequency_hz: f32,
    pub(crate) max_frequency_hz: f32,
    pub(crate) frame: Frame,
}

/// `XrHapticParametricPropertiesEXT`.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Properties {
    pub(crate) ty: i32,
    pub(crate) next: *mut c_void,
    /// The runtime's preferred time between two frames; 0 if it has no preference.
    pub(crate) ideal_frame: Duration,
    /// Minimum duration of the first frame; 0 for any.
    pub(crate) least_first_frame: Duration,
    pub(crate) min_frequency_hz: f32,
    pub(crate) max_frequency_hz: f32,
}

/// `XrSystemHapticParametricPropertiesEXT`.
#[repr(C)]
pub(crate) struct SystemProperties {
    pub(crate) ty: i32,
    pub(crate) next: *mut c_void,
    pub(crate) is_supported: Bool32,
}

/// `xrHapticParametricGetPropertiesEXT`.
pub(crate) type GetProperties =
    unsafe extern "system" fn(Session, *const HapticActionInfo, *mut Properties) -> Result;
