//! Band energies: how strong a spectrum is in a few log-spaced bands, a byte a band.
//!
//! Nine such energies tell how real a rendered texture feels (paper, Results), so the model keeps just
//! them. Of all spectra with these energies it plays the plainest: straight between the bands' apexes
//! in decibels over the logarithm of frequency.

mod knots;

use htex_dsp::bands::{BAND_COUNT, BandBank};
use htex_dsp::grid::{Band, GRID_HZ, level_rms};
use htex_model::{Descriptor, Error, Fit, FitInput, Model, Numbers, Store, Values, mix};
use htex_shaped::{Curve, ShapedVoice};

use knots::Knots;

const BELOW: usize = 0;
const STEP: usize = 1;

const BANDS_OPTION: usize = 0;
const STEP_OPTION: usize = 1;

const MAX_BANDS: u32 = 40;
/// Most steps below the loudest band: what a byte holds.
const MAX_STEPS: f64 = 255.0;
/// A file keeps the step as so many of these, dB.
const STEP_UNIT_DB: f64 = 0.05;
const STEP_RANGE_DB: (f64, f64) = (STEP_UNIT_DB, 6.0);
/// No band counts as further below the loudest than this: a band without energy is 120 dB below it,
/// as in the measure of band errors, which adds 1e-12 of the largest energy.
pub const FLOOR_DB: f64 = 120.0;

/// Rounds in which a voice's spectrum is sharpened.
const SHARPENINGS: usize = 2;

/// The model.
pub struct BandEnergies;

htex_model::export_model!(BandEnergies, symbols: "plugin");

impl Model for BandEnergies {
    type Voice = ShapedVoice<Spectrum>;

    fn descriptor() -> Descriptor {
        let steps = |scale| Store::U8 {
            scale,
            offset: 0.0,
            log: false,
        };
        Descriptor::new(
            "org.htex.bands",
            "Bands",
            env!("CARGO_PKG_VERSION"),
            "The energies in a few log-spaced bands; straight lines in decibels between them.",
        )
        .keeping_level()
        .list(
            "below_loudest",
            "1",
            (0.0, MAX_STEPS),
            MAX_BANDS,
            "Energy of each band, in steps below the loudest band's; one to 40 bands.",
        )
        .stored(steps(1.0))
        .scalar("step_db", "dB", STEP_RANGE_DB, "The step.")
        .stored(steps(STEP_UNIT_DB))
        .integer_option(
            "bands",
            (1, MAX_BANDS),
            BAND_COUNT as u32,
            "Log-spaced bands, overlapping by half (paper: nine critical bands). 19, 29 and 39 divide \
             the nine evenly and keep their energies as well.",
        )
        .option(
            "step_db",
            "dB",
            STEP_RANGE_DB,
            0.5,
            "Energies are rounded to whole steps of this, itself rounded to 0.05 dB; coarser where 255 \
             steps would not reach the quietest band, which counts as at most 120 dB down.",
        )
    }

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let top = input.magnitude.iter().copied().fold(0.0, f64::max);
        let band: Band = input.band.edges().into();
        let bank = BandBank::new(
            input.options[BANDS_OPTION] as usize,
            band,
            input.frequency_hz,
        );
        let relative: Vec<f64> = input.magnitude.iter().map(|m| m / top).collect();
        let energies = bank.energies(&relative);
        let loudest = energies.iter().copied().fold(0.0, f64::max);
        if loudest == 0.0 {
            return Err(Error::cannot_fit(
                "the spectrum is silent, at least between its edges: all band energies are zero",
            ));
        }
        let below_db = |energy: &f64| (10.0 * libm::log10(loudest / energy)).min(FLOOR_DB);
        let below_db: Vec<f64> = energies.iter().map(below_db).collect();
        let step_db = step_db(input.options[STEP_OPTION], &below_db);
        let round = |below_db: &f64| libm::round(below_db / step_db).min(MAX_STEPS);
        let below: Vec<f64> = below_db.iter().map(round).collect();
        let spectrum = Spectrum::of(&below, step_db, band)?;
        let count = [below.len() as f64];
        Ok(Fit {
            parameters: [&count[..], &below, &[step_db]].concat(),
            // The loudest band has the recording's energy.
            level_rms: top * libm::sqrt(loudest) * spectrum.level,
        })
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: htex_model::Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let band: Band = band.edges().into();
        let spectrum = Spectrum::new(parameters, band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = if band.contains(f) {
                spectrum.between(&spectrum.magnitude, f) / spectrum.level
            } else {
                0.0
            };
        }
        Ok(())
    }

    /// Mixes decibels.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        let kind = |set: &Values<'_>| (set.list(BELOW).len(), set.scalar(STEP));
        if sets.iter().any(|set| kind(set) != kind(&sets[0])) {
            return Err(Error::argument(
                "energies of different bands or in different steps cannot be mixed",
            ));
        }
        mix::linear(sets, weights, out)
    }

    fn voice_rate_hz(_: &Values<'_>, band: htex_model::Band, wanted_hz: f64) -> f64 {
        htex_shaped::voice_rate_hz(band, wanted_hz)
    }

    fn voice(
        parameters: &Values<'_>,
        band: htex_model::Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        ShapedVoice::new(parameters, band, rate_hz, seed)
    }
}

