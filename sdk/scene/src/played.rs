//! A surface as it is played by one of its representations: its rates, its constant factors and its level.

use htex_format::ErrorMeasure;
use htex_play::{Explored, SampleSource, VoiceOptions};

use crate::SceneError;
use crate::error::OfSurface;
use crate::file::{Effect, Switch};
use crate::load::LoadedScene;
use crate::requirements::{Requirements, Span};

/// Largest frequency ratio that a live motion is prepared for.
const LIVE_RATIO: f64 = 4.0;
/// Largest force that a live motion is prepared for, relative to the recorded one.
const LIVE_FORCE: f64 = 3.0;
/// Rate of a voice before a compensation, relative to the highest frequency.
const FILTERED_OVERSAMPLING: f64 = 2.5;

/// A surface played by one of its representations.
#[derive(Debug, Clone)]
pub(crate) struct PlayedSurface {
    pub(crate) surface: usize,
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

impl PlayedSurface {
    /// Takes the representation of `model` for a surface.
    pub(crate) fn new(
        scene: &LoadedScene,
        required: &Requirements,
        surface: usize,
        model: &str,
    ) -> Result<Self, SceneError> {
        let (asset, touch) = (&scene.assets[surface], &required.touches[surface]);
        let (known, explored, error_db) = known(asset, model, scene.scene.budget.error);
        let loaded = asset.loaded_model(Some(model)).of_surface(surface, scene)?;
        let mut played = Self {
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
            fixed_ratio: required.pitch,
            fixed_force_gain: 1.0,
            gain: scene.scene.surfaces[surface].gain,
            level_rms: 0.0,
        };
        played.scale_speed(scene);
        let force_gain = played.scale_force(scene);
        let source = played.source(scene, required).of_surface(surface, scene)?;
        played.rate_hz = source.rate_hz();
        played.divide_rate(required.rate_hz);
        played.mix_rate_hz = played.rate_hz * played.oversampling;
        let shape = played
            .compensated(required, asset)
            .of_surface(surface, scene)?;
        played.level_rms =
            loudest(asset, model, source.level_rms()) * played.gain * force_gain * shape;
        Ok(played)
    }

    /// Makes the surface's voice. A model that renders at any rate is given one that needs no conversion
    /// after speed scaling, or, before a compensation, one at which its filter is short.
    pub(crate) fn source(
        &self,
        scene: &LoadedScene,
        required: &Requirements,
    ) -> Result<SampleSource, htex_play::Error> {
        let mut wanted_hz = required.rate_hz / (self.fixed_ratio * self.oversampling);
        if required.compensation.is_some() {
            wanted_hz = wanted_hz.min(FILTERED_OVERSAMPLING * self.top_hz);
        }
        scene.assets[self.surface].source(
            &VoiceOptions::default()
                .with_model(&self.model)
                .with_rate_hz(wanted_hz)
                .with_seed(required.seed.wrapping_add(self.surface as u64))
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
    fn compensated(
        &self,
        required: &Requirements,
        asset: &htex_play::Asset,
    ) -> Result<f64, htex_play::Error> {
        let Some(inverse) = &required.compensation else {
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
