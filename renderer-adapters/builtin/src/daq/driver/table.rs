//! The NI-DAQmx functions that the adapter uses, as `NIDAQmx.h` declares them.
#![allow(unsafe_code)] // A loader: the library's functions are C.

use std::ffi::{CString, c_char, c_void};
use std::ptr::null_mut;

use crate::daq::fault::Fault;
use crate::driver::driver_table;

pub(super) type Handle = *mut c_void;

type CardText = unsafe extern "system" fn(*const c_char, *mut c_char, u32) -> i32;
type CardNumber = unsafe extern "system" fn(*const c_char, *mut f64) -> i32;

/// Size of the buffer for names and messages of the driver, bytes.
const ROOM: usize = 8192;

// Each function returns 0, a positive warning or a negative error.
driver_table! {
    extern "system", hint: "";
    get_device_names = "DAQmxGetSysDevNames": (*mut c_char, u32) -> i32,
    get_product = "DAQmxGetDevProductType": (*const c_char, *mut c_char, u32) -> i32,
    get_outputs = "DAQmxGetDevAOPhysicalChans": (*const c_char, *mut c_char, u32) -> i32,
    get_max_rate = "DAQmxGetDevAOMaxRate": (*const c_char, *mut f64) -> i32,
    get_min_rate = "DAQmxGetDevAOMinRate": (*const c_char, *mut f64) -> i32,
    get_inputs = "DAQmxGetDevAIPhysicalChans": (*const c_char, *mut c_char, u32) -> i32,
    get_max_input_rate = "DAQmxGetDevAIMaxMultiChanRate": (*const c_char, *mut f64) -> i32,
    get_min_input_rate = "DAQmxGetDevAIMinRate": (*const c_char, *mut f64) -> i32,
    create_input = "DAQmxCreateAIVoltageChan": (Handle, *const c_char, *const c_char, i32, f64, f64, i32, *const c_char) -> i32,
    set_input_buffer = "DAQmxCfgInputBuffer": (Handle, u32) -> i32,
    get_available = "DAQmxGetReadAvailSampPerChan": (Handle, *mut u32) -> i32,
    read_samples = "DAQmxReadAnalogF64": (Handle, i32, f64, u32, *mut f64, u32, *mut i32, *mut u32) -> i32,
    create_task = "DAQmxCreateTask": (*const c_char, *mut Handle) -> i32,
    create_voltage = "DAQmxCreateAOVoltageChan": (Handle, *const c_char, *const c_char, f64, f64, i32, *const c_char) -> i32,
    set_clock = "DAQmxCfgSampClkTiming": (Handle, *const c_char, f64, i32, i32, u64) -> i32,
    set_buffer = "DAQmxCfgOutputBuffer": (Handle, u32) -> i32,
    set_regeneration = "DAQmxSetWriteRegenMode": (Handle, i32) -> i32,
    start_task = "DAQmxStartTask": (Handle) -> i32,
    stop_task = "DAQmxStopTask": (Handle) -> i32,
    clear_task = "DAQmxClearTask": (Handle) -> i32,
    reset_device = "DAQmxResetDevice": (*const c_char) -> i32,
    is_done = "DAQmxIsTaskDone": (Handle, *mut u32) -> i32,
    get_space = "DAQmxGetWriteSpaceAvail": (Handle, *mut u32) -> i32,
    get_generated = "DAQmxGetWriteTotalSampPerChanGenerated": (Handle, *mut u64) -> i32,
    write_samples = "DAQmxWriteAnalogF64": (Handle, i32, u32, f64, u32, *const f64, *mut i32, *mut u32) -> i32,
    get_error_string = "DAQmxGetErrorString": (i32, *mut c_char, u32) -> i32,
    get_error_details = "DAQmxGetExtendedErrorInfo": (*mut c_char, u32) -> i32,
}

impl Table {
    /// Checks the result of a call. Ignores warnings. An error contains the driver's message.
    pub(super) fn check(&self, code: i32) -> Result<(), Fault> {
        if code >= 0 {
            return Ok(());
        }
        // SAFETY: both functions get a buffer and its length.
        let details = filled(|to, space| unsafe { (self.get_error_details)(to, space) });
        // The details of the last call say more than the general text of a code.
        let words = details.filter(|text| !text.is_empty()).or_else(|| {
            // SAFETY: as above.
            filled(|to, space| unsafe { (self.get_error_string)(code, to, space) })
        });
        Err(Fault { code, words: words.unwrap_or_default().replace(['\n', '\r'], " ") })
    }

    pub(super) fn device_names(&self) -> Result<String, Fault> {
        // SAFETY: a buffer and its length.
        self.text(|to, space| unsafe { (self.get_device_names)(to, space) })
    }

    /// Calls a function that writes a text about a card.
    pub(super) fn card_text(&self, function: CardText, card: &str) -> Result<String, Fault> {
        let card = c_text(card);
        // SAFETY: a string that ends in zero, a buffer and its length.
        self.text(|to, space| unsafe { function(card.as_ptr(), to, space) })
    }

    /// Calls a function that writes a number about a card.
    pub(super) fn card_number(&self, function: CardNumber, card: &str) -> Result<f64, Fault> {
        let (card, mut number) = (c_text(card), 0.0);
        // SAFETY: a string that ends in zero, and a place for one number.
        self.check(unsafe { function(card.as_ptr(), &mut number) })?;
        Ok(number)
    }

    pub(super) fn new_task(&self) -> Result<Handle, Fault> {
        let (name, mut handle) = (c_text(""), null_mut());
        // SAFETY: a string that ends in zero, and a place for one handle.
        self.check(unsafe { (self.create_task)(name.as_ptr(), &mut handle) })?;
        Ok(handle)
    }

    fn text(&self, call: impl Fn(*mut c_char, u32) -> i32) -> Result<String, Fault> {
        let mut code = 0;
        let text = filled(|to, space| {
            code = call(to, space);
            code
        });
        self.check(code)?;
        Ok(text.unwrap_or_default())
    }
}

/// Returns the text that a function writes into a buffer, or `None` if the call fails.
fn filled(call: impl FnOnce(*mut c_char, u32) -> i32) -> Option<String> {
    let mut bytes = vec![0u8; ROOM];
    let code = call(bytes.as_mut_ptr().cast(), ROOM as u32);
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(0);
    (code >= 0).then(|| String::from_utf8_lossy(&bytes[..end]).into_owned())
}

/// Converts a text to a string that ends in zero. A text that contains a zero becomes empty.
pub(super) fn c_text(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}
