//! Models that are objects at run time instead of Rust types, e.g. models written in a scripting
//! language.

use std::sync::Arc;

use htex_model::abi::ABI_MARKER;
use htex_model::arguments::{band, check_fit, check_fit_input, check_rate, finite, interpolate};
use htex_model::shim::{copy, guarded, last_error};
use htex_model::{
    Band, Descriptor, Error, Fit, FitCondition, FitInput, Motion, Numbers, Status, Values, mix,
};

use crate::raw::{RawModel, RawVoice};
use crate::{HostError, MOTION_EXTENSION};

/// A model that is a Rust object instead of a type. Implement this trait if the model is not known
/// at compile time.
///
/// Units and arguments are the same as in [`htex_model::Model`]. The host checks the arguments
/// before each call, as it does for such a model. Panics become errors.
///
/// ```
/// use std::sync::Arc;
/// use htex_host::{Band, Registry, RuntimeModel, RuntimeVoice};
/// use htex_model::{Descriptor, Error, Fit, FitInput, StaticDescriptor, StaticField, Values};
/// /// A constant.
/// struct Constant(f32);
/// impl RuntimeModel for Constant {
///     fn fit(&self, _: &FitInput<'_>) -> Result<Fit, Error> {
///         Ok(Fit { parameters: vec![0.5], level_rms: 1.0 })
///     }
///     fn magnitude(&self, _: &Values<'_>, _: Band, _: &[f64], m: &mut [f64]) -> Result<(), Error> {
///         m.fill(1.0);
///         Ok(())
///     }
///     fn voice(&self, _: &Values<'_>, _: Band, _: f64, _: u64) -> Result<Box<dyn RuntimeVoice>, Error> {
///         Ok(Box::new(Constant(self.0)))
///     }
/// }
/// impl RuntimeVoice for Constant {
///     fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
///         out.fill(self.0);
///         Ok(())
///     }
///     fn retune(&mut self, _: &Values<'_>) -> Result<(), Error> {
///         Ok(())
///     }
/// }
/// const FIELDS: &[StaticField] = &[StaticField::scalar("unused", "1", (0.0, 1.0), "Unused.")];
/// let descriptor = StaticDescriptor::new("org.example.constant", "Constant", "1.0.0", "A constant.").fields(FIELDS);
/// let mut registry = Registry::builtin();
/// registry.add_runtime_model("Rust", Descriptor::from(&descriptor), Arc::new(Constant(0.25)))?;
/// let model = registry.find("constant")?;
/// let mut block = [0.0; 4];
/// model.voice(&[0.5], Band::TACTILE, 2_000.0, 0)?.render(&mut block)?;
/// assert_eq!((block, &model.origin().to_string()[..]), ([0.25; 4], "Rust"));
/// # Ok::<(), htex_host::HostError>(())
/// ```
pub trait RuntimeModel: Send + Sync + 'static {
    /// Fits the model, as [`htex_model::Model::fit`] does. `input.condition` is known only if the
    /// model follows the motion.
    ///
    /// # Errors
    /// Returns an error if the model cannot describe the spectrum.
    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, Error>;

    /// Computes the magnitude, as [`htex_model::Model::magnitude`] does.
    ///
    /// # Errors
    /// Returns an error if the parameters describe no spectrum.
    fn magnitude(
        &self,
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error>;

    /// Interpolates parameter sets, as [`htex_model::Model::interpolate`] does. The default
    /// interpolates every number linearly.
    ///
    /// # Errors
    /// Returns an error if the sets cannot be interpolated.
    fn interpolate(
        &self,
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        mix::linear(sets, weights, out)
    }

    /// Returns the sample rate of a voice, as [`htex_model::Model::voice_rate_hz`] does.
    fn voice_rate_hz(&self, _parameters: &Values<'_>, _band: Band, wanted_hz: f64) -> f64 {
        wanted_hz
    }

    /// Creates a voice, as [`htex_model::Model::voice`] does.
    ///
    /// # Errors
    /// Returns an error if a voice cannot be created with these parameters at this rate.
    fn voice(
        &self,
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RuntimeVoice>, Error>;

    /// Returns whether the model follows the motion itself, like a model with the extension
    /// `htex.motion/1`.
    fn follows_motion(&self) -> bool {
        false
    }
}

/// A voice of a [`RuntimeModel`]. This trait is like [`htex_model::Voice`], except that rendering
/// may fail.
pub trait RuntimeVoice: Send {
    /// Fills `out` with the next samples.
    ///
    /// # Errors
    /// Returns an error if the voice cannot produce samples. The host then plays zeros.
    fn render(&mut self, out: &mut [f32]) -> Result<(), Error>;

    /// Changes to other parameters, as [`htex_model::Voice::retune`] does.
    ///
    /// # Errors
    /// Returns an error if the voice cannot change to these parameters.
    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error>;

    /// Sets the motion, as [`htex_model::MotionVoice::set_motion`] does. The host calls this method
    /// only for models that follow the motion.
    fn set_motion(&mut self, _motion: Motion) {}
}

/// A [`RuntimeModel`] with its descriptor, as the host calls it.
pub(crate) struct RuntimeModelAdapter {
    shared: Arc<Shared>,
}

/// The data that a model and its voices share.
struct Shared {
    descriptor: Descriptor,
    json: Vec<u8>,
    model: Arc<dyn RuntimeModel>,
}

impl RuntimeModelAdapter {
    /// Creates the model.
    ///
    /// # Errors
    /// Returns an error if the descriptor contains a number that JSON cannot represent.
    pub(crate) fn new(
        descriptor: Descriptor,
        model: Arc<dyn RuntimeModel>,
    ) -> Result<Self, HostError> {
        let json = serde_json::to_vec(&descriptor).map_err(|error| HostError::Broken {
            model: descriptor.id.clone(),
            call: "htex_model_descriptor",
            what: error.to_string(),
        })?;
        Ok(Self { shared: Arc::new(Shared { descriptor, json, model }) })
    }
}

impl Shared {
    fn values<'a>(&self, parameters: &'a [f64]) -> Result<Values<'a>, Error> {
        Values::read(&self.descriptor, parameters)
    }

    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, Error> {
        let (speed_mm_s, force_n) = input.condition.numbers();
        let condition = if self.model.follows_motion() {
            FitCondition::from_numbers(speed_mm_s, force_n)?
        } else {
            FitCondition::default()
        };
        let input = FitInput { band: band(input.band.edges())?, condition, ..*input };
        check_fit_input(&input, &self.descriptor)?;
        let fit = self.model.fit(&input)?;
        check_fit(&fit, &self.descriptor)?;
        Ok(fit)
    }

    fn interpolate(&self, flat: &[f64], weights: &[f64], out: &mut [f64]) -> i64 {
        let own = |sets: &[Values<'_>], weights: &[f64], mixed: &mut Numbers<'_>| {
            self.model.interpolate(sets, weights, mixed)
        };
        guarded(|| interpolate(&self.descriptor, &own, flat, weights, out))
    }
}

