//! A loaded model: calls its functions safely and checks their results.

use std::path::Path;
use std::sync::Arc;

use htex_dsp::grid::Band;
use htex_model::abi::{MAX_PARAMETERS, MAX_RATE_HZ, MAX_TEXT_BYTES, MIN_RATE_HZ};
use htex_model::{Descriptor, Kind, Status, Values};
#[cfg(feature = "fit")]
use htex_model::{Fit, FitInput};

use crate::descriptor::read_descriptor;
use crate::error::plain;
use crate::raw::{RawModel, check_marker};
use crate::sandbox::Sandbox;
use crate::{HostError, ModelVoice, Origin, WasmLimits};

/// Usual sample rate of a sound card, hertz.
pub(crate) const HIGH_RATE_HZ: f64 = 48_000.0;

/// Id of the ABI extension for models that follow the motion of the finger.
pub const MOTION_EXTENSION: &str = htex_model::motion_1::MotionTable::ID;
/// When a function returns parameters, the first call has a parameter buffer of this length.
const USUAL_PARAMETERS: usize = 256;

/// A model that can be called. Cloning this value does not load the model again.
///
/// ```
/// use htex_host::{Band, Registry};
/// let registry = Registry::builtin();
/// let bands = registry.find("bands")?;
/// assert_eq!((bands.id(), bands.short_name()), ("org.htex.bands", "bands"));
/// let sbeta = registry.find("sbeta")?;
/// let magnitude = sbeta.magnitude(&[2.0, 5.0], Band::TACTILE, &[50.0, 2_000.0])?;
/// assert_eq!(magnitude[1], 0.0, "outside the band");
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Clone)]
pub struct LoadedModel {
    descriptor: Arc<Descriptor>,
    origin: Arc<Origin>,
    raw: Arc<dyn RawModel>,
}

impl std::fmt::Debug for LoadedModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("LoadedModel").field(&self.descriptor.id).finish()
    }
}

impl LoadedModel {
    /// Checks the marker and reads the descriptor of a model.
    pub(crate) fn new(origin: Origin, raw: Arc<dyn RawModel>) -> Result<Self, HostError> {
        let name = origin.to_string();
        let broken = |call, what| HostError::Broken { model: name.clone(), call, what };
        check_marker(&name, raw.abi_version())?;
        let call = "htex_model_descriptor";
        let json = text(|out| raw.descriptor(out)).map_err(|error| match error {
            TextError::Status(status) => HostError::Call {
                model: name.clone(),
                call,
                status: Status::from_code(status),
                message: reason(|out| raw.last_error(out)),
            },
            TextError::Broken(what) => broken(call, what),
        })?;
        let descriptor = read_descriptor(&json).map_err(|error| broken(call, error.to_string()))?;
        Ok(Self::of(origin, descriptor, raw))
    }

    pub(crate) fn of(origin: Origin, descriptor: Descriptor, raw: Arc<dyn RawModel>) -> Self {
        Self { descriptor: Arc::new(descriptor), origin: Arc::new(origin), raw }
    }

    /// Loads a model from a file. A WASM module (`.wasm`) runs in a sandbox with the default
    /// limits. A native library runs with all the rights of this program.
    ///
    /// # Errors
    /// Returns an error if the file is neither a WASM module nor a native library, or if its model
    /// violates the ABI.
    pub fn from_file(path: &Path) -> Result<Self, HostError> {
        Self::from_file_within(path, &WasmLimits::default())
    }

    /// Loads a model as [`Self::from_file`] does, but with other limits for a WASM module.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_file`].
    pub fn from_file_within(path: &Path, limits: &WasmLimits) -> Result<Self, HostError> {
        Self::from_file_in(path, &Sandbox::new(limits))
    }

