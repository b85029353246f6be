//! Options of a voice.

use htex_host::Synthesis;

use crate::Motion;
use crate::exploration::{CEILING, Effects};

/// Options for making a voice.
///
/// ```
/// use htex::{Motion, VoiceOptions};
/// let options = VoiceOptions::default()
///     .with_rate_hz(48_000.0)
///     .with_motion(Motion::new(80.0, 0.4))
///     .with_seed(7);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct VoiceOptions {
    pub(crate) rate_hz: f64,
    pub(crate) seed: u64,
    pub(crate) motion: Option<Motion>,
    pub(crate) synthesis: Synthesis,
    pub(crate) effects: Effects,
    pub(crate) ceiling: f64,
    pub(crate) gain: f64,
    pub(crate) limit: Option<f64>,
    pub(crate) envelope_bands: usize,
    pub(crate) fluctuation: bool,
}

impl Default for VoiceOptions {
    /// The defaults: 20 kHz (the paper's rate), seed 0, the motion of the default condition,
    /// streamed synthesis, all effects, a ceiling of 4 times the strongest recorded level, a gain
    /// of 1, no limit, no envelope and no fluctuation.
    fn default() -> Self {
        Self {
            rate_hz: 20_000.0,
            seed: 0,
            motion: None,
            synthesis: Synthesis::Streamed,
            effects: Effects::default(),
            ceiling: CEILING,
            gain: 1.0,
            limit: None,
            envelope_bands: 0,
            fluctuation: false,
        }
    }
}

impl VoiceOptions {
    /// Sets the sample rate, hertz: at least twice the highest frequency of the texture, at most 10
    /// MHz.
    #[must_use]
    pub fn with_rate_hz(mut self, rate_hz: f64) -> Self {
        self.rate_hz = rate_hz;
        self
    }

    /// Sets the seed of the noise and phases. Voices with equal seeds produce equal samples.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Sets the motion at the start; `None` selects the default condition
    /// ([`Representation::default_condition`](crate::Representation::default_condition)).
    #[must_use]
    pub fn with_motion(mut self, motion: impl Into<Option<Motion>>) -> Self {
        self.motion = motion.into();
        self
    }

    /// Sets how the samples are made. Either the model itself renders them, or a cheaper method
    /// renders them with a constant spectrum. A [`SampleSource`](crate::SampleSource) is always
    /// streamed.
    #[must_use]
    pub fn with_synthesis(mut self, synthesis: Synthesis) -> Self {
        self.synthesis = synthesis;
        self
    }

    /// Sets the ceiling of the level at motions outside the recorded range, as a multiple of the
    /// strongest recorded level. The ceiling must be above 0 and finite. The ceiling limits how far
    /// a motion can raise the level, but it never lowers a recorded level.
    #[must_use]
    pub fn with_ceiling(mut self, ceiling: f64) -> Self {
        self.ceiling = ceiling;
        self
    }

    /// Sets the initial gain of the samples, which must not be negative.
    /// [`Voice::set_gain`](crate::Voice::set_gain) changes it later.
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.gain = gain;
        self
    }

    /// Sets a limit for the absolute value of samples after the gain, in the asset's unit; above 0.
    /// When a sample would exceed the limit, a limiter reduces the gain at once. The gain then
    /// recovers with a time constant of 50 ms. `None` means no limit.
    #[must_use]
    pub fn with_limit(mut self, limit: impl Into<Option<f64>>) -> Self {
        self.limit = limit.into();
        self
    }

    /// Sets the number of bands in [`Voice::envelope`](crate::Voice::envelope), 1 to 32. The number
    /// may also be 0: the voice then computes no envelope.
    #[must_use]
    pub fn with_envelope_bands(mut self, bands: usize) -> Self {
        self.envelope_bands = bands;
        self
    }

    /// Sets whether the texture becomes stronger and weaker in time as its recording did. This
    /// works only if the asset states the strength of the fluctuation
    /// ([`htex_format::Fluctuation`]). By default the noise is stationary. The fluctuation does not
    /// change the mean square of the samples. Nobody has tested yet whether this fluctuation makes
    /// a texture feel more real. A [`SampleSource`](crate::SampleSource) ignores this option.
    #[must_use]
    pub fn with_fluctuation(mut self, fluctuation: bool) -> Self {
        self.fluctuation = fluctuation;
        self
    }

    /// Sets which effects the finger's motion has on the voice. A
    /// [`SampleSource`](crate::SampleSource) ignores these effects.
    #[must_use]
    pub fn with_effects(mut self, effects: Effects) -> Self {
        self.effects = effects;
        self
    }
}
