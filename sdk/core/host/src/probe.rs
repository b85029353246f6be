//! For checkers of models: calls a model with buffers of any size, and with invalid arrays that a
//! host never passes. Apps do not need these functions.
//!
//! These functions do not check the model's results, except that a negative number becomes an
//! error.

use htex_dsp::grid::Band;
#[cfg(feature = "fit")]
use htex_model::FitInput;

use crate::table::TableModel;
use crate::{HostError, LoadedModel, ModelVoice};

/// Length that a call states for an array that does not exist.
const LEN: usize = 4;
/// A handle that belongs to no voice.
const NO_HANDLE: i64 = i64::MAX - 1;

/// Valid arguments of the model's functions. [`LoadedModel::unusable_arrays`] replaces one array at
/// a time by an invalid one.
#[derive(Debug, Clone, Copy)]
pub struct ProbeArguments<'a> {
    pub parameters: &'a [f64],
    pub band: Band,
    /// A sample rate that the model returned for the parameters, hertz.
    pub rate_hz: f64,
    pub frequency_hz: &'a [f64],
    pub magnitude: &'a [f64],
    pub options: &'a [f64],
}

/// The result of a call with an invalid array.
#[derive(Debug, Clone)]
pub struct Unusable {
    /// Names of the function and the array, e.g. "`magnitude` with null `parameters`".
    pub what: String,
    /// The number that the call returned. A rate is truncated to a whole number.
    pub answer: i64,
    /// The number that the ABI requires.
    pub wanted: i64,
}

impl LoadedModel {
    /// Fits the model. Writes the level to `level_rms`, and the parameters to `parameters`. The
    /// array `parameters` may be too short. Returns the number of parameters of the fit.
    ///
    /// # Errors
    /// Returns an error if the model returns one.
    #[cfg(feature = "fit")]
    pub fn fit_into(
        &self,
        input: &FitInput<'_>,
        parameters: &mut [f64],
        level_rms: &mut f64,
    ) -> Result<usize, HostError> {
        self.check("fit", self.raw().fit(input, parameters, level_rms))
    }

    /// Writes the shape's magnitude at each frequency to `magnitude`.
    ///
    /// # Errors
    /// Returns an error if the model returns one.
    pub fn magnitude_into(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<usize, HostError> {
        let raw = self.raw();
        self.check("magnitude", raw.magnitude(parameters, band, frequency_hz, magnitude))
    }

    /// Interpolates concatenated parameter sets, and writes the result to `parameters`. Returns the
    /// length of the whole result, even if `parameters` is shorter.
    ///
    /// # Errors
    /// Returns an error if the model returns one.
    pub fn interpolate_into(
        &self,
        sets: &[f64],
        weights: &[f64],
        parameters: &mut [f64],
    ) -> Result<usize, HostError> {
        let answer = self.raw().interpolate(sets, weights, parameters);
        self.check("interpolate", answer)
    }

    /// Writes the descriptor to `out`. Returns the length of the whole descriptor, even if `out` is
    /// shorter.
    ///
    /// # Errors
    /// Returns an error if the model returns one.
    pub fn descriptor_into(&self, out: &mut [u8]) -> Result<usize, HostError> {
        self.check("descriptor", self.raw().descriptor(out))
    }

    /// Calls each function with null and misaligned arrays. Returns `None` for a WASM module, whose
    /// pointers are only indices into its memory.
    pub fn unusable_arrays(&self, arguments: &ProbeArguments<'_>) -> Option<Vec<Unusable>> {
        self.raw().unusable_arrays(arguments)
    }
}

impl ModelVoice {
    /// Renders without checking the samples.
    ///
    /// # Errors
    /// Returns an error if the model returns one.
    pub fn render_into(&mut self, out: &mut [f32]) -> Result<(), HostError> {
        let answer = self.raw_mut().render(out);
        self.done("voice_render", answer)
    }

    /// Calls `htex_voices_1_render` with the voices at these indices. An index may occur twice, or
    /// belong to no voice. Returns `None` if the model does not have the extension.
    pub fn render_any_together(
        voices: &mut [Self],
        numbers: &[usize],
        frames: usize,
        out: &mut [f32],
    ) -> Option<i64> {
        let render = voices.first()?.together()?.render;
        let handle = |i: &usize| {
            let voice = voices.get(*i).and_then(Self::together);
            voice.map_or(NO_HANDLE, |voice| voice.handle)
        };
        let handles: Vec<i64> = numbers.iter().map(handle).collect();
        if out.len() < handles.len() * frames {
            return None;
        }
        // SAFETY: the slices are live, with `frames` samples for each handle. The exclusive
        // reference ensures that only this thread uses the voices.
        Some(unsafe { render(handles.as_ptr(), handles.len(), out.as_mut_ptr(), frames) })
    }
}

/// Returns a misaligned address of a number whose bytes are readable and writable.
fn misaligned<T>(numbers: &mut [T]) -> *mut T {
    numbers.as_mut_ptr().cast::<u8>().wrapping_add(1).cast()
}

/// Collects answers.
struct Answers(Vec<Unusable>);

impl Answers {
    const INVALID_ARGUMENT: i64 = htex_model::Status::InvalidArgument as i64;

    fn add(&mut self, call: &str, array: &str, answer: i64) {
        self.0.push(Unusable {
            what: format!("`{call}` with {array}"),
            answer,
            wanted: Self::INVALID_ARGUMENT,
        });
    }
}

/// Calls the functions of a table with unusable arrays. A misaligned pointer points into a live
/// array. If a model wrongly uses the pointer, it damages only this array.
impl TableModel {
    pub(crate) fn probe(&self, a: &ProbeArguments<'_>) -> Vec<Unusable> {
        let mut answers = Answers(Vec::new());
        self.probe_texts(&mut answers);
        self.probe_fit(a, &mut answers);
        self.probe_magnitude(a, &mut answers);
        self.probe_interpolate(a, &mut answers);
        self.probe_voice(a, &mut answers);
        answers.0
    }

