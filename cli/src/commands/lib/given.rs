//! A library as an argument: a path, or a URI of which only the needed ranges are read.

use std::path::{Path, PathBuf};

use clap::builder::{OsStringValueParser, TypedValueParser};
use htex_library::{Library, Located};
use htex_storage::{Location, Storage};

use crate::failure::Failure;
use crate::of_file::ResultOfFile;

/// A library by path or URI.
#[derive(Clone, Debug)]
pub(crate) struct Given(Location);

impl Given {
    /// The parser of the argument.
    pub(crate) fn parser() -> impl TypedValueParser<Value = Self> {
        OsStringValueParser::new().try_map(|text| Location::parse(&text).map(Self))
    }

    pub(crate) fn open(&self) -> Result<Library<Located>, Failure> {
        Library::open_located(&storage()?, &self.0).of(&self.shown())
    }

    /// The file, if it is one of this machine.
    pub(crate) fn local(&self) -> Option<&Path> {
        self.0.local()
    }

    /// The path or URI for texts.
    pub(crate) fn shown(&self) -> PathBuf {
        PathBuf::from(self.0.to_string())
    }
}

fn storage() -> Result<Storage, Failure> {
    Ok(Storage::from_environment()?)
}