/// The step that is wanted, as a file keeps it, or the least that reaches down to the quietest band.
fn step_db(wanted_db: f64, below_db: &[f64]) -> f64 {
    let reach_db = below_db.iter().copied().fold(0.0, f64::max);
    let least = libm::ceil(reach_db / (MAX_STEPS * STEP_UNIT_DB) - 1e-9);
    libm::round(wanted_db / STEP_UNIT_DB).max(least) * STEP_UNIT_DB
}

/// The magnitude that band energies stand for, on the grid.
pub struct Spectrum {
    knots: Knots,
    magnitude: Vec<f64>,
    /// What a voice plays: it is read through a window, as recordings are, and then looks like
    /// `magnitude`.
    played: Vec<f64>,
    /// RMS of `magnitude`.
    level: f64,
    first_bin: usize,
}

impl Spectrum {
    fn of(below: &[f64], step_db: f64, band: Band) -> Result<Self, Error> {
        if below.is_empty() {
            return Err(Error::parameters(
                "`below_loudest` is empty; at least one band is wanted",
            ));
        }
        if band.bins() == 0 {
            return Err(Error::parameters(format!(
                "no bin of the {GRID_HZ} Hz grid lies in the band {} to {} Hz",
                band.low_hz, band.high_hz
            )));
        }
        let mut spectrum = Self {
            knots: Knots::new(below.len(), band),
            magnitude: vec![0.0; band.bins()],
            played: vec![0.0; band.bins()],
            level: 0.0,
            first_bin: band.first_bin(),
        };
        spectrum.make(below, step_db);
        Ok(spectrum)
    }

    fn make(&mut self, below: &[f64], step_db: f64) {
        self.knots.solve(|band| below[band] * step_db);
        let power = self.knots.power();
        for (m, power) in self.magnitude.iter_mut().zip(power) {
            *m = libm::sqrt(*power);
        }
        self.level = level_rms(&self.magnitude);
        sharpen(power, &mut self.played);
        for power in &mut self.played {
            *power = libm::sqrt(*power);
        }
    }

    /// Between bins: on the straight line between them.
    fn between(&self, magnitude: &[f64], frequency_hz: f64) -> f64 {
        let last = magnitude.len() - 1;
        let place = (frequency_hz / GRID_HZ - self.first_bin as f64).clamp(0.0, last as f64);
        let below = place as usize;
        let above = (below + 1).min(last);
        let (a, b) = (magnitude[below], magnitude[above]);
        a + (place - below as f64) * (b - a)
    }
}

impl Curve for Spectrum {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        Self::of(parameters.list(BELOW), parameters.scalar(STEP), band)
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let below = parameters.list(BELOW);
        if below.len() != self.knots.bands() {
            return Err(Error::argument("a voice keeps its number of bands"));
        }
        self.make(below, parameters.scalar(STEP));
        Ok(())
    }

    fn at(&self, frequency_hz: f64) -> f64 {
        self.between(&self.played, frequency_hz)
    }

    fn level(&self) -> f64 {
        self.level
    }
}

/// Writes the power that reads as `power` through the Hann window, nearly: noise of even power is read
/// in its own bin by two thirds, and by a sixth in each neighbour (Richardson and Lucy's steps).
fn sharpen(power: &[f64], sharp: &mut [f64]) {
    let last = power.len() - 1;
    sharp.copy_from_slice(power);
    for _ in 0..SHARPENINGS {
        let mut before = sharp[0];
        for bin in 0..=last {
            let here = sharp[bin];
            let read = (before + 4.0 * here + sharp[(bin + 1).min(last)]) / 6.0;
            before = here;
            if read > 0.0 {
                sharp[bin] = here * (power[bin] / read);
            }
        }
    }
}
