//! The requirements of a scene. The requirements are derived from the scene, its assets and its
//! device before any stage is built.

use htex_device::{Capabilities, Quantity};
use htex_play::Motion;
use htex_play::exploration::CONTACT_RAMP_S;

use crate::SceneError;
use crate::device::quantity_misfit;
use crate::file::{Effect, Surface, Switch};
use crate::load::Scene;
use crate::motion::{Course, Readings, topmost};
use crate::response::Inverse;

/// Relative difference of speeds and forces that counts as rounding.
const SAME: f64 = 1e-6;
/// Maximum number of control blocks that are examined before a scene plays: nearly an hour of
/// motion. A longer scene is examined at larger intervals.
const MOST_LOOKS: u64 = 1 << 20;
/// Duration of a control block, seconds.
// This is 64 frames at the paper's rate of 20 kHz.
const CONTROL_S: f64 = 0.0032;
/// Level of a preview by ear, dB relative to full scale.
const PREVIEW_DBFS: f64 = -18.0;

/// Range of the values that occur.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Span {
    pub(crate) const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
    pub(crate) const ONE: Self = Self { low: 1.0, high: 1.0 };
    pub(crate) const ANY: Self = Self { low: 0.0, high: f64::INFINITY };

    pub(crate) fn include(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    /// Whether the span contains at most one value, within rounding.
    pub(crate) fn is_point(&self) -> bool {
        self.low >= self.high - SAME * self.high.abs()
    }

    /// Returns the value of a span with a single value, or 1 if the span is empty.
    pub(crate) fn only(&self) -> f64 {
        if self.low <= self.high { self.low } else { 1.0 }
    }

    /// Whether the span is empty or its only value is 1, within rounding.
    pub(crate) fn is_one(&self) -> bool {
        let near = |x: f64| (x - 1.0).abs() <= SAME;
        self.low > self.high || (near(self.low) && near(self.high))
    }

    pub(crate) fn text(&self, unit: &str) -> String {
        match self {
            _ if self.high == f64::INFINITY => "live".to_owned(),
            _ if self.is_point() => format!("{:.4} {unit}", self.low),
            _ => format!("{:.3} to {:.3} {unit}", self.low, self.high),
        }
    }
}

/// Requirements of the scene as a whole.
#[derive(Debug)]
pub(crate) struct Requirements {
    pub(crate) device: Capabilities,
    pub(crate) rate_hz: f64,
    /// Frames in a control block.
    pub(crate) control: usize,
    /// Length in frames; `None` if endless.
    pub(crate) frames: Option<u64>,
    pub(crate) live: bool,
    pub(crate) turns_round: bool,
    pub(crate) breaks_contact: bool,
    /// Quantity of the assets.
    pub(crate) quantity: htex_format::Quantity,
    /// Device units per asset unit.
    pub(crate) quantity_gain: f64,
    /// Reference level: the RMS that is mapped to the drive voltage or the preview level, at the
    /// input of the device's stages, in the assets' unit.
    pub(crate) level_rms: f64,
    pub(crate) drive_v: f64,
    pub(crate) gain_db: f64,
    pub(crate) level_dbfs: f64,
    pub(crate) pitch: f64,
    pub(crate) seed: u64,
    pub(crate) compensation: Option<Inverse>,
    /// Whether the scene switches on the fluctuation of its textures.
    pub(crate) fluctuation: bool,
    /// How each surface is touched.
    pub(crate) touches: Vec<Touch>,
}

/// How a surface is touched over the scene.
#[derive(Debug, Clone)]
pub(crate) struct Touch {
    /// Fraction of the time during which the finger slides over the surface, 0 to 1.
    pub(crate) share: f64,
    pub(crate) always: bool,
    pub(crate) speed_mm_s: Span,
    pub(crate) force_n: Span,
    /// The finger at the first contact.
    pub(crate) first: Option<Motion>,
    /// The motions at which the finger slides. Each motion differs from the previous one.
    pub(crate) motions: Vec<Motion>,
}

