//! Reads the settings of the file to write, and checks that the file format supports them.

use std::path::{Path, PathBuf};

use htex_device::{Capabilities, DeviceError, Quantity, Rates, Settings};

use crate::file::encoding::Encoding;

/// Lowest and highest rate, hertz.
const RATES_HZ: (f64, f64) = (100.0, 1_000_000.0);
/// The usual rate of friction recordings, hertz.
const USUAL_RATE_HZ: f64 = 20_000.0;
/// Number of samples per period of a carrier.
const PER_PERIOD: f64 = 10.0;
const BLOCK_FRAMES: u32 = 4_096;

/// File formats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    Wav,
    Csv,
    Npy,
    Raw,
}

/// A file to write.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    pub(crate) path: PathBuf,
    pub(crate) form: Form,
    pub(crate) encoding: Encoding,
    pub(crate) quantity: Quantity,
    /// The factor of each channel. A channel contains each sample multiplied by its factor. Only a
    /// WAV file can have several channels.
    pub(crate) factors: Vec<f32>,
    /// Largest magnitude, in the quantity's unit.
    limit: Option<f64>,
    carrier_hz: Option<f64>,
}

impl Plan {
    pub(crate) fn new(settings: &Settings) -> Result<Self, DeviceError> {
        let path = PathBuf::from(settings.text("path"));
        let form = form(settings.text("format"), &path)?;
        let named = settings.text("quantity");
        let mut all = Quantity::ALL.into_iter();
        // The descriptor allows only these names, so the fallback is never used.
        let quantity =
            all.find(|quantity| quantity.name() == named).unwrap_or(Quantity::LateralForce);
        let plan = Self {
            encoding: encoding(settings, form)?,
            path,
            form,
            quantity,
            factors: vec![1.0],
            limit: of_voltage(settings, quantity, "limit_v")?,
            carrier_hz: of_voltage(settings, quantity, "carrier_hz")?,
        };
        if quantity == Quantity::DisplayVoltage && plan.limit.is_none() {
            return refuse("limit_v", "a display_voltage must have a limit above 0 V");
        }
        Ok(plan)
    }

    /// Plans a WAV file of sound with one channel for each factor.
    pub(crate) fn channels(path: PathBuf, factors: Vec<f32>) -> Self {
        Self {
            path,
            form: Form::Wav,
            encoding: Encoding::F32,
            quantity: Quantity::Sound,
            factors,
            limit: Some(1.0),
            carrier_hz: None,
        }
    }

    pub(crate) fn capabilities(&self) -> Capabilities {
        let integer = self.encoding.step_and_limit();
        let limits = [integer.map(|(_, limit)| limit), self.limit];
        let carried = self.carrier_hz.map_or(0.0, |hz| PER_PERIOD * hz);
        Capabilities {
            quantity: self.quantity,
            rates: Rates::Range { min_hz: RATES_HZ.0, max_hz: RATES_HZ.1 },
            default_rate_hz: carried.clamp(USUAL_RATE_HZ, RATES_HZ.1),
            limit: limits.into_iter().flatten().reduce(f64::min),
            step: integer.map(|(step, _)| step),
            carrier_hz: self.carrier_hz,
            paced: false,
            block_frames: BLOCK_FRAMES,
        }
    }

    /// Checks that this file format supports the rate.
    pub(crate) fn check_rate(&self, rate_hz: f64) -> Result<(), DeviceError> {
        let rates = self.capabilities().rates;
        if !rates.has(rate_hz) {
            return Err(DeviceError::Rate {
                device: "File".to_owned(),
                rate_hz,
                rates: rates.to_string(),
            });
        }
        if self.form == Form::Wav && rate_hz.fract() != 0.0 {
            let what = format!("the rate of a WAV file is a whole number, and {rate_hz} Hz is not");
            return refuse("format", &what);
        }
        Ok(())
    }
}

fn form(format: &str, path: &Path) -> Result<Form, DeviceError> {
    let extension =
        path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let wanted = if format == "auto" { &extension } else { format };
    match wanted {
        "wav" => Ok(Form::Wav),
        "csv" => Ok(Form::Csv),
        "npy" => Ok(Form::Npy),
        "raw" => Ok(Form::Raw),
        _ => refuse("format", "the file's extension is not wav, csv, npy or raw; name the format"),
    }
}

fn encoding(settings: &Settings, form: Form) -> Result<Encoding, DeviceError> {
    let full_scale = settings.number("full_scale");
    match (settings.text("encoding"), form) {
        (_, Form::Csv) if settings.text("encoding") != "f32" => {
            refuse("encoding", "a CSV holds the quantity in its unit; only f32 is supported")
        }
        ("i24", Form::Npy) => refuse("encoding", "NPY has no i24; choose f32 or i16"),
        ("i24", _) => Ok(Encoding::integer(24, full_scale)),
        ("i16", _) => Ok(Encoding::integer(16, full_scale)),
        _ if full_scale != 1.0 => refuse(
            "full_scale",
            "f32 holds the quantity in its unit; only i24 and i16 have another scale",
        ),
        _ => Ok(Encoding::F32),
    }
}

/// Reads a setting that applies only to voltages. The value 0 means that it is not set.
fn of_voltage(
    settings: &Settings,
    quantity: Quantity,
    name: &str,
) -> Result<Option<f64>, DeviceError> {
    let number = Some(settings.number(name)).filter(|number| *number > 0.0);
    if number.is_some() && quantity != Quantity::DisplayVoltage {
        return refuse(name, "only the quantity display_voltage has one");
    }
    Ok(number)
}

fn refuse<T>(name: &str, what: &str) -> Result<T, DeviceError> {
    Err(DeviceError::setting(name, what))
}
