//! NI-DAQmx, loaded at the first use.

mod clocked;
mod found;
mod input_task;
mod table;
mod task;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use htex_device::DeviceError;

use crate::fault::Fault;
use table::Table;

pub(crate) use clocked::Stopper;
pub(crate) use input_task::{InputTask, Terminals};
pub(crate) use task::Task;

/// Loaded libraries by the setting that named them. A driver has threads of its own, so none is
/// ever unloaded.
static LOADED: Mutex<BTreeMap<String, &'static Driver>> = Mutex::new(BTreeMap::new());

pub(crate) struct Driver {
    table: Table,
}

impl Driver {
    /// Loads the library at `path`, or the installed one when it is empty.
    pub(crate) fn load(path: &str) -> Result<&'static Self, DeviceError> {
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

    /// Every analog output, and the product it is part of.
    pub(crate) fn outputs(&self) -> Result<Vec<(String, String)>, Fault> {
        let mut outputs = Vec::new();
        for card in list(&self.table.device_names()?) {
            let product = self.table.product(card)?;
            let channels = self.table.outputs(card)?;
            outputs.extend(list(&channels).map(|c| (c.to_owned(), product.clone())));
        }
        Ok(outputs)
    }

    /// Every analog input, and the product it is part of.
    pub(crate) fn inputs(&self) -> Result<Vec<(String, String)>, Fault> {
        let mut inputs = Vec::new();
        for card in list(&self.table.device_names()?) {
            let product = self.table.product(card)?;
            let channels = self.table.inputs(card)?;
            inputs.extend(list(&channels).map(|c| (c.to_owned(), product.clone())));
        }
        Ok(inputs)
    }

    /// Lowest (1 Hz and above) rate of a card's analog input, and the highest of all channels
    /// together, hertz.
    pub(crate) fn input_rates(&self, card: &str) -> Result<(f64, f64), Fault> {
        Ok((self.table.min_input_rate(card)?.max(1.0), self.table.max_input_rate(card)?))
    }

    /// Lowest (1 Hz and above) and highest rate of a card's analog output, hertz.
    pub(crate) fn rates(&self, card: &str) -> Result<(f64, f64), Fault> {
        Ok((self.table.min_rate(card)?.max(1.0), self.table.max_rate(card)?))
    }
}

impl Driver {
    /// Ends all tasks of an output's card.
    #[allow(unsafe_code)] // The driver's functions are C.
    pub(crate) fn reset(&self, output: &str) -> Result<(), Fault> {
        let card = table::c_text(output.split('/').next().unwrap_or_default());
        // SAFETY: a string that ends in zero.
        self.table.check(unsafe { (self.table.reset_device)(card.as_ptr()) })
    }
}

/// The items of a list separated by commas.
fn list(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(str::trim).filter(|name| !name.is_empty())
}
