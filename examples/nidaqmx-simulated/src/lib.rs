//! The C functions of NI-DAQmx that analog output and input need, over a simulated PCIe-6321.
//!
//! Each function has the arguments and results that National Instruments' `NIDAQmx.h` states. The
//! card's output is recorded; see README.md.
//!
//! It is a real library, which programs load in the same way as NI's library. So symbols, types and
//! error codes are tested, and people without the card can play to the simulated card.
#![allow(clippy::missing_safety_doc, clippy::too_many_arguments)] // The header states both.

mod card;
mod codes;
mod fault;
mod input;

use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use card::loopback::Loopback;
use card::{CHANNELS, Card, MAX_RATE_HZ, MIN_RATE_HZ};

static CARD: Mutex<Option<Card>> = Mutex::new(None);
static LAST: Mutex<i32> = Mutex::new(0);

const DO_NOT_ALLOW_REGEN: i32 = 10158;

fn with<T>(run: impl FnOnce(&mut Card) -> T) -> T {
    let mut card: MutexGuard<Option<Card>> = CARD.lock().unwrap_or_else(PoisonError::into_inner);
    run(card.get_or_insert_with(from_environment))
}

fn from_environment() -> Card {
    let mut card = Card::default();
    for name in ["record", "clock", "input", "loopback", "unplug_after", "fault", "fault_while"] {
        if let Ok(value) = std::env::var(format!("NIDAQMX_SIM_{}", name.to_uppercase())) {
            set(&mut card, name, &value);
        }
    }
    card
}

fn set(card: &mut Card, name: &str, value: &str) {
    match name {
        "record" => card.record = Some(value.into()),
        "clock" => (card.by_calls, card.stands) = (value == "calls", value == "still"),
        "input" => card.input = Some(rows(value)),
        "loopback" => card.loopback = Some(Loopback::new(value.as_ref())),
        "late_s" => card.late_s = value.parse().unwrap_or(0.0),
        "unplug_after" => card.unplug_after = value.parse().ok(),
        "fault" => fault::plan(value),
        "fault_while" => fault::only_while(value),
        _ => eprintln!("nidaqmx-simulated: unknown setting `{name}`"),
    }
}

fn status<T>(answer: Result<T, i32>) -> i32 {
    let code = answer.err().unwrap_or(0);
    if code != 0 {
        *LAST.lock().unwrap_or_else(PoisonError::into_inner) = code;
    }
    code
}

/// Stores a result at the caller's pointer.
unsafe fn store<T>(answer: Result<T, i32>, to: *mut T) -> i32 {
    status(answer.map(|value| unsafe { to.write(value) }))
}

unsafe fn text(from: *const c_char) -> String {
    unsafe { CStr::from_ptr(from) }.to_string_lossy().into_owned()
}

/// Copies a string; for a buffer of size 0, returns the size needed, as the driver does.
unsafe fn copy(text: &str, to: *mut c_char, size: u32) -> i32 {
    let text = CString::new(text).unwrap_or_default();
    let bytes = text.as_bytes_with_nul();
    if to.is_null() || size == 0 {
        return bytes.len() as i32;
    }
    if bytes.len() > size as usize {
        return status::<()>(Err(codes::STRING_TOO_LONG));
    }
    unsafe { to.copy_from_nonoverlapping(bytes.as_ptr().cast(), bytes.len()) };
    0
}

fn device(name: &str) -> Result<(), i32> {
    match name {
        "Dev1" => with(|card| card.plugged()),
        _ => Err(codes::NO_SUCH_DEVICE),
    }
}

/// Reads a file of voltages: a line for each frame, a number for each input, separated by commas.
fn rows(path: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| {
        eprintln!("nidaqmx-simulated: {path}: {error}");
        String::new()
    });
    let row = |line: &str| line.split(',').map(|cell| cell.trim().parse().unwrap_or(0.0)).collect();
    text.lines().map(row).collect()
}

