//! The stored form of a page: a checksum, the unpacked length and a deflate stream.

use flate2::{Crc, Decompress, FlushDecompress, Status};

use crate::library::fault::Fault;
use crate::library::rules as rule;

/// Size of the frame before the stream, bytes.
const FRAME_BYTES: usize = 8;

/// Returns the largest size that a page can have in the file. In the worst case, a deflate stream
/// is a few bytes per block larger than its contents.
fn most_packed(unpacked: u64) -> u64 {
    (unpacked + unpacked / 64 + 64).saturating_add(FRAME_BYTES as u64)
}

/// Unpacks a page of at most `most` unpacked bytes.
pub(crate) fn unpack(page: &[u8], most: u64, place: &str) -> Result<Vec<u8>, Fault> {
    let corrupt = |problem: &str| {
        let message = format!("the page is damaged: {problem}; get the file again");
        Fault::new(rule::LIBRARY_PAGE_CORRUPT, place, message)
    };
    let Some((frame, stream)) = page.split_first_chunk::<FRAME_BYTES>() else {
        return Err(corrupt("it is shorter than its frame"));
    };
    let [a, b, c, d, e, f, g, h] = *frame;
    let (stated, size) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
    let found = crc32(&page[4..]);
    if found != stated {
        let message =
            format!("its checksum is {found:08x} instead of {stated:08x}; get the file again");
        return Err(Fault::new(rule::LIBRARY_PAGE_CHECKSUM, place, message));
    }
    // The checksum covers the size, but the size may still be wrong. Therefore, it is limited
    // before memory is allocated.
    check_size(u64::from(size), most, place)?;
    inflate(stream, size as usize).map_err(corrupt)
}

/// Compares the unpacked size of a page with the limit.
fn check_size(size: u64, most: u64, place: &str) -> Result<(), Fault> {
    if size <= most {
        return Ok(());
    }
    let message = format!(
        "the page unpacks to {size} bytes and the limit is {most}; raise it if you trust the file"
    );
    Err(Fault::new(rule::LIBRARY_PAGE_TOO_LARGE, place, message))
}

/// Compares the size of a page in the file with the size that follows from `most`, the limit of its
/// unpacked size.
pub(crate) fn check_packed_size(size: u64, most: u64, place: &str) -> Result<(), Fault> {
    if size <= most_packed(most) {
        return Ok(());
    }
    let message = format!(
        "the page has {size} bytes and the limit is {most} unpacked; raise it if you trust the file"
    );
    Err(Fault::new(rule::LIBRARY_PAGE_TOO_LARGE, place, message))
}

/// Computes the CRC-32 of pages and of the header with the inflater's code. Every program that
/// reads libraries already contains the tables of this code.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

fn inflate(stream: &[u8], size: usize) -> Result<Vec<u8>, &'static str> {
    // The buffer is one byte longer than stated, to detect a stream that is longer than stated.
    let mut bytes = vec![0; size + 1];
    let mut inflater = Decompress::new(false);
    let status = inflater
        .decompress(stream, &mut bytes, FlushDecompress::Finish)
        .map_err(|_| "its deflate stream is invalid")?;
    if inflater.total_out() != size as u64 {
        return Err("its deflate stream has another length than stated");
    }
    if status != Status::StreamEnd {
        return Err("its deflate stream does not end");
    }
    if inflater.total_in() != stream.len() as u64 {
        return Err("bytes follow its deflate stream");
    }
    bytes.truncate(size);
    Ok(bytes)
}

/// Packs a page. The same contents give the same bytes on every machine.
#[cfg(feature = "write")]
pub(crate) fn pack(contents: &[u8]) -> Vec<u8> {
    let size = contents.len() as u32;
    let mut page = vec![0; 4];
    page.extend(size.to_le_bytes());
    page.extend(deflate(contents));
    let crc = crc32(&page[4..]);
    page[..4].copy_from_slice(&crc.to_le_bytes());
    page
}

/// Compresses with zlib-rs, which chooses the same matches on every processor.
#[cfg(feature = "write")]
fn deflate(contents: &[u8]) -> Vec<u8> {
    use flate2::{Compress, Compression, FlushCompress};
    let mut stream = Vec::with_capacity(most_packed(contents.len() as u64) as usize);
    // The bytes depend on the compression level, so the level is fixed: equal textures must give
    // equal files.
    let mut deflater = Compress::new(Compression::new(9), false);
    loop {
        let consumed = deflater.total_in() as usize;
        let rest = contents.get(consumed..).unwrap_or_default();
        match deflater.compress_vec(rest, &mut stream, FlushCompress::Finish) {
            Ok(flate2::Status::StreamEnd) => return stream,
            // The stream needs more memory than expected. No input can cause an error here.
            _ => stream.reserve(1024),
        }
    }
}
