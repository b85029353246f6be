//! Checks of finishing, aborting and closing.

use std::time::Duration;

use crate::harness::{Finding, Found};
use htex_device::{Adapter, Device, DeviceError, StreamFormat};

use crate::device::adapter::{Case, write_all};

/// All frames must be played, and nothing can be written afterwards.
pub(crate) fn finishes(case: &Case) -> Found {
    let (mut device, _) = case.open()?;
    let tone = case.tone(1_000)?;
    write_all(device.as_mut(), &tone)?;
    let files = files(case);
    device.finish()?;
    let status = device.status();
    if status.frames_played != 1_000 {
        let played = status.frames_played;
        let message = format!("1000 frames were written, and {played} came out");
        return Err(Finding::failed(message));
    }
    let after =
        [("a write", device.write(&tone, Duration::ZERO).map(drop)), ("finish", device.finish())];
    for (call, answer) in after {
        let Err(DeviceError::Closed(_)) = answer else {
            return Err(Finding::failed(format!("{call} after the end is not refused as closed")));
        };
    }
    drop(device);
    // Only the numbers of files are compared, because finishing may rename them.
    if self::files(case).len() < files.len() {
        return Err(Finding::failed("what was written is gone when the device is closed"));
    }
    Ok(Finding::passed("all frames came out, and writes afterwards are refused"))
}

/// Closing without `finish` must leave nothing behind.
pub(crate) fn aborts(case: &Case) -> Found {
    let before = files(case);
    let (mut device, _) = case.open()?;
    write_all(device.as_mut(), &case.tone(1_000)?)?;
    drop(device);
    let after = files(case);
    match after.iter().find(|file| !before.contains(file)) {
        Some(file) => Err(Finding::failed(format!("`{file}` is left behind"))),
        None => Ok(Finding::passed("nothing is left behind")),
    }
}

fn files(case: &Case) -> Vec<String> {
    let entries = std::fs::read_dir(case.files.folder.path()).into_iter().flatten();
    let names = entries.flatten().map(|entry| entry.file_name());
    names.map(|name| name.to_string_lossy().into_owned()).collect()
}

/// A closed handle must be refused, even after another device was opened.
pub(crate) fn handles(case: &Case) -> Found {
    let native = case.native()?;
    let can = case.capabilities()?;
    let format = StreamFormat { rate_hz: can.default_rate_hz, block_frames: can.block_frames };
    let mut closed = native.open_native(&case.settings()?, &format)?;
    closed.close_and_keep_handle()?;
    for another in [false, true] {
        let open = || Ok::<_, Finding>(native.open(&case.settings()?, &format)?);
        let _open = another.then(open).transpose()?;
        let calls = [
            ("write", closed.write(&[0.0], Duration::ZERO).map(drop)),
            ("status", closed.checked_status().map(drop)),
            ("finish", closed.finish()),
            ("close", closed.close_and_keep_handle()),
        ];
        for (call, answer) in calls {
            let Err(DeviceError::Closed(_)) = answer else {
                let message = format!("`{call}` takes a handle that was closed");
                return Err(Finding::failed(message));
            };
        }
    }
    Ok(Finding::passed("a closed handle is refused"))
}
