//! Wave64 of Sony: a WAV with lengths of 64 bits; 32-bit floats only.

use std::io::{BufReader, Read};

use crate::error::{Fault, ReadProblem};
use crate::formats::samples::{Order, Samples, channel_names};
use crate::input::Opened;
use crate::value_limit::ValueLimit;

/// The first 16 bytes of a file.
pub(crate) const RIFF: &[u8] = b"riff\x2e\x91\xcf\x11\xa5\xd6\x28\xdb\x04\xc1\x00\x00";
/// Bytes before the first chunk: two identifiers and the length of the file.
const START: usize = 40;
/// Bytes of an identifier and a length, which counts them too.
const CHUNK: u64 = 24;
/// Bytes of the format that are read, and of the longest that is skipped over.
const FORMAT: usize = 16;
const MOST_SKIPPED: u64 = 1 << 20;
const FLOAT: u16 = 3;

/// Opens a Wave64, whose samples are then read one by one.
pub(crate) fn open(opened: Opened<'_>, limit: ValueLimit) -> Result<Samples<'_>, Fault> {
    let mut input = BufReader::new(opened.stream());
    let mut start = [0; START];
    input.read_exact(&mut start)?;
    let mut format = None;
    loop {
        let (name, length) = chunk(&mut input)?;
        if &name == b"data" {
            break samples(input, length, format, limit);
        }
        // Chunks begin at multiples of 8 bytes.
        let padded = length.next_multiple_of(8);
        if padded > MOST_SKIPPED {
            return Err(broken("a chunk before the samples is too long"));
        }
        let mut bytes = Vec::new();
        (&mut input).take(padded).read_to_end(&mut bytes)?;
        if &name == b"fmt " {
            format = bytes.first_chunk().copied();
        }
    }
}

/// Reads the name of a chunk and the length of its contents, bytes.
fn chunk(input: &mut impl Read) -> Result<([u8; 4], u64), Fault> {
    let (mut id, mut length) = ([0; 16], [0; 8]);
    input.read_exact(&mut id)?;
    input.read_exact(&mut length)?;
    let [a, b, c, d, ..] = id;
    let length = u64::from_le_bytes(length).checked_sub(CHUNK);
    Ok((
        [a, b, c, d],
        length.ok_or_else(|| broken("a chunk has no length"))?,
    ))
}

fn samples<'a>(
    mut input: impl Read + 'a,
    length: u64,
    format: Option<[u8; FORMAT]>,
    limit: ValueLimit,
) -> Result<Samples<'a>, Fault> {
    let format = format.ok_or_else(|| broken("there is no format before the samples"))?;
    let word = |at: usize| u16::from_le_bytes([format[at], format[at + 1]]);
    let (kind, width, bits) = (word(0), usize::from(word(2)), word(14));
    let rate_hz = u32::from(word(4)) | u32::from(word(6)) << 16;
    if (kind, bits) != (FLOAT, 32) || width == 0 {
        return Err(broken("only 32-bit floats are read; export it as such"));
    }
    let values = length / 4;
    let read = move |at: u64| {
        let mut value = [0; 4];
        match input.read_exact(&mut value) {
            Ok(()) => Ok(f64::from(f32::from_le_bytes(value))),
            Err(_) => Err(broken(&format!("the file ends at value {at} of {values}"))),
        }
    };
    Ok(Samples {
        columns: channel_names(width),
        rate_hz: Some(f64::from(rate_hz)),
        are_integers: false,
        frames: Some(values / width as u64),
        limit,
        order: Order::Interleaved,
        samples: Box::new((0..values).map(read)),
    })
}

fn broken(problem: &str) -> Fault {
    ReadProblem::invalid(problem).into()
}
