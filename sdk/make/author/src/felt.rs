//! How much of the difference between two spectra a fingertip can feel, i.e. the difference above
//! the detection threshold. This computation is independent of the measures with which models are
//! fitted and compared.

use htex_dsp::fidelity::{THIRD_OCTAVES, third_octave};
use htex_dsp::vibrotactile::{Listener, Skin};
use htex_format::Quantity;

use serde::{Deserialize, Serialize};

use crate::spectrum::{SpectrumRef, TextureSpectrum};

/// Smallest difference in level that people notice, decibels: 20 %. Forta, Griffin & Morioka 2012,
/// *Experimental Brain Research* 220, report medians of 20 % to 58 % for their conditions. This is
/// the smallest of these medians.
pub(crate) const DIFFERENCE_THRESHOLD_DB: f64 = 1.584;

/// Exponent with which a sensation is assumed to grow with the displacement of the skin (Stevens'
/// power law). We have no experiment that supports this exponent: on the confusions of five
/// materials, the measure with this exponent is not better than other measures
/// (`tests/peers/confusions.py`).
const SENSATION_EXPONENT: f64 = 0.3;

/// Bound for the difference between two recordings of the same surface, in multiples of the first
/// recording's repeatability. The repeatability itself is not a bound but a median: half of all
/// second recordings differ by more. If a surface is recorded a second time, the second recording
/// is within this bound in nine out of ten cases. We compared 180 pairs of takes. The two takes of
/// a pair are recordings of a robot's fingertip on the same material. There were 20 materials in
/// total. In 94 % of the pairs, the difference was at most 3.5 times the repeatability of the first
/// take. In 89 %, it was at most 3 times the repeatability.
pub const REPEATABILITY_BOUND: f64 = 3.5;

/// Sensation levels (levels relative to the detection threshold) of two spectra in third-octave
/// bands, and the differences between these levels. Below the threshold nothing can be felt, so a
/// level below 0 dB counts as 0 dB when the difference is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Felt {
    /// Centre frequencies of the bands, hertz.
    pub centre_hz: Vec<f64>,
    /// Sensation level of the reference in each band, decibels; negative below the threshold.
    pub reference_db: Vec<f64>,
    /// Sensation level of the compared spectrum in each band, decibels; negative below the
    /// threshold.
    pub level_db: Vec<f64>,
    /// Difference of the levels above the threshold in each band, decibels.
    pub error_db: Vec<f64>,
    /// RMS of the differences in `error_db`, decibels. The RMS covers only bands in which at least
    /// one spectrum is above the threshold. It is 0 if there is no such band.
    pub error_rms_db: f64,
    /// The largest absolute difference in any band, decibels.
    pub largest_error_db: f64,
    /// Difference of the total levels above the threshold, decibels. The total level is computed
    /// from the energy of all bands together.
    pub total_error_db: f64,
    /// RMS difference in sensation, over all bands. To compute the sensation in a band, the
    /// displacement is divided by the detection threshold, and the ratio is raised to the power of
    /// 0.3. At the threshold, the sensation is 1.
    pub sensation_error_rms: f64,
}

impl Felt {
    /// Whether the reference itself cannot be felt: all its bands together are below the detection
    /// threshold.
    pub fn is_below_detection_threshold(&self) -> bool {
        let energies = self.reference_db.iter().map(|db| libm::pow(10.0, 0.1 * db));
        energies.sum::<f64>() < 1.0
    }

    /// Whether the reference can be felt and every difference from it is below the difference
    /// threshold of 1.584 dB.
    pub fn is_below_difference_threshold(&self) -> bool {
        !self.is_below_detection_threshold()
            && self.largest_error_db < DIFFERENCE_THRESHOLD_DB
            && self.total_error_db.abs() < DIFFERENCE_THRESHOLD_DB
    }
}

