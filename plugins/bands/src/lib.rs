//! Band-energy model (`org.htex.bands`): the energy of a spectrum in log-spaced bands, with three
//! to six bits per band.
//!
//! This model is not from the paper, and was not evaluated in perception experiments. The paper
//! regresses ratings on energy differences in such bands (section "Linear regression"). The r² of
//! this regression, which the paper calls low, does not increase with more than nine bands. Thirty
//! bands keep a spectrum within about 0.3 dB of the recording in third-octave bands. Files do not
//! store the energies themselves, but a curve from which the bands get these energies. The curve is
//! in decibels, and it is piecewise linear. Its frequency axis is the axis on which the bands are
//! equally spaced. Its knots are at the bands' apexes.
//!
//! By default, there are thirty knots from edge to edge of the asset's frequency band. The levels
//! of the knots are in steps of 1 dB, and the differences of levels are stored in a Rice code. The
//! table has medians over 15 simulated recordings:
//!
//! | knots | storage | third-octave error |
//! |---|---|---|
//! | 9 inside the band | one byte per band, 11 bytes in all | 3.7 dB |
//! | 19 inside the band | one byte per band, 21 bytes in all | 1.4 dB |
//! | 22 from edge to edge | one byte per band | 0.8 dB |
//! | 22 from edge to edge, on the axis ln(f + 20 Hz) | one byte per band | 0.5 dB |
//! | 30 from edge to edge, on the axis ln(f + 20 Hz) | Rice code, 21 bytes in all | 0.3 dB |
//!
//! On the axis ln(f + 20 Hz), even the knots at low frequencies are at least one bin apart. In the
//! Rice code, a band needs only two thirds of a byte. For all bands together, entropy codes with
//! longer tails need one byte more, and steps of 0.5 dB need two or three bytes more.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod axis;
mod fit;

use alloc::sync::Arc;
use alloc::vec::Vec;

use htex_dsp::exponential::exponentials;
use htex_dsp::grid::{Band, GRID_HZ, level_rms};
use htex_dsp::shaped_noise::ComponentsKey;
use htex_dsp::sharpening::sharpen;
use htex_model::shaped::{Curve, Places, ShapedModel};
use htex_model::{
    Error, Fit, FitInput, Numbers, StaticDescriptor, StaticField, StaticOption, Store, UsualRange,
    Values, mix, text,
};

use axis::{Axis, Layout, Point};
use fit::{Fitter, below_highest_db, total_energy};

const BELOW: usize = 0;
const STEP: usize = 1;
const LAYOUT: usize = 2;

const BANDS_OPTION: usize = 0;
const STEP_OPTION: usize = 1;
const LAYOUT_OPTION: usize = 2;

/// Default number of bands. For 15 simulated recordings, thirty bands in steps of 1 dB took 21
/// bytes (median; at most 23), with a median third-octave error of 0.33 dB. With 9 bands the error
/// is 3.7 dB. With 64 bands it is 0.18 dB, in 35 bytes.
const DEFAULT_BANDS: u32 = 30;
const DEFAULT_STEP_DB: f64 = 1.0;
const MAX_BANDS: u32 = 64;
/// Largest number of steps from the highest knot down to another knot: the range of a byte.
const MAX_STEPS: f64 = 255.0;
/// Resolution with which files store the step, dB.
const STEP_UNIT_DB: f64 = 0.05;
const STEP_RANGE_DB: (f64, f64) = (STEP_UNIT_DB, 6.0);
/// Largest level difference in dB, both between the loudest band and any other band, and between
/// the highest knot and any other knot. A band without energy gets a level that is this far below
/// the loudest band. The measure of band errors has the same limit, because it adds 1e-12 of the
/// largest energy to every band: this is the limit, expressed as a ratio of energies.
pub const FLOOR_DB: f64 = 120.0;

const fn steps(scale: f64) -> Store {
    Store::U8 { scale, offset: 0.0, log: false }
}

pub struct BandEnergies;

htex_model::export_model!(BandEnergies, symbols: "plugin");

