//! Spectral beta: the spectrum's profile as a beta density on the normalised logarithmic frequency
//! axis, two numbers (paper, Spectral beta).

mod fit;

use htex_dsp::beta::{BetaDensity, log_unit};
use htex_dsp::grid::{Band, GRID_HZ, curve_level_rms};
use htex_model::{Descriptor, Error, Fit, FitInput, Model, Numbers, Values, mix};
use htex_shaped::{Curve, ShapedVoice};

const ALPHA: usize = 0;
const BETA: usize = 1;

/// The model.
pub struct SpectralBeta;

htex_model::export_model!(SpectralBeta, symbols: "plugin");

impl Model for SpectralBeta {
    type Voice = ShapedVoice<Shape>;

    fn descriptor() -> Descriptor {
        Descriptor::new(
            "org.htex.sbeta",
            "sBeta",
            env!("CARGO_PKG_VERSION"),
            "The spectrum's profile as a beta density over the logarithm of frequency: two numbers.",
        )
        .scalar("alpha", "1", (1e-3, 1e6), "First shape parameter: the rise from the low edge.")
        .scalar("beta", "1", (1e-3, 1e6), "Second shape parameter: the fall to the high edge.")
        .integer_option(
            "points",
            (3, 64),
            10,
            "Spectral peaks the density is fitted to (paper: ten).",
        )
        .option(
            "jnd",
            "1",
            (0.0, 1.0),
            0.12,
            "Least relative distance of two such peaks (paper: 12 %, for sPeak).",
        )
        .option(
            "lower_bound",
            "1",
            (0.0, 1.0),
            1.0,
            "Smallest alpha and beta; below 1 the density may be infinite at an edge.",
        )
        .choice(
            "error",
            &["magnitude", "decibel"],
            "What is least at the points: the squared difference of magnitudes, which the strongest \
             peaks decide, or that of decibels, to which all peaks count alike (the paper names none).",
        )
    }

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: htex_model::Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        htex_shaped::magnitude::<Shape>(parameters, band, frequency_hz, magnitude)
    }

    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
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

/// The density over frequency, and its RMS in the band.
#[derive(Clone, Copy)]
pub struct Shape {
    profile: Profile,
    level: f64,
}

impl Curve for Shape {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let mut shape = Self {
            profile: Profile::new(1.0, 1.0, band),
            level: 1.0,
        };
        shape.set(parameters)?;
        Ok(shape)
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let (alpha, beta) = (parameters.scalar(ALPHA), parameters.scalar(BETA));
        self.profile = Profile::new(alpha, beta, self.profile.band);
        self.level = curve_level_rms(self.profile.band, |f| self.at(f));
        if self.level > 0.0 && self.level.is_finite() {
            return Ok(());
        }
        Err(Error::parameters(format!(
            "alpha {alpha} and beta {beta} put all energy between two bins of the {GRID_HZ} Hz grid; \
             take smaller ones"
        )))
    }

    fn at(&self, frequency_hz: f64) -> f64 {
        self.profile.at(frequency_hz)
    }

    fn level(&self) -> f64 {
        self.level
    }
}

/// The beta density at the frequencies of a band. Where it is infinite, at an edge with a parameter
/// below 1, the value a quarter of a bin inside stands for what a bin that wide would read.
#[derive(Clone, Copy)]
pub(crate) struct Profile {
    density: BetaDensity,
    band: Band,
    low_hz: f64,
    high_hz: f64,
}

impl Profile {
    pub(crate) fn new(alpha: f64, beta: f64, band: Band) -> Self {
        let inset = |parameter: f64| if parameter < 1.0 { 0.25 * GRID_HZ } else { 0.0 };
        Self {
            density: BetaDensity::new(alpha, beta),
            band,
            low_hz: band.low_hz + inset(alpha),
            high_hz: band.high_hz - inset(beta),
        }
    }

    pub(crate) fn at(&self, frequency_hz: f64) -> f64 {
        let inside = frequency_hz.clamp(self.low_hz, self.high_hz);
        self.density.at(log_unit(inside, self.band))
    }
}
