//! Unpacking of an entry, with checks of its checksum and the end of its stream.

use std::borrow::Cow;

use flate2::{Decompress, FlushDecompress, Status};

use crate::zip_records::Common;

pub(crate) const STORED: u16 = 0;
pub(crate) const DEFLATED: u16 = 8;

/// Unpacks an entry's data, whose sizes are already checked against the limits.
///
/// # Errors
/// A message that says what is wrong with the data.
pub(crate) fn unpack<'a>(data: &'a [u8], common: &Common) -> Result<Cow<'a, [u8]>, String> {
    let bytes = match common.method {
        DEFLATED => Cow::Owned(inflate(data, common.size as usize)?),
        _ => Cow::Borrowed(data),
    };
    let crc = crc32fast::hash(&bytes);
    if crc == common.crc {
        return Ok(bytes);
    }
    let stated = common.crc;
    Err(format!("its checksum is {crc:08x} instead of {stated:08x}"))
}

fn inflate(data: &[u8], size: usize) -> Result<Vec<u8>, String> {
    // One byte more than stated, to detect a longer stream.
    let mut bytes = vec![0; size + 1];
    let mut stream = Decompress::new(false);
    let status = stream
        .decompress(data, &mut bytes, FlushDecompress::Finish)
        .map_err(|_| "its deflate stream is invalid".to_owned())?;
    let (used, unpacked) = (stream.total_in(), stream.total_out());
    if status != Status::StreamEnd {
        return Err(match unpacked > size as u64 {
            true => format!("it unpacks to more than {size} bytes"),
            false => "its deflate stream does not end".to_owned(),
        });
    }
    if unpacked != size as u64 {
        return Err(format!("it unpacks to {unpacked} bytes instead of {size}"));
    }
    let behind = data.len() as u64 - used;
    if behind > 0 {
        return Err(format!(
            "{behind} bytes follow the end of its deflate stream"
        ));
    }
    bytes.truncate(size);
    Ok(bytes)
}
