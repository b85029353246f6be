//! Piecewise linear envelopes (PWLE), as Android's `VibrationEffect.WaveformEnvelopeBuilder`
//! (API 36) accepts them.
//!
//! Android gives access to vibrators only in Java. The application therefore exports three C
//! functions that call Java (`docs/devices.md` declares them). A stream is played as a series of
//! effects. Each effect replaces the previous effect and begins with a ramp from 0. The adapter
//! passes an effect to the application as soon as all blocks of the effect are known.
#![allow(unsafe_code)] // The application's functions are C.

use std::thread::sleep;
use std::time::Duration;

use crate::driver::Claim;
use crate::motor::{Block, Motor, Plan};
use htex_base::native::{Library, Symbols};
use htex_device::DeviceError;
use htex_dsp::reduced::Scale;

/// Duration of an effect, seconds, if the vibrator accepts enough points. Longer effects have fewer
/// ramps; shorter effects have less delay.
const EFFECT_S: f64 = 0.1;
/// Minimum number of points of an effect: a ramp and one more point.
const LEAST_POINTS: u32 = 2;

/// The limits of a vibrator, from `VibratorEnvelopeEffectInfo` and `VibratorFrequencyProfile`.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C)]
pub(crate) struct Limits {
    most_points: u32,
    least_ms: u32,
    most_ms: u32,
    low_hz: f32,
    high_hz: f32,
}

/// The arguments of `addControlPoint`. The values are reached at the end of the duration, which
/// begins at the previous point.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct ControlPoint {
    amplitude: f32,
    frequency_hz: f32,
    duration_ms: u32,
}

/// The application's functions. Each returns 0, or a negative number if it fails.
#[derive(Clone, Copy)]
pub(crate) struct Vibrator {
    play: unsafe extern "C" fn(*const ControlPoint, u32) -> i32,
    cancel: unsafe extern "C" fn() -> i32,
    limits: Limits,
}

impl Vibrator {
    /// Loads the functions from the library at `path`.
    pub(crate) fn load(path: &str) -> Result<Self, DeviceError> {
        let refused = |what: String| DeviceError::setting("runtime", what);
        if path.is_empty() {
            return Err(refused(
                "form=pwle wants the application's library, which has the vibrator; name it"
                    .to_owned(),
            ));
        }
        // SAFETY: the user named this library.
        let library = unsafe { Library::from_name(path) };
        let library =
            library.map_err(|error| refused(format!("`{path}` cannot be loaded: {error}")))?;
        let missing = |name: &'static str| refused(format!("`{path}` has no `{name}`"));
        let symbols = Symbols { library, missing: &missing };
        let mut limits = Limits::default();
        // SAFETY: the functions are published with these names and types.
        let (vibrator, code) = unsafe {
            let get: unsafe extern "C" fn(*mut Limits) -> i32 = symbols.get("htex_pwle_limits")?;
            let code = get(&mut limits);
            let vibrator = Self {
                play: symbols.get("htex_pwle_play")?,
                cancel: symbols.get("htex_pwle_cancel")?,
                limits,
            };
            (vibrator, code)
        };
        if code < 0 {
            return Err(DeviceError::Missing(format!(
                "`{path}` has no vibrator that plays envelopes (htex_pwle_limits returned {code})"
            )));
        }
        vibrator.check(path)
    }

    fn check(self, path: &str) -> Result<Self, DeviceError> {
        let Limits { most_points, least_ms, most_ms, low_hz, high_hz } = self.limits;
        let is_sane =
            most_points >= LEAST_POINTS && least_ms <= most_ms && low_hz > 0.0 && low_hz <= high_hz;
        if is_sane && high_hz.is_finite() {
            Ok(self)
        } else {
            Err(DeviceError::Missing(format!(
                "`{path}` states limits of a vibrator that make no sense: {:?}",
                self.limits
            )))
        }
    }