/// How much of a difference can be felt, in a few numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct FeltError {
    /// RMS difference of the levels above the detection threshold, over third-octave bands,
    /// decibels.
    pub error_rms_db: f64,
    /// The largest absolute difference in any band, decibels.
    pub largest_error_db: f64,
    /// Difference of the total levels above the detection threshold, decibels. The total level is
    /// computed from the energy of all bands together.
    pub total_error_db: f64,
    /// RMS difference in sensation over third-octave bands ([`Felt::sensation_error_rms`]); 0 in
    /// results of earlier versions.
    #[serde(default)]
    pub sensation_error_rms: f64,
    /// Whether the recorded texture itself cannot be felt: all bands together are below the
    /// detection threshold. In this case, `below_difference_threshold` and `below_if_sensitive` are
    /// false.
    #[serde(default)]
    pub below_detection_threshold: bool,
    /// Whether the difference is too small to notice, i.e. below the difference threshold in every
    /// band and in total.
    pub below_difference_threshold: bool,
    /// The same as `below_difference_threshold`, computed for a person with a sensitive finger and
    /// soft skin ([`Listener::sensitive`]).
    pub below_if_sensitive: bool,
    /// Whether the nine-band error is at most [`REPEATABILITY_BOUND`] times the recording's own
    /// repeatability. If this is true, a second recording could differ from the first recording as
    /// much as the model differs from it. False if the repeatability is not known.
    pub within_repeatability: bool,
}

impl FeltError {
    /// Measures how the spectrum `magnitude` differs from the recorded spectrum. `nine_band_db` is
    /// the nine-band error of the magnitudes ([`htex_format::Measure::NineBand`]).
    pub fn new(recorded: &TextureSpectrum, magnitude: &[f64], nine_band_db: Option<f64>) -> Self {
        let by =
            |listener: &Listener| felt(recorded.as_ref(), magnitude, recorded.quantity, listener);
        let felt = by(&Listener::default());
        Self {
            error_rms_db: felt.error_rms_db,
            largest_error_db: felt.largest_error_db,
            total_error_db: felt.total_error_db,
            sensation_error_rms: felt.sensation_error_rms,
            below_detection_threshold: felt.is_below_detection_threshold(),
            below_difference_threshold: felt.is_below_difference_threshold(),
            below_if_sensitive: by(&Listener::sensitive()).is_below_difference_threshold(),
            within_repeatability: nine_band_db
                .zip(recorded.repeatability_rms_db())
                .is_some_and(|(error, own)| error <= REPEATABILITY_BOUND * own),
        }
    }

    /// Returns a phrase that compares the difference, or the texture itself, with the thresholds.
    /// The phrase can end a sentence.
    pub const fn verdict(&self) -> &'static str {
        if self.below_detection_threshold {
            "the texture itself cannot be felt"
        } else if self.below_difference_threshold {
            "below the difference threshold"
        } else {
            "above the difference threshold"
        }
    }

    /// Combines two results into a worst case. For each number, the result contains the value that
    /// is further from 0. A flag is true only if it is true in both results.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        let further = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        Self {
            error_rms_db: further(self.error_rms_db, other.error_rms_db),
            largest_error_db: further(self.largest_error_db, other.largest_error_db),
            total_error_db: further(self.total_error_db, other.total_error_db),
            sensation_error_rms: further(self.sensation_error_rms, other.sensation_error_rms),
            below_detection_threshold: self.below_detection_threshold
                && other.below_detection_threshold,
            below_difference_threshold: self.below_difference_threshold
                && other.below_difference_threshold,
            below_if_sensitive: self.below_if_sensitive && other.below_if_sensitive,
            within_repeatability: self.within_repeatability && other.within_repeatability,
        }
    }
}

