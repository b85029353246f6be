//! One recording of a finger sliding on a surface, in physical units.

use htex_format::{Finding, Quantity};
use thiserror::Error;

/// Highest sample rate, hertz: no force sensor is as fast, and counts of samples stay numbers.
pub const MAX_RATE_HZ: f64 = 1e9;
/// Largest number of a recording, in any unit: its square, summed over hours, is still a number.
const LARGEST: f64 = 1e12;

/// Why a set of columns is not a recording.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RecordingError {
    /// The rate is zero, negative, NaN, or above [`MAX_RATE_HZ`].
    #[error("the sample rate is {rate_hz} Hz; it must be above 0 and at most {MAX_RATE_HZ} Hz")]
    Rate {
        /// The rate that was given.
        rate_hz: f64,
    },
    /// More axes than the quantity has, or none.
    #[error("a recording of a {} has 1 to {} axes, this one has {axes}", .quantity.words(), most_axes(*.quantity))]
    Axes {
        /// What is recorded.
        quantity: Quantity,
        /// How many axes were given.
        axes: usize,
    },
    /// Fewer than two samples.
    #[error("a recording needs at least 2 samples, this one has {samples}")]
    TooShort {
        /// How many samples were given.
        samples: usize,
    },
    /// A range with fewer than two samples in it.
    #[error(
        "from {from_s} to {to_s} s there are fewer than 2 samples; the recording runs from {begins_s:.3} to {ends_s:.3} s"
    )]
    Between {
        /// Where the range begins, seconds.
        from_s: f64,
        /// Where it ends, seconds.
        to_s: f64,
        /// Where the recording begins, seconds.
        begins_s: f64,
        /// Where it ends, seconds.
        ends_s: f64,
    },
    /// A signal is not as long as the first axis.
    #[error(
        "the {signal} has {got} samples, the first axis has {expected}; all signals must be equally long"
    )]
    Lengths {
        /// Which signal.
        signal: &'static str,
        /// Samples of the first axis.
        expected: usize,
        /// Samples of this signal.
        got: usize,
    },
    /// A sample is larger than any recording's.
    #[error(
        "the {signal} is {value} at sample {sample} (counted from 0), and no recording goes beyond {LARGEST}; correct its unit"
    )]
    TooLarge {
        /// Which signal.
        signal: &'static str,
        /// Index from 0.
        sample: usize,
        /// What it is.
        value: f64,
    },
    /// A sample is NaN or infinite.
    #[error(
        "the {signal} is {value} at sample {sample} (counted from 0); repair or cut the recording there"
    )]
    NotFinite {
        /// Which signal.
        signal: &'static str,
        /// Index from 0.
        sample: usize,
        /// NaN or an infinity.
        value: f64,
    },
}

/// A recording: the texture's signal, such as the lateral force, and what is known about how the finger pressed
/// and moved.
///
/// All signals are equally long, at least two samples, and finite, none beyond 1e12.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// File name without its directory, for messages and provenance.
    pub source: String,
    /// Samples per second of every signal, hertz.
    pub rate_hz: f64,
    /// What the axes are.
    pub quantity: Quantity,
    /// The signal in the quantity's unit: one axis, or perpendicular ones: two of a lateral force, up to three of
    /// an acceleration, velocity or displacement.
    pub axes: Vec<Vec<f64>>,
    /// Normal force, newtons, positive on the whole when the finger presses.
    pub normal_n: Option<Vec<f64>>,
    /// Sliding speed of each sample, mm/s.
    pub speed_mm_s: Option<Vec<f64>>,
    /// True when the file says that it comes from a simulator and not from a finger.
    pub simulated: bool,
    /// Samples of the file before the first of this recording.
    pub first_sample: usize,
    /// What the time column showed: gaps, unevenness.
    pub clock_findings: Vec<Finding>,
    /// What the reader had to assume or noticed; each a full sentence.
    pub warnings: Vec<String>,
}

impl Recording {
    /// A checked recording of a lateral force, one or two axes in newtons: [`Self::of`].
    ///
    /// # Errors
    /// As of [`Self::of`].
    ///
    /// ```
    /// # use htex_author::recording::Recording;
    /// let recording = Recording::new("tap.csv", 1000.0, vec![vec![0.1, 0.2, 0.1]])?;
    /// assert_eq!(recording.samples(), 3);
    /// assert_eq!(recording.duration_s(), 0.003);
    /// # Ok::<(), htex_author::recording::RecordingError>(())
    /// ```
    pub fn new(
        source: impl Into<String>,
        rate_hz: f64,
        axes: Vec<Vec<f64>>,
    ) -> Result<Self, RecordingError> {
        Self::of(Quantity::LateralForce, source, rate_hz, axes)
    }

