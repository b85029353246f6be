//! Converts types that implement [`Model`] to model objects, for models that the program itself
//! adds.

use std::sync::Arc;

use htex_model::{
    Band, Descriptor, Error, Fit, FitInput, Model, Motion, MotionVoice, Numbers, Values, Voice,
};

use crate::HostError;
use crate::runtime::{RuntimeModel, RuntimeModelAdapter, RuntimeVoice};

/// The function [`MotionVoice::set_motion`] of a voice.
type SetMotion<V> = fn(&mut V, Motion);

/// A model object for a type that implements [`Model`].
struct TypeModel<M: Model> {
    set_motion: Option<SetMotion<M::Voice>>,
}

/// A voice object for the voice of a type that implements [`Model`].
struct TypeVoice<V> {
    voice: V,
    set_motion: Option<SetMotion<V>>,
}

/// Creates the model of a type.
///
/// # Errors
/// Returns the errors of [`RuntimeModelAdapter::new`].
pub(crate) fn model<M: Model>() -> Result<RuntimeModelAdapter, HostError> {
    described::<M>(None)
}

/// Creates the model of a type whose voice follows the motion.
///
/// # Errors
/// Returns the errors of [`RuntimeModelAdapter::new`].
pub(crate) fn motion_model<M: Model<Voice: MotionVoice>>() -> Result<RuntimeModelAdapter, HostError>
{
    described::<M>(Some(M::Voice::set_motion))
}

fn described<M: Model>(
    set_motion: Option<SetMotion<M::Voice>>,
) -> Result<RuntimeModelAdapter, HostError> {
    let descriptor = Descriptor::from(&M::DESCRIPTOR);
    RuntimeModelAdapter::new(descriptor, Arc::new(TypeModel::<M> { set_motion }))
}

impl<M: Model> RuntimeModel for TypeModel<M> {
    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, Error> {
        M::fit(input)
    }

    fn magnitude(
        &self,
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        M::magnitude(parameters, band, frequency_hz, magnitude)
    }

    fn interpolate(
        &self,
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        M::interpolate(sets, weights, out)
    }

    fn voice_rate_hz(&self, parameters: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        M::voice_rate_hz(parameters, band, wanted_hz)
    }

    fn voice(
        &self,
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RuntimeVoice>, Error> {
        Ok(Box::new(TypeVoice {
            voice: M::voice(parameters, band, rate_hz, seed)?,
            set_motion: self.set_motion,
        }))
    }

    fn follows_motion(&self) -> bool {
        self.set_motion.is_some()
    }
}

impl<V: Voice> RuntimeVoice for TypeVoice<V> {
    fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.voice.render(out);
        Ok(())
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.voice.retune(parameters)
    }

    fn set_motion(&mut self, motion: Motion) {
        if let Some(set) = self.set_motion {
            set(&mut self.voice, motion);
        }
    }
}
