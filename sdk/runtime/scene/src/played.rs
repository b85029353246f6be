//! A surface with its chosen representation: the sample rates, the constant factors and the level.

use std::sync::Arc;

use htex_format::Fluctuation;
use htex_play::exploration::CEILING;
use htex_play::{Conditions, Representation, SampleSource, Scaling, VoiceOptions};

use crate::SceneError;
use crate::file::{Effect, Switch};
use crate::load::Scene;
use crate::requirements::{Requirements, Span, Touch};

/// Largest frequency ratio for which a live scene is prepared.
const LIVE_RATIO: f64 = 4.0;
/// Largest level factor for which a live scene is prepared.
const LIVE_GAIN: f64 = 3.0;
/// Rate of a voice before compensation, relative to the highest frequency.
const FILTERED_OVERSAMPLING: f64 = 2.5;

/// A surface played by one of its representations.
#[derive(Debug, Clone)]
pub(crate) struct PlayedSurface {
    pub(crate) surface: usize,
    pub(crate) model: String,
    /// The error by which the representation is chosen, decibels, in the measure that the budget
    /// names. `None` if it was not measured.
    pub(crate) error_db: Option<f64>,
    /// Largest error over the measured conditions, decibels. The budget limits this error.
    pub(crate) largest_error_db: Option<f64>,
    /// Number of known conditions.
    pub(crate) known: usize,
    /// Known speeds and forces, and the scaling law that applies outside them.
    pub(crate) conditions: Arc<Conditions>,
    /// The frequency factors and level factors that occur.
    pub(crate) frequency: Span,
    pub(crate) level: Span,
    /// Whether the model follows the motion itself.
    pub(crate) follows_motion: bool,
    /// The fluctuation that the asset states, if it is not 0.
    pub(crate) fluctuation: Option<Fluctuation>,
    pub(crate) speed_mm_s: Span,
    pub(crate) force_n: Span,
    pub(crate) always_touched: bool,
    pub(crate) share: f64,
    /// Motion with which the voice starts. `None` for the default condition.
    pub(crate) start: Option<htex_play::Motion>,
    /// Rate of the model, hertz.
    pub(crate) rate_hz: f64,
    /// Whether the model always has this rate, and no stage changes the rate before the conversion.
    pub(crate) own_rate: bool,
    /// Rate after speed scaling, relative to the rate of the model.
    pub(crate) oversampling: f64,
    pub(crate) mix_rate_hz: f64,
    /// Highest frequency of the voice, hertz.
    pub(crate) voice_top_hz: f64,
    /// Highest frequency at the rate of the mix, hertz.
    pub(crate) top_hz: f64,
    /// Constant frequency ratio at which the voice is read.
    pub(crate) fixed_ratio: f64,
    /// Constant factor of the level.
    pub(crate) fixed_gain: f64,
    /// Factor that multiplies the asset's level.
    pub(crate) gain: f64,
    /// Largest RMS after compensation, in the asset's unit.
    pub(crate) level_rms: f64,
}

impl PlayedSurface {
    /// Makes a surface that the representation of `model` plays.
    pub(crate) fn new(
        scene: &Scene,
        required: &Requirements,
        surface: usize,
        model: &str,
    ) -> Result<Self, SceneError> {
        let (asset, touch) = (&scene.assets[surface], &required.touches[surface]);
        let measure = scene.file.budget.error;
        let representation =
            asset.representation(model).map_err(SceneError::for_surface(surface, scene))?;
        let stored = representation.data();
        let conditions =
            representation.conditions().map_err(SceneError::for_surface(surface, scene))?;
        let loaded = representation.model().map_err(SceneError::for_surface(surface, scene))?;
        let mut played = Self {
            surface,
            model: model.to_owned(),
            error_db: stored.error_db(measure),
            largest_error_db: stored.largest_error_db(measure),
            known: stored.at.len(),
            conditions: Arc::new(conditions),
            frequency: Span::NONE,
            level: Span::NONE,
            follows_motion: loaded.follows_motion(),
            fluctuation: asset.manifest().fluctuation.filter(|f| !f.is_zero()),
            speed_mm_s: touch.speed_mm_s,
            force_n: touch.force_n,
            always_touched: touch.always,
            share: touch.share,
            start: touch.first.map(|finger| finger.without_direction()),
            rate_hz: 0.0,
            own_rate: false,
            oversampling: 1.0,
            mix_rate_hz: 0.0,
            voice_top_hz: asset.band().high_hz,
            top_hz: asset.band().high_hz,
            fixed_ratio: required.pitch,
            fixed_gain: 1.0,
            gain: scene.file.surfaces[surface].gain,
            level_rms: 0.0,
        };
        // The order matters: the rate of the source depends on the frequency factors, and its level
        // on the gain.
        played.find_factors(scene, touch);
        played.scale_frequencies();
        let most_gain = played.scale_level();
        let source =
            played.source(scene, required).map_err(SceneError::for_surface(surface, scene))?;
        played.rate_hz = source.rate_hz();
        played.divide_rate(required.rate_hz);
        played.own_rate = source.has_own_rate() && played.oversampling == 1.0;
        played.mix_rate_hz = played.rate_hz * played.oversampling;
        let shape = played
            .compensated(required, representation)
            .map_err(SceneError::for_surface(surface, scene))?;
        let levels = stored.at.iter().map(|at| at.level_rms);
        let loudest = levels.fold(source.level_rms(), f64::max);
        played.level_rms = loudest * played.gain * most_gain * shape;
        Ok(played)
    }

