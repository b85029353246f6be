//! Replaces the stores if the feature `cloud` is off. Every use of a remote URI then returns an
//! error.

use std::convert::Infallible;
use std::fs::File;
use std::ops::Range;
use std::path::Path;

use crate::storage::location::Uri;
use crate::storage::{Entry, Location, Settings, Stat, StorageError, StorageProblem, Variables};

#[derive(Debug, Default)]
pub(crate) struct Clients;

/// A store that cannot exist.
pub(crate) struct Store(Infallible);

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Version {
    pub(crate) bytes: u64,
    pub(crate) etag: Option<String>,
}

impl Version {
    pub(crate) fn unknown(bytes: u64) -> Self {
        Self { bytes, etag: None }
    }
}

pub(crate) struct ReadPart {
    pub(crate) bytes: Vec<u8>,
    pub(crate) version: Version,
}

impl Store {
    pub(crate) fn open(
        location: &Location,
        _: &Uri,
        _: (&Settings, &Variables, &Clients),
        _: bool,
    ) -> Result<Self, StorageError> {
        Err(StorageProblem::NoCloud.at_place(location))
    }

    pub(crate) fn usage(&self) -> (u64, u64) {
        match self.0 {}
    }

    pub(crate) fn stat(&self) -> Result<Option<Stat>, StorageError> {
        match self.0 {}
    }

    pub(crate) fn list(&self, _: glob::Pattern) -> Result<Vec<Entry>, StorageError> {
        match self.0 {}
    }

    pub(crate) fn read(&self, _: u64) -> Result<Vec<u8>, StorageError> {
        match self.0 {}
    }

    pub(crate) fn download(&self, _: File, _: u64) -> Result<File, StorageError> {
        match self.0 {}
    }

    pub(crate) fn part(&self, _: Range<u64>, _: Option<Version>) -> Result<ReadPart, StorageError> {
        match self.0 {}
    }

    pub(crate) fn write(&self, _: Vec<u8>) -> Result<(), StorageError> {
        match self.0 {}
    }

    pub(crate) fn upload(&self, _: &Path) -> Result<(), StorageError> {
        match self.0 {}
    }

    pub(crate) fn remove(&self) -> Result<(), StorageError> {
        match self.0 {}
    }
}
