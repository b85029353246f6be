//! Packs textures into a library.
//!
//! The packer does not know which objects are shared until it has received the last texture.
//! Therefore, the packer first writes each added texture to a temporary store, the spool, and
//! writes the library at the end. Textures of another library need no spool, because they can be
//! read from that library. The packer sorts textures by name, and shared objects by hash. As a
//! result, the same textures always give the same file, whatever the order in which they were
//! added, and whichever libraries they came from.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::{Contact, Law, Quantity, ReadError};

use crate::library::description::Description;
use crate::library::entry::{Conditions, Entry};
use crate::library::error::LibraryError;
use crate::library::facts::{Facts, MOST_WORDS};
use crate::library::layout::{check_limits, indexed, is_beyond_ratio, write};
use crate::library::leaf::MOST_CUTS;
use crate::library::metadata::LibraryMetadata;
use crate::library::name::{check_library_name, check_name, file_key};
use crate::library::pieces::{Objects, Piece, Pieces, Source, modules};
use crate::library::prepared::{Describe, PreparedTexture};
use crate::library::reader::Library;
use crate::library::sharing::Sharing;
use crate::library::source::LibrarySource;
use crate::library::spool::{Spool, Store};
use crate::library::wire::TEXT_BYTES;

/// The textures of a library that is being written.
pub(crate) struct Packer<S> {
    /// Path of the file, for error messages; empty for a library in memory.
    path: PathBuf,
    name: String,
    spool: Spool<S>,
    /// Other libraries whose textures are packed again. Stores from 1.
    libraries: Vec<Box<dyn Source + Send>>,
    objects: Objects,
    /// Textures with different bytes.
    textures: Vec<PendingTexture>,
    /// Indices of the textures by hash.
    by_hash: HashMap<[u8; 32], u32>,
    /// Index of the texture of each name. The index and the payload have this order.
    added: BTreeMap<String, u32>,
    /// The name of each texture by its [`file_key`], to find names that denote the same file on
    /// some systems.
    files: BTreeMap<[u8; 16], String>,
    /// Distinct sets of words. Many textures have the same words, so each distinct set of words is
    /// in memory only once.
    words: BTreeSet<Arc<Words>>,
    /// Whether textures without a licence may be packed.
    pub(crate) allows_unlicensed: bool,
    /// Computes a description for each texture that is added without one.
    pub(crate) describe: Option<Describe>,
    pub(crate) metadata: LibraryMetadata,
    /// Whether a texture that did not come from a packed library embeds a module.
    has_new_modules: bool,
}

/// Texts of a texture in the index, except its name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Words {
    pub tags: Vec<String>,
    pub models: Vec<String>,
    pub license: Option<String>,
    pub author: Option<String>,
}

