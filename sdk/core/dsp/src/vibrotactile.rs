//! Perception of vibration by a fingertip: the smallest displacement that people detect, and the
//! impedance of the skin, which converts a force to a displacement.
//!
//! The threshold applies to a vibrating contactor with an area of 2.9 cm² on the hand's glabrous
//! skin. The threshold is constant up to 40 Hz, and then falls by 12 dB per octave to its smallest
//! value at 250 Hz, where the Pacinian channel is most sensitive (Verrillo 1963, *J. Acoust. Soc.
//! Am.* 35, 1962–1966, as summarised by Gescheider & Verrillo 1979). Above 250 Hz, the threshold
//! rises by 9 dB per octave (Verrillo 1966, *Psychonomic Science* 4, 135–136). The smallest
//! threshold is −20 dB re 1 µm, i.e. 0.1 µm peak (Bolanowski, Gescheider, Verrillo & Checkosky
//! 1988, *J. Acoust. Soc. Am.* 84, 1680–1694). The thresholds of different people differ by some 10
//! dB. At frequencies at which the Pacinian channel determines the threshold, each halving of the
//! contact's area raises the threshold by 3 dB.
//!
//! The authors of htex read only the abstracts of the two papers on slopes (Verrillo 1963, 1966).
//! The smallest threshold and the values of [`Skin`] are commonly quoted from the papers, rounded
//! to one or two digits. A laboratory that has measured its participants should use its own
//! [`Listener`].

/// Frequency up to which the threshold is constant, hertz.
const FLAT_HZ: f64 = 40.0;
/// Frequency of the smallest threshold, hertz.
const MOST_SENSITIVE_HZ: f64 = 250.0;
/// The smallest threshold, metres, peak.
const SMALLEST_THRESHOLD_M: f64 = 1e-7;
/// Exponents of the frequency in the threshold: −12 dB and +9 dB per octave.
const FALL: f64 = -2.0;
const RISE: f64 = 1.5;

/// Returns the detection threshold of a sinusoidal displacement, metres, peak. The frequency is in
/// hertz, above 0.
///
/// ```
/// use htex_dsp::vibrotactile::detection_threshold_m;
/// assert_eq!(detection_threshold_m(250.0), 1e-7);
/// assert!((detection_threshold_m(125.0) / 4e-7 - 1.0).abs() < 1e-12); // 12 dB an octave
/// assert_eq!(detection_threshold_m(20.0), detection_threshold_m(40.0));
/// ```
pub fn detection_threshold_m(frequency_hz: f64) -> f64 {
    let slope = if frequency_hz <= MOST_SENSITIVE_HZ { FALL } else { RISE };
    let ratio = frequency_hz.max(FLAT_HZ) / MOST_SENSITIVE_HZ;
    SMALLEST_THRESHOLD_M * libm::pow(ratio, slope)
}

/// Mechanical impedance of a fingertip for a force along the surface: a spring, a damper and a mass
/// in parallel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skin {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    /// Moving mass, kg.
    pub mass_kg: f64,
}

impl Default for Skin {
    /// A fingertip that is pressed with about 0.5 N: elastic up to about 100 Hz, and viscous above
    /// (Wiertlewski & Hayward 2012, *J. Biomech.* 45, 1869–1874, seven people, 20 to 500 Hz). The
    /// values are rounded. They differ between people and between forces by a factor of about two
    /// (6 dB).
    fn default() -> Self {
        Self { stiffness_n_m: 1_000.0, damping_n_s_m: 1.5, mass_kg: 1.5e-4 }
    }
}

impl Skin {
    /// Returns the displacement (metres) that a sinusoidal force of 1 N causes at a frequency
    /// (hertz).
    ///
    /// ```
    /// use htex_dsp::vibrotactile::Skin;
    /// let skin = Skin::default();
    /// assert!((skin.displacement_m(1.0) / 1e-3 - 1.0).abs() < 1e-3); // 1 mm a newton
    /// assert!(skin.displacement_m(500.0) < 0.3e-3);
    /// ```
    pub fn displacement_m(&self, frequency_hz: f64) -> f64 {
        let omega = 2.0 * core::f64::consts::PI * frequency_hz;
        let elastic = self.stiffness_n_m - self.mass_kg * omega * omega;
        1.0 / libm::hypot(elastic, self.damping_n_s_m * omega)
    }
}

/// A listener: the skin, and the detection threshold relative to [`detection_threshold_m`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Listener {
    /// Impedance of the fingertip.
    pub skin: Skin,
    /// Threshold relative to [`detection_threshold_m`], decibels; negative for a more sensitive
    /// listener.
    pub threshold_shift_db: f64,
}

impl Listener {
    /// A listener with more sensitive fingertips than most people: the threshold is 10 dB lower
    /// than usual, and the same force moves the skin twice as far.
    ///
    /// ```
    /// use htex_dsp::vibrotactile::Listener;
    /// let [typical, sensitive] = [Listener::default(), Listener::sensitive()];
    /// let sensation = |of: Listener| of.skin.displacement_m(250.0) / of.threshold_m(250.0);
    /// let gain = sensation(sensitive) / sensation(typical);
    /// assert!((20.0 * gain.log10() - 16.02).abs() < 0.01);
    /// ```
    #[must_use]
    pub fn sensitive() -> Self {
        let skin = Skin::default();
        Self {
            skin: Skin {
                stiffness_n_m: 0.5 * skin.stiffness_n_m,
                damping_n_s_m: 0.5 * skin.damping_n_s_m,
                mass_kg: 0.5 * skin.mass_kg,
            },
            threshold_shift_db: -10.0,
        }
    }

    /// Returns this listener's detection threshold (metres, peak) at a frequency (hertz, above 0).
    pub fn threshold_m(&self, frequency_hz: f64) -> f64 {
        detection_threshold_m(frequency_hz) * libm::pow(10.0, self.threshold_shift_db / 20.0)
    }
}
