//! A recording of a finger sliding on a surface, in physical units.

use htex_base::finding::{Finding, Notice};
use htex_format::Quantity;
use thiserror::Error;

use crate::hash::RecordedFile;

/// Highest sample rate of a recording, hertz. No force sensor is faster, and at this rate the
/// number of samples in a recording can still be computed exactly.
pub const MAX_RATE_HZ: f64 = 1e9;
/// Largest magnitude of a sample, in any unit. It keeps sums of squares over hours finite.
const LARGEST: f64 = 1e12;

/// The reason why a recording cannot be constructed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The rate is zero, negative, NaN, or above [`MAX_RATE_HZ`].
    #[error("the sample rate is {rate_hz} Hz; it must be above 0 and at most {MAX_RATE_HZ} Hz")]
    Rate { rate_hz: f64 },
    /// There are no axes, or more axes than the quantity can have.
    #[error("a recording of a {} has 1 to {} axes, this one has {axes}", .quantity.words(), most_axes(*.quantity))]
    Axes { quantity: Quantity, axes: usize },
    /// There are fewer than two samples.
    #[error("a recording needs at least 2 samples, this one has {samples}")]
    TooShort { samples: usize },
    /// There are fewer than two samples between the two given times.
    #[error(
        "from {from_s} to {to_s} s there are fewer than 2 samples; the recording runs from {begins_s:.3} to {ends_s:.3} s"
    )]
    Between { from_s: f64, to_s: f64, begins_s: f64, ends_s: f64 },
    /// A signal and the first axis differ in length.
    #[error(
        "the {signal} has {got} samples, the first axis has {expected}; all signals must be equally long"
    )]
    Lengths { signal: &'static str, expected: usize, got: usize },
    /// The magnitude of a sample exceeds 1e12.
    #[error(
        "the {signal} is {value} at sample {sample} (counted from 0), and no recording goes beyond {LARGEST}; correct its unit"
    )]
    TooLarge {
        signal: &'static str,
        /// Index of the sample, counted from 0.
        sample: usize,
        value: f64,
    },
    /// A sample is NaN or infinite.
    #[error(
        "the {signal} is {value} at sample {sample} (counted from 0); repair or cut the recording there"
    )]
    NotFinite {
        signal: &'static str,
        /// Index of the sample, counted from 0.
        sample: usize,
        value: f64,
    },
}

/// A recording: the texture's signal, such as the lateral force, and optionally the normal force
/// and the sliding speed.
///
/// All signals have the same length of at least two samples. Their values are finite, with
/// magnitudes up to 1e12.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// File name without its directory, for messages and provenance.
    pub source: String,
    /// The file that the recording was read from. An asset's provenance stores the hash of this
    /// file.
    pub file: RecordedFile,
    /// Samples per second of every signal, hertz.
    pub rate_hz: f64,
    /// Quantity of the axes.
    pub quantity: Quantity,
    /// The texture's signal in the quantity's unit, one list of samples for each axis. The axes are
    /// perpendicular. A lateral force has one or two axes, a normal force has one, and an
    /// acceleration, velocity or displacement has up to three.
    pub axes: Vec<Vec<f64>>,
    /// Normal force, newtons, with a positive mean.
    pub normal_n: Option<Vec<f64>>,
    /// Sliding speed of each sample, mm/s.
    pub speed_mm_s: Option<Vec<f64>>,
    /// True if the file states that a simulator made the recording instead of a finger.
    pub simulated: bool,
    /// Number of samples in the file before the first sample of this recording.
    pub first_sample: usize,
    /// Findings about the time column: gaps, jitter.
    pub clock_findings: Vec<Finding>,
    /// The reader's assumptions and observations, each a full sentence.
    pub warnings: Vec<Notice>,
}

impl Recording {
    /// Creates a recording of a lateral force with one or two axes, in newtons.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::from_axes`].
    ///
    /// ```
    /// # use htex_recording::Recording;
    /// let recording = Recording::new("tap.csv", 1000.0, vec![vec![0.1, 0.2, 0.1]])?;
    /// assert_eq!(recording.samples(), 3);
    /// assert_eq!(recording.duration_s(), 0.003);
    /// # Ok::<(), htex_recording::RecordingError>(())
    /// ```
    pub fn new(
        source: impl Into<String>,
        rate_hz: f64,
        axes: Vec<Vec<f64>>,
    ) -> Result<Self, RecordingError> {
        Self::from_axes(Quantity::LateralForce, source, rate_hz, axes)
    }

