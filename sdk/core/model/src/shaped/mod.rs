//! Models that describe a spectrum by a curve and play it as noise.
//!
//! Every type that implements [`ShapedModel`] also implements [`Model`]. Such a type names another
//! type, which implements [`Curve`]. From the curve, this module derives the magnitude at unit RMS,
//! the sample rate and the voice ([`ShapedVoice`]). By default, it interpolates parameters
//! linearly.
mod places;

use crate::{Error, Fit, FitInput, Model, Numbers, StaticDescriptor, Values, Voice, mix};
use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::shaped_noise::{ComponentsKey, ShapedNoise, economical_rate_hz};

pub use places::Places;

const NO_SPECTRUM: &str =
    "these parameters describe no spectrum: nothing in the band, or nothing finite";

/// A model that plays random-phase noise with the spectrum of a [`Curve`]. Every type that
/// implements this trait also implements [`Model`].
///
/// # Example
///
/// Flat noise between two frequencies:
///
/// ```
/// use htex_model::shaped::{Curve, ShapedModel};
/// use htex_model::{
///     Band, Error, Fit, FitInput, Model, StaticDescriptor, StaticField, Values,
/// };
///
/// struct Plateau {
///     low_hz: f64,
///     high_hz: f64,
///     band: Band,
/// }
///
/// impl Curve for Plateau {
///     fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
///         Ok(Self { low_hz: parameters.scalar(0), high_hz: parameters.scalar(1), band })
///     }
///
///     fn band(&self) -> Band {
///         self.band
///     }
///
///     fn magnitude_at(&self, frequency_hz: f64) -> f64 {
///         f64::from((self.low_hz..=self.high_hz).contains(&frequency_hz))
///     }
/// }
///
/// impl ShapedModel for Plateau {
///     type Curve = Self;
///
///     const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
///         "org.example.plateau",
///         "Plateau",
///         "1.0.0",
///         "Flat noise between two frequencies.",
///     )
///     .fields(&[
///         StaticField::scalar("low_hz", "Hz", (0.0, 2_000.0), "Lowest frequency."),
///         StaticField::scalar("high_hz", "Hz", (0.0, 2_000.0), "Highest frequency."),
///     ]);
///
///     /// Finds the two frequencies between which 90 % of the power lies.
///     fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
///         let power = || input.magnitude.iter().map(|m| m * m);
///         let total: f64 = power().sum();
///         let below = |part: f64| {
///             let mut sum = 0.0;
///             let bin = power().position(|p| {
///                 sum += p;
///                 sum > part * total
///             });
///             bin.map(|bin| input.frequency_hz[bin])
///                 .ok_or(Error::cannot_fit("the spectrum is zero"))
///         };
///         let parameters = vec![below(0.05)?, below(0.95)?];
///         Ok(Fit { parameters, level_rms: input.level_rms() })
///     }
/// }
///
/// let values = Values::read(&<Plateau as Model>::DESCRIPTOR, &[80.0, 250.0])?;
/// let mut magnitude = [0.0; 2];
/// <Plateau as Model>::magnitude(&values, Band::TACTILE, &[100.0, 500.0], &mut magnitude)?;
/// assert!(magnitude[0] > 0.0 && magnitude[1] == 0.0);
/// # Ok::<(), Error>(())
/// ```
pub trait ShapedModel: 'static {
    /// The curve that the parameters define.
    type Curve: Curve;

    /// The descriptor; see [`Model::DESCRIPTOR`].
    const DESCRIPTOR: StaticDescriptor;

    /// Finds the parameters that describe a spectrum; see [`Model::fit`].
    ///
    /// # Errors
    /// Returns an error if the model cannot describe the spectrum; see [`Model::fit`].
    fn fit(input: &FitInput<'_>) -> Result<Fit, Error>;

    /// Writes the magnitude of the shape; see [`Model::magnitude`]. The default writes the curve,
    /// scaled to unit RMS.
    ///
    /// # Errors
    /// Returns an error if the parameters describe no spectrum in this band.
    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        out: &mut [f64],
    ) -> Result<(), Error> {
        check::<Self::Curve>(parameters, band)?;
        magnitude::<Self::Curve>(parameters, band, frequency_hz, out)
    }

    /// Interpolates parameter sets; see [`Model::interpolate`]. The default interpolates every
    /// number linearly.
    ///
    /// # Errors
    /// Returns an error if the sets cannot be interpolated, e.g. because their lists differ in
    /// length.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        mix::linear(sets, weights, out)
    }
}

impl<M: ShapedModel> Model for M {
    type Voice = ShapedVoice<M::Curve>;

    const DESCRIPTOR: StaticDescriptor = <M as ShapedModel>::DESCRIPTOR;

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        <M as ShapedModel>::fit(input)
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        out: &mut [f64],
    ) -> Result<(), Error> {
        <M as ShapedModel>::magnitude(parameters, band, frequency_hz, out)
    }

    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        <M as ShapedModel>::interpolate(sets, weights, out)
    }

    fn voice_rate_hz(_: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        voice_rate_hz(band, wanted_hz)
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        check::<M::Curve>(parameters, band)?;
        ShapedVoice::new(parameters, band, rate_hz, seed)
    }
}

/// Returns an error if the curve is zero everywhere in the band, or not finite.
fn check<C: Curve>(parameters: &Values<'_>, band: Band) -> Result<(), Error> {
    let level = C::new(parameters, band)?.level();
    if level > 0.0 && level.is_finite() { Ok(()) } else { Err(Error::parameters(NO_SPECTRUM)) }
}

