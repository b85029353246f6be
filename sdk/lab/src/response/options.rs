//! Options of measuring a response.

use htex_base::finding::Hint;
use serde::Serialize;

use super::error::ResponseError;
use super::estimator::Estimator;

/// Smallest number of samples in a window.
const FEWEST_SAMPLES: f64 = 16.0;

/// Options of measuring a frequency response.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ResponseOptions {
    pub excitation: Excitation,
    pub estimator: Estimator,
    /// Length of a window, seconds. The frequency grid of the response is its inverse, hertz. With
    /// a multiple of 0.2 s, the grid contains all multiples of 5 Hz, the grid of texture spectra.
    pub window_s: f64,
    /// Lowest frequency of the response, hertz.
    pub low_hz: f64,
    /// Highest frequency of the response, hertz. If half the sample rate is lower, that is used
    /// instead.
    pub high_hz: f64,
    /// Magnitude of the input at which its sensor or amplifier is overloaded.
    pub input_limit: Option<f64>,
    /// The same for the output.
    pub output_limit: Option<f64>,
}

/// How the setup was excited.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Excitation {
    /// Separate hits of an impact hammer.
    Hits(HitOptions),
    /// A drive without pauses, such as noise or a sweep. It is cut into windows with half overlap.
    /// Each has its mean removed and is multiplied by a periodic Hann window.
    Continuous,
}

/// How hits are found and cut out.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HitOptions {
    /// Part of the window before the trigger, seconds. The mean of each channel in that part is
    /// removed.
    pub pre_trigger_s: f64,
    /// Level at which a hit starts, relative to the largest input of its recording. The level used
    /// is at least 8 times the noise.
    pub trigger: f64,
    /// Size of a second contact in the window, relative to the hit, from which the hit counts as a
    /// double hit. The size used is at least 8 times the noise.
    pub double: f64,
    /// Force window: the input is kept until this time after the trigger, seconds, and then fades
    /// to zero over a quarter of that time (half a cosine). It removes the noise of the input
    /// between hits.
    pub force_window_s: Option<f64>,
    /// Exponential window: both channels are multiplied by `exp(-t / this)` after the trigger,
    /// seconds. It forces responses that outlast the window to end, and raises their damping by its
    /// inverse, in 1/s.
    pub exponential_s: Option<f64>,
}

impl Default for HitOptions {
    fn default() -> Self {
        Self {
            pre_trigger_s: 0.02,
            trigger: 0.1,
            double: 0.1,
            force_window_s: None,
            exponential_s: None,
        }
    }
}

impl HitOptions {
    /// Sets the force window, seconds after the trigger.
    #[must_use]
    pub fn with_force_window_s(mut self, force_window_s: impl Into<Option<f64>>) -> Self {
        self.force_window_s = force_window_s.into();
        self
    }

    /// Sets the time constant of the exponential window, seconds.
    #[must_use]
    pub fn with_exponential_s(mut self, exponential_s: impl Into<Option<f64>>) -> Self {
        self.exponential_s = exponential_s.into();
        self
    }

    /// Sets the part of the window before the trigger, seconds.
    #[must_use]
    pub fn with_pre_trigger_s(mut self, pre_trigger_s: f64) -> Self {
        self.pre_trigger_s = pre_trigger_s;
        self
    }

    /// Sets the level of a hit (relative to the largest input) and of a second contact (relative to
    /// the hit).
    #[must_use]
    pub fn with_levels(mut self, trigger: f64, double: f64) -> Self {
        (self.trigger, self.double) = (trigger, double);
        self
    }
}

impl Default for ResponseOptions {
    /// Hits, H1, windows of 1 s, 20 to 1000 Hz.
    fn default() -> Self {
        Self {
            excitation: Excitation::Hits(HitOptions::default()),
            estimator: Estimator::H1,
            window_s: 1.0,
            low_hz: 20.0,
            high_hz: 1000.0,
            input_limit: None,
            output_limit: None,
        }
    }
}

