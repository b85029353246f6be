//! A loaded model: safe calls, checked answers.

use std::path::Path;
use std::sync::Arc;

use htex_dsp::grid::Band;
use htex_model::abi::{
    ABI_MAJOR, ABI_MARKER, MAX_FIELDS, MAX_PARAMETERS, MAX_RATE_HZ, MAX_TEXT_BYTES, MIN_RATE_HZ,
};
use htex_model::{Descriptor, Fit, Status, Values};

use crate::raw::{RawFit, RawModel};
use crate::{HostError, ModelVoice};

/// Parameters for which there is room at the first call.
const USUAL_PARAMETERS: usize = 256;

/// What a fit may look at; see [`htex_model::FitInput`] for units.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)]
pub struct FitRequest<'a> {
    pub band: Band,
    pub frequency_hz: &'a [f64],
    pub magnitude: &'a [f64],
    pub signal: &'a [f64],
    pub signal_rate_hz: f64,
    /// One value an option of the descriptor; [`LoadedModel::options`] makes them.
    pub options: &'a [f64],
}

/// A model that can be called. Cheap to clone.
#[derive(Clone)]
pub struct LoadedModel {
    descriptor: Arc<Descriptor>,
    raw: Arc<dyn RawModel>,
}

impl std::fmt::Debug for LoadedModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("LoadedModel")
            .field(&self.descriptor.id)
            .finish()
    }
}

impl LoadedModel {
    /// Checks the marker and reads the descriptor of a model from `origin` (for messages).
    pub(crate) fn new(origin: &str, raw: Arc<dyn RawModel>) -> Result<Self, HostError> {
        let broken = |call, what| HostError::Broken {
            model: origin.to_owned(),
            call,
            what,
        };
        check_marker(origin, raw.abi_version())?;
        let call = "htex_model_descriptor";
        let json = text(|out| raw.descriptor(out))
            .ok_or_else(|| broken(call, "no UTF-8 text of at most 1 MiB".to_owned()))?;
        let descriptor: Descriptor =
            serde_json::from_str(&json).map_err(|e| broken(call, e.to_string()))?;
        check_descriptor(&descriptor).map_err(|what| broken(call, what))?;
        Ok(Self {
            descriptor: Arc::new(descriptor),
            raw,
        })
    }

    /// Loads a model from a native library.
    ///
    /// # Errors
    /// When the file is no such library, or its model breaks the ABI.
    pub fn from_file(path: &Path) -> Result<Self, HostError> {
        let raw = crate::native::load(path)?;
        Self::new(&path.display().to_string(), Arc::new(raw))
    }

    /// What the model says of itself.
    pub fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    /// The model's reverse-DNS id.
    pub fn id(&self) -> &str {
        &self.descriptor.id
    }

    /// The last part of the id: the name used on command lines.
    pub fn short_name(&self) -> &str {
        let id = self.id();
        id.rsplit('.').next().unwrap_or(id)
    }

    /// Fits the model to a spectrum.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason.
    pub fn fit(&self, request: &FitRequest<'_>) -> Result<Fit, HostError> {
        let call = "fit";
        if request.frequency_hz.len() != request.magnitude.len() {
            let what = "as many magnitudes as frequencies are wanted".to_owned();
            return Err(self.error(call, Status::InvalidArgument, what));
        }
        let raw = RawFit {
            band: abi_band(request.band),
            frequency_hz: request.frequency_hz,
            magnitude: request.magnitude,
            signal: request.signal,
            signal_rate_hz: request.signal_rate_hz,
            options: request.options,
        };
        let mut level_rms = f64::NAN;
        let parameters = self.numbers(call, |out| self.raw.fit(&raw, out, &mut level_rms))?;
        if !level_rms.is_finite() || level_rms < 0.0 {
            return Err(self.broken(call, format!("the level is {level_rms}")));
        }
        Ok(Fit {
            parameters,
            level_rms,
        })
    }

    /// The shape's magnitude at `frequency_hz`: unit RMS on the 5 Hz grid in the band.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason; [`HostError::Broken`] if a magnitude is not a
    /// number or negative.
    pub fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, HostError> {
        let call = "magnitude";
        let mut magnitude = vec![f64::NAN; frequency_hz.len()];
        let (raw, band) = (&self.raw, abi_band(band));
        self.check(
            call,
            raw.magnitude(parameters, band, frequency_hz, &mut magnitude),
        )?;
        match magnitude.iter().position(|m| !m.is_finite() || *m < 0.0) {
            None => Ok(magnitude),
            Some(i) => {
                let what = format!("{} at {} Hz", magnitude[i], frequency_hz[i]);
                Err(self.broken(call, what))
            }
        }
    }

    /// Parameters between several sets, weighted; weights sum to one.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason.
    pub fn interpolate(&self, sets: &[&[f64]], weights: &[f64]) -> Result<Vec<f64>, HostError> {
        let call = "interpolate";
        if sets.len() != weights.len() {
            let what = "as many weights as sets are wanted".to_owned();
            return Err(self.error(call, Status::InvalidArgument, what));
        }
        let flat = sets.concat();
        self.numbers(call, |out| self.raw.interpolate(&flat, weights, out))
    }