    /// Creates a recording without normal force, speed or warnings. `axes` are in the quantity's
    /// unit.
    ///
    /// # Errors
    /// Returns an error if the rate is not above 0 or exceeds [`MAX_RATE_HZ`], if there are no
    /// axes, or if there are more axes than the quantity can have. Also returns an error if the
    /// axes have fewer than two samples, differ in length, or contain NaN, infinity or a magnitude
    /// above 1e12.
    ///
    /// ```
    /// # use htex_recording::Recording;
    /// # use htex_format::Quantity;
    /// let axes = vec![vec![0.1, -0.2], vec![0.0, 0.3], vec![9.8, 9.9]];
    /// let tool = Recording::from_axes(Quantity::Acceleration, "tool.csv", 10_000.0, axes)?;
    /// assert_eq!((tool.axes.len(), tool.quantity.unit()), (3, "m/s2"));
    /// # Ok::<(), htex_recording::RecordingError>(())
    /// ```
    pub fn from_axes(
        quantity: Quantity,
        source: impl Into<String>,
        rate_hz: f64,
        axes: Vec<Vec<f64>>,
    ) -> Result<Self, RecordingError> {
        check_rate(rate_hz)?;
        if !(1..=most_axes(quantity)).contains(&axes.len()) {
            let axes = axes.len();
            return Err(RecordingError::Axes { quantity, axes });
        }
        let samples = axes[0].len();
        if samples < 2 {
            return Err(RecordingError::TooShort { samples });
        }
        for axis in &axes {
            check(quantity.words(), axis, samples)?;
        }
        Ok(Self {
            source: source.into(),
            file: RecordedFile::default(),
            rate_hz,
            quantity,
            axes,
            normal_n: None,
            speed_mm_s: None,
            simulated: false,
            first_sample: 0,
            clock_findings: Vec::new(),
            warnings: Vec::new(),
        })
    }

    /// Adds the normal force, newtons. Some sensors report pressing as negative. Therefore, all
    /// samples change sign if the mean of the force is negative.
    ///
    /// # Errors
    /// Returns an error if the signal differs in length from the axes, or a value is not finite or
    /// exceeds 1e12 in magnitude.
    pub fn with_normal(mut self, mut normal_n: Vec<f64>) -> Result<Self, RecordingError> {
        check("normal force", &normal_n, self.samples())?;
        // The sum decides, not the first sample, because noise may make some samples negative.
        if normal_n.iter().sum::<f64>() < 0.0 {
            normal_n.iter_mut().for_each(|force| *force = -*force);
        }
        self.normal_n = Some(normal_n);
        Ok(self)
    }

    /// Adds the sliding speed of each sample, mm/s.
    ///
    /// # Errors
    /// Returns an error if the signal differs in length from the axes, or a value is not finite or
    /// exceeds 1e12 in magnitude.
    pub fn with_speed(mut self, speed_mm_s: Vec<f64>) -> Result<Self, RecordingError> {
        check("speed", &speed_mm_s, self.samples())?;
        self.speed_mm_s = Some(speed_mm_s);
        Ok(self)
    }