/// Numbers of textures: how many have an error below a listener's difference threshold, and how
/// many the listener cannot feel at all. Another count, `within_repeatability`, is the number of
/// textures whose error is within the variation of the recording itself. This count does not show
/// what can be felt: the more the recordings vary, the higher `within_repeatability` is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct FeltShare {
    /// Number of textures.
    pub textures: usize,
    /// Textures that cannot be felt at all. `below_difference_threshold` and `below_if_sensitive`
    /// leave these textures out.
    #[serde(default)]
    pub below_detection_threshold: usize,
    /// Textures whose difference is below the difference threshold.
    pub below_difference_threshold: usize,
    /// Textures whose difference is below the difference threshold of a person with a sensitive
    /// finger and soft skin.
    pub below_if_sensitive: usize,
    /// Textures whose nine-band error is at most 3.5 times the recording's own repeatability.
    pub within_repeatability: usize,
}

impl FeltShare {
    /// Adds a texture's result to the counts.
    pub fn count(&mut self, felt: &FeltError) {
        self.textures += 1;
        self.below_detection_threshold += usize::from(felt.below_detection_threshold);
        self.below_difference_threshold += usize::from(felt.below_difference_threshold);
        self.below_if_sensitive += usize::from(felt.below_if_sensitive);
        self.within_repeatability += usize::from(felt.within_repeatability);
    }
}

/// Compares how two spectra on the same frequency grid feel to a listener: `reference` and
/// `magnitude`. Before the comparison, magnitudes are converted to displacements of the skin.
/// Forces are converted through the skin's impedance, and accelerations and velocities by
/// integration.
///
/// ```
/// use htex_author::{SpectrumRef, felt};
/// use htex_dsp::vibrotactile::Listener;
/// use htex_format::Quantity;
/// use htex_host::Band;
///
/// let band = Band::TACTILE;
/// let (hertz, quiet) = (band.grid_hz(), vec![1e-9; band.bins()]);
/// let reference = SpectrumRef { band, frequency_hz: &hertz, magnitude: &quiet };
/// let felt = felt(reference, &vec![2e-9; band.bins()], Quantity::LateralForce, &Listener::default());
/// // A difference of 6 dB that nobody feels: 1 nN is far below the threshold.
/// assert_eq!(felt.largest_error_db, 0.0);
/// ```
pub fn felt(
    reference: SpectrumRef<'_>,
    magnitude: &[f64],
    quantity: Quantity,
    listener: &Listener,
) -> Felt {
    let energies =
        |magnitude: &[f64]| energies(reference.frequency_hz, magnitude, quantity, listener);
    let (ours, theirs) = (energies(reference.magnitude), energies(magnitude));
    let bands: Vec<usize> = (0..THIRD_OCTAVES).filter(|k| ours[*k].is_some()).collect();
    let levels = |all: &[Option<f64>]| -> Vec<f64> {
        bands.iter().map(|k| level_db(all[*k].unwrap_or_default())).collect()
    };
    let (reference_db, level_db) = (levels(&ours), levels(&theirs));
    let pairs = reference_db.iter().zip(&level_db);
    let error_db: Vec<f64> = pairs.clone().map(|(r, m)| m.max(0.0) - r.max(0.0)).collect();
    let felt: Vec<f64> = pairs
        .zip(&error_db)
        .filter(|((r, m), _)| **r > 0.0 || **m > 0.0)
        .map(|(_, error)| *error)
        .collect();
    // Energies are added before they are compared with the threshold, because several bands can be
    // felt together even if each band alone is too weak.
    let total = |all: &[Option<f64>]| self::level_db(all.iter().flatten().sum()).max(0.0);
    let sensations = reference_db.iter().zip(&level_db);
    let sensations: Vec<f64> = sensations.map(|(r, m)| sensation(*m) - sensation(*r)).collect();
    Felt {
        sensation_error_rms: htex_dsp::bands::rms(&sensations),
        centre_hz: bands.iter().map(|k| centre_hz(*k)).collect(),
        error_rms_db: htex_dsp::bands::rms(&felt),
        largest_error_db: error_db.iter().fold(0.0, |most, e| f64::max(most, e.abs())),
        total_error_db: total(&theirs) - total(&ours),
        reference_db,
        level_db,
        error_db,
    }
}