    /// Parameters between several sets, into the caller's buffer, without allocating on this side;
    /// answers how many there are.
    ///
    /// # Errors
    /// As [`Self::interpolate`], and when `out` is too small.
    pub fn interpolate_into(
        &self,
        sets: &[f64],
        weights: &[f64],
        out: &mut [f64],
    ) -> Result<usize, HostError> {
        let call = "interpolate";
        let len = self.check(call, self.raw.interpolate(sets, weights, out))?;
        if len > out.len() {
            return Err(self.broken(call, format!("{len} parameters where {} fit", out.len())));
        }
        Ok(len)
    }

    /// The rate at which a voice renders when `wanted_hz` is wanted, hertz.
    ///
    /// # Errors
    /// [`HostError::Call`] with the model's reason.
    pub fn voice_rate_hz(
        &self,
        parameters: &[f64],
        band: Band,
        wanted_hz: f64,
    ) -> Result<f64, HostError> {
        let rate_hz = self.raw.voice_rate(parameters, abi_band(band), wanted_hz);
        if rate_hz < 0.0 {
            self.check("voice_rate", rate_hz as i64)?;
        }
        if (MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
            return Ok(rate_hz);
        }
        Err(self.broken("voice_rate", format!("a rate of {rate_hz} Hz")))
    }

    /// Makes a voice that renders at `rate_hz`, which is what [`Self::voice_rate_hz`] answered.
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
        let band = abi_band(band);
        match self.raw.voice_new(parameters, band, rate_hz, seed) {
            Ok(voice) => Ok(ModelVoice::new(self.clone(), voice)),
            Err(status) => Err(self.told("voice_new", status, |out| self.raw.last_error(out))),
        }
    }

    /// Whether the model has the extension `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`).
    ///
    /// # Errors
    /// [`HostError::Broken`] if the answer is neither yes nor no.
    pub fn has_extension(&self, id: &str) -> Result<bool, HostError> {
        match self.raw.extension(id.as_bytes()) {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.broken("extension", format!("it answers {other} to `{id}`"))),
        }
    }

    /// A length, or the error that a negative answer stands for.
    fn check(&self, call: &'static str, answer: i64) -> Result<usize, HostError> {
        if answer >= 0 {
            return Ok(answer as usize);
        }
        Err(self.told(call, answer, |out| self.raw.last_error(out)))
    }

    /// The error of a negative answer, in the words of the model.
    pub(crate) fn told(
        &self,
        call: &'static str,
        answer: i64,
        last_error: impl FnMut(&mut [u8]) -> i64,
    ) -> HostError {
        let message = text(last_error).unwrap_or_else(|| "no reason given".to_owned());
        self.error(call, Status::from_code(answer), message)
    }

    /// Calls with a buffer of the usual size, and once more if that was too small; the answer must
    /// be one set of parameters that fits the descriptor.
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
        let fits = Values::read(&self.descriptor, &numbers).map(|_| ());
        fits.map_err(|error| self.broken(call, error.message))?;
        Ok(numbers)
    }

    fn error(&self, call: &'static str, status: Status, message: String) -> HostError {
        HostError::Call {
            model: self.id().to_owned(),
            call,
            status,
            message,
        }
    }

    fn broken(&self, call: &'static str, what: String) -> HostError {
        HostError::Broken {
            model: self.id().to_owned(),
            call,
            what,
        }
    }
}

/// Refuses a model of another major version of the ABI.
pub(crate) fn check_marker(origin: &str, marker: u32) -> Result<(), HostError> {
    if marker >> 8 == ABI_MARKER >> 8 {
        return Ok(());
    }
    Err(HostError::Broken {
        model: origin.to_owned(),
        call: "htex_model_abi_version",
        what: format!("its marker is {marker:#x}; this host loads models of ABI {ABI_MAJOR}.x"),
    })
}

fn abi_band(band: Band) -> htex_model::Band {
    htex_model::Band {
        low_hz: band.low_hz,
        high_hz: band.high_hz,
    }
}

/// Reads a text of a length not known beforehand.
fn text(mut call: impl FnMut(&mut [u8]) -> i64) -> Option<String> {
    let len = usize::try_from(call(&mut [])).ok()?;
    if len > MAX_TEXT_BYTES {
        return None;
    }
    let mut bytes = vec![0; len];
    (call(&mut bytes) == len as i64).then_some(())?;
    String::from_utf8(bytes).ok()
}

fn check_descriptor(descriptor: &Descriptor) -> Result<(), String> {
    let dotted = descriptor.id.split('.').count() >= 3
        && descriptor.id.split('.').all(|part| !part.is_empty());
    if !dotted
        || !descriptor
            .id
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b"._-".contains(&b))
    {
        return Err(format!("`{}` is not a reverse-DNS id", descriptor.id));
    }
    if semver::Version::parse(&descriptor.version).is_err() {
        return Err(format!(
            "`{}` is not a semantic version",
            descriptor.version
        ));
    }
    if descriptor.fields.is_empty() || descriptor.fields.len() > MAX_FIELDS {
        return Err(format!("1 to {MAX_FIELDS} parameter fields are allowed"));
    }
    let fields = descriptor.fields.iter().map(|f| (&f.name, f.min, f.max));
    let options = descriptor.options.iter().map(|o| (&o.name, o.min, o.max));
    for (name, min, max) in fields.chain(options) {
        if !(min.is_finite() && max.is_finite() && min <= max) {
            return Err(format!("`{name}` has the range {min} to {max}"));
        }
    }
    let mut names: Vec<&str> = descriptor.fields.iter().map(|f| f.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("two fields are named `{}`", pair[0])),
        None => Ok(()),
    }
}