    /// Loads a model as [`Self::from_file`] does, in a sandbox that other models may share.
    pub(crate) fn from_file_in(path: &Path, sandbox: &Sandbox) -> Result<Self, HostError> {
        if path.extension().is_some_and(|extension| extension == "wasm") {
            return Self::from_wasm_file(path, sandbox);
        }
        let raw = crate::native::load(path)?;
        Self::new(Origin::Native(path.to_owned()), Arc::new(raw))
    }

    /// Loads a model from a file that the user did not name. The file must be a WASM module,
    /// whatever its name is. If a file, such as a recipe, names another file, only this function
    /// decides whether the host loads that file.
    pub(crate) fn from_module_in(path: &Path, sandbox: &Sandbox) -> Result<Self, HostError> {
        if !is_module(path).map_err(HostError::loading(path.display()))? {
            return Err(HostError::NotModule { path: path.display().to_string() });
        }
        Self::from_wasm_file(path, sandbox)
    }

    #[cfg(feature = "wasm")]
    fn from_wasm_file(path: &Path, sandbox: &Sandbox) -> Result<Self, HostError> {
        let origin = path.display().to_string();
        check_engine(&origin, sandbox)?;
        let raw = crate::wasm::load_file(path, sandbox)?;
        Self::new(Origin::Wasm(path.to_owned()), Arc::new(raw))
    }

    #[cfg(not(feature = "wasm"))]
    fn from_wasm_file(path: &Path, _: &Sandbox) -> Result<Self, HostError> {
        Err(no_wasm(&path.display().to_string()))
    }

    /// Loads a model from the bytes of a WASM module. `name` names the asset or file that contains
    /// the module; error messages contain this name.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a module, its model violates the ABI, or this program
    /// was built without the `wasm` feature.
    pub fn from_wasm_bytes(
        name: &str,
        bytes: &[u8],
        limits: &WasmLimits,
    ) -> Result<Self, HostError> {
        Self::from_wasm_in(name, bytes, &Sandbox::new(limits))
    }

    /// Loads a model as [`Self::from_wasm_bytes`] does, in a sandbox that other models may share.
    #[cfg(any(feature = "wasm", target_family = "wasm"))]
    pub(crate) fn from_wasm_in(
        name: &str,
        bytes: &[u8],
        sandbox: &Sandbox,
    ) -> Result<Self, HostError> {
        check_engine(name, sandbox)?;
        let origin = Origin::Embedded(name.to_owned());
        let raw = crate::wasm::load(&origin.to_string(), bytes, sandbox)?;
        Self::new(origin, Arc::new(raw))
    }

    #[cfg(not(any(feature = "wasm", target_family = "wasm")))]
    pub(crate) fn from_wasm_in(name: &str, _: &[u8], _: &Sandbox) -> Result<Self, HostError> {
        Err(no_wasm(name))
    }