/// Changes a setting of the simulation: `record`, `input`, `loopback`, `late_s`, `clock`,
/// `unplug_after`, `fault`, `fault_while`. Not part of NI-DAQmx.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn nidaqmx_simulated_set(name: *const c_char, value: *const c_char) {
    let (name, value) = unsafe { (text(name), text(value)) };
    with(|card| set(card, &name, &value));
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetSysDevNames(to: *mut c_char, size: u32) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetSysDevNames") {
        return code;
    }
    let names = if device("Dev1").is_ok() { "Dev1" } else { "" };
    unsafe { copy(names, to, size) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevProductType(
    name: *const c_char,
    to: *mut c_char,
    size: u32,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevProductType") {
        return code;
    }
    match device(&unsafe { text(name) }) {
        Ok(()) => unsafe { copy("PCIe-6321 (simulated)", to, size) },
        Err(code) => status::<()>(Err(code)),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevAOPhysicalChans(
    name: *const c_char,
    to: *mut c_char,
    size: u32,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevAOPhysicalChans") {
        return code;
    }
    match device(&unsafe { text(name) }) {
        Ok(()) => unsafe { copy(&CHANNELS.join(", "), to, size) },
        Err(code) => status::<()>(Err(code)),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevAOMaxRate(name: *const c_char, to: *mut f64) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevAOMaxRate") {
        return code;
    }
    unsafe { store(device(&text(name)).map(|()| MAX_RATE_HZ), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevAOMinRate(name: *const c_char, to: *mut f64) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevAOMinRate") {
        return code;
    }
    unsafe { store(device(&text(name)).map(|()| MIN_RATE_HZ), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxCreateTask(_: *const c_char, task: *mut *mut c_void) -> i32 {
    if let Some(code) = fault::injected("DAQmxCreateTask") {
        return code;
    }
    unsafe { store(with(Card::create).map(|id| id as *mut c_void), task) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxCreateAOVoltageChan(
    task: *mut c_void,
    channel: *const c_char,
    _name: *const c_char,
    min_v: f64,
    max_v: f64,
    _units: i32,
    _scale: *const c_char,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxCreateAOVoltageChan") {
        return code;
    }
    let channel = unsafe { text(channel) };
    status(with(|c| c.add_channel(task as usize, &channel, min_v, max_v)))
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxCfgSampClkTiming(
    task: *mut c_void,
    _source: *const c_char,
    rate_hz: f64,
    _edge: i32,
    _mode: i32,
    samples: u64,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxCfgSampClkTiming") {
        return code;
    }
    status(with(|c| c.set_clock(task as usize, rate_hz, samples)))
}

#[unsafe(no_mangle)]
pub extern "system" fn DAQmxCfgOutputBuffer(task: *mut c_void, samples: u32) -> i32 {
    if let Some(code) = fault::injected("DAQmxCfgOutputBuffer") {
        return code;
    }
    status(with(|c| c.set_buffer(task as usize, samples)))
}

#[unsafe(no_mangle)]
pub extern "system" fn DAQmxSetWriteRegenMode(task: *mut c_void, mode: i32) -> i32 {
    if let Some(code) = fault::injected("DAQmxSetWriteRegenMode") {
        return code;
    }
    status(with(|c| c.set_regenerates(task as usize, mode != DO_NOT_ALLOW_REGEN)))
}

#[unsafe(no_mangle)]
pub extern "system" fn DAQmxStartTask(task: *mut c_void) -> i32 {
    if let Some(code) = fault::injected("DAQmxStartTask") {
        return code;
    }
    status(with(|c| c.start(task as usize)))
}

#[unsafe(no_mangle)]
pub extern "system" fn DAQmxStopTask(task: *mut c_void) -> i32 {
    if let Some(code) = fault::injected("DAQmxStopTask") {
        return code;
    }
    status(with(|c| c.stop(task as usize)))
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxResetDevice(name: *const c_char) -> i32 {
    if let Some(code) = fault::injected("DAQmxResetDevice") {
        return code;
    }
    match device(&unsafe { text(name) }) {
        Ok(()) => {
            with(Card::reset);
            0
        }
        Err(code) => status::<()>(Err(code)),
    }
}

#[unsafe(no_mangle)]
pub extern "system" fn DAQmxClearTask(task: *mut c_void) -> i32 {
    if let Some(code) = fault::injected("DAQmxClearTask") {
        return code;
    }
    status(with(|c| c.clear(task as usize)))
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxIsTaskDone(task: *mut c_void, to: *mut u32) -> i32 {
    if let Some(code) = fault::injected("DAQmxIsTaskDone") {
        return code;
    }
    unsafe { store(with(|c| c.done(task as usize)).map(u32::from), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetWriteSpaceAvail(task: *mut c_void, to: *mut u32) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetWriteSpaceAvail") {
        return code;
    }
    unsafe { store(with(|c| c.space(task as usize)), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetWriteTotalSampPerChanGenerated(
    task: *mut c_void,
    to: *mut u64,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetWriteTotalSampPerChanGenerated") {
        return code;
    }
    unsafe { store(with(|c| c.generated(task as usize)), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxWriteAnalogF64(
    task: *mut c_void,
    count: i32,
    auto_start: u32,
    timeout_s: f64,
    _layout: u32,
    samples: *const f64,
    written: *mut i32,
    _reserved: *mut u32,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxWriteAnalogF64") {
        return code;
    }
    let samples = unsafe { std::slice::from_raw_parts(samples, count.max(0) as usize) };
    if let Some(code) = fault::short_write() {
        // A driver behaves in this way if its buffer has space for only some of the samples, or for
        // none.
        let taken = with(|c| c.write(task as usize, &samples[..samples.len() / 2], false));
        if !written.is_null() {
            unsafe { written.write(taken.unwrap_or(0) as i32) };
        }
        return status::<()>(if code == 0 { Ok(()) } else { Err(code) });
    }
    let since = Instant::now();
    let mut all = 0;
    let answer = loop {
        match with(|c| c.write(task as usize, &samples[all..], auto_start != 0)) {
            Ok(taken) => all += taken,
            Err(code) => break Err(code),
        }
        if all == samples.len() {
            break Ok(());
        }
        if timeout_s >= 0.0 && since.elapsed().as_secs_f64() >= timeout_s {
            break Err(codes::NOT_YET);
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    if !written.is_null() {
        unsafe { written.write(all as i32) };
    }
    status(answer)
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetErrorString(code: i32, to: *mut c_char, size: u32) -> i32 {
    unsafe { copy(codes::words(code), to, size) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetExtendedErrorInfo(to: *mut c_char, size: u32) -> i32 {
    let code = *LAST.lock().unwrap_or_else(PoisonError::into_inner);
    unsafe { copy(&format!("{} (status {code})", codes::words(code)), to, size) }
}