    /// Returns the part of the recording between two times, in seconds after the file's first
    /// sample. `None` stands for the start or the end of this recording. The part keeps all
    /// findings about the time column.
    ///
    /// # Errors
    /// Returns an error if a time is not finite, or there are fewer than two samples between the
    /// times.
    ///
    /// ```
    /// # use htex_recording::Recording;
    /// let recording = Recording::new("tap.csv", 10.0, vec![vec![0.1, 0.2, 0.3, 0.4]])?;
    /// let part = recording.between(Some(0.1), Some(0.3))?;
    /// assert_eq!((part.first_sample, &part.axes[0][..]), (1, &[0.2, 0.3][..]));
    /// # Ok::<(), htex_recording::RecordingError>(())
    /// ```
    pub fn between(
        mut self,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> Result<Self, RecordingError> {
        let sample = |second: f64| {
            // Times count from the start of the file. This recording may already be only a part of
            // it.
            let at = (second * self.rate_hz).round() - self.first_sample as f64;
            at.clamp(0.0, self.samples() as f64) as usize
        };
        let from = from_s.map_or(0, sample);
        let to = to_s.map_or(self.samples(), sample);
        let times_are_finite = [from_s, to_s].into_iter().flatten().all(f64::is_finite);
        if !times_are_finite || to < from.saturating_add(2) {
            return Err(RecordingError::Between {
                from_s: from_s.unwrap_or(self.second(0)),
                to_s: to_s.unwrap_or(self.second(self.samples())),
                begins_s: self.second(0),
                ends_s: self.second(self.samples()),
            });
        }
        self.keep(from, to);
        Ok(self)
    }

    /// Keeps the samples from `from` up to but not including `to`; both must be at most the number
    /// of samples.
    pub(crate) fn keep(&mut self, from: usize, to: usize) {
        let (normal, speed) = (&mut self.normal_n, &mut self.speed_mm_s);
        for signal in self.axes.iter_mut().chain(normal).chain(speed) {
            signal.truncate(to);
            signal.drain(..from);
        }
        self.first_sample += from;
    }

    /// Returns the time of a sample in seconds after the file's first sample. `sample` is the index
    /// in this recording, which may be only a part of the file.
    #[must_use]
    pub fn second(&self, sample: usize) -> f64 {
        (self.first_sample + sample) as f64 / self.rate_hz
    }

    /// Returns the magnitude of the signal at a sample: the length of the vector formed by the
    /// values of all axes.
    #[must_use]
    pub fn magnitude_at(&self, sample: usize) -> f64 {
        let square = |axis: &Vec<f64>| axis[sample] * axis[sample];
        match &self.axes[..] {
            [axis] => axis[sample].abs(),
            axes => axes.iter().map(square).sum::<f64>().sqrt(),
        }
    }

    /// Returns the name of an axis, such as `lateral_x` or `signal`. Messages use this name, and
    /// findings use it to point to a place.
    #[must_use]
    pub fn axis_name(&self, axis: usize) -> &'static str {
        let names = match self.quantity {
            Quantity::LateralForce => ["lateral", "lateral_x", "lateral_y", "lateral_z"],
            Quantity::NormalForce => ["normal"; 4],
            _ => ["signal", "signal_x", "signal_y", "signal_z"],
        };
        match self.axes.len() {
            1 => names[0],
            _ => names[(axis + 1).min(3)],
        }
    }

    /// Returns the number of samples in each signal, at least 2.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.axes.first().map_or(0, Vec::len)
    }

    /// Returns the length in seconds: number of samples divided by the sample rate.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.samples() as f64 / self.rate_hz
    }
}

/// Returns the largest number of axes of a quantity: two for a lateral force, one for a normal
/// force, three for an acceleration, velocity or displacement.
pub(crate) const fn most_axes(quantity: Quantity) -> usize {
    match quantity {
        Quantity::LateralForce => 2,
        Quantity::NormalForce => 1,
        Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement => 3,
    }
}

/// Checks that a sample rate is in range.
pub(crate) fn check_rate(rate_hz: f64) -> Result<(), RecordingError> {
    if rate_hz > 0.0 && rate_hz <= MAX_RATE_HZ {
        Ok(())
    } else {
        Err(RecordingError::Rate { rate_hz })
    }
}

fn check(signal: &'static str, values: &[f64], expected: usize) -> Result<(), RecordingError> {
    if values.len() != expected {
        return Err(RecordingError::Lengths { signal, expected, got: values.len() });
    }
    // NaN compares as false, so it does not pass.
    let holds = |value: &f64| value.abs() <= LARGEST;
    match values.iter().position(|value| !holds(value)) {
        Some(sample) if values[sample].is_finite() => {
            Err(RecordingError::TooLarge { signal, sample, value: values[sample] })
        }
        Some(sample) => Err(RecordingError::NotFinite { signal, sample, value: values[sample] }),
        None => Ok(()),
    }
}