/// The data in memory about a texture that was added.
pub(crate) struct PendingTexture {
    pub words: Arc<Words>,
    pub conditions: Conditions,
    pub contact: Contact,
    pub law: Law,
    pub quantity: Quantity,
    pub description: Description,
    pub is_licensed: bool,
    pub bytes: u64,
    pub blake3: [u8; 32],
    pub pieces: Pieces,
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
            libraries: Vec::new(),
            objects: Objects::default(),
            textures: Vec::new(),
            by_hash: HashMap::new(),
            added: BTreeMap::new(),
            files: BTreeMap::new(),
            words: BTreeSet::new(),
            allows_unlicensed: false,
            describe: None,
            metadata: LibraryMetadata::default(),
            has_new_modules: false,
        })
    }

    /// Adds a texture; see [`crate::library::Writer::add`].
    pub(crate) fn add(&mut self, name: &str, asset: &[u8]) -> Result<(), LibraryError> {
        self.check(name)?;
        // If an equal texture was added before, the texture is not read again.
        if let Some(known) = self.by_hash.get(blake3::hash(asset).as_bytes()) {
            let known = *known;
            self.use_again(known, || Ok(asset.to_vec()))?;
            self.keep(name, known);
            return Ok(());
        }
        let prepared = PreparedTexture::new(asset.to_vec(), self.describe);
        self.add_prepared(name, prepared.map_err(LibraryError::of_asset(name))?)
    }

    /// Adds a texture; see [`crate::library::Writer::add_prepared`].
    pub(crate) fn add_prepared(
        &mut self,
        name: &str,
        texture: PreparedTexture,
    ) -> Result<(), LibraryError> {
        self.check(name)?;
        let PreparedTexture { bytes, blake3, facts, description } = texture;
        if let Some(known) = self.by_hash.get(&blake3) {
            let known = *known;
            self.use_again(known, || Ok(bytes))?;
            // The two descriptions are combined, so that the file does not depend on the order of
            // the textures.
            let texture = &mut self.textures[known as usize];
            texture.description = texture.description.or(description);
            self.keep(name, known);
            return Ok(());
        }
        check_words(name, "tags", &facts.tags)?;
        check_words(name, "models", &facts.models)?;
        let pieces = self.spooled(&bytes).map_err(LibraryError::unchanged(&self.path))?;
        self.has_new_modules |= !pieces.objects.is_empty();
        let bytes = bytes.len() as u64;
        self.insert(name, facts, description, (bytes, blake3), pieces);
        Ok(())
    }

    /// Adds the textures of a library; see [`crate::library::Writer::add_library`].
    pub(crate) fn add_library<L: LibrarySource + Send + 'static>(
        &mut self,
        library: Library<L>,
        mut name: impl FnMut(&Entry) -> Option<String>,
    ) -> Result<(), LibraryError> {
        let store = self.libraries.len() as u32 + 1;
        let payload = library.index().header().payload.start;
        let mut known_objects = HashMap::new();
        for entry in library.entries() {
            let entry = entry?;
            let Some(name) = name(&entry) else { continue };
            self.check(&name)?;
            if let Some(known) = self.by_hash.get(&entry.blake3) {
                let known = *known;
                self.use_again(known, || library.read(&entry))?;
                self.keep(&name, known);
                continue;
            }
            let shared = library.index().asset_ranges(&entry).into_iter().skip(1);
            let is_part = entry.place.own.is_empty();
            let mut objects = Vec::with_capacity(entry.place.cuts.len());
            for (cut, range) in entry.place.cuts.iter().zip(shared) {
                let object = match known_objects.get(&range) {
                    Some(object) => {
                        self.objects.use_again(*object, is_part);
                        *object
                    }
                    None => {
                        let bytes = library.read_range(range.clone())?;
                        let piece = || Ok::<_, LibraryError>(Piece { store, range: range.clone() });
                        let object = self.objects.add(&bytes, is_part, piece)?;
                        // The library's copy of the object is used, because it can be read before
                        // the spool is complete.
                        self.objects.all[object as usize].piece = piece()?;
                        known_objects.insert(range, object);
                        object
                    }
                };
                objects.push((cut.at as u32, object));
            }
            let own = payload + entry.place.own.start..payload + entry.place.own.end;
            let pieces = Pieces { own: Piece { store, range: own }, objects: objects.into() };
            let (facts, description) = self.stated(&library, &entry)?;
            self.insert(&name, facts, description, (entry.bytes, entry.blake3), pieces);
        }
        self.libraries.push(Box::new(library));
        Ok(())
    }

    /// Checks the name of a texture that is to be added.
    fn check(&self, name: &str) -> Result<(), LibraryError> {
        check_name(name)
            .map_err(|problem| LibraryError::Name { name: name.to_owned(), problem })?;
        if self.added.contains_key(name) {
            return Err(LibraryError::Duplicate { name: name.to_owned() });
        }
        match self.files.get(&file_key(name)) {
            Some(other) => Err(LibraryError::Alike { name: name.to_owned(), other: other.clone() }),
            None => Ok(()),
        }
    }

    /// Returns what a library states about a texture. The index of a library of version 1.0 does
    /// not state everything, so a texture of such a library is read.
    fn stated<L: LibrarySource>(
        &self,
        library: &Library<L>,
        entry: &Entry,
    ) -> Result<(Facts, Description), LibraryError> {
        let Some(facts) = Facts::of_entry(entry) else {
            let bytes = library.read(entry)?;
            let read = PreparedTexture::new(bytes, self.describe);
            let read = read.map_err(LibraryError::of_asset(&entry.name))?;
            return Ok((read.facts, read.description));
        };
        Ok((facts, library.description(entry)?))
    }

    fn insert(
        &mut self,
        name: &str,
        facts: Facts,
        description: Description,
        (bytes, blake3): (u64, [u8; 32]),
        pieces: Pieces,
    ) {
        let Facts { tags, models, license, author, .. } = facts;
        let texture = PendingTexture {
            is_licensed: license.is_some(),
            words: self.common_words(Words { tags, models, license, author }),
            conditions: facts.conditions,
            contact: facts.contact,
            law: facts.law,
            quantity: facts.quantity,
            description,
            bytes,
            blake3,
            pieces,
        };
        let index = self.textures.len() as u32;
        self.by_hash.insert(texture.blake3, index);
        self.textures.push(texture);
        self.keep(name, index);
    }

    fn keep(&mut self, name: &str, texture: u32) {
        self.added.insert(name.to_owned(), texture);
        self.files.insert(file_key(name), name.to_owned());
    }

    /// Writes a texture to the spool. Its modules become objects.
    fn spooled(&mut self, asset: &[u8]) -> io::Result<Pieces> {
        let Self { spool, objects, .. } = self;
        // All modules are written first, so that the texture's own bytes are adjacent in the spool.
        let ranges = modules(asset);
        let found: Vec<u32> = ranges
            .iter()
            .map(|range| {
                objects.add(&asset[range.clone()], false, || spool.add(&asset[range.clone()]))
            })
            .collect::<io::Result<_>>()?;
        let start = spool.end();
        let (mut at, mut cuts) = (0, Vec::with_capacity(ranges.len()));
        for (range, object) in ranges.iter().zip(found) {
            spool.add(&asset[at..range.start])?;
            // A valid asset has at most 16 MiB, so 32 bits are enough. They keep the memory for
            // each texture small.
            cuts.push(((spool.end() - start) as u32, object));
            at = range.end;
        }
        spool.add(&asset[at..])?;
        let own = Piece { store: 0, range: start..spool.end() };
        Ok(Pieces { own, objects: cuts.into() })
    }

    /// Counts one more use of a texture. From the second use on, all its bytes belong to objects:
    /// its modules, and the parts between them.
    fn use_again(
        &mut self,
        texture: u32,
        bytes: impl FnOnce() -> Result<Vec<u8>, LibraryError>,
    ) -> Result<(), LibraryError> {
        let pieces = self.textures[texture as usize].pieces.clone();
        if pieces.own.range.is_empty() {
            self.objects.count(&pieces, true);
            return Ok(());
        }
        let asset = bytes()?;
        let modules = modules(&asset);
        let ends = modules.iter().flat_map(|range| [range.start, range.end]);
        let ends: Vec<usize> = ends.chain([asset.len()]).collect();
        let starts = std::iter::once(0).chain(ends.iter().copied());
        // Parts and modules alternate.
        let parts: Vec<(&[u8], bool)> = starts
            .zip(&ends)
            .enumerate()
            .map(|(i, (start, end))| (&asset[start..*end], i % 2 == 0))
            .filter(|(bytes, _)| !matches!(bytes, []))
            .collect();
        if parts.len() > MOST_CUTS {
            self.objects.count(&pieces, true);
            return Ok(());
        }
        self.objects.count(&pieces, false);
        let Self { spool, objects, path, .. } = self;
        let parts = parts.into_iter().map(|(bytes, is_part)| {
            objects.add(bytes, is_part, || spool.add(bytes)).map(|object| (0, object))
        });
        let parts: io::Result<Vec<_>> = parts.collect();
        let objects = parts.map_err(LibraryError::unchanged(path))?.into();
        let own = Piece { store: 0, range: 0..0 };
        let pieces = Pieces { own, objects };
        self.objects.count(&pieces, true);
        self.textures[texture as usize].pieces = pieces;
        Ok(())
    }

    /// If only one texture of a packed library has a module, the module is among the texture's own
    /// bytes. This function finds such modules. Now another texture may.
    fn find_modules(&mut self) -> Result<(), LibraryError> {
        if self.libraries.is_empty() || self.libraries.len() == 1 && !self.has_new_modules {
            return Ok(());
        }
        for i in 0..self.textures.len() {
            let pieces = self.textures[i].pieces.clone();
            if pieces.own.store == 0 {
                continue;
            }
            let asset = self.read(&pieces).map_err(LibraryError::unchanged(&self.path))?;
            if modules(&asset).len() > pieces.objects.len() {
                self.objects.count(&pieces, false);
                let pieces = self.spooled(&asset).map_err(LibraryError::unchanged(&self.path))?;
                self.textures[i].pieces = pieces;
            }
        }
        Ok(())
    }

    /// Reads a texture of a packed library.
    fn read(&mut self, pieces: &Pieces) -> io::Result<Vec<u8>> {
        let (mut asset, mut at) = (Vec::new(), pieces.own.range.start);
        let mut copy = |piece: &Piece, asset: &mut Vec<u8>| {
            let library =
                piece.store.checked_sub(1).and_then(|i| self.libraries.get_mut(i as usize));
            match library {
                Some(library) => library.copy(piece.range.clone(), asset),
                None => Err(io::Error::other("an object is in another store")),
            }
        };
        let store = pieces.own.store;
        for (before, object) in &pieces.objects {
            let next = pieces.own.range.start + u64::from(*before);
            copy(&Piece { store, range: at..next }, &mut asset)?;
            copy(&self.objects.all[*object as usize].piece, &mut asset)?;
            at = next;
        }
        copy(&Piece { store, range: at..pieces.own.range.end }, &mut asset)?;
        Ok(asset)
    }

    /// Returns these words in one allocation. All textures with the same words share it.
    fn common_words(&mut self, words: Words) -> Arc<Words> {
        let words = Arc::new(words);
        if let Some(known) = self.words.get(&words) {
            return known.clone();
        }
        self.words.insert(words.clone());
        words
    }

    /// Refuses textures without a licence, because only their authors may pass them on.
    fn check_licences(&self) -> Result<(), LibraryError> {
        let is_licensed = |texture: u32| self.textures[texture as usize].is_licensed;
        let mut unlicensed = self.added.iter().filter(|(_, texture)| !is_licensed(**texture));
        match unlicensed.next() {
            Some((name, _)) if !self.allows_unlicensed => {
                Err(LibraryError::Unlicensed { name: name.clone(), others: unlicensed.count() })
            }
            _ => Ok(()),
        }
    }

    /// Writes the library to `target`.
    pub(crate) fn finish(mut self, target: &mut impl Write) -> Result<PackSummary, LibraryError> {
        // The licences are checked only here, when all textures are known, so that the message can
        // say how many textures have no licence.
        self.check_licences()?;
        self.find_modules()?;
        self.metadata.check().map_err(|problem| LibraryError::Limit {
            name: format!("library {:?}", self.name),
            problem,
        })?;
        let Self { path, name, spool, libraries, objects, textures, added, metadata, .. } = self;
        let mut spool = spool.finish().map_err(LibraryError::unchanged(&path))?;
        let mut sharing = Sharing::new(objects.all, true);
        let textures: Vec<(&String, &PendingTexture)> =
            added.iter().map(|(name, texture)| (name, &textures[*texture as usize])).collect();
        let (mut header, mut index, total) = indexed((&name, &metadata), &textures, &sharing);
        // Readers refuse a small file that unpacks to a huge folder. If this limit would be
        // exceeded, equal textures are stored several times.
        if is_beyond_ratio(&header, total) {
            sharing = sharing.without_parts();
            (header, index, _) = indexed((&name, &metadata), &textures, &sharing);
        }
        check_limits(&name, &header, total)?;
        let libraries = libraries.into_iter();
        let mut libraries: Vec<Box<dyn Source + Send>> = libraries.collect();
        let mut stores: Vec<&mut dyn Source> = vec![&mut spool];
        stores.extend(libraries.iter_mut().map(|library| &mut **library as &mut dyn Source));
        write(target, &header, &index, &mut stores, &sharing, &textures)
            .map_err(LibraryError::unchanged(&path))?;
        Ok(PackSummary {
            entries: header.entries,
            bytes: header.payload.end,
            index_bytes: header.leaves.end,
            shared_objects: sharing.shared().len() as u64,
            saved_bytes: sharing.saved_bytes(),
            blake3: header.index_blake3,
        })
    }
}

impl LibraryError {
    /// Turns an error of reading an asset into a library error that names the texture.
    pub(crate) fn of_asset(name: &str) -> impl FnOnce(ReadError) -> Self {
        move |error| Self::Asset { name: name.to_owned(), error: Box::new(error) }
    }

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