    /// Returns whether both are clones of one model.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.raw, &other.raw)
    }

    /// Returns the origin of the model's code.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    pub fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    /// Returns the model's reverse-DNS id.
    pub fn id(&self) -> &str {
        &self.descriptor.id
    }

    /// Returns the last part of the id, the name used on command lines.
    pub fn short_name(&self) -> &str {
        let id = self.id();
        id.rsplit('.').next().unwrap_or(id)
    }

    /// Fits the model to a spectrum. `input.options` must contain one value for each option of the
    /// descriptor, in the descriptor's order. [`Self::options`] makes this list. Only models that
    /// follow the motion ([`Self::follows_motion`]) receive `input.condition`. Needs the feature
    /// `fit`.
    ///
    /// ```
    /// use htex_host::{Band, FitCondition, FitInput, Registry};
    /// let registry = Registry::builtin();
    /// let model = registry.find("sslope")?;
    /// let frequency_hz: Vec<f64> = (4..=200).map(|i| 5.0 * f64::from(i)).collect();
    /// let magnitude: Vec<f64> = frequency_hz.iter().map(|f| 0.01 * 100.0 / f).collect();
    /// let fit = model.fit(&FitInput {
    ///     band: Band::TACTILE,
    ///     frequency_hz: &frequency_hz,
    ///     magnitude: &magnitude,
    ///     signal: &[],
    ///     signal_rate_hz: 20_000.0,
    ///     options: &model.options(&[])?,
    ///     condition: FitCondition::default(),
    /// })?;
    /// assert!(fit.level_rms > 0.0);
    /// # Ok::<(), htex_host::HostError>(())
    /// ```
    ///
    /// # Errors
    /// Returns [`HostError::Call`] if the model cannot describe the spectrum. Models that follow
    /// the motion also return this error if the speed or the force is negative or not finite.
    #[cfg(feature = "fit")]
    pub fn fit(&self, input: &FitInput<'_>) -> Result<Fit, HostError> {
        let call = "fit";
        if input.frequency_hz.len() != input.magnitude.len() {
            let what = format!(
                "there are {} magnitudes for {} frequencies; pass one per frequency",
                input.magnitude.len(),
                input.frequency_hz.len()
            );
            return Err(self.error(call, Status::InvalidArgument, what));
        }
        // The initial value is NaN, so that it is an error if the model does not write a level.
        let mut level_rms = f64::NAN;
        let parameters = self.numbers(call, |out| self.raw.fit(input, out, &mut level_rms))?;
        if !level_rms.is_finite() || level_rms < 0.0 {
            return Err(self.broken(call, format!("the level is {level_rms}")));
        }
        Ok(Fit { parameters, level_rms })
    }

    /// Returns the magnitude of the spectrum's shape at each frequency in `frequency_hz`. The shape
    /// has unit RMS on the 5 Hz grid in the band.
    ///
    /// # Errors
    /// Returns [`HostError::Call`] if the model refuses the arguments, and [`HostError::Broken`] if
    /// a magnitude is negative or not finite.
    pub fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, HostError> {
        let call = "magnitude";
        // The initial values are NaN, so that it is an error if the model does not write all
        // magnitudes.
        let mut magnitude = vec![f64::NAN; frequency_hz.len()];
        let (raw, band) = (&self.raw, band);
        let answer = raw.magnitude(parameters, band, frequency_hz, &mut magnitude);
        self.check(call, answer)?;
        self.check_zero(call, answer)?;
        match magnitude.iter().position(|m| !m.is_finite() || *m < 0.0) {
            None => Ok(magnitude),
            Some(i) => {
                let what = format!("{} at {} Hz", magnitude[i], frequency_hz[i]);
                Err(self.broken(call, what))
            }
        }
    }

    /// Interpolates parameter sets with weights that sum to one.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason.
    pub fn interpolate(&self, sets: &[&[f64]], weights: &[f64]) -> Result<Vec<f64>, HostError> {
        let call = "interpolate";
        if sets.len() != weights.len() {
            let what = format!(
                "there are {} weights for {} sets; pass one per set",
                weights.len(),
                sets.len()
            );
            return Err(self.error(call, Status::InvalidArgument, what));
        }
        let flat = sets.concat();
        self.numbers(call, |out| self.raw.interpolate(&flat, weights, out))
    }

    /// Returns the length of the longest parameter set that the descriptor allows.
    pub fn most_parameters(&self) -> usize {
        let most = self.descriptor.fields.iter().map(|field| match field.kind {
            Kind::Scalar => 1,
            Kind::List { max_len } => 1 + max_len as usize,
        });
        most.sum::<usize>().min(MAX_PARAMETERS)
    }

    /// Returns the sample rate of a voice, hertz. `wanted_hz` is the rate that the caller needs. If
    /// the model returns another rate, the caller must resample the voice's samples.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason.
    pub fn voice_rate_hz(
        &self,
        parameters: &[f64],
        band: Band,
        wanted_hz: f64,
    ) -> Result<f64, HostError> {
        let rate_hz = self.raw.voice_rate(parameters, band, wanted_hz);
        if rate_hz < 0.0 {
            self.check("voice_rate", rate_hz as i64)?;
        }
        if (MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
            return Ok(rate_hz);
        }
        Err(self.broken("voice_rate", format!("a rate of {rate_hz} Hz")))
    }

    /// Returns whether `rate_hz` is the model's own rate, i.e. whether the model returns this rate
    /// for every requested rate. To test this, the function requests a much higher rate.
    ///
    /// # Errors
    /// Returns the errors of [`Self::voice_rate_hz`].
    pub fn has_own_rate(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
    ) -> Result<bool, HostError> {
        let high_hz = HIGH_RATE_HZ.max(4.0 * rate_hz).min(MAX_RATE_HZ);
        Ok(self.voice_rate_hz(parameters, band, high_hz)? == rate_hz)
    }

    /// Creates a voice that renders at `rate_hz`, which must be a rate that [`Self::voice_rate_hz`]
    /// returned.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason.
    pub fn voice(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<ModelVoice, HostError> {
        match self.raw.voice_new(parameters, band, rate_hz, seed) {
            Ok(voice) => Ok(ModelVoice::new(self.clone(), voice)),
            Err(0) => Err(self.broken("voice_new", "it returns the handle 0".to_owned())),
            Err(status) => {
                Err(self.call_error("voice_new", status, |out| self.raw.last_error(out)))
            }
        }
    }

    /// For checkers of models: renders two equal voices in a single instance of a WASM module, one
    /// after the other, with `frames` samples for each voice. In normal use, each voice has its own
    /// instance. Returns `None` for a model that is not a WASM module.
    ///
    /// # Errors
    /// Returns [`HostError::Call`] if the model returns an error.
    pub fn two_voices(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
        frames: usize,
    ) -> Result<Option<[Vec<f32>; 2]>, HostError> {
        let mut out = [vec![0.0; frames], vec![0.0; frames]];
        match self.raw.two_voices(parameters, band, rate_hz, seed, &mut out) {
            None => Ok(None),
            Some(status) => self.check("voice_render", status).map(|_| Some(out)),
        }
    }

    /// Returns whether the model has the extension `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`).
    ///
    /// # Errors
    /// Returns [`HostError::Broken`] if the model returns neither 0 nor 1.
    pub fn has_extension(&self, id: &str) -> Result<bool, HostError> {
        match self.check("extension", self.raw.extension(id.as_bytes()))? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.broken("extension", format!("it returns {other} for `{id}`"))),
        }
    }

    /// Returns whether the model has the extension `htex.motion/1`. The voices of such a model
    /// receive the motion of the finger ([`ModelVoice::set_motion`]), and the model itself changes
    /// the sound with the motion. The fits of such a model receive the speed and force of the
    /// recording.
    pub fn follows_motion(&self) -> bool {
        self.raw.follows_motion()
    }

    /// Converts a returned number to a length. A negative number becomes an error.
    pub(crate) fn check(&self, call: &'static str, returned: i64) -> Result<usize, HostError> {
        if returned >= 0 {
            return Ok(returned as usize);
        }
        Err(self.call_error(call, returned, |out| self.raw.last_error(out)))
    }

    /// Checks the status that a call without a result returned: 0 is success.
    pub(crate) fn check_zero(&self, call: &'static str, answer: i64) -> Result<(), HostError> {
        match answer {
            0 => Ok(()),
            other => Err(self.broken(call, format!("it returns {other}; 0 means success"))),
        }
    }

    pub(crate) fn raw(&self) -> &dyn RawModel {
        self.raw.as_ref()
    }

    /// Returns the error of a negative status, with the model's last-error text.
    pub(crate) fn call_error(
        &self,
        call: &'static str,
        status: i64,
        last_error: impl FnMut(&mut [u8]) -> i64,
    ) -> HostError {
        self.error(call, Status::from_code(status), reason(last_error))
    }

    /// Makes a call that returns parameters. The first call has a buffer of the usual size. If this
    /// buffer is too small, a second call has a larger one. The result must be one parameter set
    /// that matches the descriptor.
    fn numbers(
        &self,
        call: &'static str,
        mut with: impl FnMut(&mut [f64]) -> i64,
    ) -> Result<Vec<f64>, HostError> {
        let mut numbers = vec![0.0; USUAL_PARAMETERS];
        let mut len = self.check(call, with(&mut numbers))?;
        if len > numbers.len() && len <= MAX_PARAMETERS {
            numbers.resize(len, 0.0);
            len = self.check(call, with(&mut numbers))?;
        }
        if len > numbers.len() {
            return Err(self.broken(call, format!("{len} parameters")));
        }
        numbers.truncate(len);
        let fits = Values::read(&*self.descriptor, &numbers).map(|_| ());
        fits.map_err(|error| self.broken(call, error.message))?;
        Ok(numbers)
    }

    pub(crate) fn error(&self, call: &'static str, status: Status, message: String) -> HostError {
        HostError::Call { model: self.id().to_owned(), call, status, message }
    }

    pub(crate) fn broken(&self, call: &'static str, what: String) -> HostError {
        HostError::Broken { model: self.id().to_owned(), call, what }
    }
}