impl RawModel for RuntimeModelAdapter {
    fn abi_version(&self) -> u32 {
        ABI_MARKER
    }

    fn descriptor(&self, out: &mut [u8]) -> i64 {
        copy(&self.shared.json, out)
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        last_error(out.into())
    }

    fn fit(&self, input: &FitInput<'_>, parameters: &mut [f64], level_rms: &mut f64) -> i64 {
        guarded(|| {
            let fit = self.shared.fit(input)?;
            *level_rms = fit.level_rms;
            Ok(copy(&fit.parameters, parameters))
        })
    }

    fn magnitude(
        &self,
        parameters: &[f64],
        of: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> i64 {
        guarded(|| {
            finite("frequency_hz", frequency_hz)?;
            let values = self.shared.values(parameters)?;
            let model = &self.shared.model;
            model.magnitude(&values, band(of.edges())?, frequency_hz, magnitude)?;
            Ok(0)
        })
    }

    fn interpolate(&self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        self.shared.interpolate(sets, weights, parameters)
    }

    fn extension(&self, id: &[u8]) -> i64 {
        // `htex.voices/1` is not supported, because its call needs a table of C functions.
        i64::from(self.follows_motion() && id == MOTION_EXTENSION.as_bytes())
    }

    fn follows_motion(&self) -> bool {
        self.shared.model.follows_motion()
    }

    fn voice_rate(&self, parameters: &[f64], of: Band, wanted_hz: f64) -> f64 {
        let mut rate_hz = 0.0;
        let status = guarded(|| {
            check_rate(wanted_hz)?;
            let values = self.shared.values(parameters)?;
            let model = &self.shared.model;
            rate_hz = model.voice_rate_hz(&values, band(of.edges())?, wanted_hz);
            check_rate(rate_hz).map(|()| 0)
        });
        if status < 0 { status as f64 } else { rate_hz }
    }

    fn voice_new(
        &self,
        parameters: &[f64],
        of: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RawVoice>, i64> {
        let mut voice = None;
        let status = guarded(|| {
            check_rate(rate_hz)?;
            let values = self.shared.values(parameters)?;
            let model = &self.shared.model;
            voice = Some(model.voice(&values, band(of.edges())?, rate_hz, seed)?);
            Ok(0)
        });
        match voice {
            Some(_) => Ok(Box::new(RuntimeVoiceAdapter { shared: self.shared.clone(), voice })),
            None => Err(status),
        }
    }
}

/// A voice; `None` after it was freed.
struct RuntimeVoiceAdapter {
    shared: Arc<Shared>,
    voice: Option<Box<dyn RuntimeVoice>>,
}

impl RuntimeVoiceAdapter {
    fn call(
        &mut self,
        with: impl FnOnce(&mut dyn RuntimeVoice, &Shared) -> Result<(), Error>,
    ) -> i64 {
        let Self { shared, voice } = self;
        guarded(|| {
            let voice = voice.as_deref_mut().ok_or_else(freed)?;
            with(voice, shared).map(|()| 0)
        })
    }
}

fn freed() -> Error {
    Error::new(Status::BadHandle, "no such voice; it was freed")
}

impl RawVoice for RuntimeVoiceAdapter {
    fn render(&mut self, out: &mut [f32]) -> i64 {
        self.call(|voice, _| voice.render(out))
    }

    fn retune(&mut self, parameters: &[f64]) -> i64 {
        self.call(|voice, shared| voice.retune(&shared.values(parameters)?))
    }

    fn set_motion(&mut self, motion: Motion) -> i64 {
        if !self.shared.model.follows_motion() {
            return 0;
        }
        self.call(|voice, _| {
            motion.check()?;
            voice.set_motion(motion);
            Ok(())
        })
    }

    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        self.shared.interpolate(sets, weights, parameters)
    }

    fn free(&mut self) -> i64 {
        guarded(|| self.voice.take().map(|_| 0).ok_or_else(freed))
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        last_error(out.into())
    }
}
