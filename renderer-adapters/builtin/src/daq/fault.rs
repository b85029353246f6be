//! Errors of NI-DAQmx, and their conversion to device errors. The codes are from `NIDAQmx.h`.

use htex_device::DeviceError;

/// Codes for a device that is not or no longer available: not present (-88705), removed, absent,
/// powered off or not accessible.
const GONE: [i32; 8] = [-88705, -200045, -200170, -200194, -200220, -200324, -200175, -201003];
/// Another task or another program uses the output.
const RESERVED: i32 = -50103;
/// Samples came too late: the buffer, or the memory on the card, became empty.
const DRY: [i32; 5] = [-200290, -200291, -200016, -200018, -200621];

/// Samples were read too late: the buffer was overwritten (-200279), or the memory on the card was
/// full (-200361).
const OVERRUN: [i32; 2] = [-200279, -200361];

/// The warning about a voltage that may remain at the display.
pub(crate) const NOT_ZERO: &str = "the output could not be set to zero: switch the amplifier off";

/// An error code of the driver and its message.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    pub(crate) code: i32,
    pub(crate) words: String,
}

impl Fault {
    pub(crate) fn is_dry(&self) -> bool {
        DRY.contains(&self.code)
    }

    pub(crate) fn is_overrun(&self) -> bool {
        OVERRUN.contains(&self.code)
    }

    /// Converts the fault to the error of a device that was running.
    pub(crate) fn failed(&self, device: &str) -> DeviceError {
        DeviceError::Failed {
            device: device.to_owned(),
            what: format!("NI-DAQmx {}: {}", self.code, self.words),
        }
    }

    /// Converts the fault to the error of a device that was running and could not be set to zero.
    pub(crate) fn failed_and_not_zero(&self, device: &str) -> DeviceError {
        DeviceError::Failed {
            device: device.to_owned(),
            what: format!("NI-DAQmx {}: {}; {NOT_ZERO}", self.code, self.words),
        }
    }

    /// Converts the fault to the error of a device that cannot be opened.
    pub(crate) fn missing(&self, device: &str) -> DeviceError {
        let Self { code, words } = self;
        match *code {
            RESERVED => DeviceError::Busy(format!(
                "{device} is in use by another program or device (NI-DAQmx {code}: {words})"
            )),
            code if GONE.contains(&code) => DeviceError::Missing(format!(
                "{device} is not connected (NI-DAQmx {code}: {words}); see NI MAX or `nilsdev`"
            )),
            _ => self.failed(device),
        }
    }
}