/// Returns the energies relative to the threshold in each third-octave band; `None` for a band
/// without a bin.
fn energies(
    frequency_hz: &[f64],
    magnitude: &[f64],
    quantity: Quantity,
    listener: &Listener,
) -> [Option<f64>; THIRD_OCTAVES] {
    let mut energies = [None; THIRD_OCTAVES];
    for (&hertz, &magnitude) in frequency_hz.iter().zip(magnitude) {
        let Some(band) = third_octave(hertz) else {
            continue;
        };
        let peak_m = magnitude * displacement_m(hertz, quantity, &listener.skin);
        let ratio = peak_m / listener.threshold_m(hertz);
        // Magnitudes are the peaks of sinusoids under a Hann window. This window spreads the energy
        // of a sinusoid over 1.5 bins.
        *energies[band].get_or_insert(0.0) += ratio * ratio / 1.5;
    }
    energies
}

/// Returns the displacement of the skin, in metres, that a sample of value 1 causes.
fn displacement_m(hertz: f64, quantity: Quantity, skin: &Skin) -> f64 {
    let omega = 2.0 * std::f64::consts::PI * hertz;
    match quantity {
        Quantity::LateralForce | Quantity::NormalForce => skin.displacement_m(hertz),
        Quantity::Acceleration => 1.0 / (omega * omega),
        Quantity::Velocity => 1.0 / omega,
        Quantity::Displacement => 1.0,
    }
}

/// Returns the magnitude of a sinusoid that lies exactly at a listener's detection threshold, in
/// the quantity's unit. The frequency `hertz` must be above 0.
///
/// ```
/// use htex_author::threshold_magnitude;
/// use htex_dsp::vibrotactile::Listener;
/// use htex_format::Quantity;
/// let at = |quantity| threshold_magnitude(250.0, quantity, &Listener::default());
/// assert_eq!(at(Quantity::Displacement), 1e-7);
/// assert!((0.2e-3..0.3e-3).contains(&at(Quantity::LateralForce)));
/// ```
pub fn threshold_magnitude(hertz: f64, quantity: Quantity, listener: &Listener) -> f64 {
    listener.threshold_m(hertz) / displacement_m(hertz, quantity, &listener.skin)
}

/// Returns the level of an energy relative to the threshold. For zero energy the level is far below
/// the threshold.
fn level_db(energy: f64) -> f64 {
    10.0 * libm::log10(energy.max(1e-30))
}

/// Returns the sensation for a level above the threshold: the ratio of displacement to threshold,
/// raised to the power of [`SENSATION_EXPONENT`].
fn sensation(level_db: f64) -> f64 {
    libm::pow(10.0, SENSATION_EXPONENT * level_db / 20.0)
}