impl ResponseOptions {
    #[must_use]
    pub fn with_excitation(mut self, excitation: Excitation) -> Self {
        self.excitation = excitation;
        self
    }

    #[must_use]
    pub fn with_estimator(mut self, estimator: Estimator) -> Self {
        self.estimator = estimator;
        self
    }

    /// Sets the length of a window, seconds.
    #[must_use]
    pub fn with_window_s(mut self, window_s: f64) -> Self {
        self.window_s = window_s;
        self
    }

    /// Sets the lowest and the highest frequency, hertz.
    #[must_use]
    pub fn with_band_hz(mut self, low_hz: f64, high_hz: f64) -> Self {
        (self.low_hz, self.high_hz) = (low_hz, high_hz);
        self
    }

    /// Sets the magnitudes at which input and output are overloaded.
    #[must_use]
    pub fn with_limits(
        mut self,
        input: impl Into<Option<f64>>,
        output: impl Into<Option<f64>>,
    ) -> Self {
        (self.input_limit, self.output_limit) = (input.into(), output.into());
        self
    }

    /// Returns the number of samples in a window. Refuses options with which no recording can be
    /// measured.
    pub(crate) fn check(&self, rate_hz: f64) -> Result<usize, ResponseError> {
        let samples = (self.window_s * rate_hz).round();
        let enough = format!("a window needs {FEWEST_SAMPLES} samples or more, at {rate_hz} Hz");
        require(
            ("the window (s)", Hint::new(&["window"])),
            self.window_s,
            (FEWEST_SAMPLES..1e15).contains(&samples),
            &enough,
        )?;
        let low = self.low_hz >= 0.0 && self.low_hz < rate_hz / 2.0;
        require(
            ("the lowest frequency (Hz)", Hint::new(&["low"])),
            self.low_hz,
            low,
            "it must be 0 or more, and below half of the sample rate",
        )?;
        let high = self.high_hz > self.low_hz && self.high_hz.is_finite();
        require(
            ("the highest frequency (Hz)", Hint::new(&["high"])),
            self.high_hz,
            high,
            "it must be finite and above the lowest",
        )?;
        positive(("the limit of the input", Hint::new(&["input_limit"])), self.input_limit)?;
        positive(("the limit of the output", Hint::new(&["output_limit"])), self.output_limit)?;
        if let Excitation::Hits(hits) = &self.excitation {
            hits.check(self.window_s)?;
        }
        Ok(samples as usize)
    }
}

impl HitOptions {
    fn check(&self, window_s: f64) -> Result<(), ResponseError> {
        let inside = (0.0..0.5 * window_s).contains(&self.pre_trigger_s);
        let half = "it must be 0 or more, and below half of the window";
        require(
            ("the time before the trigger (s)", Hint::new(&["pre_trigger"])),
            self.pre_trigger_s,
            inside,
            half,
        )?;
        for (option, level) in [
            (("the trigger", Hint::new(&["trigger"])), self.trigger),
            (("the level of a double hit", Hint::new(&["double"])), self.double),
        ] {
            require(
                option,
                level,
                level > 0.0 && level < 1.0,
                "it is relative and must be between 0 and 1",
            )?;
        }
        positive(("the force window (s)", Hint::new(&["force_window"])), self.force_window_s)?;
        positive(("the exponential window (s)", Hint::new(&["exponential"])), self.exponential_s)
    }
}

fn positive(option: (&'static str, Hint), value: Option<f64>) -> Result<(), ResponseError> {
    let value = value.unwrap_or(1.0);
    require(option, value, value.is_finite() && value > 0.0, "it must be finite and above 0")
}

fn require(
    (option, hint): (&'static str, Hint),
    value: f64,
    holds: bool,
    problem: &str,
) -> Result<(), ResponseError> {
    if holds {
        return Ok(());
    }
    let problem = problem.to_owned();
    Err(ResponseError::Option { option, hint, value, problem })
}
