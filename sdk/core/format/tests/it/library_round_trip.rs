//! Packed textures are read back byte for byte, and the same textures give the same file.

use crate::library_common as common;

use std::cell::RefCell;
use std::collections::BTreeMap;

use common::cases::{four, sharing};
use common::{Texture, all, module, pack, pack_bytes, texture};
use htex_format::library::{
    Entry, FIRST_READ, Library, LibraryError, LibrarySource, LocalFile, Query, Writer,
    validate_source,
};
use proptest::prelude::*;

/// A source that records what is read.
struct Counted<S>(S, RefCell<Vec<u64>>);

impl<S: LibrarySource> LibrarySource for Counted<S> {
    fn len(&self) -> std::io::Result<u64> {
        self.0.len()
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.1.borrow_mut().push(buffer.len() as u64);
        self.0.read_at(offset, buffer)
    }
}

fn valid(file: &[u8]) {
    let report = validate_source(file, &Default::default()).unwrap();
    assert!(report.valid && report.findings.is_empty(), "{:?}", report.findings);
}

#[test]
fn textures_come_back_whole_and_in_order_of_their_names() {
    for textures in [four(), sharing(), Vec::new()] {
        let (packed, file) = pack("Some", &textures);
        valid(&file);
        assert_eq!(packed.bytes, file.len() as u64);
        let mut expected: Vec<(String, Vec<u8>)> =
            textures.iter().map(|t| (t.name.clone(), t.bytes())).collect();
        expected.sort();
        assert_eq!(all(&file), expected);
        let library = Library::open_source(file.as_slice()).unwrap();
        assert_eq!((library.name(), library.len()), ("Some", textures.len() as u64));
        for (name, bytes) in expected {
            assert_eq!(library.get(&name).unwrap(), bytes);
        }
        let absent = library.get("wood/walnut").unwrap_err();
        assert!(matches!(&absent, LibraryError::Absent { name, .. } if name == "wood/walnut"));
        assert!(library.entry("").unwrap().is_none());
    }
}

/// A module that two textures embed is in the file only once. A module that one texture embeds
/// stays part of that texture.
#[test]
fn shared_modules_are_stored_once() {
    let textures = sharing();
    let (packed, file) = pack("Shared", &textures);
    let count = |module: &[u8]| file.windows(100).filter(|w| *w == &module[50..150]).count();
    assert_eq!([count(&module(1, 300)), count(&module(2, 200))], [1, 1]);
    assert_eq!(packed.shared_objects, 1);
    assert!(packed.saved_bytes >= 300);
    let inside: usize = textures.iter().map(|t| t.bytes().len()).sum();
    assert_eq!(packed.bytes, packed.index_bytes + inside as u64 - packed.saved_bytes);
}

#[test]
fn the_order_of_adding_does_not_change_the_file() {
    let mut textures = [four(), sharing()].concat();
    let first = pack("Any order", &textures);
    textures.reverse();
    assert_eq!(pack("Any order", &textures), first);
    textures.rotate_left(3);
    assert_eq!(pack("Any order", &textures), first);
}

/// Counts the reads and bytes for one texture, the first of a library with several leaves.
#[test]
fn a_texture_takes_three_reads() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("many.htexlib");
    let bytes = texture("x").bytes();
    let mut writer = Writer::create(&path, "Many").unwrap();
    for i in 0..5_000u32 {
        // Scrambled names have little in common, so the index is large.
        let name = format!("{:08x}/{i}", i.wrapping_mul(0x9E37_79B1));
        writer.add(&name, &bytes).unwrap();
    }
    writer.finish().unwrap();
    let source = Counted(LocalFile::open(&path).unwrap(), RefCell::default());
    let library = Library::open_source(source).unwrap();
    assert!(library.index().leaves() > 3);
    let name = format!("{:08x}/{}", 4_321u32.wrapping_mul(0x9E37_79B1), 4_321);
    assert_eq!(library.get(&name).unwrap(), bytes);
    let source = Counted(LocalFile::open(&path).unwrap(), RefCell::default());
    let again = Library::open_source(&source).unwrap();
    again.get(&name).unwrap();
    let reads = source.1.borrow();
    assert_eq!((reads.len(), reads[0], reads[2]), (3, FIRST_READ, bytes.len() as u64));
    assert!(reads[0] + reads[1] <= 64_000, "{reads:?}");
}