impl Requirements {
    /// Gathers the requirements that do not depend on the choice of representations.
    pub(crate) fn gather(scene: &Scene, device: &Capabilities) -> Result<Self, SceneError> {
        let (file, choice) = (&scene.file, &scene.file.device);
        let rate_hz = choice.rate_hz.unwrap_or(device.default_rate_hz);
        if !device.has_rate(rate_hz) {
            return Err(SceneError::Rate { rate_hz, rates: device.rates_text() });
        }
        let quantity = scene.quantity();
        let misfit = quantity_misfit(quantity, device.quantity, choice.quantity_gain);
        if let Some(sentence) = misfit {
            return Err(SceneError::Quantity { sentence });
        }
        let course = Course::new(&scene.file.motion, scene.trace.as_ref());
        let duration_s = file.duration_s.or(scene.trace.as_ref().map(|t| t.duration_s()));
        let limit = device.limit.unwrap_or(f64::INFINITY);
        let pitch = match device.quantity {
            Quantity::Sound => choice.pitch.unwrap_or(1.0),
            _ => 1.0,
        };
        let mut required = Self {
            rate_hz,
            control: (8.0 * (CONTROL_S * rate_hz / 8.0).round()).clamp(8.0, 4096.0) as usize,
            frames: duration_s.map(|s| (s * rate_hz).round().max(1.0) as u64),
            live: matches!(course, Course::Live),
            turns_round: false,
            breaks_contact: false,
            quantity,
            quantity_gain: choice.quantity_gain.unwrap_or(1.0),
            level_rms: 0.0,
            drive_v: choice.drive_v.unwrap_or(0.5 * limit),
            gain_db: choice.gain_db.unwrap_or(0.0),
            level_dbfs: choice.level_dbfs.unwrap_or(PREVIEW_DBFS),
            pitch,
            seed: file.seed,
            compensation: scene
                .response
                .as_ref()
                .map(|r| Inverse::new(r, &scene.assets, pitch, choice.response_depth_db)),
            fluctuation: file.effects.get(&Effect::Fluctuation) == Some(&Switch::On),
            touches: Vec::new(),
            device: device.clone(),
        };
        required.follow(&course, &file.surfaces);
        Ok(required)
    }

    /// Steps through the motion as the renderer does.
    fn follow(&mut self, course: &Course, surfaces: &[Surface]) {
        let untouched = Touch {
            share: 0.0,
            always: true,
            speed_mm_s: Span::NONE,
            force_n: Span::NONE,
            first: None,
            motions: Vec::new(),
        };
        self.touches = vec![untouched; surfaces.len()];
        // A live motion can go anywhere, so no surface, speed or force can be ruled out.
        if self.live {
            for (touch, surface) in self.touches.iter_mut().zip(surfaces) {
                touch.share = 1.0;
                touch.always = surfaces.len() == 1 && surface.region.is_none();
                touch.speed_mm_s = Span::ANY;
                touch.force_n = Span::ANY;
            }
            return;
        }
        // A constant motion needs only one step.
        let still = course.is_constant() && surfaces.len() == 1 && surfaces[0].region.is_none();
        let frames = self.frames.unwrap_or(1);
        let controls = if still { 1 } else { frames.div_ceil(self.control as u64).max(1) };
        let stride = controls.div_ceil(MOST_LOOKS);
        let looks = controls.div_ceil(stride);
        let mut readings = Readings::new(self.control_s());
        for look in 0..looks {
            let frame = (look * stride) as f64 * self.control as f64;
            let finger = readings.filter(course.motion(frame / self.rate_hz), stride);
            self.look(finger, surfaces);
        }
        for touch in &mut self.touches {
            touch.share /= looks as f64;
        }
    }

    fn look(&mut self, finger: Motion, surfaces: &[Surface]) {
        let touched = topmost(surfaces, &finger);
        self.breaks_contact |= !finger.slides();
        self.turns_round |= finger.slides() && finger.speed_mm_s < 0.0;
        for (i, touch) in self.touches.iter_mut().enumerate() {
            if touched != Some(i) {
                touch.always = false;
            } else if finger.slides() {
                touch.share += 1.0;
                touch.speed_mm_s.include(finger.speed_mm_s.abs());
                touch.force_n.include(finger.force_n);
                touch.first.get_or_insert(finger);
                if touch.motions.last() != Some(&finger.without_direction()) {
                    touch.motions.push(finger.without_direction());
                }
            }
        }
    }

    /// Duration of a control block, seconds.
    pub(crate) fn control_s(&self) -> f64 {
        self.control as f64 / self.rate_hz
    }

    /// Frames of the ramp at the end of a scene.
    pub(crate) fn ramp_frames(&self) -> u64 {
        (CONTACT_RAMP_S * self.rate_hz).ceil() as u64
    }
}
