//! The C functions of NI-DAQmx that an analog input needs.

use std::ffi::{c_char, c_void};
use std::time::{Duration, Instant};

use crate::card::MIN_RATE_HZ;
use crate::card::input::{INPUTS, MAX_INPUT_RATE_HZ};
use crate::{codes, copy, device, fault, status, store, text, with};

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevAIPhysicalChans(
    name: *const c_char,
    to: *mut c_char,
    size: u32,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevAIPhysicalChans") {
        return code;
    }
    let names: Vec<String> = (0..INPUTS).map(|input| format!("Dev1/ai{input}")).collect();
    match device(&unsafe { text(name) }) {
        Ok(()) => unsafe { copy(&names.join(", "), to, size) },
        Err(code) => status::<()>(Err(code)),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevAIMaxMultiChanRate(
    name: *const c_char,
    to: *mut f64,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevAIMaxMultiChanRate") {
        return code;
    }
    unsafe { store(device(&text(name)).map(|()| MAX_INPUT_RATE_HZ), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetDevAIMinRate(name: *const c_char, to: *mut f64) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetDevAIMinRate") {
        return code;
    }
    unsafe { store(device(&text(name)).map(|()| MIN_RATE_HZ), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxCreateAIVoltageChan(
    task: *mut c_void,
    channels: *const c_char,
    _names: *const c_char,
    _terminals: i32,
    min_v: f64,
    max_v: f64,
    _units: i32,
    _scale: *const c_char,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxCreateAIVoltageChan") {
        return code;
    }
    let channels = unsafe { text(channels) };
    status(with(|c| c.add_inputs(task as usize, &channels, min_v, max_v)))
}

#[unsafe(no_mangle)]
pub extern "system" fn DAQmxCfgInputBuffer(task: *mut c_void, samples: u32) -> i32 {
    if let Some(code) = fault::injected("DAQmxCfgInputBuffer") {
        return code;
    }
    status(with(|c| c.set_buffer(task as usize, samples)))
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxGetReadAvailSampPerChan(task: *mut c_void, to: *mut u32) -> i32 {
    if let Some(code) = fault::injected("DAQmxGetReadAvailSampPerChan") {
        return code;
    }
    unsafe { store(with(|c| c.available(task as usize)), to) }
}

#[unsafe(no_mangle)]
pub unsafe extern "system" fn DAQmxReadAnalogF64(
    task: *mut c_void,
    frames: i32,
    timeout_s: f64,
    layout: u32,
    to: *mut f64,
    size: u32,
    read: *mut i32,
    _reserved: *mut u32,
) -> i32 {
    if let Some(code) = fault::injected("DAQmxReadAnalogF64") {
        return code;
    }
    // Only interleaved samples (GroupByScanNumber) are simulated.
    if layout != 1 {
        return status::<()>(Err(codes::INVALID_VALUE));
    }
    let (since, mut samples, mut all) = (Instant::now(), Vec::new(), 0);
    let answer = loop {
        let wanted = if frames < 0 { frames } else { frames - all as i32 };
        match with(|c| c.read(task as usize, wanted, &mut samples)) {
            Ok(got) => all += got,
            Err(code) => break Err(code),
        }
        if samples.len() > size as usize {
            break Err(codes::SMALL_BUFFER);
        }
        if frames < 0 || all as i32 == frames {
            break Ok(());
        }
        if timeout_s >= 0.0 && since.elapsed().as_secs_f64() >= timeout_s {
            break Err(codes::NOT_THERE_YET);
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    let fitting = samples.len().min(size as usize);
    unsafe { to.copy_from_nonoverlapping(samples.as_ptr(), fitting) };
    if !read.is_null() {
        unsafe { read.write(all as i32) };
    }
    status(answer)
}
