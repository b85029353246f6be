//! The analog input adapter and its settings.

use htex_device::{
    Descriptor, DeviceError, Endpoint, FromScene, Setting, SettingKind, Settings, Source,
    SourceAdapter,
};

use crate::daq::driver::Driver;
use crate::daq::input_stream::InputStream;
use crate::daq::inputs::Inputs;

/// The analog inputs of National Instruments cards as a source. Samples are volts at the card. The
/// driver is loaded on first use.
pub struct DaqInput {
    descriptor: Descriptor,
}

impl DaqInput {
    pub fn new() -> Self {
        Self { descriptor: descriptor() }
    }
}

impl Default for DaqInput {
    fn default() -> Self {
        Self::new()
    }
}

fn descriptor() -> Descriptor {
    let number = |min, max| SettingKind::Number { min, max };
    let terminals = ["default", "rse", "nrse", "diff", "pseudodiff"];
    let terminals = SettingKind::Choice { values: terminals.map(str::to_owned).to_vec() };
    Descriptor {
        id: "org.htex.daq".to_owned(),
        name: "NI-DAQmx".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Analog inputs of a National Instruments card, volts.".to_owned(),
        settings: vec![
            setting(
                "channels",
                SettingKind::Text,
                "Dev1/ai0:5",
                "Analog inputs, as NI MAX names them: Dev1/ai0:5, or a list with commas.",
            ),
            setting(
                "rate_hz",
                number(1.0, 1e7),
                "20000",
                "Frames a second, hertz; 20,000 in the paper.",
            ),
            setting(
                "range_v",
                number(0.001, 100.0),
                "10",
                "Largest voltage of an input, volts either way; the card takes its next range.",
            ),
            setting(
                "terminals",
                terminals,
                "default",
                "Wiring: referenced (rse) or non-referenced single-ended (nrse), differential, pseudodifferential.",
            ),
            setting(
                "buffer_s",
                number(0.1, 60.0),
                "10",
                "Samples that may wait to be read, seconds.",
            ),
            setting(
                "driver",
                SettingKind::Text,
                "",
                "File of the NI-DAQmx library; empty: the one that is installed.",
            ),
        ],
        profiles: Vec::new(),
        mapping: None,
    }
}

fn setting(name: &str, kind: SettingKind, default: &str, description: &str) -> Setting {
    Setting {
        name: name.to_owned(),
        kind,
        default: Some(default.to_owned()),
        live_default: None,
        from_scene: FromScene::Never,
        description: description.to_owned(),
    }
}

impl SourceAdapter for DaqInput {
    fn descriptor(&self) -> &Descriptor {
        &self.descriptor
    }

    fn target(&self) -> &str {
        "channels"
    }

    /// Lists the analog inputs of all cards that the installed driver knows.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let inputs = Driver::load("")?.inputs().map_err(|fault| fault.failed("NI-DAQmx"))?;
        let endpoint = |(name, product)| Endpoint {
            name,
            setting: "channels".to_owned(),
            summary: format!("analog input of NI {product}"),
        };
        Ok(inputs.into_iter().map(endpoint).collect())
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        let inputs = Inputs::new(settings)?;
        let driver = Driver::load(&inputs.driver)?;
        inputs.check_connected(driver)?;
        Ok(Box::new(InputStream::open(inputs, driver)?))
    }
}
