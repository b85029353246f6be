//! Departures of simulated hands and surfaces from the law of a rigid relief.
//!
//! If a finger slides over a rigid relief, the frequencies are proportional to the speed, and the
//! level of the friction is proportional to the normal force. Recorded textures depart from both
//! rules. On four materials at three speeds, the level rose with the speed to the power of 0.69 to
//! 0.82. The level changed with the normal force to a power between -0.07 and 2.6. When a tool
//! slides over a surface, the frequencies of the tool's acceleration do not depend on the speed. A
//! method that assumes a rigid relief must also be tested on other surfaces; tests on rigid reliefs
//! would not show where the method fails.

use htex_dsp::normal::Normal;

use super::check_range;
use super::hand::Finger;
use crate::AuthorError;

/// The motion at which departures have no effect: the paper's recording condition, in mm/s and
/// newtons.
const SPEED_MM_S: f64 = 80.0;
const FORCE_N: f64 = 0.4;
/// Speed below which exponents do not apply, mm/s. A turning finger slides more slowly than this.
const SLOWEST_MM_S: f64 = 1.0;
/// Shortest and longest time off the surface, s, and the duration of a touchdown, s.
const LIFTED_S: [f64; 2] = [0.05, 0.25];
const TOUCHDOWN_S: f64 = 0.01;

/// How a simulated surface and hand differ from the ideal case: a rigid relief and a steady hand.
/// By default, there is no difference. The exponents scale the texture relative to 80 mm/s and 0.4
/// N.
///
/// ```
/// use htex_author::simulate::{Departures, SimulationOptions, Surface, simulate};
///
/// let tool = Departures::default().with_frequency_speed(0.0).with_level_speed(0.4);
/// let options = SimulationOptions::new(Surface::Vinyl).with_duration_s(1.0).with_departures(tool);
/// assert_eq!(simulate(&options)?.t_s.len(), 20_000);
/// # Ok::<(), htex_author::AuthorError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Departures {
    /// Exponent with which frequencies follow the speed, -0.5 to 2. The exponent is 1 for a rigid
    /// relief, and 0 if frequencies do not depend on the speed.
    pub frequency_speed: f64,
    /// Exponent with which the texture's level follows the speed, -2 to 2. The exponent is 0 for a
    /// rigid relief.
    pub level_speed: f64,
    /// Exponent with which the texture's level follows the normal force, -1 to 3. The exponent is 1
    /// for friction.
    pub level_force: f64,
    /// Drift of the texture's level during the recording, -60 to 60 dB per minute.
    pub drift_db_per_min: f64,
    /// Fraction of the time in which the finger is off the surface, 0 to 0.8. Each lift lasts 50 to
    /// 250 ms.
    pub lifted: f64,
}

impl Default for Departures {
    fn default() -> Self {
        Self {
            frequency_speed: 1.0,
            level_speed: 0.0,
            level_force: 1.0,
            drift_db_per_min: 0.0,
            lifted: 0.0,
        }
    }
}

impl Departures {
    /// Sets the exponent with which frequencies follow the speed.
    #[must_use]
    pub const fn with_frequency_speed(self, frequency_speed: f64) -> Self {
        Self { frequency_speed, ..self }
    }

    /// Sets the exponent with which the level follows the speed.
    #[must_use]
    pub const fn with_level_speed(self, level_speed: f64) -> Self {
        Self { level_speed, ..self }
    }

    /// Returns the factor between the texture's level and the level of a relief whose level is
    /// proportional to the force.
    #[must_use]
    pub const fn with_level_force(self, level_force: f64) -> Self {
        Self { level_force, ..self }
    }

    /// Sets the drift of the level, decibels per minute.
    #[must_use]
    pub const fn with_drift_db_per_min(self, drift_db_per_min: f64) -> Self {
        Self { drift_db_per_min, ..self }
    }

    /// Sets the fraction of the time in which the finger is off the surface.
    #[must_use]
    pub const fn with_lifted(self, lifted: f64) -> Self {
        Self { lifted, ..self }
    }

    pub(super) fn check(&self) -> Result<(), AuthorError> {
        let mut ranges = [
            ("frequency_speed", self.frequency_speed, -0.5, 2.0),
            ("level_speed", self.level_speed, -2.0, 2.0),
            ("level_force", self.level_force, -1.0, 3.0),
            ("drift_db_per_min", self.drift_db_per_min, -60.0, 60.0),
            ("lifted", self.lifted, 0.0, 0.8),
        ]
        .into_iter();
        ranges.try_for_each(|(option, value, low, high)| check_range(option, value, low, high))
    }

