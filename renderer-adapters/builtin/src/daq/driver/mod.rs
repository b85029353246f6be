//! The NI-DAQmx driver, loaded on first use.

mod clocked;
mod input_task;
mod table;
mod task;

use htex_device::DeviceError;

use crate::daq::fault::Fault;
use crate::driver::{DriverCache, DriverLibrary};
use table::Table;

pub(crate) use clocked::Stopper;
pub(crate) use input_task::{InputTask, Terminals};
pub(crate) use task::Task;

const LIBRARY: DriverLibrary = DriverLibrary {
    names: if cfg!(windows) { &["nicaiu.dll"] } else { &["libnidaqmx.so.1", "libnidaqmx.so"] },
    loaded_as: "the NI-DAQmx library",
    setting: "driver",
    absent: "NI-DAQmx is not installed",
    remedy: if cfg!(target_os = "linux") {
        "Install the package `ni-daqmx` from ni.com/linux, or name the library by the setting `driver`"
    } else {
        "Install NI-DAQmx from ni.com/downloads, or name the library by the setting `driver`"
    },
};

static LOADED: DriverCache<Driver> = DriverCache::new();

pub(crate) struct Driver {
    table: Table,
}

impl Driver {
    /// Loads the library at `path`, or the installed library if `path` is empty.
    pub(crate) fn load(path: &str) -> Result<&'static Self, DeviceError> {
        LOADED.get_or_load(path, || Ok(Self { table: LIBRARY.load(path, Table::from_library)? }))
    }

    /// Lists every analog output with the product name of its card.
    pub(crate) fn outputs(&self) -> Result<Vec<(String, String)>, Fault> {
        self.channels(|card| self.table.card_text(self.table.get_outputs, card))
    }

    /// Lists every analog input with the product name of its card.
    pub(crate) fn inputs(&self) -> Result<Vec<(String, String)>, Fault> {
        self.channels(|card| self.table.card_text(self.table.get_inputs, card))
    }

    fn channels(
        &self,
        of_card: impl Fn(&str) -> Result<String, Fault>,
    ) -> Result<Vec<(String, String)>, Fault> {
        let mut all = Vec::new();
        for card in list(&self.table.device_names()?) {
            let product = self.table.card_text(self.table.get_product, card)?;
            all.extend(list(&of_card(card)?).map(|name| (name.to_owned(), product.clone())));
        }
        Ok(all)
    }

    /// Returns the lowest rate of a card's analog inputs (at least 1 Hz), and the highest rate of
    /// all channels added together, hertz.
    pub(crate) fn input_rates(&self, card: &str) -> Result<(f64, f64), Fault> {
        let number = |function| self.table.card_number(function, card);
        Ok((
            number(self.table.get_min_input_rate)?.max(1.0),
            number(self.table.get_max_input_rate)?,
        ))
    }

    /// Returns the lowest (at least 1 Hz) and highest rate of a card's analog output, hertz.
    pub(crate) fn rates(&self, card: &str) -> Result<(f64, f64), Fault> {
        let number = |function| self.table.card_number(function, card);
        Ok((number(self.table.get_min_rate)?.max(1.0), number(self.table.get_max_rate)?))
    }
}

impl Driver {
    /// Ends all tasks of the card that has this output.
    #[allow(unsafe_code)] // The driver's functions are C.
    pub(crate) fn reset(&self, output: &str) -> Result<(), Fault> {
        let card = table::c_text(output.split('/').next().unwrap_or_default());
        // SAFETY: a string that ends in zero.
        self.table.check(unsafe { (self.table.reset_device)(card.as_ptr()) })
    }
}

/// Splits a comma-separated list.
fn list(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(str::trim).filter(|name| !name.is_empty())
}
