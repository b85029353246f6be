//! The simulated card of `examples/nidaqmx-simulated`, one for each test.

mod library;

use std::collections::BTreeMap;
use std::ffi::{CString, c_char};
use std::fs;
use std::path::PathBuf;

use htex_device::{Adapter, DeviceError, Input, Output, Settings, StreamFormat};
use htex_device_builtin::daq::{Daq, DaqInput};
use library::built;
use tempfile::TempDir;

pub const PAPER: &str = "pcie-6321_tabor-9200a_sct3250";
pub const GAIN: f64 = 50.0;
pub const RATE_HZ: f64 = 20_000.0;

/// One simulated card with its own copy of the library. Its clock advances with each call, so that
/// tests do not depend on time.
pub struct Card {
    folder: TempDir,
    library: PathBuf,
}

impl Card {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join(built().file_name().unwrap());
        fs::copy(built(), &library).unwrap();
        let card = Self { folder, library };
        card.set("record", card.folder.path().to_str().unwrap());
        card.set("clock", "calls");
        card
    }

    /// Changes a setting of the simulation.
    pub fn set(&self, name: &str, value: &str) {
        type Set = unsafe extern "system" fn(*const c_char, *const c_char);
        let [name, value] = [name, value].map(|text| CString::new(text).unwrap());
        // SAFETY: the function has this type; the library stays loaded, as the adapter keeps it.
        unsafe {
            let library = libloading::Library::new(&self.library).unwrap();
            let set = library.get::<Set>("nidaqmx_simulated_set").unwrap();
            set(name.as_ptr(), value.as_ptr());
            std::mem::forget(library);
        }
    }

    /// Returns how often a driver function was called since the last fault was set.
    pub fn calls(&self, function: &str) -> u64 {
        type Calls = unsafe extern "system" fn(*const c_char) -> u64;
        let function = CString::new(function).unwrap();
        // SAFETY: as above.
        unsafe {
            let library = libloading::Library::new(&self.library).unwrap();
            let calls = library.get::<Calls>("nidaqmx_simulated_calls").unwrap()(function.as_ptr());
            std::mem::forget(library);
            calls
        }
    }

    /// Returns settings of a user who allows direct voltage, because many tests write a direct
    /// voltage.
    pub fn settings(&self, given: &[(&str, &str)]) -> Settings {
        let driver = ("driver", self.library.to_str().unwrap());
        let given = [&[driver, ("dc_limit_v", "150")], given].concat();
        let given: BTreeMap<String, String> =
            given.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
        Settings::resolve(Daq.descriptor(), Some(PAPER), &given).unwrap()
    }

    pub fn open(&self, given: &[(&str, &str)]) -> Result<Box<dyn Output>, DeviceError> {
        self.open_at(RATE_HZ, given)
    }

    pub fn open_at(
        &self,
        rate_hz: f64,
        given: &[(&str, &str)],
    ) -> Result<Box<dyn Output>, DeviceError> {
        self.open_as(rate_hz, 256, given)
    }

    /// Opens a device for blocks of this many frames.
    pub fn open_blocks(
        &self,
        block_frames: u32,
        given: &[(&str, &str)],
    ) -> Result<Box<dyn Output>, DeviceError> {
        self.open_as(RATE_HZ, block_frames, given)
    }

    fn open_as(
        &self,
        rate_hz: f64,
        block_frames: u32,
        given: &[(&str, &str)],
    ) -> Result<Box<dyn Output>, DeviceError> {
        let format = StreamFormat { rate_hz, block_frames };
        Daq.open_output(&self.settings(given), &format)
    }

    pub fn open_input(&self, given: &[(&str, &str)]) -> Result<Box<dyn Input>, DeviceError> {
        let driver = ("driver", self.library.to_str().unwrap());
        let given = [&[driver], given]
            .concat()
            .iter()
            .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
            .collect();
        let adapter = DaqInput;
        adapter.open_input(&Settings::resolve(adapter.descriptor(), None, &given)?)
    }

    /// Puts voltages on the inputs: one row for each frame, one number for each input.
    pub fn put_in(&self, rows: &[Vec<f64>]) {
        let file = self.folder.path().join("input.csv");
        let row = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        fs::write(&file, rows.iter().map(row).collect::<Vec<_>>().join("\n")).unwrap();
        self.set("input", file.to_str().unwrap());
    }

    /// Returns everything that `Dev1/ao0` has output so far, in volts of the card; possibly
    /// nothing.
    pub fn recorded(&self) -> Vec<f64> {
        let lines = fs::read_to_string(self.folder.path().join("Dev1_ao0.txt")).unwrap_or_default();
        lines.lines().map(|line| line.parse().unwrap()).collect()
    }
}
