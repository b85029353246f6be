//! The stimulus of a trial: a scene with one surface, and the gain at which it is played. This
//! module also measures the levels of the samples that are written to the device.

use std::path::Path;

use htex_device::{Capabilities, DIRECT_LIMIT_V, DirectVoltage, Quantity};
use htex_scene::SceneFile;
use htex_scene::file::{DeviceChoice, Levels, Surface};

use crate::study::file::Study;
use crate::study::lines::OutputLevels;

/// If the study does not set the maximum level of a sound, this level is used, decibels relative to
/// full scale.
const SOUND_DBFS: f64 = -18.0;

/// A texture, the model that plays it, and the settings of the playback.
#[derive(Debug, Clone, PartialEq)]
pub struct Stimulus {
    pub texture: String,
    pub model: String,
    /// Length, seconds. If `None`, the stimulus plays until it is stopped.
    pub seconds: Option<f64>,
    /// Seed of the playback's random numbers.
    pub seed: u64,
    /// Gain relative to the maximum, decibels. If `None`, the stimulus plays at the level that the
    /// study's device sets.
    pub gain_db: Option<f64>,
    /// When the participant set the gain, this level (RMS, in the assets' unit) was mapped to the
    /// device's drive voltage or preview level. Only devices whose `levels` setting is `own` use
    /// this level.
    pub reference_rms: Option<f64>,
    /// File name, without extension, for the recording of the felt force. `None` if this force is
    /// not recorded.
    pub felt: Option<String>,
    /// Name of the file to which the device writes the stimulus, if the device writes files.
    /// Examples are `rise-vinyl`, `training-0003`, `gain-vinyl` and `trial-0017`.
    pub file: String,
}

/// Returns the scene in which a model plays a texture, as the bytes of a scene file. Paths in the
/// scene are relative to the study's folder.
pub fn scene_of(study: &Study, asset: &Path, model: &str) -> Vec<u8> {
    let surface = Surface { representation: model.to_owned(), ..Surface::everywhere(asset) };
    let scene = SceneFile {
        htex_scene: htex_scene::file::VERSION.to_owned(),
        surfaces: vec![surface],
        motion: study.motion.clone(),
        device: study.device.clone(),
        duration_s: Some(study.trial_s),
        seed: study.seed,
        budget: Default::default(),
        effects: Default::default(),
    };
    // Serialising cannot fail, because every value of a scene exists in JSON.
    serde_json::to_vec(&scene).unwrap_or_default()
}

/// Returns a display's drive voltage before a gain is applied, volts. This is the study's `drive_v`
/// or, if the study sets none, the display's limit.
pub fn full_drive(device: &DeviceChoice, able: &Capabilities) -> Option<f64> {
    let is_display = able.quantity == Quantity::DisplayVoltage;
    device.drive_v.or(able.limit).filter(|_| is_display)
}

/// Applies a gain to the device of a scene. The gain is relative to the maximum. On a display,
/// scales the drive (`drive_v`, or the display's limit). On a sound device, adds the gain to
/// `level_dbfs`. On all other devices, adds the gain to `gain_db`. Returns the drive of a display
/// in volts, and `None` for other devices.
pub fn set_gain(
    device: &mut DeviceChoice,
    able: &Capabilities,
    gain_db: f64,
    reference_rms: Option<f64>,
) -> Option<f64> {
    if device.levels == Levels::Own && device.reference_rms.is_none() {
        device.reference_rms = reference_rms;
    }
    match able.quantity {
        Quantity::DisplayVoltage => {
            let most_v = full_drive(device, able)?;
            let drive_v = most_v * libm::pow(10.0, gain_db / 20.0);
            device.drive_v = Some(drive_v);
            Some(drive_v)
        }
        Quantity::Sound => {
            device.level_dbfs = Some(device.level_dbfs.unwrap_or(SOUND_DBFS) + gain_db);
            None
        }
        _ => {
            device.gain_db = Some(device.gain_db.unwrap_or(0.0) + gain_db);
            None
        }
    }
}

/// Measures the samples that are written to a device.
///
/// ```
/// use htex_lab::study::Meter;
/// let mut meter = Meter::new("V", 1000.0);
/// meter.push(&[3.0, -3.0, 3.0, -3.0]);
/// let levels = meter.levels();
/// assert_eq!((levels.peak, levels.rms, levels.duration_s), (3.0, 3.0, 0.004));
/// assert!((levels.direct - 0.03).abs() < 1e-12, "3 V for 1 ms of 100 ms");
/// ```
#[derive(Debug, Clone)]
pub struct Meter {
    unit: String,
    rate_hz: f64,
    frames: u64,
    peak: f64,
    /// Sum of the squared samples.
    energy: f64,
    direct: f64,
    last: DirectVoltage,
}

impl Meter {
    /// Creates a meter for samples with this unit and this sample rate (hertz).
    pub fn new(unit: &str, rate_hz: f64) -> Self {
        Self {
            unit: unit.to_owned(),
            rate_hz,
            frames: 0,
            peak: 0.0,
            energy: 0.0,
            direct: 0.0,
            last: DirectVoltage::new(DIRECT_LIMIT_V, rate_hz),
        }
    }

    /// Measures samples that were written to the device.
    pub fn push(&mut self, samples: &[f32]) {
        for sample in samples {
            let value = f64::from(*sample);
            self.peak = self.peak.max(value.abs());
            self.energy += value * value;
            // The samples are pushed one by one, because the largest mean may occur inside a block.
            self.last.push(std::slice::from_ref(sample));
            self.direct = self.direct.max(self.last.mean_v().abs());
        }
        self.frames += samples.len() as u64;
    }

    /// Returns the levels so far.
    pub fn levels(&self) -> OutputLevels {
        OutputLevels {
            unit: self.unit.clone(),
            peak: self.peak,
            rms: (self.energy / self.frames.max(1) as f64).sqrt(),
            direct: self.direct,
            duration_s: self.frames as f64 / self.rate_hz,
        }
    }
}