impl ShapedModel for BandEnergies {
    type Curve = Spectrum;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.bands",
        "Bands",
        env!("CARGO_PKG_VERSION"),
        "The energies in overlapping bands, stored as a curve of straight lines in decibels. The curve has a knot \
         for each band.",
    )
    .keeping_level()
    .fields(&[
        StaticField::list(
            "below_highest",
            "1",
            (0.0, MAX_STEPS),
            MAX_BANDS,
            "Level of each knot: how many steps it is below the highest knot. One to 64 knots.",
        )
        .stored(Store::Packed {
            scale: 1.0,
            offset: 0.0,
            log: false,
        })
        // In the fits to 15 simulated recordings of five surfaces, nine tenths of the knots are at
        // most 42 dB below the highest knot, and nearly all knots at most 60 dB.
        .usual(UsualRange::linear(0.0, 60.0)),
        StaticField::scalar("step_db", "dB", STEP_RANGE_DB, "Size of a step.").stored(steps(STEP_UNIT_DB))
        .usual(UsualRange::log(0.25, 3.0)),
        StaticField::scalar(
            "layout",
            "1",
            (0.0, 1.0),
            "0: knots inside the band, evenly spaced in ln f. 1: knots from edge to edge, evenly spaced in ln(f + 20 \
             Hz).",
        )
        .stored(steps(1.0))
        .usual(UsualRange::linear(0.0, 1.0)),
    ])
    .options(&[
        StaticOption::integer(
            "bands",
            (1, MAX_BANDS),
            DEFAULT_BANDS,
            "Number of bands. Each overlaps its neighbours by half. 9 gives the bands of the paper's regression; \
             with 19, the bands are half as far apart.",
        )
        .sweep(&[
            1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0, 16.0, 19.0, 20.0,
            22.0, 24.0, 26.0, 28.0, 30.0, 34.0, 40.0, 48.0, 56.0, 64.0,
        ]),
        StaticOption::number(
            "step_db",
            "dB",
            STEP_RANGE_DB,
            DEFAULT_STEP_DB,
            "Step to which the levels of the knots are rounded. The step itself is rounded to 0.05 dB. The model \
             uses a larger step if 255 steps would not reach the lowest knot, which is at most 120 dB below the \
             highest knot.",
        )
        .sweep(&[3.0, 1.5, 1.0, 0.75, 0.5, 0.25]),
        StaticOption::choice(
            "layout",
            &["auto", "within", "edges"],
            "Where the outermost knots are: `within` the frequency band, as in the paper's regression, or at its \
             `edges`. `auto` selects `edges` for 20 bands or more.",
        )
        .sweep_alone(&[1.0]),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let top = input.magnitude.iter().copied().fold(0.0, f64::max);
        let knots = input.options[BANDS_OPTION] as usize;
        let axis = Axis {
            knots,
            layout: match input.options[LAYOUT_OPTION] as usize {
                0 => Layout::for_bands(knots),
                1 => Layout::Within,
                _ => Layout::Edges,
            },
            band: input.band,
        };
        // For a silent spectrum these are NaN, and `Fitter::new` then finds no energy.
        let power: Vec<f64> = input.magnitude.iter().map(|m| (m / top) * (m / top)).collect();
        let fitter = Fitter::new(&axis, input.frequency_hz, &power).ok_or_else(|| {
            Error::cannot_fit(
                "the spectrum is silent, at least between its edges: all band energies are zero",
            )
        })?;
        let below_db = below_highest_db(&fitter.fit());
        let step_db = step_db(input.options[STEP_OPTION], &below_db);
        let round = |below_db: &f64| libm::round(below_db / step_db).min(MAX_STEPS);
        let below: Vec<f64> = below_db.iter().map(round).collect();
        let spectrum = Spectrum::with_knots(&below, step_db, axis)?;
        let made: Vec<f64> = spectrum.magnitude.iter().map(|m| m * m).collect();
        // The level is chosen so that the total energy of the bands equals the recording's.
        let energy = |power: &[f64]| total_energy(&axis, input.frequency_hz, power);
        let gain = htex_dsp::root::sqrt(energy(&power) / energy(&made));
        let count = [below.len() as f64];
        let rest = [step_db, axis.layout.number()];
        Ok(Fit {
            parameters: [&count[..], &below, &rest].concat(),
            level_rms: top * gain * spectrum.level,
        })
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let spectrum = Spectrum::new(parameters, band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = if band.contains(f) {
                libm::exp(spectrum.axis.point(f).between(&spectrum.knots)) / spectrum.level
            } else {
                0.0
            };
        }
        Ok(())
    }

    /// Interpolates the knots in decibels.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        let kind = |set: &Values<'_>| (set.list(BELOW).len(), set.scalar(STEP), set.scalar(LAYOUT));
        if sets.iter().any(|set| kind(set) != kind(&sets[0])) {
            return Err(Error::argument(
                "levels of different bands or in different steps cannot be mixed",
            ));
        }
        mix::linear(sets, weights, out)
    }
}

