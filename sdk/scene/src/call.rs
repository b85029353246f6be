//! The requirements of a scene, gathered from the scene, its assets and its device before anything is built.

use htex_device::{Capabilities, Quantity};
use htex_format::ErrorMeasure;
use htex_play::exploration::CONTACT_RAMP_S;
use htex_play::{Explored, Recorded, Source, VoiceOptions};

use crate::SceneError;
use crate::device::quantity_misfit;
use crate::file::{Effect, Surface, Switch};
use crate::load::LoadedScene;
use crate::motion::{Course, Finger, topmost};
use crate::response::Inverse;

/// Largest frequency ratio that a live motion is prepared for.
const LIVE_RATIO: f64 = 4.0;
/// Largest force that a live motion is prepared for, relative to the recorded one.
const LIVE_FORCE: f64 = 3.0;
/// Rate of a voice before a compensation, relative to the highest frequency.
const FILTERED_OVERSAMPLING: f64 = 2.5;
/// Relative difference of speeds and forces that is attributed to rounding.
const SAME: f64 = 1e-6;
/// Maximum number of control blocks examined before a scene plays, nearly an hour of motion; a longer scene
/// is sampled at larger intervals.
const MOST_LOOKS: u64 = 1 << 20;
/// Duration of a control block, seconds.
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
    const NONE: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };
    pub(crate) const ANY: Self = Self {
        low: 0.0,
        high: f64::INFINITY,
    };

    fn take(&mut self, x: f64) {
        self.low = self.low.min(x);
        self.high = self.high.max(x);
    }

    /// Whether it contains one value, within rounding, or none.
    pub(crate) fn is_point(&self) -> bool {
        self.low >= self.high - SAME * self.high.abs()
    }

    /// Whether it requires more than one scaling factor for a texture recorded at `recorded`.
    pub(crate) fn changes(&self, recorded: &Recorded) -> bool {
        !self.is_point() && recorded.ratio(self.low) != recorded.ratio(self.high)
    }

    /// Whether it is the recorded value, within rounding.
    pub(crate) fn is_as(&self, recorded: &Recorded) -> bool {
        let near = |x: f64| (recorded.ratio(x) - 1.0).abs() <= SAME;
        near(self.low) && near(self.high)
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
pub(crate) struct Call {
    pub(crate) device: Capabilities,
    pub(crate) rate_hz: f64,
    /// Frames of a control block.
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
    /// Reference level: the RMS that is mapped to the drive voltage or the preview level, at the input of the
    /// device's stages, in the assets' unit.
    pub(crate) level_rms: f64,
    pub(crate) drive_v: f64,
    pub(crate) gain_db: f64,
    pub(crate) level_dbfs: f64,
    pub(crate) pitch: f64,
    pub(crate) seed: u64,
    pub(crate) compensation: Option<Inverse>,
    /// Touch of each surface.
    pub(crate) touches: Vec<Touch>,
}

/// How a surface is touched over the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// Fraction of the time, 0 to 1.
    pub(crate) share: f64,
    pub(crate) always: bool,
    pub(crate) speed_mm_s: Span,
    pub(crate) force_n: Span,
    /// The finger at the first contact.
    pub(crate) first: Option<Finger>,
}

impl Call {
    /// Gathers the requirements that do not depend on the choice of representations.
    pub(crate) fn gather(scene: &LoadedScene, device: &Capabilities) -> Result<Self, SceneError> {
        let (file, choice) = (&scene.scene, &scene.scene.device);
        let rate_hz = choice.rate_hz.unwrap_or(device.default_rate_hz);
        if !device.rates.has(rate_hz) {
            return Err(SceneError::Rate {
                rate_hz,
                rates: device.rates.to_string(),
            });
        }
        let quantity = scene.quantity();
        let misfit = quantity_misfit(quantity, device.quantity, choice.quantity_gain);
        if let Some(sentence) = misfit {
            return Err(SceneError::Quantity { sentence });
        }
        let course = Course::new(&scene.scene.motion, scene.trace.as_ref());
        let duration_s = file
            .duration_s
            .or(scene.trace.as_ref().map(|t| t.duration_s()));
        let limit = device.limit.unwrap_or(f64::INFINITY);
        let pitch = match device.quantity {
            Quantity::Sound => choice.pitch.unwrap_or(1.0),
            _ => 1.0,
        };
        let mut call = Self {
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
            touches: Vec::new(),
            device: device.clone(),
        };
        call.follow(&course, &file.surfaces);
        Ok(call)
    }

