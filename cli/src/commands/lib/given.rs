//! A library argument: a path, or a URI from which only the needed ranges are read.

use std::path::{Path, PathBuf};

use clap::builder::{OsStringValueParser, TypedValueParser};
use htex_base::storage::{Location, Storage};
use htex_format::library::{Library, LibraryFile};

use crate::failure::Failure;
use crate::of_file::of_file;

/// A library given by a path or URI.
#[derive(Clone, Debug)]
pub(crate) struct Given(Location);

impl Given {
    /// Returns the parser of the argument.
    pub(crate) fn parser() -> impl TypedValueParser<Value = Self> {
        OsStringValueParser::new().try_map(|text| Location::parse(&text).map(Self))
    }

    pub(crate) fn open(&self) -> Result<Library<LibraryFile>, Failure> {
        Library::open_located(&storage()?, &self.0).map_err(of_file(&self.shown()))
    }

    /// Returns the file if it is on this machine.
    pub(crate) fn local(&self) -> Option<&Path> {
        self.0.local()
    }

    /// Returns the path or URI for messages.
    pub(crate) fn shown(&self) -> PathBuf {
        PathBuf::from(self.0.to_string())
    }
}

fn storage() -> Result<Storage, Failure> {
    Ok(Storage::from_environment()?)
}