/// Returns the wanted step, rounded to the resolution of files. If this step is too small to reach
/// the quietest band, returns the smallest step that reaches it.
fn step_db(wanted_db: f64, below_db: &[f64]) -> f64 {
    let reach_db = below_db.iter().copied().fold(0.0, f64::max);
    let least = libm::ceil(reach_db / (MAX_STEPS * STEP_UNIT_DB) - 1e-9);
    libm::round(wanted_db / STEP_UNIT_DB).max(least) * STEP_UNIT_DB
}

/// The curve that a parameter set describes, on the frequency grid.
pub struct Spectrum {
    axis: Axis,
    points: Arc<[Point]>,
    /// The parameters: the numbers of steps below the highest knot, and the step.
    below: Vec<f64>,
    step_db: f64,
    /// Logarithms of magnitude. The largest possible value is 0.
    knots: Vec<f64>,
    magnitude: Vec<f64>,
    power: Vec<f64>,
    /// Power spectrum of the voice. It is sharpened such that it equals `magnitude` when it is
    /// measured through the window, as recordings are.
    played: Vec<f64>,
    /// Working memory: `played` before a step of sharpening.
    before: Vec<f64>,
    /// RMS of `magnitude`.
    level: f64,
    first_bin: usize,
    /// Positions of a voice's frequencies between the bins.
    places: Option<Arc<Places>>,
}

impl Spectrum {
    fn with_knots(below: &[f64], step_db: f64, axis: Axis) -> Result<Self, Error> {
        let band = axis.band;
        if below.is_empty() {
            return Err(Error::parameters("`below_highest` is empty; it needs at least one knot"));
        }
        if band.bins() == 0 {
            return Err(Error::parameters(text![
                "no bin of the ",
                GRID_HZ,
                " Hz grid lies in the band ",
                band.low_hz,
                " to ",
                band.high_hz,
                " Hz",
            ]));
        }
        let zeros = || vec![0.0; band.bins()];
        let mut spectrum = Self {
            axis,
            below: below.to_vec(),
            step_db,
            places: None,
            points: axis.grid_points(),
            knots: vec![0.0; below.len()],
            magnitude: zeros(),
            power: zeros(),
            played: zeros(),
            before: zeros(),
            level: 0.0,
            first_bin: band.first_bin(),
        };
        spectrum.make(|logs| logs.iter_mut().for_each(|x| *x = libm::exp(*x)));
        spectrum.level = level_rms(&spectrum.magnitude);
        Ok(spectrum)
    }

    /// Computes the played spectrum from the parameters. Does not allocate.
    fn make(&mut self, exponentials: impl Fn(&mut [f64])) {
        let least = self.below.iter().copied().fold(f64::INFINITY, f64::min);
        for (knot, below) in self.knots.iter_mut().zip(&self.below) {
            *knot = -self.step_db * (below - least) * core::f64::consts::LN_10 / 20.0;
        }
        for (point, log) in self.points.iter().zip(&mut self.magnitude) {
            *log = point.between(&self.knots);
        }
        exponentials(&mut self.magnitude);
        for (magnitude, power) in self.magnitude.iter().zip(&mut self.power) {
            *power = *magnitude * *magnitude;
        }
        sharpen(&self.power, &mut self.before, &mut self.played);
        for power in &mut self.played {
            *power = htex_dsp::root::sqrt(*power);
        }
    }

    fn layout(parameters: &Values<'_>) -> Layout {
        Layout::from_number(parameters.scalar(LAYOUT))
    }
}

impl Curve for Spectrum {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let below = parameters.list(BELOW);
        let axis = Axis { knots: below.len(), layout: Self::layout(parameters), band };
        Self::with_knots(below, parameters.scalar(STEP), axis)
    }

    fn band(&self) -> Band {
        self.axis.band
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let below = parameters.list(BELOW);
        if below.len() != self.knots.len() || Self::layout(parameters) != self.axis.layout {
            return Err(Error::argument("a voice cannot change its bands"));
        }
        self.below.copy_from_slice(below);
        self.step_db = parameters.scalar(STEP);
        Ok(())
    }

    /// Interpolates linearly between bins.
    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        let last = self.played.len() - 1;
        let place = (frequency_hz / GRID_HZ - self.first_bin as f64).clamp(0.0, last as f64);
        let below = place as usize;
        let (a, b) = (self.played[below], self.played[(below + 1).min(last)]);
        a + (place - below as f64) * (b - a)
    }

    fn level(&self) -> f64 {
        self.level
    }

    fn prepare(&mut self, frequency_hz: &[f64], key: ComponentsKey) {
        self.places = Some(Places::shared(frequency_hz, key, self.axis.band));
    }

    fn fill(&mut self, _: &[f64], magnitude: &mut [f64]) {
        self.make(exponentials);
        if let Some(places) = &self.places {
            places.read(&self.played, magnitude);
        }
    }
}
