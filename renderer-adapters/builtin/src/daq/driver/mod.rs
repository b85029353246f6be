//! The NI-DAQmx driver, loaded on first use.

mod clocked;
mod found;
mod input_task;
mod table;
mod task;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

use crate::daq::fault::Fault;
use table::Table;

pub(crate) use clocked::Stopper;
pub(crate) use input_task::{InputTask, Terminals};
pub(crate) use task::Task;

/// Loaded libraries, by the setting that named them. They are never unloaded, because a driver has
/// threads of its own.
static LOADED: Mutex<BTreeMap<String, &'static Driver>> = Mutex::new(BTreeMap::new());

pub(crate) struct Driver {
    table: Table,
}

impl Driver {
    /// Loads the library at `path`, or the installed one if `path` is empty.
    pub(crate) fn load(path: &str) -> Result<&'static Self, DeviceError> {
        // Locked while the library is loaded, so that it is loaded only once.
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(driver) = loaded.get(path) {
            return Ok(driver);
        }
        let table = match path {
            "" => found::installed()?,
            _ => found::named(path)?,
        };
        let driver: &'static Self = Box::leak(Box::new(Self { table }));
        loaded.insert(path.to_owned(), driver);
        Ok(driver)
    }

    /// Lists every analog output with the product it belongs to.
    pub(crate) fn outputs(&self) -> Result<Vec<(String, String)>, Fault> {
        let mut outputs = Vec::new();
        for card in list(&self.table.device_names()?) {
            let product = self.table.product(card)?;
            let channels = self.table.outputs(card)?;
            outputs.extend(list(&channels).map(|c| (c.to_owned(), product.clone())));
        }
        Ok(outputs)
    }

    /// Lists every analog input with the product it belongs to.
    pub(crate) fn inputs(&self) -> Result<Vec<(String, String)>, Fault> {
        let mut inputs = Vec::new();
        for card in list(&self.table.device_names()?) {
            let product = self.table.product(card)?;
            let channels = self.table.inputs(card)?;
            inputs.extend(list(&channels).map(|c| (c.to_owned(), product.clone())));
        }
        Ok(inputs)
    }

    /// Returns the lowest rate of a card's analog inputs (at least 1 Hz) and the highest total rate
    /// of all channels together, hertz.
    pub(crate) fn input_rates(&self, card: &str) -> Result<(f64, f64), Fault> {
        Ok((self.table.min_input_rate(card)?.max(1.0), self.table.max_input_rate(card)?))
    }

    /// Returns the lowest (at least 1 Hz) and highest rate of a card's analog output, hertz.
    pub(crate) fn rates(&self, card: &str) -> Result<(f64, f64), Fault> {
        Ok((self.table.min_rate(card)?.max(1.0), self.table.max_rate(card)?))
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
