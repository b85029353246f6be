//! Packs textures into a library.
//!
//! Only after the last texture does the packer know which modules are shared. So the packer first
//! writes each added texture to a temporary store, the spool, and writes the library at the end.
//! The packer orders textures by name, and shared objects by hash. So the same textures always give
//! the same file, in whatever order they were added.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::{Asset, Contact, Law};

use crate::library::encode::Pages;
use crate::library::entry::{Conditions, Entry};
use crate::library::error::LibraryError;
use crate::library::facts::{Facts, MOST_WORDS};
use crate::library::header::{HEADER_BYTES, Header, MINOR};
use crate::library::leaf::length;
use crate::library::limits::Limits;
use crate::library::name::{check_library_name, check_name, file_key};
use crate::library::sharing::Sharing;
use crate::library::spool::{Spool, SpoolRange, SpoolReader, Store};
use crate::library::wire::TEXT_BYTES;

/// The textures of a library that is being written.
pub(crate) struct Packer<S> {
    /// Path of the file, for error messages; empty for a library in memory.
    path: PathBuf,
    name: String,
    spool: Spool<S>,
    /// The textures by name, in the order in which the index and the payload contain them.
    added: BTreeMap<String, PendingTexture>,
    /// The name of each texture by its [`file_key`], to find names that denote the same file on
    /// some systems.
    files: BTreeMap<[u8; 16], String>,
    /// Distinct sets of tags and models. Many textures have the same set, so each distinct set is
    /// in memory only once.
    words: BTreeSet<Arc<Words>>,
    /// Whether textures without a licence may be packed.
    pub(crate) allows_unlicensed: bool,
}

/// Tags and models of a texture.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Words {
    tags: Vec<String>,
    models: Vec<String>,
}

/// The data in memory about a texture that was added.
struct PendingTexture {
    words: Arc<Words>,
    conditions: Conditions,
    contact: Contact,
    law: Law,
    is_licensed: bool,
    blake3: [u8; 32],
    spooled: SpoolRange,
}

/// Sizes, counts and hash of a library that was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct PackSummary {
    /// Number of textures.
    pub entries: u64,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Size of the header and the index together, bytes.
    pub index_bytes: u64,
    /// Number of objects that several textures share.
    pub shared_objects: u64,
    /// Number of bytes that the file saves because it stores shared objects only once.
    pub saved_bytes: u64,
    /// BLAKE3 of the index, which identifies the library.
    pub blake3: [u8; 32],
}

impl<S: Store> Packer<S> {
    /// Starts a library with this name. `store` holds the textures until the library is written.
    pub(crate) fn new(path: &Path, name: &str, store: S) -> Result<Self, LibraryError> {
        check_library_name(name)
            .map_err(|problem| LibraryError::Name { name: name.to_owned(), problem })?;
        Ok(Self {
            path: path.to_owned(),
            name: name.to_owned(),
            spool: Spool::new(store),
            added: BTreeMap::new(),
            files: BTreeMap::new(),
            words: BTreeSet::new(),
            allows_unlicensed: false,
        })
    }

    /// Adds a texture; see [`crate::library::Writer::add`].
    pub(crate) fn add(&mut self, name: &str, asset: &[u8]) -> Result<(), LibraryError> {
        check_name(name)
            .map_err(|problem| LibraryError::Name { name: name.to_owned(), problem })?;
        if self.added.contains_key(name) {
            return Err(LibraryError::Duplicate { name: name.to_owned() });
        }
        let file = file_key(name);
        if let Some(other) = self.files.get(&file) {
            return Err(LibraryError::Alike { name: name.to_owned(), other: other.clone() });
        }
        let read = Asset::from_bytes(asset).map_err(|error| LibraryError::Asset {
            name: name.to_owned(),
            error: Box::new(error),
        })?;
        let facts = Facts::new(&read.manifest);
        check_words(name, "tags", &facts.tags)?;
        check_words(name, "models", &facts.models)?;
        let spooled = self.spool.add(asset).map_err(LibraryError::unchanged(&self.path))?;
        let added = PendingTexture {
            words: self.common_words(facts.tags, facts.models),
            conditions: facts.conditions,
            contact: facts.contact,
            law: facts.law,
            is_licensed: read.manifest.license.is_some(),
            blake3: *blake3::hash(asset).as_bytes(),
            spooled,
        };
        self.added.insert(name.to_owned(), added);
        self.files.insert(file, name.to_owned());
        Ok(())
    }

    /// Returns these tags and models in one allocation. All textures with the same tags and models
    /// share it.
    fn common_words(&mut self, tags: Vec<String>, models: Vec<String>) -> Arc<Words> {
        let words = Arc::new(Words { tags, models });
        if let Some(known) = self.words.get(&words) {
            return known.clone();
        }
        self.words.insert(words.clone());
        words
    }