    fn probe_texts(&self, answers: &mut Answers) {
        let (table, null) = (self.table(), std::ptr::null_mut());
        // SAFETY: null, which must be refused.
        answers.add("descriptor", "null `out`", unsafe { (table.descriptor)(null, LEN) });
        // SAFETY: null, which must be refused.
        answers.add("last_error", "null `out`", unsafe { (table.last_error)(null, LEN) });
        answers.0.push(Unusable {
            what: "`extension` with null `id`".to_owned(),
            // SAFETY: null, which is not the id of an extension.
            answer: unsafe { (table.extension)(null, LEN) },
            wanted: 0,
        });
    }

    fn probe_fit(&self, a: &ProbeArguments<'_>, answers: &mut Answers) {
        let (hz, m, none) = (a.frequency_hz.as_ptr(), a.magnitude.as_ptr(), std::ptr::null());
        let mut out = vec![0.0; a.parameters.len() + 1];
        let (mut numbers, mut level) = (a.frequency_hz.to_vec(), 0.0);
        numbers.push(0.0);
        let to: *mut f64 = out.as_mut_ptr();
        let mut fit = |array: &str, hz, m, signal, signal_len, to, level: *mut f64| {
            let (low, high) = a.band.edges();
            let (bins, capacity) = (a.frequency_hz.len(), a.parameters.len());
            let (options, count) = (a.options.as_ptr(), a.options.len());
            // SAFETY: the slices are live, except one array that must be refused.
            let answer = unsafe {
                (self.table().fit)(
                    low, high, hz, m, bins, signal, signal_len, a.rate_hz, options, count, to,
                    capacity, level,
                )
            };
            answers.add("fit", array, answer);
        };
        let crooked: *const f64 = misaligned(&mut numbers);
        let level: *mut f64 = &raw mut level;
        fit("null `frequency_hz`", none, m, none, 0, to, level);
        fit("misaligned `frequency_hz`", crooked, m, none, 0, to, level);
        fit("null `magnitude`", hz, none, none, 0, to, level);
        fit("null `signal`", hz, m, none, LEN, to, level);
        fit("null `parameters`", hz, m, none, 0, std::ptr::null_mut(), level);
        fit("null `level_rms`", hz, m, none, 0, to, std::ptr::null_mut());
    }

    fn probe_magnitude(&self, a: &ProbeArguments<'_>, answers: &mut Answers) {
        let (mut out, none) = (vec![0.0; a.frequency_hz.len() + 1], std::ptr::null());
        let (p, hz, to) = (a.parameters.as_ptr(), a.frequency_hz.as_ptr(), out.as_mut_ptr());
        let crooked = misaligned(&mut out);
        for (array, p, hz, to) in [
            ("null `parameters`", none, hz, to),
            ("null `frequency_hz`", p, none, to),
            ("null `magnitude`", p, hz, std::ptr::null_mut()),
            ("misaligned `magnitude`", p, hz, crooked),
        ] {
            let (low, high) = a.band.edges();
            // SAFETY: the slices are live, except one array that must be refused.
            answers.add("magnitude", array, unsafe {
                (self.table().magnitude)(
                    p,
                    a.parameters.len(),
                    low,
                    high,
                    hz,
                    to,
                    a.frequency_hz.len(),
                )
            });
        }
    }

    fn probe_interpolate(&self, a: &ProbeArguments<'_>, answers: &mut Answers) {
        let (mut out, weights) = (vec![0.0; a.parameters.len()], [1.0]);
        let (sets, one, none, to) =
            (a.parameters.as_ptr(), weights.as_ptr(), std::ptr::null(), out.as_mut_ptr());
        for (array, sets, weights, to) in [
            ("null `sets`", none, one, to),
            ("null `weights`", sets, none, to),
            ("null `parameters`", sets, one, std::ptr::null_mut()),
        ] {
            let len = a.parameters.len();
            // SAFETY: the slices are live, except one array that must be refused.
            answers.add("interpolate", array, unsafe {
                (self.table().interpolate)(sets, len, weights, 1, to, len)
            });
        }
    }

    fn probe_voice(&self, a: &ProbeArguments<'_>, answers: &mut Answers) {
        let (table, null) = (self.table(), std::ptr::null());
        let (len, (low, high)) = (a.parameters.len(), a.band.edges());
        // SAFETY: null, which must be refused.
        let rate_hz = unsafe { (table.voice_rate)(null, len, low, high, a.rate_hz) };
        answers.add("voice_rate", "null `parameters`", rate_hz as i64);
        // SAFETY: null, which must be refused.
        let new = unsafe { (table.voice_new)(null, len, low, high, a.rate_hz, 0) };
        answers.add("voice_new", "null `parameters`", new);
        // SAFETY: a live slice.
        let voice =
            unsafe { (table.voice_new)(a.parameters.as_ptr(), len, low, high, a.rate_hz, 0) };
        let mut out = [0.0f32; LEN + 1];
        // SAFETY: null, which must be refused.
        answers.add("voice_retune", "null `parameters`", unsafe {
            (table.voice_retune)(voice, null, len)
        });
        for (array, to) in
            [("null `out`", std::ptr::null_mut()), ("misaligned `out`", misaligned(&mut out))]
        {
            // SAFETY: a pointer that must be refused. The misaligned pointer points to live
            // samples.
            answers.add("voice_render", array, unsafe { (table.voice_render)(voice, to, LEN) });
        }
        (table.voice_free)(voice);
    }
}
