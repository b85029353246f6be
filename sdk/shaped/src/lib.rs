//! Shared code of models that describe a spectrum by a curve and play it as noise.
//!
//! A model supplies the [`Curve`]; this crate provides the magnitude at unit RMS and the voice.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

extern crate alloc;

mod places;

use htex_dsp::grid::Band;
use htex_dsp::shaped_noise::{ComponentsKey, ShapedNoise, economical_rate_hz};
use htex_model::{Error, Values, Voice};

pub use places::Places;

/// A magnitude curve defined by a model's parameters.
pub trait Curve: Sized + Send + 'static {
    /// Makes the curve of `parameters` in a band.
    ///
    /// # Errors
    /// If the parameters describe no spectrum: the curve is zero or not finite in the band.
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error>;

    /// Changes the parameters. `[render thread, no allocation]`
    ///
    /// # Errors
    /// As [`Self::new`]; the curve may be unusable afterwards.
    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error>;

    /// Value of the curve at a frequency in the band, in any scale, finite and not negative.
    fn at(&self, frequency_hz: f64) -> f64;

    /// RMS of the curve on the band's grid, above 0.
    fn level(&self) -> f64;

    /// Prepares [`Self::fill`] for these frequencies, hertz. Tables over them may be shared by
    /// `key`.
    fn prepare(&mut self, _frequency_hz: &[f64], _key: ComponentsKey) {}

    /// Writes the curve at the prepared frequencies, in any scale. A voice calls it at most once in
    /// 10 ms, not after every [`Self::set`], so slow computations belong here rather than in `set`.
    /// If the parameters describe no spectrum, the values are all zero or not finite.
    /// `[render thread, no allocation]`
    fn fill(&mut self, frequency_hz: &[f64], magnitude: &mut [f64]) {
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = self.at(f);
        }
    }
}

/// Writes a curve's magnitude at unit RMS; zero for frequencies outside the band.
///
/// # Errors
/// If the parameters describe no spectrum.
pub fn magnitude<C: Curve>(
    parameters: &Values<'_>,
    band: Band,
    frequency_hz: &[f64],
    magnitude: &mut [f64],
) -> Result<(), Error> {
    let curve = C::new(parameters, band)?;
    let level = curve.level();
    for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
        *m = if band.contains(f) { curve.at(f) / level } else { 0.0 };
    }
    Ok(())
}

/// Rate in hertz at which a shaped voice renders: an integer fraction of `wanted_hz`, as low as the
/// band allows.
pub fn voice_rate_hz(band: Band, wanted_hz: f64) -> f64 {
    economical_rate_hz(wanted_hz, band)
}

/// Random-phase noise with the spectrum of a curve.
pub struct ShapedVoice<C> {
    curve: C,
    noise: ShapedNoise,
}

impl<C: Curve> ShapedVoice<C> {
    /// A voice of unit RMS.
    ///
    /// # Errors
    /// If the parameters describe no spectrum.
    pub fn new(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
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
        if noise.retune_with(|hz, magnitude| curve.fill(hz, magnitude)) {
            Ok(())
        } else {
            Err(Error::parameters(
                "these parameters describe no spectrum: nothing in the band, or nothing finite",
            ))
        }
    }
}