    /// Refuses textures without a licence, because only the people who made such a texture may pass
    /// it on.
    fn check_licences(&self) -> Result<(), LibraryError> {
        let mut unlicensed = self.added.iter().filter(|(_, texture)| !texture.is_licensed);
        match unlicensed.next() {
            Some((name, _)) if !self.allows_unlicensed => {
                Err(LibraryError::Unlicensed { name: name.clone(), others: unlicensed.count() })
            }
            _ => Ok(()),
        }
    }

    /// Writes the library to `target`.
    pub(crate) fn finish(self, target: &mut impl Write) -> Result<PackSummary, LibraryError> {
        // Only here, when all textures are known, so that the message can say how many have no
        // licence.
        self.check_licences()?;
        let Self { path, name, spool, added, .. } = self;
        let (mut spool, modules) = spool.finish().map_err(LibraryError::unchanged(&path))?;
        let sharing = Sharing::new(modules);
        let (header, index, total) = index(&name, &added, &sharing);
        check_limits(&name, &header, total)?;
        write(target, &header, &index, &mut spool, &sharing, &added)
            .map_err(LibraryError::unchanged(&path))?;
        Ok(PackSummary {
            entries: header.entries,
            bytes: header.payload.end,
            index_bytes: header.leaves.end,
            shared_objects: sharing.objects().len() as u64,
            saved_bytes: sharing.saved_bytes(),
            blake3: header.index_blake3,
        })
    }
}

impl LibraryError {
    /// Turns an error of the system into a library error that names the file and says that it is
    /// unchanged.
    pub(crate) fn unchanged(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |error| Self::Write { path: path.to_owned(), error }
    }
}

fn check_words(name: &str, what: &str, words: &[String]) -> Result<(), LibraryError> {
    let problem = if words.len() > MOST_WORDS {
        format!("it has {} {what} and the index holds {MOST_WORDS}; leave some out", words.len())
    } else if let Some(word) = words.iter().find(|word| word.len() > TEXT_BYTES) {
        format!(
            "one of its {what} has {} bytes and the index holds {TEXT_BYTES}; shorten it",
            word.len()
        )
    } else {
        return Ok(());
    };
    Err(LibraryError::Limit { name: name.to_owned(), problem })
}

/// Encodes the index. Returns the header, the root and leaves, and the total size of all textures.
fn index(
    name: &str,
    added: &BTreeMap<String, PendingTexture>,
    sharing: &Sharing,
) -> (Header, Vec<u8>, u64) {
    let (mut pages, mut payload, mut total) = (Pages::default(), 0, 0);
    // Own bytes of the textures follow each other in the order of names. `write` copies them in the
    // same order.
    for (name, texture) in added {
        let place = sharing.place(&texture.spooled, payload);
        payload = place.own.end;
        let shared = place.cuts.iter().map(|cut| length(&cut.object));
        let bytes = length(&place.own) + shared.sum::<u64>();
        total += bytes;
        pages.add(Entry {
            name: name.clone(),
            tags: texture.words.tags.clone(),
            models: texture.words.models.clone(),
            conditions: texture.conditions,
            contact: texture.contact,
            law: texture.law,
            bytes,
            blake3: texture.blake3,
            place,
        });
    }
    let (root, leaves, leaf_count) = pages.finish(name);
    // The parts follow each other without gaps, so each begins where the one before ends.
    let mut end = HEADER_BYTES as u64;
    let mut part = |bytes: u64| {
        let start = end;
        end += bytes;
        start..end
    };
    let index = [root.as_slice(), &leaves].concat();
    let header = Header {
        minor: MINOR,
        root: part(root.len() as u64),
        leaves: part(leaves.len() as u64),
        shared: part(sharing.bytes()),
        payload: part(payload),
        entries: added.len() as u64,
        leaf_count,
        index_blake3: *blake3::hash(&index).as_bytes(),
    };
    (header, index, total)
}

/// Checks the limits of readers, so that every library that is written can be read within the
/// default limits.
fn check_limits(name: &str, header: &Header, total: u64) -> Result<(), LibraryError> {
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
    } else if total > header.payload.end.saturating_mul(limits.ratio) {
        let ratio = limits.ratio;
        format!(
            "its textures have {total} bytes, over {ratio} times the bytes of the file, and readers refuse that; split it"
        )
    } else {
        return Ok(());
    };
    Err(LibraryError::Limit { name: format!("library {name:?}"), problem })
}

fn write(
    target: &mut impl Write,
    header: &Header,
    index: &[u8],
    spool: &mut SpoolReader<impl Store>,
    sharing: &Sharing,
    added: &BTreeMap<String, PendingTexture>,
) -> io::Result<()> {
    target.write_all(&header.to_bytes())?;
    target.write_all(index)?;
    // `sharing` assigned the places of the objects in this order, and `index` the places of the
    // textures.
    for object in sharing.objects() {
        spool.copy(object, target)?;
    }
    for texture in added.values() {
        for piece in sharing.own_pieces(&texture.spooled) {
            spool.copy(piece, target)?;
        }
    }
    target.flush()
}
