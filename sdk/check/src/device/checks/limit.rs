//! Checks that a device refuses invalid samples: samples beyond the limit, NaN and infinities.

use std::time::Duration;

use crate::harness::{CheckResult, Finding};
use htex_device::DeviceError;

use crate::device::case::{Case, check_closed, write_all};

/// Checks that samples beyond the limit are refused, both positive and negative ones.
pub(crate) fn over(case: &Case) -> CheckResult {
    let Some(limit) = case.capabilities()?.limit else {
        return Ok(Finding::skipped("it has no limit"));
    };
    // 1 % over the limit is more than any tolerance for rounding.
    for sample in [1.01 * limit, -1.01 * limit, 1e6 * limit] {
        refuses(case, sample as f32)?;
    }
    Ok(Finding::passed(format!("samples over {limit} are refused, and the output stays at zero")))
}

/// Checks that NaN and infinities are refused.
pub(crate) fn no_number(case: &Case) -> CheckResult {
    for sample in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        refuses(case, sample)?;
    }
    Ok(Finding::passed("NaN and infinities are refused, and the output stays at zero"))
}

/// Writes one invalid sample among valid ones. Checks that the device refuses it and is closed
/// afterwards.
fn refuses(case: &Case, bad: f32) -> Result<(), Finding> {
    let wrong = |what: String| Err(Finding::failed(format!("a sample of {bad}: {what}")));
    let (mut device, _) = case.open_output()?;
    let tone = case.tone(64)?;
    write_all(device.as_mut(), &tone)?;
    match device.write(&[tone[1], bad, tone[2]], Duration::ZERO) {
        Err(DeviceError::OverLimit { .. }) => {}
        Err(error) => return wrong(format!("it is refused with another error: {error}")),
        Ok(0) => return wrong("it is neither taken nor refused".to_owned()),
        Ok(_) => return wrong("it is taken".to_owned()),
    }
    let status = device.status();
    if status.frames_written != 64 {
        let counted = status.frames_written;
        return wrong(format!("64 frames were taken before, and it counts {counted}"));
    }
    check_closed([
        ("a write afterwards", device.write(&tone, Duration::ZERO).map(drop)),
        ("finish afterwards", device.finish()),
    ])
}
