//! sBeta model (`org.htex.sbeta`): the envelope of the spectrum as a beta density on the normalised
//! logarithmic frequency axis. The density has two parameters (section "Spectral beta" of the
//! paper).
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;

mod decibels;
mod fit;

use alloc::sync::Arc;
use alloc::vec::Vec;

use htex_dsp::beta::{BetaDensity, LogAxis};
use htex_dsp::grid::{Band, GRID_HZ, curve_level_rms};
use htex_dsp::shaped_noise::ComponentsKey;
use htex_dsp::shared::Shared;
use htex_model::shaped::{Curve, ShapedModel};
use htex_model::{
    Error, Fit, FitInput, StaticDescriptor, StaticField, StaticOption, UsualRange, Values, text,
};

const ALPHA: usize = 0;
const BETA: usize = 1;

pub(crate) struct SpectralBeta;

htex_model::export_model!(SpectralBeta, symbols: "plugin");

impl ShapedModel for SpectralBeta {
    type Curve = Shape;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.sbeta",
        "sBeta",
        env!("CARGO_PKG_VERSION"),
        "The profile of the spectrum, as a beta density over the logarithm of frequency. The two parameters \
         determine the shape of the density.",
    )
    .fields(&[
        StaticField::scalar("alpha", "1", (1e-3, 1e6), "First shape parameter: the rise from the low edge.")
        // The fits to 15 simulated recordings of five surfaces have an alpha of 0.8 to 2.3 and a
        // beta of 2.1 to 3.4. Below 1, the density rises without bound towards the edge. At 20, it
        // is a peak half an octave wide.
        .usual(UsualRange::log(0.5, 20.0)),
        StaticField::scalar("beta", "1", (1e-3, 1e6), "Second shape parameter: the fall to the high edge.")
        .usual(UsualRange::log(0.5, 20.0)),
    ])
    .options(&[
        StaticOption::integer(
            "points",
            (3, 64),
            10,
            "Number of spectral peaks to which the density is fitted. The paper uses ten.",
        )
        .sweep(&[3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 50.0]),
        StaticOption::number(
            "jnd",
            "1",
            (0.0, 1.0),
            0.12,
            "Smallest relative distance between the frequencies of two such peaks. The paper uses 12 % for sPeak.",
        )
        .sweep_alone(&[0.24, 0.12, 0.06, 0.0]),
        StaticOption::number(
            "lower_bound",
            "1",
            (0.0, 1.0),
            0.5,
            "Smallest allowed alpha and beta. With a value below 1, the density may be infinite at an edge. The \
             paper states no bound; htex assumes that the paper used 1.",
        )
        .sweep(&[1.0, 0.0]),
        StaticOption::choice(
            "error",
            &["decibel", "magnitude"],
            "What the fit minimises. `decibel`: the squared differences in decibels, to which all peaks and bins \
             contribute alike. `magnitude`: the squared differences of magnitudes, which the strongest peaks \
             dominate. The paper states neither; htex assumes that the paper used `magnitude`.",
        )
        .sweep(&[1.0, 0.0]),
        StaticOption::integer(
            "bins",
            (0, 64),
            20,
            "Number of bins, evenly spaced in log frequency, to which the density is fitted in addition to the \
             peaks. The largest bin is always added. 0: only the peaks, as in the paper.",
        )
        .sweep_alone(&[0.0, 5.0, 10.0, 20.0, 40.0]),
        StaticOption::choice(
            "refit",
            &["if_high", "never"],
            "`if_high`: a fit to only peaks above twice the largest bin also uses `points` bins. `never`: as in the paper.",
        )
        .sweep_alone(&[1.0]),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }
}

/// The beta density over frequency, and its RMS in the band.
#[derive(Clone)]
pub struct Shape {
    profile: Profile,
    level: f64,
    logs: Option<Arc<Logs>>,
}