    /// A checked recording without normal force, speed or warnings; `axes` are in the quantity's unit.
    ///
    /// # Errors
    /// When the rate is not above 0 and at most [`MAX_RATE_HZ`], there are no axes or more than the quantity
    /// has, or they are shorter than two samples, differ in length, or hold NaN or an infinity.
    ///
    /// ```
    /// # use htex_author::recording::Recording;
    /// # use htex_format::Quantity;
    /// let axes = vec![vec![0.1, -0.2], vec![0.0, 0.3], vec![9.8, 9.9]];
    /// let tool = Recording::of(Quantity::Acceleration, "tool.csv", 10_000.0, axes)?;
    /// assert_eq!((tool.axes.len(), tool.quantity.unit()), (3, "m/s2"));
    /// # Ok::<(), htex_author::recording::RecordingError>(())
    /// ```
    pub fn of(
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

    /// Adds the normal force, newtons; a force that is negative on average is turned round, so that
    /// pressing reads positive whichever way the sensor counts.
    ///
    /// # Errors
    /// When it differs in length from the axes or is not finite.
    pub fn with_normal(mut self, mut normal_n: Vec<f64>) -> Result<Self, RecordingError> {
        check("normal force", &normal_n, self.samples())?;
        if normal_n.iter().sum::<f64>() < 0.0 {
            normal_n.iter_mut().for_each(|force| *force = -*force);
        }
        self.normal_n = Some(normal_n);
        Ok(self)
    }

    /// Adds the sliding speed of each sample, mm/s.
    ///
    /// # Errors
    /// When it differs in length from the axes or is not finite.
    pub fn with_speed(mut self, speed_mm_s: Vec<f64>) -> Result<Self, RecordingError> {
        check("speed", &speed_mm_s, self.samples())?;
        self.speed_mm_s = Some(speed_mm_s);
        Ok(self)
    }

    /// The part of the recording between two times of its file, seconds; a side that is not given is left
    /// as it is. What was found of the clock stays.
    ///
    /// # Errors
    /// When a time is not finite, or fewer than two samples lie between them.
    ///
    /// ```
    /// # use htex_author::recording::Recording;
    /// let recording = Recording::new("tap.csv", 10.0, vec![vec![0.1, 0.2, 0.3, 0.4]])?;
    /// let part = recording.between(Some(0.1), Some(0.3))?;
    /// assert_eq!((part.first_sample, &part.axes[0][..]), (1, &[0.2, 0.3][..]));
    /// # Ok::<(), htex_author::recording::RecordingError>(())
    /// ```
    pub fn between(
        mut self,
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> Result<Self, RecordingError> {
        let sample = |second: f64| {
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
        let (normal, speed) = (&mut self.normal_n, &mut self.speed_mm_s);
        for signal in self.axes.iter_mut().chain(normal).chain(speed) {
            signal.truncate(to);
            signal.drain(..from);
        }
        self.first_sample += from;
        Ok(self)
    }

    /// Time of a sample in its file, seconds.
    #[must_use]
    pub fn second(&self, sample: usize) -> f64 {
        (self.first_sample + sample) as f64 / self.rate_hz
    }

    /// Length of the signal's vector at a sample.
    #[must_use]
    pub fn magnitude_at(&self, sample: usize) -> f64 {
        let square = |axis: &Vec<f64>| axis[sample] * axis[sample];
        match &self.axes[..] {
            [axis] => axis[sample].abs(),
            axes => axes.iter().map(square).sum::<f64>().sqrt(),
        }
    }

    /// An axis' name in pointers and messages: `lateral_x`, `signal`.
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

    /// Samples in each signal, at least 2.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.axes.first().map_or(0, Vec::len)
    }

    /// Length in seconds: samples over rate.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.samples() as f64 / self.rate_hz
    }
}

/// A force along a surface has two axes, one across it has one, and motions have three.
pub(crate) const fn most_axes(quantity: Quantity) -> usize {
    match quantity {
        Quantity::LateralForce => 2,
        Quantity::NormalForce => 1,
        Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement => 3,
    }
}

/// Refuses a rate that no recording has.
pub(crate) fn check_rate(rate_hz: f64) -> Result<(), RecordingError> {
    match rate_hz > 0.0 && rate_hz <= MAX_RATE_HZ {
        true => Ok(()),
        false => Err(RecordingError::Rate { rate_hz }),
    }
}

fn check(signal: &'static str, values: &[f64], expected: usize) -> Result<(), RecordingError> {
    if values.len() != expected {
        return Err(RecordingError::Lengths {
            signal,
            expected,
            got: values.len(),
        });
    }
    // False for NaN too.
    let holds = |value: &f64| value.abs() <= LARGEST;
    match values.iter().position(|value| !holds(value)) {
        Some(sample) if values[sample].is_finite() => Err(RecordingError::TooLarge {
            signal,
            sample,
            value: values[sample],
        }),
        Some(sample) => Err(RecordingError::NotFinite {
            signal,
            sample,
            value: values[sample],
        }),
        None => Ok(()),
    }
}
