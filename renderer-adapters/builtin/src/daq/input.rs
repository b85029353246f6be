//! The analog input adapter and its settings.

use std::sync::LazyLock;

use htex_device::{
    Adapter, Descriptor, DeviceError, Direction, Endpoint, Input, Setting, SettingKind, Settings,
};

use crate::daq::driver::Driver;
use crate::daq::inputs::Inputs;
use crate::daq::sampler::Sampler;

/// The analog inputs of National Instruments cards. Samples are volts at the card. The
/// driver is loaded on first use.
#[derive(Debug, Clone, Copy, Default)]
pub struct DaqInput;

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
    let number = |min, max| SettingKind::Number { min, max };
    let terminals = SettingKind::choice(&["default", "rse", "nrse", "diff", "pseudodiff"]);
    Descriptor {
        id: "org.htex.daq".to_owned(),
        name: "NI-DAQmx".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Analog inputs of a National Instruments card, volts.".to_owned(),
        direction: Direction::Input,
        target: Some("channels".to_owned()),
        settings: vec![
            Setting::hardware(
                "channels",
                SettingKind::Text,
                "Dev1/ai0:5",
                "Names of the analog inputs in NI MAX: a range such as Dev1/ai0:5, or a list with commas.",
            ),
            Setting::hardware(
                "rate_hz",
                number(1.0, 1e7),
                "20000",
                "Sample rate, hertz; 20,000 in the paper.",
            ),
            Setting::hardware(
                "range_v",
                number(0.001, 100.0),
                "10",
                "Largest voltage of an input, positive or negative, volts. The card uses its \
                 smallest range that includes this voltage.",
            ),
            Setting::hardware(
                "terminals",
                terminals,
                "default",
                "Wiring: referenced single-ended (rse), non-referenced single-ended (nrse), differential (diff) or pseudodifferential (pseudodiff).",
            ),
            Setting::hardware(
                "buffer_s",
                number(0.1, 60.0),
                "10",
                "Size of the buffer for samples that wait to be read, seconds.",
            ),
            Setting::hardware(
                "driver",
                SettingKind::Text,
                "",
                "File of the NI-DAQmx library. Empty: the installed library.",
            ),
        ],
        ..Descriptor::default()
    }
});

impl Adapter for DaqInput {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
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

    fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
        let inputs = Inputs::new(settings)?;
        let driver = Driver::load(&inputs.driver)?;
        inputs.check_connected(driver)?;
        Ok(Box::new(Sampler::open(inputs, driver)?))
    }
}