/// Logarithms of `u` and of `1 - u` for a voice's frequencies. `u` is the position of a frequency
/// on the axis.
struct Logs {
    log: Vec<f64>,
    log_rest: Vec<f64>,
}

/// Finite substitute for the logarithm of 0. Its product with any exponent other than 0 is outside
/// the range of exponentials.
const LOG_ZERO: f64 = -1e300;

impl Curve for Shape {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let (alpha, beta) = (parameters.scalar(ALPHA), parameters.scalar(BETA));
        let profile = Profile::new(alpha, beta, band);
        profile.check()?;
        let level = curve_level_rms(band, |f| profile.density_at(f));
        if level > 0.0 && level.is_finite() {
            return Ok(Self { profile, level, logs: None });
        }
        Err(Error::parameters(text![
            "alpha ",
            alpha,
            " and beta ",
            beta,
            " put all energy between two bins of the ",
            GRID_HZ,
            " Hz grid; take smaller ones",
        ]))
    }

    fn band(&self) -> Band {
        self.profile.band
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let (alpha, beta) = (parameters.scalar(ALPHA), parameters.scalar(BETA));
        self.profile = Profile::new(alpha, beta, self.profile.band);
        self.profile.check()
    }

    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        self.profile.density_at(frequency_hz)
    }

    fn level(&self) -> f64 {
        self.level
    }

    fn prepare(&mut self, frequency_hz: &[f64], key: ComponentsKey) {
        static LOGS: Shared<ComponentsKey, Logs> = Shared::new();
        let axis = self.profile.axis;
        let finite = |log: f64| log.max(LOG_ZERO);
        let logs = || {
            let places = || frequency_hz.iter().map(|hz| axis.unit_at(*hz));
            Arc::new(Logs {
                log: places().map(|u| finite(libm::log(u))).collect(),
                log_rest: places().map(|u| finite(libm::log1p(-u))).collect(),
            })
        };
        self.logs = Some(LOGS.get(key, logs));
    }

    fn fill(&mut self, frequency_hz: &[f64], magnitude: &mut [f64]) {
        let Some(logs) = &self.logs else {
            return;
        };
        let profile = &self.profile;
        profile.density.fill(&logs.log, &logs.log_rest, magnitude);
        let all = frequency_hz.iter().zip(magnitude);
        let is_inset = |hz: &f64| *hz < profile.low_hz || *hz > profile.high_hz;
        for (hz, m) in all.filter(|(hz, _)| is_inset(hz)) {
            *m = profile.density_at(*hz);
        }
    }
}

/// The beta density at the frequencies of a band. If a parameter is below 1, the density is
/// infinite at the parameter's edge. There, the density a quarter of a bin inside the band replaces
/// it. This value is close to what a bin of this width measures.
#[derive(Clone, Copy)]
pub(crate) struct Profile {
    density: BetaDensity,
    band: Band,
    axis: LogAxis,
    low_hz: f64,
    high_hz: f64,
}

impl Profile {
    pub(crate) fn new(alpha: f64, beta: f64, band: Band) -> Self {
        let inset = |parameter: f64| if parameter < 1.0 { 0.25 * GRID_HZ } else { 0.0 };
        Self {
            density: BetaDensity::new(alpha, beta),
            band,
            axis: LogAxis::new(band),
            low_hz: band.low_hz + inset(alpha),
            high_hz: band.high_hz - inset(beta),
        }
    }

    /// Refuses a band that is narrower than what is left out at its edges.
    fn check(&self) -> Result<(), Error> {
        if self.low_hz <= self.high_hz {
            return Ok(());
        }
        Err(Error::parameters("an alpha or beta below 1 needs a band of 2.5 Hz or more"))
    }

    pub(crate) fn density_at(&self, frequency_hz: f64) -> f64 {
        // Not `clamp`, which would panic in a band that `check` refuses.
        let inside = frequency_hz.max(self.low_hz).min(self.high_hz);
        self.density.density_at(self.axis.unit_at(inside))
    }
}