/// An error of reading a text.
enum TextError {
    /// The model returned this status.
    Status(i64),
    /// The returned length or text violates the ABI.
    Broken(String),
}

/// Reads a text of unknown length with two calls: one for the length, one for the text.
fn text(mut call: impl FnMut(&mut [u8]) -> i64) -> Result<String, TextError> {
    let first = call(&mut []);
    let len = usize::try_from(first).map_err(|_| TextError::Status(first))?;
    if len > MAX_TEXT_BYTES {
        let what = format!("its text has {len} bytes; {MAX_TEXT_BYTES} are allowed");
        return Err(TextError::Broken(what));
    }
    let mut bytes = vec![0; len];
    match call(&mut bytes) {
        status if status < 0 => Err(TextError::Status(status)),
        // The buffer has the length that the first call returned, so a longer text would be cut
        // off.
        second if second != first => Err(TextError::Broken(format!(
            "its text has {first} bytes in one call and {second} in the next"
        ))),
        _ => String::from_utf8(bytes).map_err(|e| TextError::Broken(e.to_string())),
    }
}

/// Returns the model's last-error text.
fn reason(last_error: impl FnMut(&mut [u8]) -> i64) -> String {
    let text = text(last_error).ok().filter(|text| !text.is_empty());
    text.map_or_else(|| "no reason given".to_owned(), |text| plain(&text))
}

/// Refuses a module if the engine is off.
#[cfg(any(feature = "wasm", target_family = "wasm"))]
fn check_engine(origin: &str, sandbox: &Sandbox) -> Result<(), HostError> {
    match sandbox.limits.engine {
        crate::WasmEngine::Off => Err(HostError::Load {
            path: origin.to_owned(),
            what: "the engine of WASM modules is off; turn it on in the options of opening"
                .to_owned(),
        }),
        _ => Ok(()),
    }
}

#[cfg(not(feature = "wasm"))]
fn no_wasm(origin: &str) -> HostError {
    HostError::Load {
        path: origin.to_owned(),
        what: "this program was built without the engine of WASM modules; build it with the Cargo feature `wasm`, which \
               is on by default".to_owned(),
    }
}

/// Returns whether the path is a regular file that begins with the bytes of a WASM module.
fn is_module(path: &Path) -> std::io::Result<bool> {
    use std::io::Read;
    // Opening a named pipe would block.
    if !path.metadata()?.is_file() {
        return Ok(false);
    }
    let mut first = Vec::new();
    std::fs::File::open(path)?.take(4).read_to_end(&mut first)?;
    Ok(first == b"\0asm")
}
