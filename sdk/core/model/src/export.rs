//! The macro that generates a model's C functions.

/// Generates the C functions of a [`Model`](crate::Model), and a table of them, `pub static TABLE`.
///
/// `symbols: "FEATURE"` names a Cargo feature of the calling crate. When this feature is on, the
/// macro also exports the functions under their C names (`htex_model_…`). A native library or a
/// WASM module needs these exports. Such a library or module contains exactly one model. A WASM
/// module also gets the two memory functions of the ABI.
///
/// Add `extensions: [motion]`, as in `export_model!(Stick, symbols: "plugin", extensions:
/// [motion])`, if the model has the extension `htex.motion/1`. The model's voice then has to
/// implement [`MotionVoice`](crate::MotionVoice).
///
/// The macro also generates `pub static VOICES` and `pub static MOTION`, which contain the
/// functions of the extensions `htex.voices/1` and `htex.motion/1`. `MOTION` is `None` if the model
/// does not have the extension `htex.motion/1`.
///
/// ```
/// # #![allow(clippy::needless_doctest_main)]
/// # use htex_model::*;
/// # pub struct Flat;
/// # pub struct FlatVoice;
/// # impl Voice for FlatVoice {
/// #     fn render(&mut self, out: &mut [f32]) { out.fill(0.0) }
/// #     fn retune(&mut self, _: &Values<'_>) -> Result<(), Error> { Ok(()) }
/// # }
/// # impl Model for Flat {
/// #     type Voice = FlatVoice;
/// #     const DESCRIPTOR: StaticDescriptor =
/// #         StaticDescriptor::new("org.example.flat", "Flat", "1.0.0", "None.");
/// #     fn fit(_: &FitInput<'_>) -> Result<Fit, Error> { Err(Error::cannot_fit("never")) }
/// #     fn magnitude(_: &Values<'_>, _: Band, _: &[f64], m: &mut [f64]) -> Result<(), Error> { m.fill(1.0); Ok(()) }
/// #     fn interpolate(_: &[Values<'_>], _: &[f64], _: &mut Numbers<'_>) -> Result<(), Error> { Ok(()) }
/// #     fn voice(_: &Values<'_>, _: Band, _: f64, _: u64) -> Result<FlatVoice, Error> { Ok(FlatVoice) }
/// # }
/// htex_model::export_model!(Flat, symbols: "plugin");
/// fn main() {
///     assert_eq!((TABLE.abi_version)(), htex_model::abi::ABI_MARKER);
/// }
/// ```
#[macro_export]
macro_rules! export_model {
    ($model:ty, symbols: $feature:literal) => {
        $crate::export_model!(@model $model, $feature, false);

        /// The C functions of the extension `htex.motion/1`: `None`, because this model does not
        /// have the extension.
        pub static MOTION: Option<$crate::motion_1::MotionTable> = None;
    };
    ($model:ty, symbols: $feature:literal, extensions: [motion]) => {
        $crate::export_model!(@model $model, $feature, true);
        $crate::export_model!(@motion $feature);
    };
    (@model $model:ty, $feature:literal, $motion:literal) => {
        static HTEX_MODEL_STATE: $crate::shim::State<$model> = {
            const DESCRIPTOR: $crate::StaticDescriptor = <$model as $crate::Model>::DESCRIPTOR;
            static JSON: [u8; $crate::json::length(&DESCRIPTOR)] = $crate::json::text(&DESCRIPTOR);
            $crate::shim::State::new(&JSON)
        };

        /// The model's C functions.
        pub static TABLE: $crate::abi::ModelTable = $crate::abi::ModelTable {
            abi_version: htex_model_exports::htex_model_abi_version,
            descriptor: htex_model_exports::htex_model_descriptor,
            last_error: htex_model_exports::htex_model_last_error,
            fit: htex_model_exports::htex_model_fit,
            magnitude: htex_model_exports::htex_model_magnitude,
            interpolate: htex_model_exports::htex_model_interpolate,
            voice_rate: htex_model_exports::htex_model_voice_rate,
            voice_new: htex_model_exports::htex_model_voice_new,
            voice_render: htex_model_exports::htex_model_voice_render,
            voice_retune: htex_model_exports::htex_model_voice_retune,
            voice_free: htex_model_exports::htex_model_voice_free,
            extension: htex_model_exports::htex_model_extension,
        };

        /// The C functions of the extension `htex.voices/1`.
        pub static VOICES: $crate::voices_1::VoicesTable = $crate::voices_1::VoicesTable {
            render: htex_model_exports::htex_voices_1_render,
        };

        /// The C functions under their ABI names; `htex_model::abi` documents them.
        #[allow(missing_docs, clippy::missing_safety_doc, clippy::too_many_arguments)]
        mod htex_model_exports {
            use super::HTEX_MODEL_STATE as STATE;
            use $crate::shim::{self, FitCall, Input, Output};

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_model_abi_version() -> u32 {
                $crate::abi::ABI_MARKER
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_descriptor(
                out: *mut u8,
                capacity: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's buffer is valid.
                STATE.descriptor(unsafe { Output::new(out, capacity) })
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_last_error(
                out: *mut u8,
                capacity: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's buffer is valid.
                shim::last_error(unsafe { Output::new(out, capacity) })
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_fit(
                band_low_hz: f64,
                band_high_hz: f64,
                frequency_hz: *const f64,
                magnitude: *const f64,
                bins: usize,
                signal: *const f64,
                signal_len: usize,
                signal_rate_hz: f64,
                options: *const f64,
                options_len: usize,
                parameters: *mut f64,
                capacity: usize,
                level_rms: *mut f64,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's arrays are valid.
                STATE.fit(unsafe {
                    FitCall {
                        band: (band_low_hz, band_high_hz),
                        frequency_hz: Input::new(frequency_hz, bins),
                        magnitude: Input::new(magnitude, bins),
                        signal: Input::new(signal, signal_len),
                        signal_rate_hz,
                        options: Input::new(options, options_len),
                        parameters: Output::new(parameters, capacity),
                        level_rms: Output::new(level_rms, 1),
                    }
                })
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_magnitude(
                parameters: *const f64,
                parameters_len: usize,
                band_low_hz: f64,
                band_high_hz: f64,
                frequency_hz: *const f64,
                magnitude: *mut f64,
                bins: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's arrays are valid.
                unsafe {
                    STATE.magnitude(
                        Input::new(parameters, parameters_len),
                        (band_low_hz, band_high_hz),
                        Input::new(frequency_hz, bins),
                        Output::new(magnitude, bins),
                    )
                }
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_interpolate(
                sets: *const f64,
                sets_len: usize,
                weights: *const f64,
                weights_len: usize,
                parameters: *mut f64,
                capacity: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's arrays are valid.
                unsafe {
                    STATE.interpolate(
                        Input::new(sets, sets_len),
                        Input::new(weights, weights_len),
                        Output::new(parameters, capacity),
                    )
                }
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_voice_rate(
                parameters: *const f64,
                parameters_len: usize,
                band_low_hz: f64,
                band_high_hz: f64,
                wanted_hz: f64,
            ) -> f64 {
                // SAFETY: the ABI guarantees that the caller's array is valid.
                let parameters = unsafe { Input::new(parameters, parameters_len) };
                STATE.voice_rate(parameters, (band_low_hz, band_high_hz), wanted_hz)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_voice_new(
                parameters: *const f64,
                parameters_len: usize,
                band_low_hz: f64,
                band_high_hz: f64,
                rate_hz: f64,
                seed: u64,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's array is valid.
                let parameters = unsafe { Input::new(parameters, parameters_len) };
                STATE.voice_new(parameters, (band_low_hz, band_high_hz), rate_hz, seed)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_voice_render(
                voice: i64,
                out: *mut f32,
                frames: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's buffer is valid, and that only one
                // thread uses the voice.
                unsafe { STATE.voice_render(voice, Output::new(out, frames)) }
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_voice_retune(
                voice: i64,
                parameters: *const f64,
                parameters_len: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's array is valid, and that only one
                // thread uses the voice.
                unsafe { STATE.voice_retune(voice, Input::new(parameters, parameters_len)) }
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_model_voice_free(voice: i64) -> i64 {
                STATE.voice_free(voice)
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_extension(
                id: *const u8,
                id_len: usize,
            ) -> i64 {
                // SAFETY: the ABI guarantees that the caller's text is valid.
                shim::extension(unsafe { Input::new(id, id_len) }, $motion)
            }

            #[cfg_attr(all(feature = $feature, not(target_family = "wasm")), unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_voices_1_render(
                voices: *const i64,
                count: usize,
                out: *mut f32,
                frames: usize,
            ) -> i64 {
                // SAFETY: the extension guarantees that the caller's arrays are valid, and that
                // only one thread uses each voice.
                unsafe {
                    let out = Output::new(out, count.saturating_mul(frames));
                    STATE.voices_render(Input::new(voices, count), frames, out)
                }
            }

            #[cfg(target_family = "wasm")]
            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) extern "C" fn htex_model_alloc(len: usize) -> *mut u8 {
                shim::alloc(len)
            }

            #[cfg(target_family = "wasm")]
            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_model_free(pointer: *mut u8, len: usize) {
                // SAFETY: the ABI guarantees that `htex_model_alloc` returned this block for this
                // length.
                unsafe { shim::free(pointer, len) }
            }
        }
    };
    (@motion $feature:literal) => {
        /// The C functions of the extension `htex.motion/1`.
        pub static MOTION: Option<$crate::motion_1::MotionTable> =
            Some($crate::motion_1::MotionTable {
                set: htex_motion_exports::htex_motion_1_set,
                fit: htex_motion_exports::htex_motion_1_fit,
            });

        /// The C functions of `htex.motion/1`; `htex_model::motion_1` documents them.
        #[allow(missing_docs, clippy::missing_safety_doc, clippy::too_many_arguments)]
        mod htex_motion_exports {
            use super::HTEX_MODEL_STATE as STATE;
            use $crate::shim::{FitCall, Input, Output};

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_motion_1_set(
                voice: i64,
                speed_mm_s: f64,
                force_n: f64,
                position_mm: f64,
                x_mm: f64,
                y_mm: f64,
            ) -> i64 {
                let motion = $crate::Motion {
                    speed_mm_s,
                    force_n,
                    position_mm,
                    x_mm,
                    y_mm,
                };
                // SAFETY: the extension guarantees that only one thread uses the voice.
                unsafe { STATE.motion_set(voice, motion) }
            }

            #[cfg_attr(feature = $feature, unsafe(no_mangle))]
            pub(super) unsafe extern "C" fn htex_motion_1_fit(
                band_low_hz: f64,
                band_high_hz: f64,
                frequency_hz: *const f64,
                magnitude: *const f64,
                bins: usize,
                signal: *const f64,
                signal_len: usize,
                signal_rate_hz: f64,
                options: *const f64,
                options_len: usize,
                speed_mm_s: f64,
                force_n: f64,
                parameters: *mut f64,
                capacity: usize,
                level_rms: *mut f64,
            ) -> i64 {
                // SAFETY: the extension guarantees that the caller's arrays are valid.
                let call = unsafe {
                    FitCall {
                        band: (band_low_hz, band_high_hz),
                        frequency_hz: Input::new(frequency_hz, bins),
                        magnitude: Input::new(magnitude, bins),
                        signal: Input::new(signal, signal_len),
                        signal_rate_hz,
                        options: Input::new(options, options_len),
                        parameters: Output::new(parameters, capacity),
                        level_rms: Output::new(level_rms, 1),
                    }
                };
                STATE.motion_fit(call, speed_mm_s, force_n)
            }
        }
    };
}
