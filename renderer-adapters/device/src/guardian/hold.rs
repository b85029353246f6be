//! Holds a device in the helper program, for the app at the other end of the pipes.

use std::io::{BufReader, BufWriter, Read, Write};
use std::time::Duration;

use crate::{AdapterEntry, DeviceError, Output, Settings, StreamFormat};

use crate::guardian::message::{Answer, FINISH, Opening, STATUS, WRITE, put, read_message};

/// Holds a device open for the app at the other end of two pipes. Returns when the pipe `from`
/// ends. In a helper program, the pipes are its standard input and output.
///
/// Call this function in a program that ignores signals, so that only the end of the pipe `from`
/// ends the program.
pub fn hold(
    find: impl FnOnce(&str) -> Result<AdapterEntry, DeviceError>,
    from: impl Read,
    to: impl Write,
) {
    let (mut from, mut to) = (BufReader::new(from), BufWriter::new(to));
    let opened = read_message(&mut from).ok().map(|(_, body)| open(find, &body));
    let mut device = match opened {
        None => return,
        Some(Err(error)) => {
            let _ = answer(&mut to, &Answer::Failed(error.to_string()));
            return;
        }
        Some(Ok(device)) => device,
    };
    let mut heard = answer(&mut to, &Answer::Done(0));
    while heard.is_ok() {
        let Ok((tag, body)) = read_message(&mut from) else {
            break;
        };
        let said = match tag {
            WRITE => write(&mut *device, &body),
            STATUS => Ok(Answer::Status(device.status().into())),
            FINISH => device.finish().map(|()| Answer::Done(0)),
            // An unknown request aborts too, because zero is always safe.
            _ => {
                // The device is dropped before the answer, because the answer says that the output
                // is at zero.
                drop(device);
                let _ = answer(&mut to, &Answer::Done(0));
                return;
            }
        };
        let said = said.unwrap_or_else(Answer::of_error);
        heard = answer(&mut to, &said);
    }
    // The app has ended. Play what was written, so that it ends at zero. If that fails, dropping
    // the device sets it to zero.
    let _ = device.finish();
}

fn open(
    find: impl FnOnce(&str) -> Result<AdapterEntry, DeviceError>,
    body: &[u8],
) -> Result<Box<dyn Output>, DeviceError> {
    let opening: Opening = serde_json::from_slice(body)
        .map_err(|error| DeviceError::Message(format!("invalid first message: {error}")))?;
    let known = find(&opening.device)?;
    let settings = Settings::from_lines(known.descriptor(), &opening.settings)?;
    let format = StreamFormat { rate_hz: opening.rate_hz, block_frames: opening.block_frames };
    known.adapter.open_output(&settings, &format)
}

fn write(device: &mut dyn Output, body: &[u8]) -> Result<Answer, DeviceError> {
    let (words, _) = body.as_chunks::<4>();
    let Some((timeout_ms, samples)) = words.split_first() else {
        return Ok(Answer::Done(0));
    };
    let timeout = Duration::from_millis(u32::from_le_bytes(*timeout_ms).into());
    let samples: Vec<f32> = samples.iter().map(|word| f32::from_le_bytes(*word)).collect();
    let taken = device.write(&samples, timeout)?;
    Ok(Answer::Done(taken as u64))
}

fn answer(to: &mut impl Write, answer: &Answer) -> std::io::Result<()> {
    put(to, b'a', &serde_json::to_vec(answer)?)
}
