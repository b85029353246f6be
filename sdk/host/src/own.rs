//! Models of the program itself: types that implement [`Model`], called without C functions.

use std::sync::Arc;

use htex_model::abi::ABI_MARKER;
use htex_model::shim::{self, FitCall, State};
use htex_model::{Band, Model, Motion, MotionVoice, json};

use crate::raw::{RawFit, RawModel, RawVoice};

/// Most bytes of such a model's descriptor in JSON.
const MOST_JSON_BYTES: usize = 65_536;

/// A model of the program itself. Arguments are checked and panics caught as for an exported model.
pub(crate) struct OwnModel<M: Model> {
    state: Arc<State<M>>,
    motion: Option<OwnMotion<M>>,
}

/// The functions of `htex.motion/1` of a model.
struct OwnMotion<M: Model> {
    fit: fn(&State<M>, FitCall<'_>, f64, f64) -> i64,
    /// Safety: as [`State::motion_set`].
    set: unsafe fn(&State<M>, i64, Motion) -> i64,
}

impl<M: Model> OwnModel<M> {
    /// Makes the model; `None` if its descriptor is longer than 64 KiB.
    pub(crate) fn new() -> Option<Self> {
        let len = json::length(&M::DESCRIPTOR);
        let bytes: Vec<u8> = json::text::<MOST_JSON_BYTES>(&M::DESCRIPTOR).into();
        // The text lives until the program ends; a program registers a model once or a few times.
        let json: &'static [u8] = Box::leak(bytes.get(..len)?.into());
        Some(Self {
            state: Arc::new(State::new(json)),
            motion: None,
        })
    }
}

impl<M: Model<Voice: MotionVoice>> OwnModel<M> {
    /// Adds the extension `htex.motion/1`.
    pub(crate) fn with_motion(self) -> Self {
        Self {
            motion: Some(OwnMotion {
                fit: State::motion_fit,
                set: State::motion_set,
            }),
            ..self
        }
    }
}

impl<M: Model> Clone for OwnMotion<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Model> Copy for OwnMotion<M> {}

impl<M: Model> RawModel for OwnModel<M> {
    fn abi_version(&self) -> u32 {
        ABI_MARKER
    }

    fn descriptor(&self, out: &mut [u8]) -> i64 {
        self.state.descriptor(out.into())
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        shim::last_error(out.into())
    }

    fn fit(&self, call: &RawFit<'_>, parameters: &mut [f64], level_rms: &mut f64) -> i64 {
        let fit = FitCall {
            band: call.band.edges(),
            frequency_hz: call.frequency_hz.into(),
            magnitude: call.magnitude.into(),
            signal: call.signal.into(),
            signal_rate_hz: call.signal_rate_hz,
            options: call.options.into(),
            parameters: parameters.into(),
            level_rms: std::slice::from_mut(level_rms).into(),
        };
        match self.motion {
            Some(motion) => {
                let (speed_mm_s, force_n) = call.condition.numbers();
                (motion.fit)(&self.state, fit, speed_mm_s, force_n)
            }
            None => self.state.fit(fit),
        }
    }

    fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> i64 {
        let (frequency_hz, magnitude) = (frequency_hz.into(), magnitude.into());
        self.state
            .magnitude(parameters.into(), band.edges(), frequency_hz, magnitude)
    }

    fn interpolate(&self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        self.state
            .interpolate(sets.into(), weights.into(), parameters.into())
    }

    fn extension(&self, id: &[u8]) -> i64 {
        // `htex.voices/1` is absent: its call needs a table of C functions.
        let known = self.motion.is_some() && id == crate::MOTION_EXTENSION.as_bytes();
        i64::from(known)
    }

    fn follows_motion(&self) -> bool {
        self.motion.is_some()
    }

    fn voice_rate(&self, parameters: &[f64], band: Band, wanted_hz: f64) -> f64 {
        self.state
            .voice_rate(parameters.into(), band.edges(), wanted_hz)
    }

    fn voice_new(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RawVoice>, i64> {
        let handle = self
            .state
            .voice_new(parameters.into(), band.edges(), rate_hz, seed);
        if handle < 0 {
            return Err(handle);
        }
        Ok(Box::new(OwnVoice {
            state: self.state.clone(),
            motion: self.motion,
            handle,
            freed: false,
        }))
    }
}

/// A voice and its handle, which no other value holds.
struct OwnVoice<M: Model> {
    state: Arc<State<M>>,
    motion: Option<OwnMotion<M>>,
    handle: i64,
    freed: bool,
}

impl<M: Model> RawVoice for OwnVoice<M> {
    fn render(&mut self, out: &mut [f32]) -> i64 {
        // SAFETY: `&mut self` restricts the handle to one thread at a time.
        unsafe { self.state.voice_render(self.handle, out.into()) }
    }

    fn retune(&mut self, parameters: &[f64]) -> i64 {
        // SAFETY: `&mut self` restricts the handle to one thread at a time.
        unsafe { self.state.voice_retune(self.handle, parameters.into()) }
    }

    fn set_motion(&mut self, motion: Motion) -> i64 {
        let Some(own) = self.motion else {
            return 0;
        };
        // SAFETY: `&mut self` restricts the handle to one thread at a time.
        unsafe { (own.set)(&self.state, self.handle, motion) }
    }

    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        self.state
            .interpolate(sets.into(), weights.into(), parameters.into())
    }

    fn free(&mut self) -> i64 {
        self.freed = true;
        self.state.voice_free(self.handle)
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        shim::last_error(out.into())
    }
}

impl<M: Model> Drop for OwnVoice<M> {
    fn drop(&mut self) {
        if !self.freed {
            // The handle is live, so the call does not fail.
            self.state.voice_free(self.handle);
        }
    }
}