/// Returns the geometric mean of a band's edges, 20 · 2^(k/3) Hz.
fn centre_hz(band: usize) -> f64 {
    20.0 * libm::exp2((band as f64 + 0.5) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use htex_host::Band;

    fn spectra(of: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let hertz = Band::TACTILE.grid_hz();
        let magnitude = hertz.iter().map(|f| of(*f)).collect();
        (hertz, magnitude)
    }

    fn compared(a: impl Fn(f64) -> f64, b: impl Fn(f64) -> f64, quantity: Quantity) -> Felt {
        let (hertz, reference) = spectra(a);
        let reference =
            SpectrumRef { band: Band::TACTILE, frequency_hz: &hertz, magnitude: &reference };
        felt(reference, &spectra(b).1, quantity, &Listener::default())
    }

    /// A sinusoid at the threshold has a level of 0 dB, for every quantity.
    #[test]
    fn the_threshold_is_at_0_db() {
        let line = |peak: f64| {
            move |f: f64| match (f - 250.0).abs() {
                d if d < 1.0 => peak,
                d if d < 6.0 => 0.5 * peak,
                _ => 0.0,
            }
        };
        let omega = 2.0 * std::f64::consts::PI * 250.0;
        let force = 1e-7 / Skin::default().displacement_m(250.0);
        for (quantity, peak) in [
            (Quantity::Displacement, 1e-7),
            (Quantity::Velocity, 1e-7 * omega),
            (Quantity::Acceleration, 1e-7 * omega * omega),
            (Quantity::LateralForce, force),
        ] {
            let felt = compared(line(peak), line(10.0 * peak), quantity);
            // The spectral line appears in three bins, which belong to two bands. The thresholds of
            // neighbouring bins differ by less than 0.4 dB.
            let energy: f64 = felt.reference_db.iter().map(|db| 10f64.powf(db / 10.0)).sum();
            assert!(level_db(energy).abs() < 0.15, "{quantity}: {felt:?}");
            assert!((felt.total_error_db - 20.0).abs() < 0.15, "{quantity}: {felt:?}");
        }
    }

    /// For a more sensitive person, the felt difference is at least as large in every band.
    #[test]
    fn a_sensitive_person_feels_no_less() {
        let (hertz, recorded) = spectra(|f| 2e-3 / (1.0 + f / 100.0));
        for gain_db in [-12.0, -3.0, -1.0, 0.5, 2.0, 9.0] {
            for tilt in [-1.0, 0.0, 1.0] {
                let gain = |f: f64| 10f64.powf(gain_db / 20.0) * (f / 200.0).powf(tilt);
                let other: Vec<f64> =
                    hertz.iter().zip(&recorded).map(|(f, m)| m * gain(*f)).collect();
                let reference =
                    SpectrumRef { band: Band::TACTILE, frequency_hz: &hertz, magnitude: &recorded };
                let by = |listener| felt(reference, &other, Quantity::LateralForce, &listener);
                let (typical, sensitive) = (by(Listener::default()), by(Listener::sensitive()));
                let pairs = typical.error_db.iter().zip(&sensitive.error_db);
                assert!(
                    pairs.into_iter().all(|(t, s)| s.abs() >= t.abs() - 1e-9),
                    "{gain_db} {tilt}"
                );
            }
        }
    }

    /// Above the third octaves there is nothing to compare.
    #[test]
    fn a_band_without_third_octaves_has_no_difference() {
        let band = Band { low_hz: 1100.0, high_hz: 2000.0 };
        let (hertz, magnitude) = (band.grid_hz(), vec![0.1; band.bins()]);
        let reference = SpectrumRef { band, frequency_hz: &hertz, magnitude: &magnitude };
        let found = felt(reference, &magnitude, Quantity::LateralForce, &Listener::default());
        assert_eq!((found.error_rms_db, found.sensation_error_rms), (0.0, 0.0));
    }

    /// A difference that lies entirely below the threshold is not felt in any band. A difference of
    /// 6 dB far above the threshold is felt in every band.
    #[test]
    fn only_what_is_felt_counts() {
        let below = compared(|_| 1e-9, |_| 1e-8, Quantity::LateralForce);
        assert_eq!((below.error_rms_db, below.total_error_db), (0.0, 0.0));
        assert!(below.is_below_detection_threshold() && !below.is_below_difference_threshold());
        let unchanged = compared(|_| 0.1, |_| 0.1, Quantity::LateralForce);
        assert!(unchanged.is_below_difference_threshold());
        assert!(!unchanged.is_below_detection_threshold());
        let above = compared(|_| 0.1, |_| 0.2, Quantity::LateralForce);
        assert!(above.error_db.iter().all(|e| (e - 6.0206).abs() < 1e-3), "{above:?}");
        // Every sensation grows by the same factor.
        let [recorded, doubled] = [(0.1, 1e-9), (0.2, 1e-9)].map(|(a, b)| {
            compared(move |_| b, move |_| a, Quantity::LateralForce).sensation_error_rms
        });
        assert!((doubled / recorded / 2f64.powf(0.3) - 1.0).abs() < 1e-2, "{doubled} {recorded}");
        assert!(!above.is_below_difference_threshold());
    }
}