#[test]
fn a_writer_that_is_dropped_leaves_nothing_and_keeps_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.htexlib");
    std::fs::write(&path, b"before").unwrap();
    let mut writer = Writer::create(&path, "New").unwrap();
    writer.add("a", &texture("a").bytes()).unwrap();
    drop(writer);
    assert_eq!(std::fs::read(&path).unwrap(), b"before");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn what_cannot_be_packed_is_refused_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.htexlib");
    let mut writer = Writer::create(&path, "A").unwrap();
    let good = texture("a").bytes();
    writer.add("a", &good).unwrap();
    let refused = |writer: &mut Writer, name: &str, asset: &[u8]| {
        writer.add(name, asset).unwrap_err().to_string()
    };
    for (name, words) in
        [("a", "two textures have the name a"), ("../a", "is not a name"), ("", "is not a name")]
    {
        let message = refused(&mut writer, name, &good);
        assert!(message.contains(words), "{message}");
    }
    let message = refused(&mut writer, "text", b"no asset");
    assert!(message.starts_with("text: ") && message.contains("ARCHIVE_INVALID"), "{message}");
    let mut tagged = texture("tagged");
    tagged.tags = (0..65).map(|i| i.to_string()).collect();
    assert!(refused(&mut writer, "tagged", &tagged.bytes()).contains("65 tags"));
    tagged.tags = vec!["t".repeat(256)];
    assert!(refused(&mut writer, "tagged", &tagged.bytes()).contains("256 bytes"));
    assert_eq!(writer.finish().unwrap().entries, 1);
    assert!(Writer::create(&path, "a\nb").is_err());
    assert!(Writer::create(&folder.path().join("no/where"), "A").is_err());
}

#[test]
fn searches_find_by_words_tags_conditions_and_models() {
    let (_, file) = pack("Four", &four());
    let library = Library::open_source(file.as_slice()).unwrap();
    let found = |query: Query| {
        let entries = library.entries().map(|entry| entry.unwrap());
        let found = entries.filter(|entry| query.matches(entry));
        found.map(|entry| entry.name).collect::<Vec<_>>()
    };
    let words = |words: &[&str]| Query {
        words: words.iter().map(|w| (*w).to_owned()).collect(),
        ..Query::default()
    };
    assert_eq!(found(words(&["WOOD", "o"])), ["wood/birch", "wood/oak", "wood/Ölweide"]);
    assert_eq!(found(words(&["textil"])), ["felt", "wood/oak"]);
    assert_eq!(found(words(&["öl"])), ["wood/Ölweide"]);
    let tags = vec!["Rough".to_owned(), "textile".to_owned()];
    assert_eq!(found(Query { tags, ..Query::default() }), ["felt", "wood/oak"]);
    let speed = |x| Query { speed_mm_s: Some(x), ..Query::default() };
    assert_eq!(found(speed(100.0)), ["wood/birch"]);
    assert_eq!(found(speed(82.0)).len(), 4);
    assert_eq!(found(speed(123.0)), ["wood/birch"]);
    let force = |x| Query { force_n: Some(x), ..Query::default() };
    assert_eq!((found(force(0.49)).len(), found(force(2.0)).len()), (4, 0));
    let model = |x: &str| Query { model: Some(x.to_owned()), ..Query::default() };
    assert_eq!((found(model("sbeta")).len(), found(model("org.htex.ar")).len()), (4, 0));
}

fn textures() -> impl Strategy<Value = Vec<Texture>> {
    let one = (
        "[a-c]{1,3}(/[a-cß]{1,3}){0,2}",
        proptest::collection::vec("[a-z ]{0,12}", 0..4),
        proptest::collection::vec(0u32..500, 1..4),
        proptest::collection::vec(0u64..3, 0..3),
    );
    let one = one.prop_map(|(name, tags, mut speeds, mut modules)| {
        // Speeds are far apart, and a module has one id.
        speeds.sort();
        speeds.dedup();
        modules.dedup();
        Texture {
            name,
            tags,
            speeds_mm_s: speeds.into_iter().map(f64::from).collect(),
            modules: modules.into_iter().map(|seed| module(seed, 100)).collect(),
        }
    });
    proptest::collection::vec(one, 0..12)
}

/// One texture under several names, alone, with a shared module and beside a texture that has the
/// module, too.
#[test]
fn equal_textures_are_stored_once() {
    let mut with_module = texture("felt");
    with_module.modules = vec![module(1, 300)];
    let mut other = texture("linen");
    other.modules = with_module.modules.clone();
    let plain = texture("oak").bytes();
    let named = |name: &str, bytes: &[u8]| (name.to_owned(), bytes.to_vec());
    let (first, second) = (with_module.bytes(), other.bytes());
    let textures: BTreeMap<_, _> = [
        named("oak", &plain),
        named("copy/oak", &plain),
        named("felt", &first),
        named("a felt", &first),
        named("linen", &second),
    ]
    .into();
    let (packed, file) = pack_bytes("Equal", &textures);
    valid(&file);
    assert_eq!(all(&file), textures.clone().into_iter().collect::<Vec<_>>());
    let all: usize = textures.values().map(Vec::len).sum();
    let stored = packed.bytes - packed.index_bytes;
    assert_eq!(stored, all as u64 - packed.saved_bytes);
    // Each texture once, and the module once.
    assert!(stored <= (plain.len() + first.len() + second.len() - 300) as u64, "{stored}");
}