    /// Steps through the motion as the renderer does.
    fn follow(&mut self, course: &Course, surfaces: &[Surface]) {
        let untouched = Touch {
            share: 0.0,
            always: true,
            speed_mm_s: Span::NONE,
            force_n: Span::NONE,
            first: None,
        };
        self.touches = vec![untouched; surfaces.len()];
        if self.live {
            for (touch, surface) in self.touches.iter_mut().zip(surfaces) {
                touch.share = 1.0;
                touch.always = surfaces.len() == 1 && surface.region.is_none();
                touch.speed_mm_s = Span::ANY;
                touch.force_n = Span::ANY;
            }
            return;
        }
        // A constant motion needs one step.
        let still = course.is_constant() && surfaces.len() == 1 && surfaces[0].region.is_none();
        let frames = self.frames.unwrap_or(1);
        let controls = match still {
            true => 1,
            false => frames.div_ceil(self.control as u64).max(1),
        };
        let stride = controls.div_ceil(MOST_LOOKS);
        let looks = controls.div_ceil(stride);
        for look in 0..looks {
            let frame = (look * stride) as f64 * self.control as f64;
            let finger = course.at(frame / self.rate_hz);
            self.look(finger, surfaces);
        }
        for touch in &mut self.touches {
            touch.share /= looks as f64;
        }
    }

    fn look(&mut self, finger: Finger, surfaces: &[Surface]) {
        let touched = topmost(surfaces, &finger);
        self.breaks_contact |= !finger.slides();
        self.turns_round |= finger.slides() && finger.speed_mm_s < 0.0;
        for (i, touch) in self.touches.iter_mut().enumerate() {
            if touched != Some(i) {
                touch.always = false;
            } else if finger.slides() {
                touch.share += 1.0;
                touch.speed_mm_s.take(finger.speed_mm_s.abs());
                touch.force_n.take(finger.force_n);
                touch.first.get_or_insert(finger);
            }
        }
    }

    /// Frames of the ramp at the end of a scene.
    pub(crate) fn ramp_frames(&self) -> u64 {
        (CONTACT_RAMP_S * self.rate_hz).ceil() as u64
    }
}

/// A surface played by one of its representations.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) surface: usize,
    /// Id of the model.
    pub(crate) model: String,
    /// Error by the budget's measure, decibels; infinite if not measured.
    pub(crate) error_db: f64,
    /// Number of known conditions.
    pub(crate) known: usize,
    /// Known speeds and forces.
    pub(crate) explored: Explored,
    /// The model follows the motion itself.
    pub(crate) follows_motion: bool,
    pub(crate) speed_mm_s: Span,
    pub(crate) force_n: Span,
    pub(crate) always_touched: bool,
    pub(crate) share: f64,
    /// Motion the voice starts with; `None`: the first condition.
    pub(crate) start: Option<htex_play::Motion>,
    /// Rate of the model, hertz.
    pub(crate) rate_hz: f64,
    /// Rate after speed scaling, relative to the rate of the model.
    pub(crate) oversampling: f64,
    pub(crate) mix_rate_hz: f64,
    /// Highest frequency of the voice, hertz.
    pub(crate) voice_top_hz: f64,
    /// Highest frequency at the rate of the mix, hertz.
    pub(crate) top_hz: f64,
    /// Constant frequency ratio at which the voice is read.
    pub(crate) fixed_ratio: f64,
    pub(crate) fixed_force_gain: f64,
    /// Factor on the asset's level.
    pub(crate) gain: f64,
    /// Largest RMS after compensation, in the asset's unit.
    pub(crate) level_rms: f64,
}

impl Part {
    /// Makes the part of a surface that is played by the representation of `model`.
    pub(crate) fn new(
        scene: &LoadedScene,
        call: &Call,
        surface: usize,
        model: &str,
    ) -> Result<Self, SceneError> {
        let (asset, touch) = (&scene.assets[surface], &call.touches[surface]);
        let (known, explored, error_db) = known(asset, model, scene.scene.budget.error);
        let failed = |source| SceneError::Surface {
            surface,
            asset: scene.scene.surfaces[surface].asset.clone(),
            source,
        };
        let loaded = asset.loaded_model(Some(model)).map_err(failed)?;
        let mut part = Self {
            surface,
            model: model.to_owned(),
            error_db,
            known,
            explored,
            follows_motion: loaded.follows_motion(),
            speed_mm_s: touch.speed_mm_s,
            force_n: touch.force_n,
            always_touched: touch.always,
            share: touch.share,
            start: touch.first.map(|finger| finger.motion()),
            rate_hz: 0.0,
            oversampling: 1.0,
            mix_rate_hz: 0.0,
            voice_top_hz: asset.band().high_hz,
            top_hz: asset.band().high_hz,
            fixed_ratio: call.pitch,
            fixed_force_gain: 1.0,
            gain: scene.scene.surfaces[surface].gain,
            level_rms: 0.0,
        };
        part.scale_speed(scene);
        let force_gain = part.scale_force(scene);
        let source = part.source(scene, call).map_err(failed)?;
        part.rate_hz = source.rate_hz();
        part.divide_rate(call.rate_hz);
        part.mix_rate_hz = part.rate_hz * part.oversampling;
        let shape = part.compensated(call, asset).map_err(failed)?;
        part.level_rms = loudest(asset, model, source.level_rms()) * part.gain * force_gain * shape;
        Ok(part)
    }

