//! Reads and writes GLB, the binary container of glTF 2.0 (specification, section 4.4). A container
//! consists of a header, a chunk with JSON, and a chunk with binary data.

use crate::error::Fault;

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
/// Size of the header: magic, version and file length.
const HEADER_BYTES: usize = 12;
/// Size of a chunk's header: length and kind.
const CHUNK_HEADER_BYTES: usize = 8;
const JSON: [u8; 4] = *b"JSON";
const BINARY: [u8; 4] = *b"BIN\0";
/// Chunks begin at multiples of this many bytes.
const ALIGNMENT: usize = 4;

/// The chunks of a file.
#[derive(Debug)]
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Returns the chunks of a file. If the file is not a container, its whole content is the JSON.
/// Chunks of other kinds are ignored, as the specification requires.
pub(super) fn chunks(file: &[u8]) -> Result<Chunks<'_>, Fault> {
    if !file.starts_with(MAGIC) {
        return Ok(Chunks { json: file, binary: None });
    }
    check_header(file)?;
    let json = Chunk::read_at(file, HEADER_BYTES)?;
    if json.kind != JSON {
        let place = format!("byte {}", HEADER_BYTES + 4);
        return Err(Fault::new(place, "the first chunk is not JSON"));
    }
    let next = if json.end < file.len() { Some(Chunk::read_at(file, json.end)?) } else { None };
    // A second chunk of another kind is not an error, because the specification lets readers skip
    // unknown chunks.
    Ok(Chunks { json: json.bytes, binary: next.filter(|c| c.kind == BINARY).map(|c| c.bytes) })
}

fn check_header(file: &[u8]) -> Result<(), Fault> {
    let short = || Fault::whole("it ends in the header of a .glb; get the whole file");
    let version = number_at(file, 4).ok_or_else(short)?;
    if version != VERSION {
        let problem = format!("the container has version {version}, and 2 is read");
        return Err(Fault::new("byte 4", problem));
    }
    let stated = number_at(file, 8).ok_or_else(short)?;
    if stated as usize == file.len() {
        return Ok(());
    }
    let problem = format!(
        "the header states {stated} bytes, and the file has {}; get the whole file",
        file.len()
    );
    Err(Fault::new("byte 8", problem))
}

/// Returns the 32-bit number at a byte offset, or `None` if the file is too short.
fn number_at(file: &[u8], at: usize) -> Option<u32> {
    let bytes = file.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes))
}

struct Chunk<'a> {
    kind: [u8; 4],
    bytes: &'a [u8],
    /// Byte offset of the next chunk.
    end: usize,
}

impl<'a> Chunk<'a> {
    fn read_at(file: &'a [u8], at: usize) -> Result<Self, Fault> {
        let place = || format!("byte {at}");
        let short = || Fault::new(place(), "the file ends in the header of a chunk");
        let length = number_at(file, at).ok_or_else(short)? as usize;
        let rest = file.get(at + 4..).ok_or_else(short)?;
        let (kind, rest) = rest.split_first_chunk().ok_or_else(short)?;
        let bytes = rest.get(..length).ok_or_else(|| {
            let problem =
                format!("the chunk has {length} bytes, and {} are left of the file", rest.len());
            Fault::new(place(), problem)
        })?;
        if !length.is_multiple_of(ALIGNMENT) {
            let problem = format!("the chunk has {length} bytes; it must be a multiple of 4");
            return Err(Fault::new(place(), problem));
        }
        Ok(Self { kind: *kind, bytes, end: at + CHUNK_HEADER_BYTES + length })
    }
}

/// Writes a container. It must be smaller than 4 GiB.
pub(super) fn file(json: Vec<u8>, binary: Vec<u8>) -> Vec<u8> {
    // The specification requires that JSON is padded with blanks, so that it stays valid, and that
    // bytes are padded with zeros.
    let chunks = [(JSON, padded(json, b' ')), (BINARY, padded(binary, 0))];
    let lengths = chunks.iter().map(|(_, bytes)| CHUNK_HEADER_BYTES + bytes.len());
    let length = HEADER_BYTES + lengths.sum::<usize>();
    let mut file = Vec::with_capacity(length);
    file.extend(MAGIC);
    file.extend(VERSION.to_le_bytes());
    file.extend((length as u32).to_le_bytes());
    for (kind, bytes) in chunks {
        file.extend((bytes.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(bytes);
    }
    file
}

fn padded(mut bytes: Vec<u8>, by: u8) -> Vec<u8> {
    bytes.resize(bytes.len().next_multiple_of(ALIGNMENT), by);
    bytes
}
