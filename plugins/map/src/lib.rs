//! Friction map: grey values over a surface, where 0 is the lowest and 255 the highest friction.
//! Electroadhesion displays play such maps. For example, TanvasTouch displays read such maps as
//! 8-bit PNG.
//!
//! Neighbouring pixels are `pitch_mm` apart. The first row is at the top. The map repeats beyond
//! its edges. Between pixels, the voice interpolates the friction with a cubic (Catmull and Rom),
//! so that a finger feels no steps.
//!
//! The voice follows the finger's place, which it receives through the extension `htex.motion/1`.
//! The voice subtracts the mean from the friction at this place and limits the result to the
//! asset's frequency band. Without motion input, the voice scans the map row by row, at the speed
//! in the parameters. The model reports the spectra and the levels of this scan.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;

mod fit;
mod lines;
mod map;
mod path;
mod surface;
mod voice;

use htex_dsp::grid::Band;
use htex_dsp::shaped_noise::economical_rate_hz;
use htex_model::{
    Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, Store, UsualRange, Values,
};

use lines::Lines;
use map::Map;
pub use voice::MapVoice;

const WIDTH: usize = 0;
const PITCH: usize = 1;
const SPEED: usize = 2;
const FORCE: usize = 3;
const RMS: usize = 4;
const GREY: usize = 5;

/// Largest number of pixels in a row, and largest number of rows.
pub const MOST_SIDE: usize = 255;
/// Allowed distances between neighbouring pixels, mm.
pub const PITCH_MM: (f64, f64) = (0.0009765625, 64.0);
pub(crate) const SPEED_MM_S: (f64, f64) = (1.0, 2000.0);
pub(crate) const FORCE_N: (f64, f64) = (0.0, 1000.0);
/// Weights that differ by less than this count as equal.
const EQUAL: f64 = 1e-9;
const MOST_GREY: f64 = 255.0;

/// The model `org.htex.map`.
pub(crate) struct FrictionMap;

htex_model::export_model!(FrictionMap, symbols: "plugin", extensions: [motion]);

/// Returns the parameter `rms` of a map: the RMS of the grey values along the rows. Counts only
/// frequencies that are within the band when the finger moves at this speed.
///
/// # Errors
/// Returns an error if the number of grey values is not a multiple of the width, or if the map has
/// no energy in the band.
pub fn rms(
    width: usize,
    pitch_mm: f64,
    speed_mm_s: f64,
    grey: &[f64],
    band: Band,
) -> Result<f64, Error> {
    let map = Map { width, pitch_mm, speed_mm_s, force_n: 0.0, rms: 0.0, grey };
    map.checked().and_then(|map| Lines::new(&map, band)).map(|lines| lines.rms)
}

const GREYS: Store = Store::U8 { scale: 1.0, offset: 0.0, log: false };

impl Model for FrictionMap {
    type Voice = MapVoice;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.map",
        "Friction map",
        env!("CARGO_PKG_VERSION"),
        "An image of the friction on a surface. The signal follows the finger's position on the image.",
    )
    .only_named()
    .fields(&[
        StaticField::scalar("width", "1", (1.0, MOST_SIDE as f64), "Number of pixels in a row.")
            .stored(GREYS)
            .usual(UsualRange::linear(1.0, 255.0)),
        StaticField::scalar("pitch_mm", "mm", PITCH_MM, "Distance between neighbouring pixels.")
            .usual(UsualRange::log(0.01, 2.0)),
        StaticField::scalar(
            "speed_mm_s",
            "mm/s",
            SPEED_MM_S,
            "Speed for which the spectrum and the level are stated.",
        )
        .usual(UsualRange::log(20.0, 200.0)),
        StaticField::scalar(
            "force_n",
            "N",
            FORCE_N,
            "Normal force for which the level is stated. 0: unknown.",
        )
        .usual(UsualRange::linear(0.0, 2.0)),
        StaticField::scalar(
            "rms",
            "1",
            (0.0, MOST_GREY),
            "RMS of the grey values along the rows, at the speed speed_mm_s and within the \
             frequency band.",
        )
        .usual(UsualRange::log(1.0, 120.0)),
        StaticField::list(
            "grey",
            "1",
            (0.0, MOST_GREY),
            (MOST_SIDE * MOST_SIDE) as u32,
            "Grey values, row by row from the top. 255 is the highest friction.",
        )
        .stored(GREYS)
        .usual(UsualRange::linear(0.0, 255.0)),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let map = Map::new(parameters)?;
        let lines = Lines::stated(&map, band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = if band.contains(f) { lines.seen_at(f) } else { 0.0 };
        }
        Ok(())
    }

    /// Writes the parameter set with the largest weight, or the first one if weights are equal.
    /// Maps are not mixed.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let mut pairs = sets.iter().zip(weights);
        match pairs.find(|(_, weight)| **weight >= largest - EQUAL) {
            Some((set, _)) => {
                out.extend(set.flat());
                Ok(())
            }
            None => Err(Error::argument("no sets to mix")),
        }
    }

    fn voice_rate_hz(_: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        economical_rate_hz(wanted_hz, band)
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        MapVoice::new(parameters, band, rate_hz, seed)
    }
}
