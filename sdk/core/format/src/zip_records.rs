//! Parses the records of a ZIP archive.

use std::ops::Range;

pub(crate) const END_BYTES: usize = 22;
const LOCAL_BYTES: usize = 30;
const CENTRAL_BYTES: usize = 46;

pub(crate) const END: u32 = 0x0605_4b50;
pub(crate) const CENTRAL: u32 = 0x0201_4b50;
pub(crate) const LOCAL: u32 = 0x0403_4b50;
const ZIP64_LOCATOR: u32 = 0x0706_4b50;
const ZIP64_LOCATOR_BYTES: usize = 20;

/// The end record.
pub(crate) struct End {
    /// Offset of the record.
    pub at: usize,
    pub disks: [u16; 2],
    pub entries_here: u16,
    pub entries: u16,
    pub directory_bytes: u32,
    pub directory_at: u32,
    pub comment_bytes: u16,
    /// Whether a locator for ZIP64 records precedes this record.
    pub zip64: bool,
}

/// The fields that the directory and a local header have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Common {
    pub flags: u16,
    pub method: u16,
    pub time_date: u32,
    pub crc: u32,
    pub packed: u32,
    pub size: u32,
}

/// A record of the directory.
pub(crate) struct Central<'a> {
    pub common: Common,
    pub name: &'a [u8],
    pub extra: &'a [u8],
    pub comment: &'a [u8],
    pub disk: u16,
    pub local_at: u32,
}

/// A local header.
pub(crate) struct Local<'a> {
    pub common: Common,
    pub name: &'a [u8],
    pub extra: &'a [u8],
    pub data: Range<usize>,
}

/// Returns the last end record of the file. In an asset, this record is the last 22 bytes.
pub(crate) fn find_end(bytes: &[u8]) -> Option<End> {
    let last = bytes.len().checked_sub(END_BYTES)?;
    // Only a comment of at most 65,535 bytes may follow the record, so the record cannot begin
    // earlier.
    let first = last.saturating_sub(usize::from(u16::MAX));
    let at = (first..=last).rev().find(|&at| u32_at(bytes, at) == Some(END))?;
    let u16_at = |offset: usize| u16_at(bytes, at + offset);
    let locator = at.checked_sub(ZIP64_LOCATOR_BYTES);
    Some(End {
        at,
        disks: [u16_at(4)?, u16_at(6)?],
        entries_here: u16_at(8)?,
        entries: u16_at(10)?,
        directory_bytes: u32_at(bytes, at + 12)?,
        directory_at: u32_at(bytes, at + 16)?,
        comment_bytes: u16_at(20)?,
        zip64: locator.is_some_and(|l| u32_at(bytes, l) == Some(ZIP64_LOCATOR)),
    })
}

/// Parses the directory record at `at` and returns it with the offset of the next one.
pub(crate) fn central(bytes: &[u8], at: usize) -> Option<(Central<'_>, usize)> {
    if u32_at(bytes, at)? != CENTRAL {
        return None;
    }
    let common = common(bytes, at.checked_add(8)?)?;
    let name_at = at.checked_add(CENTRAL_BYTES)?;
    let (name, extra_at) = part(bytes, name_at, u16_at(bytes, at + 28)?)?;
    let (extra, comment_at) = part(bytes, extra_at, u16_at(bytes, at + 30)?)?;
    let (comment, next) = part(bytes, comment_at, u16_at(bytes, at + 32)?)?;
    let record = Central {
        common,
        name,
        extra,
        comment,
        disk: u16_at(bytes, at + 34)?,
        local_at: u32_at(bytes, at + 42)?,
    };
    Some((record, next))
}

/// Parses the local header at `at`. The entry's data have `packed` bytes.
pub(crate) fn local(bytes: &[u8], at: usize, packed: u32) -> Option<Local<'_>> {
    if u32_at(bytes, at)? != LOCAL {
        return None;
    }
    let common = common(bytes, at.checked_add(6)?)?;
    let name_at = at.checked_add(LOCAL_BYTES)?;
    let (name, extra_at) = part(bytes, name_at, u16_at(bytes, at + 26)?)?;
    let (extra, data_at) = part(bytes, extra_at, u16_at(bytes, at + 28)?)?;
    let end = data_at.checked_add(usize::try_from(packed).ok()?)?;
    let data = data_at..end;
    bytes.get(data.clone())?;
    Some(Local { common, name, extra, data })
}

fn common(bytes: &[u8], at: usize) -> Option<Common> {
    Some(Common {
        flags: u16_at(bytes, at)?,
        method: u16_at(bytes, at + 2)?,
        time_date: u32_at(bytes, at + 4)?,
        crc: u32_at(bytes, at + 8)?,
        packed: u32_at(bytes, at + 12)?,
        size: u32_at(bytes, at + 16)?,
    })
}

fn part(bytes: &[u8], at: usize, length: u16) -> Option<(&[u8], usize)> {
    let end = at.checked_add(usize::from(length))?;
    Some((bytes.get(at..end)?, end))
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    let end = at.checked_add(2)?;
    Some(u16::from_le_bytes(bytes.get(at..end)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    let end = at.checked_add(4)?;
    Some(u32::from_le_bytes(bytes.get(at..end)?.try_into().ok()?))
}
