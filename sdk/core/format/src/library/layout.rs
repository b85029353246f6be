//! Lays a library out: encodes its index, and copies the pieces of its textures into place.

use std::io::{self, Write};

use crate::library::encode::{PackedIndex, Pages};
use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::header::{HEADER_BYTES, Header, MINOR};
use crate::library::leaf::length;
use crate::library::limits::Limits;
use crate::library::metadata::LibraryMetadata;
use crate::library::packer::{PendingTexture, Words};
use crate::library::pieces::{Piece, Source};
use crate::library::sharing::Sharing;

/// Encodes the index. Returns the header, the pages, and the total size of all textures.
pub(crate) fn indexed(
    (name, metadata): (&str, &LibraryMetadata),
    textures: &[(&String, &PendingTexture)],
    sharing: &Sharing,
) -> (Header, PackedIndex, u64) {
    let (mut pages, mut payload, mut total) = (Pages::default(), 0, 0);
    // The textures' own bytes follow each other in the order of the names. `write` copies them in
    // the same order.
    for (name, texture) in textures {
        let place = sharing.place(&texture.pieces, payload);
        payload = place.own.end;
        total += texture.bytes;
        let Words { tags, models, license, author } = (*texture.words).clone();
        let entry = Entry {
            name: (*name).clone(),
            tags,
            models,
            conditions: texture.conditions,
            contact: texture.contact,
            law: texture.law,
            license,
            author,
            quantity: Some(texture.quantity),
            felt_error_rms_db: texture.description.felt_error_rms_db,
            held_out_error_db: texture.description.held_out_error_db,
            bytes: texture.bytes,
            blake3: texture.blake3,
            place,
        };
        pages.add(entry, texture.description.spectrum);
    }
    let index = pages.finish(name, metadata);
    // The parts follow each other without gaps, so each part begins where the previous part ends.
    let mut end = HEADER_BYTES as u64;
    let mut part = |bytes: u64| {
        let start = end;
        end += bytes;
        start..end
    };
    let mut hash = blake3::Hasher::new();
    hash.update(&index.root).update(&index.leaves);
    let header = Header {
        minor: MINOR,
        root: part(index.root.len() as u64),
        leaves: part(index.leaves.len() as u64),
        shared: part(sharing.bytes() + index.spectra.len() as u64),
        payload: part(payload),
        entries: textures.len() as u64,
        leaf_count: index.leaf_count,
        index_blake3: *hash.finalize().as_bytes(),
    };
    (header, index, total)
}

/// Returns whether the ratio of the textures' total size to the file's size exceeds the limit of
/// readers.
pub(crate) fn is_beyond_ratio(header: &Header, total: u64) -> bool {
    total > header.payload.end.saturating_mul(Limits::default().ratio)
}

/// Checks the limits of readers, so that every library that is written can be read within the
/// default limits.
pub(crate) fn check_limits(name: &str, header: &Header, total: u64) -> Result<(), LibraryError> {
    let limits = Limits::default();
    let problem = if header.entries > limits.entries || u64::from(header.leaf_count) > limits.leaves
    {
        format!(
            "it has {} textures and readers' limit is {}; split it",
            header.entries, limits.entries
        )
    } else if length(&header.root) > limits.root_bytes {
        format!(
            "its root page has {} bytes and readers' limit is {}; split it or shorten names",
            length(&header.root),
            limits.root_bytes
        )
    } else if is_beyond_ratio(header, total) {
        let ratio = limits.ratio;
        format!(
            "its textures have {total} bytes, over {ratio} times the bytes of the file, and readers refuse that; split it"
        )
    } else {
        return Ok(());
    };
    Err(LibraryError::Limit { name: format!("library {name:?}"), problem })
}

pub(crate) fn write(
    target: &mut impl Write,
    header: &Header,
    index: &PackedIndex,
    stores: &mut [&mut dyn Source],
    sharing: &Sharing,
    textures: &[(&String, &PendingTexture)],
) -> io::Result<()> {
    target.write_all(&header.to_bytes())?;
    target.write_all(&index.root)?;
    target.write_all(&index.leaves)?;
    // This is the order in which `sharing` assigned the places of the objects, and `index` the
    // places of the textures.
    let own = textures.iter().flat_map(|(_, texture)| sharing.own_pieces(&texture.pieces));
    copy(sharing.shared().cloned(), stores, target)?;
    target.write_all(&index.spectra)?;
    copy(own, stores, target)?;
    target.flush()
}

/// Copies pieces. If several pieces follow each other in their store, they are copied at once. This
/// is the case for most pieces of another library.
fn copy(
    mut pieces: impl Iterator<Item = Piece>,
    stores: &mut [&mut dyn Source],
    target: &mut impl Write,
) -> io::Result<()> {
    let mut run = Piece { store: 0, range: 0..0 };
    loop {
        let next = pieces.next();
        if let Some(Piece { store, range }) = &next
            && *store == run.store
            && range.start == run.range.end
        {
            run.range.end = range.end;
            continue;
        }
        if let (false, Some(store)) = (run.range.is_empty(), stores.get_mut(run.store as usize)) {
            store.copy(run.range, target)?;
        }
        match next {
            Some(next) => run = next,
            None => return Ok(()),
        }
    }
}
