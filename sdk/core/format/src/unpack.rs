//! Unpacks an entry, and checks its checksum and the end of its stream.
//!
//! Every entry is unpacked and checked before the manifest is read. This module calls the inflater
//! directly, because the crate `zip` does not report whether bytes follow the end of a stream.

use std::borrow::Cow;

use flate2::{Crc, Decompress, FlushDecompress, Status};

use crate::zip_records::Common;

/// How an entry's data is damaged.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Damage {
    #[error("its checksum is {found:08x} instead of {stated:08x}")]
    Checksum { found: u32, stated: u32 },
    #[error("its deflate stream is invalid")]
    Invalid,
    #[error("its deflate stream does not end")]
    Endless,
    #[error("it unpacks to more than {0} bytes")]
    TooLong(usize),
    #[error("it unpacks to {found} bytes instead of {stated}")]
    Length { found: u64, stated: usize },
    #[error("{0} bytes follow the end of its deflate stream")]
    Follows(u64),
}

pub(crate) const STORED: u16 = 0;
pub(crate) const DEFLATED: u16 = 8;

/// Unpacks an entry's data. The caller has already checked the sizes against the limits.
///
/// # Errors
/// If the data is damaged. The error says how.
pub(crate) fn unpack<'a>(data: &'a [u8], common: &Common) -> Result<Cow<'a, [u8]>, Damage> {
    let bytes = match common.method {
        DEFLATED => Cow::Owned(inflate(data, common.size as usize)?),
        // Only stored entries are left. The check of the headers has already refused other methods.
        // It has also refused stored entries whose two sizes differ.
        _ => Cow::Borrowed(data),
    };
    let crc = crc32(&bytes);
    if crc == common.crc {
        return Ok(bytes);
    }
    Err(Damage::Checksum { found: crc, stated: common.crc })
}

/// Computes the CRC-32 of ZIP with the inflater's code. Every program that reads assets already
/// contains the tables of this code.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

fn inflate(data: &[u8], size: usize) -> Result<Vec<u8>, Damage> {
    // The buffer is one byte longer than stated, to detect a stream that is longer than stated.
    let mut bytes = vec![0; size + 1];
    let mut stream = Decompress::new(false);
    let status = stream
        .decompress(data, &mut bytes, FlushDecompress::Finish)
        .map_err(|_| Damage::Invalid)?;
    let (used, unpacked) = (stream.total_in(), stream.total_out());
    if status != Status::StreamEnd {
        return Err(if unpacked > size as u64 { Damage::TooLong(size) } else { Damage::Endless });
    }
    if unpacked != size as u64 {
        return Err(Damage::Length { found: unpacked, stated: size });
    }
    let behind = data.len() as u64 - used;
    if behind > 0 {
        return Err(Damage::Follows(behind));
    }
    bytes.truncate(size);
    Ok(bytes)
}