/// So many names that readers would refuse the small file: then each has bytes of its own.
#[test]
fn very_many_names_of_one_texture_can_be_read() {
    let mut large = texture("felt");
    large.modules = vec![module(1, 100_000)];
    large.tags = (0..60).map(|i| format!("{i} {}", "tag ".repeat(50))).collect();
    let bytes = large.bytes();
    let textures: BTreeMap<_, _> = (0..2000).map(|i| (format!("{i:04}"), bytes.clone())).collect();
    let (packed, file) = pack_bytes("Names", &textures);
    assert_eq!(packed.shared_objects, 1);
    let library = Library::open_source(file.as_slice()).unwrap();
    assert_eq!(library.get("1999").unwrap(), bytes);
    let mut ratio = library.ratio();
    library.entries().for_each(|entry| ratio.add(&entry.unwrap()).unwrap());
}

/// A change of a library.
#[derive(Debug, Clone)]
enum Change {
    Remove(usize),
    Rename(usize, String),
    Add(Texture, String),
    /// The same texture under another name.
    Copy(usize, String),
    Merge(Vec<Texture>),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let name = || "[a-c]{1,3}(/[a-c]{1,3}){0,1}";
    let one = prop_oneof![
        any::<usize>().prop_map(Change::Remove),
        (any::<usize>(), name()).prop_map(|(i, name)| Change::Rename(i, name)),
        (textures(), name()).prop_filter_map("no texture", |(all, name)| Some(Change::Add(
            all.into_iter().next()?,
            name
        ))),
        (any::<usize>(), name()).prop_map(|(i, name)| Change::Copy(i, name)),
        textures().prop_map(Change::Merge),
    ];
    proptest::collection::vec(one, 1..8)
}

/// Carries a change out, on a library and on the textures that it has.
fn change(file: &[u8], model: &mut BTreeMap<String, Vec<u8>>, change: &Change) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.htexlib");
    let mut writer = Writer::create(&path, "Any").unwrap();
    let library = || Library::open_source(file.to_vec()).unwrap();
    let nth = |i: &usize| model.keys().nth(i % model.len().max(1)).cloned();
    let is_new = |name: &String| !model.contains_key(name);
    let all = |entry: &Entry| Some(entry.name.clone());
    match change {
        Change::Remove(i) => {
            let gone = nth(i);
            let kept = |entry: &Entry| all(entry).filter(|name| Some(name) != gone.as_ref());
            writer.add_library(library(), kept).unwrap();
            gone.map(|name| model.remove(&name));
        }
        Change::Rename(i, to) if is_new(to) => {
            let from = nth(i);
            let renamed = |entry: &Entry| {
                all(entry).map(|name| if Some(&name) == from.as_ref() { to.clone() } else { name })
            };
            writer.add_library(library(), renamed).unwrap();
            if let Some(bytes) = from.and_then(|name| model.remove(&name)) {
                model.insert(to.clone(), bytes);
            }
        }
        Change::Add(texture, to) if is_new(to) => {
            writer.add(to, &texture.bytes()).unwrap();
            writer.add_library(library(), all).unwrap();
            model.insert(to.clone(), texture.bytes());
        }
        Change::Copy(i, to) if is_new(to) && !model.is_empty() => {
            let bytes = model[&nth(i).unwrap()].clone();
            writer.add_library(library(), all).unwrap();
            writer.add(to, &bytes).unwrap();
            model.insert(to.clone(), bytes);
        }
        Change::Merge(textures) => {
            let mut others: BTreeMap<String, Vec<u8>> =
                textures.iter().map(|t| (t.name.clone(), t.bytes())).collect();
            others.retain(|name, _| is_new(name));
            let (_, other) = pack_bytes("Other", &others);
            writer.add_library(library(), all).unwrap();
            writer.add_library(Library::open_source(other).unwrap(), all).unwrap();
            model.extend(others);
        }
        _ => writer.add_library(library(), all).unwrap(),
    }
    writer.finish().unwrap();
    std::fs::read(path).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..Default::default() })]
    #[test]
    fn any_textures_are_read_as_they_were_packed(mut textures in textures()) {
        textures.sort_by(|a, b| a.name.cmp(&b.name));
        textures.dedup_by(|a, b| a.name == b.name);
        let (_, file) = pack("Any", &textures);
        valid(&file);
        let expected: Vec<_> = textures.iter().map(|t| (t.name.clone(), t.bytes())).collect();
        prop_assert_eq!(all(&file), expected);
    }

    /// A changed library is the one that would be packed of what it has.
    #[test]
    fn any_changes_give_the_library_that_is_packed_of_the_result(changes in changes()) {
        let mut model = BTreeMap::new();
        let (_, mut file) = pack_bytes("Any", &model);
        for one in &changes {
            file = change(&file, &mut model, one);
            prop_assert!(file == pack_bytes("Any", &model).1, "{one:?}");
        }
        valid(&file);
    }
}