    /// Makes the surface's voice. If the model can render at any rate, the rate is chosen such that
    /// no conversion is needed after frequency scaling. If there is a compensation, the rate is
    /// chosen such that the compensation's filter is short.
    pub(crate) fn source(
        &self,
        scene: &Scene,
        required: &Requirements,
    ) -> Result<SampleSource, htex_play::Error> {
        let mut wanted_hz = required.rate_hz / (self.fixed_ratio * self.oversampling);
        if required.compensation.is_some() {
            wanted_hz = wanted_hz.min(FILTERED_OVERSAMPLING * self.top_hz);
        }
        scene.assets[self.surface].representation(&self.model[..])?.source(
            &VoiceOptions::default()
                .with_rate_hz(wanted_hz)
                // Surfaces of one asset must not play the same noise: cross-fades assume that they
                // are uncorrelated.
                .with_seed(required.seed.wrapping_add(self.surface as u64))
                .with_motion(self.start),
        )
    }

    /// Finds the frequency and level factors of all motions on the surface, for the effects that
    /// are not off.
    fn find_factors(&mut self, scene: &Scene, touch: &Touch) {
        let is_on = |effect| scene.file.effects.get(&effect) != Some(&Switch::Off);
        let range = self.conditions.range();
        let follows = self.follows_motion;
        let moves_frequencies =
            is_on(Effect::FrequencyScaling) && !follows && range.moves_frequencies();
        let moves_level = is_on(Effect::LevelScaling) && !follows && range.moves_level();
        // A live scene has no list of motions.
        if touch.speed_mm_s == Span::ANY {
            self.frequency = if moves_frequencies { Span::ANY } else { Span::ONE };
            self.level = if moves_level { Span::ANY } else { Span::ONE };
            return;
        }
        for motion in &touch.motions {
            let Scaling { frequency, level } = self.conditions.scaling(*motion, CEILING);
            self.frequency.include(if moves_frequencies { frequency } else { 1.0 });
            self.level.include(if moves_level { level } else { 1.0 });
        }
    }

    /// Applies the frequency factor to the rates. The resampler applies a constant factor; a warp
    /// applies a changing factor.
    fn scale_frequencies(&mut self) {
        if self.frequency.is_point() {
            self.fixed_ratio *= self.frequency.only();
            return;
        }
        let fastest =
            if self.frequency.high.is_finite() { self.frequency.high } else { LIVE_RATIO };
        self.oversampling = fastest.ceil().max(1.0);
        self.top_hz *= fastest.max(1.0);
    }

    /// If the speed changes, increases the oversampling until the rate is an integer fraction of
    /// the device's rate. A conversion by an integer factor takes much less time than other
    /// conversions.
    fn divide_rate(&mut self, device_hz: f64) {
        // At least one part is required, because the rate must not exceed the device's rate.
        let parts = (device_hz / (self.rate_hz * self.fixed_ratio * self.oversampling)).floor();
        if self.oversampling > 1.0 && parts >= 1.0 {
            self.oversampling = device_hz / parts / (self.rate_hz * self.fixed_ratio);
        }
    }

    /// Applies a constant level factor to the gain, and returns 1. Returns the largest factor if
    /// the factor changes.
    fn scale_level(&mut self) -> f64 {
        if self.level.is_point() {
            self.fixed_gain = self.level.only();
            self.gain *= self.fixed_gain;
            return 1.0;
        }
        if self.level.high.is_finite() { self.level.high } else { LIVE_GAIN }
    }

    /// Returns the ratio of the RMS after compensation to the RMS before it.
    fn compensated(
        &self,
        required: &Requirements,
        representation: Representation<'_>,
    ) -> Result<f64, htex_play::Error> {
        let Some(inverse) = &required.compensation else {
            return Ok(1.0);
        };
        let band = representation.texture().band();
        let grid = band.grid_hz();
        let magnitude = representation.recorded_magnitude(self.start, &grid)?;
        let sum = |gain: &dyn Fn(f64) -> f64| {
            let one = |(m, f): (&f64, &f64)| (m * gain(*f)).powi(2);
            magnitude.iter().zip(&grid).map(one).sum::<f64>()
        };
        let before = sum(&|_| 1.0);
        let behind = sum(&|hz| inverse.gain_at(hz * self.fixed_ratio));
        Ok(if before > 0.0 { (behind / before).sqrt() } else { 1.0 })
    }
}
