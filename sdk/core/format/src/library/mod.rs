//! Reads, writes and validates `.htexlib` files: thousands of textures in one file. A reader can
//! open one texture without reading the others.
//!
//! `spec/htexlib-1.md` is the normative specification. The file starts with a header and an index.
//! The index consists of compressed pages, and lists the textures sorted by name. Opening one
//! texture takes three reads in a library of any size: the start of the file, a page of the index,
//! and the texture.
//!
//! ```
//! use htex_format::library::{Library, Writer};
//! # use htex_format::{Asset, Manifest};
//! # let manifest: Manifest = serde_json::from_str(r#"{
//! #     "htex": "1.0", "name": "Cotton", "license": "CC0-1.0", "quantity": "lateral_force", "unit": "N",
//! #     "tags": ["textile"], "band": { "low_hz": 20, "high_hz": 1000 },
//! #     "conditions": [{ "speed_mm_s": 80, "force_n": 0.4 }],
//! #     "representations": [{ "model": "org.htex.sbeta", "model_version": "1.0.0",
//! #         "fields": [{ "name": "alpha", "store": "f32" }, { "name": "beta", "store": "f32" }],
//! #         "at": [{ "condition": 0, "level_rms": 0.02 }], "parameters": "parameters/sbeta.bin" }] }"#)?;
//! # let asset = Asset { manifest, parameters: vec![vec![vec![1.5, 4.0]]], reference: None, plugins: vec![], notes: vec![] };
//! # let cotton = asset.to_bytes()?;
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("cloth.htexlib");
//! let mut writer = Writer::create(&path, "Cloth")?;
//! writer.add("woven/cotton", &cotton)?;
//! writer.finish()?;
//!
//! let library = Library::open(&path)?;
//! assert_eq!(library.get("woven/cotton")?, cotton);
//! for entry in library.entries() {
//!     let entry = entry?;
//!     println!("{}: {} bytes, {:?}", entry.name, entry.bytes, entry.tags);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With the feature `storage`, `Library::open_located` opens libraries by URI. [`Index`] and
//! [`Opening`] do no input or output: they only return which bytes of the file they need.
//! [`Library`] reads the needed bytes from a [`LibrarySource`]. In a browser, a web page can fetch
//! the needed bytes from a server.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod address;
mod coarse_spectrum;
mod description;
mod difference;
#[cfg(feature = "write")]
mod encode;
mod entry;
mod error;
mod facts;
mod fault;
mod header;
mod index;
#[cfg(feature = "write")]
mod layout;
mod leaf;
mod limits;
#[cfg(feature = "storage")]
mod located;
#[cfg(not(target_family = "wasm"))]
mod many;
mod metadata;
mod name;
#[cfg(feature = "storage")]
mod name_pattern;
mod opening;
#[cfg(feature = "write")]
mod packer;
mod page;
#[cfg(feature = "write")]
mod pieces;
#[cfg(feature = "write")]
mod prepared;
mod query;
mod ratio;
mod reader;
mod root;
mod rules;
mod search;
#[cfg(feature = "write")]
mod sharing;
mod source;
mod spectra;
#[cfg(feature = "write")]
mod spool;
mod summary;
mod validate;
mod wire;
#[cfg(feature = "write")]
mod writer;

pub use address::split_address;
pub use coarse_spectrum::CoarseSpectrum;
pub use description::Description;
pub use difference::LibraryDifference;
pub use entry::{Conditions, Entry, Interval};
pub use error::LibraryError;
pub use header::{EXTENSION, MAGIC};
pub use index::Index;
pub use limits::Limits;
#[cfg(feature = "storage")]
pub use located::LibraryFile;
pub use metadata::LibraryMetadata;
pub use name::{InvalidName, Names, check_name};
#[cfg(feature = "storage")]
pub use name_pattern::NamePattern;
pub use opening::{FIRST_READ, Opening, Progress};
#[cfg(feature = "write")]
pub use packer::PackSummary;
#[cfg(feature = "write")]
pub use prepared::{Describe, PreparedTexture};
pub use query::Query;
pub use ratio::Ratio;
pub use reader::{Described, Entries, Library};
pub use rules::{RULES, findings_page};
pub use search::{Duplicate, Similar};
pub use source::{LibrarySource, LocalFile};
pub use summary::LibrarySummary;
pub use validate::{validate, validate_source};
#[cfg(feature = "write")]
pub use writer::{MemoryWriter, Writer};