    /// Whether the spectrum at one speed and force stays the same throughout the recording.
    pub(super) fn is_steady(&self) -> bool {
        self.drift_db_per_min == 0.0 && self.lifted == 0.0
    }

    /// Returns the factor of the texture's level, relative to a relief whose level is proportional
    /// to the force.
    pub(super) fn level(&self, speed_mm_s: f64, force_n: f64) -> f64 {
        power(speed_mm_s.max(SLOWEST_MM_S) / SPEED_MM_S, self.level_speed)
            * power(force_n / FORCE_N, self.level_force - 1.0)
    }

    /// Returns the speed at which the relief is read, mm/s.
    pub(super) fn pace_mm_s(&self, speed_mm_s: f64) -> f64 {
        if self.frequency_speed == 1.0 {
            return speed_mm_s;
        }
        SPEED_MM_S * power(speed_mm_s.max(SLOWEST_MM_S) / SPEED_MM_S, self.frequency_speed)
    }

    /// Describes the departures for the header of a file, each after a comma; empty if there are
    /// none.
    pub(super) fn description(&self) -> String {
        let usual = Self::default();
        let parts = [
            ("frequency ~ speed^", self.frequency_speed, usual.frequency_speed, ""),
            ("level ~ speed^", self.level_speed, usual.level_speed, ""),
            ("level ~ force^", self.level_force, usual.level_force, ""),
            ("drift ", self.drift_db_per_min, usual.drift_db_per_min, " dB/min"),
            ("lifted ", self.lifted, usual.lifted, " of the time"),
        ];
        let departs = parts.into_iter().filter(|(_, value, usual, _)| value != usual);
        departs.map(|(name, value, _, unit)| format!(", {name}{value}{unit}")).collect()
    }
}

/// Returns a power, with a short cut for the common exponent 0.
fn power(base: f64, exponent: f64) -> f64 {
    if exponent == 0.0 {
        return 1.0;
    }
    // At zero force there is no texture, whatever the exponent.
    libm::pow(base.max(1e-9), exponent)
}

/// Changes during a recording: the drifting level of the texture, and the lifting finger.
pub(super) struct Course {
    departures: Departures,
    step_s: f64,
    time_s: f64,
    random: Normal,
    /// Duration of the present contact and of the lift after it, s, and the time since the contact
    /// began.
    contact_s: f64,
    lifted_s: f64,
    since_s: f64,
}

impl Course {
    pub(super) fn new(departures: Departures, rate_hz: f64, random: Normal) -> Self {
        let mut course = Self {
            departures,
            step_s: 1.0 / rate_hz,
            time_s: 0.0,
            random,
            contact_s: f64::INFINITY,
            lifted_s: 0.0,
            since_s: 0.0,
        };
        course.begin_contact();
        course
    }

    /// Reduces the finger's force while the finger is off the surface. Returns the factor of the
    /// texture: its level at this speed and force, times the drift.
    pub(super) fn tick(&mut self, finger: &mut Finger) -> f64 {
        self.time_s += self.step_s;
        self.since_s += self.step_s;
        if self.since_s >= self.contact_s + self.lifted_s {
            self.begin_contact();
        }
        finger.normal_n *= self.touch();
        let speed = libm::hypot(finger.along_mm_s, finger.across_mm_s);
        let drift_db = self.departures.drift_db_per_min * self.time_s / 60.0;
        self.departures.level(speed, finger.normal_n) * power(10.0, drift_db / 20.0)
    }

    /// Draws random durations for the next contact and the lift after it.
    fn begin_contact(&mut self) {
        self.since_s = 0.0;
        let lifted = self.departures.lifted;
        if lifted == 0.0 {
            return;
        }
        let mut draw = |low: f64, high: f64| low + (high - low) * self.random.next_unit();
        self.lifted_s = draw(LIFTED_S[0], LIFTED_S[1]);
        // With contacts of this mean duration, the finger is off the surface for the given fraction
        // of the time.
        let mean_s = 0.5 * (LIFTED_S[0] + LIFTED_S[1]) * (1.0 - lifted) / lifted;
        self.contact_s = draw(0.5 * mean_s, 1.5 * mean_s);
    }

    /// Returns the fraction of the force that acts: 1 in contact, 0 off the surface.
    fn touch(&self) -> f64 {
        if self.contact_s.is_infinite() {
            return 1.0;
        }
        let inside = self.since_s.min(self.contact_s - self.since_s);
        (inside / TOUCHDOWN_S).clamp(0.0, 1.0)
    }
}