    /// Makes the surface's voice. A model that renders at any rate is given one that needs no conversion
    /// after speed scaling, or, before a compensation, one at which its filter is short.
    pub(crate) fn source(
        &self,
        scene: &LoadedScene,
        call: &Call,
    ) -> Result<Source, htex_play::Error> {
        let mut wanted_hz = call.rate_hz / (self.fixed_ratio * self.oversampling);
        if call.compensation.is_some() {
            wanted_hz = wanted_hz.min(FILTERED_OVERSAMPLING * self.top_hz);
        }
        scene.assets[self.surface].source(
            &VoiceOptions::default()
                .with_model(&self.model)
                .with_rate_hz(wanted_hz)
                .with_seed(call.seed.wrapping_add(self.surface as u64))
                .with_motion(self.start),
        )
    }

    /// Applies the speed to the rates: a constant one to the resampler, a changing one to the warp.
    fn scale_speed(&mut self, scene: &LoadedScene) {
        let off = scene.scene.effects.get(&Effect::SpeedScaling) == Some(&Switch::Off);
        if off || self.follows_motion || !self.explored.speed.is_one() {
            return;
        }
        let ratio = |speed: f64| self.explored.speed_ratio(speed);
        if !self.speed_mm_s.changes(&self.explored.speed) {
            if self.speed_mm_s.low.is_finite() {
                self.fixed_ratio *= ratio(self.speed_mm_s.low);
            }
            return;
        }
        let fastest = match self.speed_mm_s.high.is_finite() {
            true => ratio(self.speed_mm_s.high),
            false => LIVE_RATIO,
        };
        self.oversampling = fastest.ceil().max(1.0);
        self.top_hz *= fastest.max(1.0);
    }

    /// Increases the oversampling of a changing speed until the rate is an integer fraction of the device's:
    /// conversion by an integer factor takes a fraction of the time of other conversions.
    fn divide_rate(&mut self, device_hz: f64) {
        let parts = (device_hz / (self.rate_hz * self.fixed_ratio * self.oversampling)).floor();
        if self.oversampling > 1.0 && parts >= 1.0 {
            self.oversampling = device_hz / parts / (self.rate_hz * self.fixed_ratio);
        }
    }

    /// Applies a constant force to the gain; returns the largest gain of all forces.
    fn scale_force(&mut self, scene: &LoadedScene) -> f64 {
        let off = scene.scene.effects.get(&Effect::ForceScaling) == Some(&Switch::Off);
        if off || self.follows_motion || !self.explored.force.is_one() {
            return 1.0;
        }
        let changes = self.force_n.changes(&self.explored.force);
        match self.force_n {
            span if !changes && span.low.is_finite() => {
                self.fixed_force_gain = self.explored.force_gain(span.low);
                self.gain *= self.fixed_force_gain;
                1.0
            }
            _ if !changes => 1.0,
            span if span.high.is_finite() => self.explored.force_gain(span.high),
            _ => LIVE_FORCE,
        }
    }

    /// Ratio of the RMS after the compensation to that before it.
    fn compensated(&self, call: &Call, asset: &htex_play::Asset) -> Result<f64, htex_play::Error> {
        let Some(inverse) = &call.compensation else {
            return Ok(1.0);
        };
        let band = asset.band();
        let grid = band.grid_hz();
        let magnitude = asset.magnitude(Some(&self.model), self.start, &grid)?;
        let sum = |gain: &dyn Fn(f64) -> f64| {
            let one = |(m, f): (&f64, &f64)| (m * gain(*f)).powi(2);
            magnitude.iter().zip(&grid).map(one).sum::<f64>()
        };
        let before = sum(&|_| 1.0);
        let behind = sum(&|hz| inverse.at(hz * self.fixed_ratio));
        Ok(if before > 0.0 {
            (behind / before).sqrt()
        } else {
            1.0
        })
    }
}

/// Number of conditions of a representation, their speeds and forces, and the largest error.
fn known(asset: &htex_play::Asset, model: &str, measure: ErrorMeasure) -> (usize, Explored, f64) {
    let manifest = asset.manifest();
    let found = manifest.representations.iter().find(|r| r.model == model);
    let at = found.map_or(&[][..], |r| &r.at);
    let error = |at: &htex_format::AtCondition| {
        let quality = at.quality.as_ref();
        quality.and_then(|q| measure.of(q)).unwrap_or(f64::INFINITY)
    };
    let worst = at.iter().map(error).fold(0.0, f64::max);
    (at.len(), Explored::new(at, &manifest.conditions), worst)
}

/// The largest level of a representation, in the asset's unit.
fn loudest(asset: &htex_play::Asset, model: &str, level_rms: f64) -> f64 {
    let manifest = asset.manifest();
    let found = manifest.representations.iter().find(|r| r.model == model);
    let levels = found.into_iter().flat_map(|r| &r.at).map(|at| at.level_rms);
    levels.fold(level_rms, f64::max)
}