/// A magnitude curve that a model's parameters define.
///
/// Implement this trait and [`ShapedModel`] for a model that plays random-phase noise with the
/// spectrum of the curve. A model that also processes the noise, e.g. with a filter, implements
/// [`Model`] instead of [`ShapedModel`]. The voice of such a model contains a [`ShapedVoice`], and
/// the model's methods `magnitude` and `voice_rate_hz` call the functions [`magnitude`] and
/// [`voice_rate_hz`] of this module.
///
/// # How it is used
///
/// * [`magnitude`] makes a curve with [`new`](Self::new), and divides
///   [`magnitude_at`](Self::magnitude_at) by [`level`](Self::level).
/// * [`ShapedVoice::new`] makes a curve and starts the noise with the values of `magnitude_at`. It
///   then calls [`prepare`](Self::prepare) once, with the frequencies of the noise. `new` and
///   `prepare` may allocate.
/// * Every retune of the voice calls [`set`](Self::set). The voice then calls [`fill`](Self::fill):
///   at once, or at the end of a cross-fade (10 ms) if one is in progress. `set` and `fill` run on
///   the render thread and must not allocate.
///
/// The values of `magnitude_at` and `fill` may have any scale, and the two scales may differ,
/// because the voice normalises its samples to unit RMS in the band.
///
/// # Known doubt
///
/// If a host retunes a voice during the cross-fade of an earlier retune, the voice accepts the new
/// parameters before it knows whether [`fill`](Self::fill) will write a valid spectrum. If `fill`
/// then writes no power, the old spectrum continues without an error. Detect invalid parameters in
/// [`set`](Self::set) if that is cheap.
pub trait Curve: Sized + Send + 'static {
    /// Makes the curve of these parameters in a band. This function may allocate only if the type
    /// overrides [`Self::set`], because the default of `set` calls this function on the render
    /// thread.
    ///
    /// # Errors
    /// Returns an error if the parameters describe no spectrum, i.e. the curve is zero or not
    /// finite everywhere in the band. The curve of a [`ShapedModel`] need not check this.
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error>;

    /// Returns the band for which the curve was made.
    fn band(&self) -> Band;

    /// Changes the parameters. By default it makes a new curve. `[render thread, no allocation]`
    ///
    /// # Errors
    /// Returns an error if the parameters describe no spectrum, as for [`Self::new`]. After an
    /// error the curve may be unusable.
    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        *self = Self::new(parameters, self.band())?;
        Ok(())
    }

    /// Returns the value of the curve at a frequency in the band, in any scale. The value is finite
    /// and not negative.
    fn magnitude_at(&self, frequency_hz: f64) -> f64;

    /// Returns the RMS of the curve on the band's grid, in the scale of [`Self::magnitude_at`]. The
    /// default implementation computes this RMS; override the function to return a stored value.
    fn level(&self) -> f64 {
        curve_level_rms(self.band(), |hz| self.magnitude_at(hz))
    }

    /// Prepares [`Self::fill`] for these frequencies, hertz, e.g. by computing tables. Curves with
    /// the same `key` have the same frequencies and can share the tables.
    fn prepare(&mut self, _frequency_hz: &[f64], _key: ComponentsKey) {}

    /// Writes the curve at the prepared frequencies, in any scale. If the parameters describe no
    /// spectrum, all values are zero or not finite. `[render thread, no allocation]`
    ///
    /// A voice calls [`Self::set`] with every retune, but does not call `fill` during a cross-fade
    /// (10 ms). Therefore, slow computations belong in `fill` and not in `set`.
    fn fill(&mut self, frequency_hz: &[f64], magnitude: &mut [f64]) {
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = self.magnitude_at(f);
        }
    }
}

/// Writes a curve's magnitude at unit RMS, as [`crate::Model::magnitude`] requires it.
/// Frequencies outside the band get zero.
///
/// # Errors
/// Returns an error if the parameters describe no spectrum.
pub fn magnitude<C: Curve>(
    parameters: &Values<'_>,
    band: Band,
    frequency_hz: &[f64],
    magnitude: &mut [f64],
) -> Result<(), Error> {
    let curve = C::new(parameters, band)?;
    let level = curve.level();
    for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
        *m = if band.contains(f) { curve.magnitude_at(f) / level } else { 0.0 };
    }
    Ok(())
}

/// Returns the rate in hertz at which a [`ShapedVoice`] renders. It is `wanted_hz` divided by an
/// integer, and is as low as the band allows.
pub fn voice_rate_hz(band: Band, wanted_hz: f64) -> f64 {
    economical_rate_hz(wanted_hz, band)
}

/// The voice of a model with a [`Curve`]: random-phase noise with the spectrum of the curve.
pub struct ShapedVoice<C> {
    curve: C,
    noise: ShapedNoise,
}

impl<C: Curve> ShapedVoice<C> {
    /// Makes a voice whose samples have unit RMS.
    ///
    /// # Errors
    /// Returns an error if the parameters describe no spectrum.
    pub fn new(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
        let mut curve = C::new(parameters, band)?;
        let mut noise = ShapedNoise::new(rate_hz, band, seed);
        // `fill` cannot be used here, because it needs the frequencies that `prepare` gets only
        // below. So the noise starts with the values of `magnitude_at`.
        noise.start(|_, f| curve.magnitude_at(f));
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
            Err(Error::parameters(NO_SPECTRUM))
        }
    }
}