    /// Checks that the vibrator accepts points with this duration.
    pub(crate) fn takes(&self, block_ms: u32) -> Result<(), DeviceError> {
        let Limits { least_ms, most_ms, .. } = self.limits;
        if (least_ms..=most_ms).contains(&block_ms) {
            Ok(())
        } else {
            Err(DeviceError::setting(
                "block_ms",
                format!(
                    "the vibrator takes points of {least_ms} to {most_ms} ms, and {block_ms} ms is asked for"
                ),
            ))
        }
    }
}

/// The points of blocks that have not been passed to the vibrator yet.
pub(crate) struct Envelopes {
    vibrator: Vibrator,
    scale: Scale,
    block_ms: u32,
    effect: usize,
    waiting: Vec<ControlPoint>,
    frequency_hz: f64,
    /// Whether any effect has been passed to the vibrator.
    started: bool,
    _claim: Claim,
}

impl Envelopes {
    /// Reserves the vibrator. Nothing plays yet.
    pub(crate) fn open(path: &str, plan: &Plan) -> Result<Self, DeviceError> {
        let vibrator = Vibrator::load(path)?;
        let block_ms = milliseconds(plan);
        vibrator.takes(block_ms)?;
        let Limits { most_points, low_hz, high_hz, .. } = vibrator.limits;
        let effect = (EFFECT_S / plan.block_s).ceil() as u32;
        // The last effect needs one more point, which ends the vibration.
        let most = (most_points - 1).max(1);
        Ok(Self {
            vibrator,
            scale: Scale {
                gain: plan.gain,
                low_hz: f64::from(low_hz),
                high_hz: f64::from(high_hz),
            },
            block_ms,
            effect: effect.clamp(1, most) as usize,
            waiting: Vec::new(),
            frequency_hz: f64::from(low_hz + high_hz) / 2.0,
            started: false,
            _claim: Claim::reserve(["parametric", path, "vibrator"], "the vibrator")?,
        })
    }

    fn send(&mut self) -> Result<(), String> {
        // SAFETY: the number of points is correct, and the points live until the call returns.
        let code =
            unsafe { (self.vibrator.play)(self.waiting.as_ptr(), self.waiting.len() as u32) };
        self.waiting.clear();
        self.started = true;
        done("htex_pwle_play", code)
    }
}

impl Motor for Envelopes {
    fn play(&mut self, block: &Block<'_>) -> Result<(), String> {
        let measured = block.measured;
        // Silence has no mean frequency, so the last frequency stays.
        if measured.centroid_hz > 0.0 {
            self.frequency_hz = measured.centroid_hz.clamp(self.scale.low_hz, self.scale.high_hz);
        }
        self.waiting.push(ControlPoint {
            amplitude: self.scale.strength(measured.level_rms) as f32,
            frequency_hz: self.frequency_hz as f32,
            duration_ms: self.block_ms,
        });
        if self.waiting.len() == self.effect { self.send() } else { Ok(()) }
    }

    fn end(&mut self) -> Result<(), String> {
        // The last effect was passed on early. It still has to play for the duration of the blocks
        // after it.
        let left =
            if self.started { (self.effect - 1).saturating_sub(self.waiting.len()) } else { 0 };
        sleep(Duration::from_millis(u64::from(self.block_ms) * left as u64));
        if !self.waiting.is_empty() {
            self.waiting.push(ControlPoint {
                amplitude: 0.0,
                frequency_hz: self.frequency_hz as f32,
                duration_ms: self.block_ms,
            });
            let count = self.waiting.len() as u64;
            self.send()?;
            sleep(Duration::from_millis(u64::from(self.block_ms) * count));
        }
        self.stop()
    }

    fn stop(&mut self) -> Result<(), String> {
        // SAFETY: it takes nothing.
        done("htex_pwle_cancel", unsafe { (self.vibrator.cancel)() })
    }

    fn delay_s(&self) -> f64 {
        f64::from(self.block_ms) / 1e3 * (self.effect - 1) as f64
    }
}

fn done(call: &str, code: i32) -> Result<(), String> {
    match code {
        0.. => Ok(()),
        _ => Err(format!("{call} returned {code}")),
    }
}

/// Returns the duration of a block, which is also the duration of a point, milliseconds.
pub(crate) fn milliseconds(plan: &Plan) -> u32 {
    (1e3 * plan.block_s).round() as u32
}
