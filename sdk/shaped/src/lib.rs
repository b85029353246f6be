//! Models that describe a spectrum by a curve and play it as shaped noise: what they share.
//!
//! A model brings the [`Curve`]; this crate makes of it the magnitude at unit RMS and the voice.
#![no_std]

extern crate alloc;

mod places;

use htex_dsp::grid::Band;
use htex_dsp::shaped_noise::{ComponentsKey, ShapedNoise, economical_rate_hz};
use htex_model::{Error, Values, Voice};

pub use places::Places;

/// A magnitude curve that parameters stand for.
pub trait Curve: Sized + Send + 'static {
    /// The curve of some parameters in a band.
    ///
    /// # Errors
    /// When they describe no spectrum: nothing, or nothing finite, in the band.
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error>;

    /// Changes to other parameters. `[render thread, no allocation]`
    ///
    /// # Errors
    /// As [`Self::new`]; the curve may then be of no further use.
    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error>;

    /// The curve at a frequency in the band, in any scale, finite and not negative.
    fn at(&self, frequency_hz: f64) -> f64;

    /// RMS of the curve on the band's grid, above 0.
    fn level(&self) -> f64;

    /// Gets ready for [`Self::fill`] at these frequencies, hertz; tables over them may be kept by the key.
    fn prepare(&mut self, _frequency_hz: &[f64], _key: ComponentsKey) {}

    /// Writes the curve at the frequencies it was prepared for, in any scale. A voice asks for it at most once in 10 ms,
    /// and not after each [`Self::set`]: what takes time may wait for it, and what is then no spectrum is all zero or not
    /// finite. `[render thread, no allocation]`
    fn fill(&mut self, frequency_hz: &[f64], magnitude: &mut [f64]) {
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = self.at(f);
        }
    }
}

/// Writes a curve's magnitude at unit RMS; zero outside the band.
///
/// # Errors
/// When the parameters describe no spectrum.
pub fn magnitude<C: Curve>(
    parameters: &Values<'_>,
    band: htex_model::Band,
    frequency_hz: &[f64],
    magnitude: &mut [f64],
) -> Result<(), Error> {
    let band: Band = band.edges().into();
    let curve = C::new(parameters, band)?;
    let level = curve.level();
    for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
        *m = if band.contains(f) {
            curve.at(f) / level
        } else {
            0.0
        };
    }
    Ok(())
}

/// The rate a shaped voice renders at: low, and a whole fraction of the wanted one.
pub fn voice_rate_hz(band: htex_model::Band, wanted_hz: f64) -> f64 {
    economical_rate_hz(wanted_hz, band.edges().into())
}

/// Noise of random phases under a curve.
pub struct ShapedVoice<C> {
    curve: C,
    noise: ShapedNoise,
}

impl<C: Curve> ShapedVoice<C> {
    /// A voice of unit RMS.
    ///
    /// # Errors
    /// When the parameters describe no spectrum.
    pub fn new(
        parameters: &Values<'_>,
        band: htex_model::Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
        let band = band.edges().into();
        let mut curve = C::new(parameters, band)?;
        let mut noise = ShapedNoise::new(rate_hz, band, seed);
        noise.start(|_, f| curve.at(f));
        curve.prepare(noise.component_hz(), noise.components_key());
        Ok(Self { curve, noise })
    }
}

impl<C: Curve> Voice for ShapedVoice<C> {
    fn render(&mut self, out: &mut [f32]) {
        let Self { curve, noise } = self;
        noise.render_with(out, &mut |hz, magnitude| curve.fill(hz, magnitude));
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let Self { curve, noise } = self;
        curve.set(parameters)?;
        match noise.retune_with(|hz, magnitude| curve.fill(hz, magnitude)) {
            true => Ok(()),
            false => Err(Error::parameters(
                "these parameters describe no spectrum: nothing in the band, or nothing finite",
            )),
        }
    }
}
