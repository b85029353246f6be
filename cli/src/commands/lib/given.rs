//! A library as an argument: a path, or a URI of which only the needed ranges are read.

use std::path::{Path, PathBuf};

use clap::builder::{OsStringValueParser, TypedValueParser};
use htex_library::{Library, LibraryError, Located};
use htex_storage::{Location, Storage};

use crate::failure::Failure;

/// A library by path or URI.
#[derive(Clone, Debug)]
pub(crate) struct Given(Location);

impl Given {
    /// The parser of the argument.
    pub(crate) fn parser() -> impl TypedValueParser<Value = Self> {
        OsStringValueParser::new().try_map(|text| Location::parse(&text).map(Self))
    }

    pub(crate) fn open(&self) -> Result<Library<Located>, Failure> {
        let opened = Library::open_located(&storage()?, &self.0);
        opened.map_err(|error| self.failure(error))
    }

    /// The file, if it is one of this machine.
    pub(crate) fn local(&self) -> Option<&Path> {
        self.0.local()
    }

    /// The path or URI for texts.
    pub(crate) fn shown(&self) -> PathBuf {
        PathBuf::from(self.0.to_string())
    }

    pub(crate) fn failure(&self, error: LibraryError) -> Failure {
        match error {
            LibraryError::Storage(error) => error.into(),
            error => Failure::library(&self.shown(), error),
        }
    }
}

fn storage() -> Result<Storage, Failure> {
    Ok(Storage::from_environment()?)
}
