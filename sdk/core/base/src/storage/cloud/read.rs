//! Reads whole files, and byte ranges that all come from the same version of a file.

use std::fs::File;
use std::io::{self, Seek, Write};
use std::ops::Range;

use futures_util::StreamExt;
use object_store::{GetOptions, GetRange, GetResult, ObjectMeta};

use super::Store;
use super::explain::Fail;
use super::log::Last;
use crate::storage::{StorageError, StorageProblem};

/// One version of a file, as far as the server distinguishes versions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Version {
    pub(crate) bytes: u64,
    pub(crate) etag: Option<String>,
    /// The time when the file was written, used if there is no tag. If this time is also unknown,
    /// all versions have the same time.
    modified: i64,
}

impl Version {
    fn new(meta: &ObjectMeta) -> Self {
        let modified = match meta.e_tag {
            Some(_) => 0,
            None => meta.last_modified.timestamp_millis(),
        };
        Self { bytes: meta.size, etag: meta.e_tag.clone(), modified }
    }

    /// The version of a file of which only its size is known.
    pub(crate) fn unknown(bytes: u64) -> Self {
        Self { bytes, etag: None, modified: 0 }
    }

    /// Returns the tag for the header `If-Match`, which compares only strong tags.
    fn strong_etag(&self) -> Option<String> {
        self.etag.clone().filter(|etag| !etag.starts_with("W/"))
    }
}

/// The bytes of a range, and the version to which they belong.
pub(crate) struct ReadPart {
    pub(crate) bytes: Vec<u8>,
    pub(crate) version: Version,
}

/// Receives the bytes of a file.
trait Sink: Send + 'static {
    /// Drops all bytes received so far.
    fn start_over(&mut self) -> io::Result<()>;
    fn accept(&mut self, bytes: &[u8]) -> io::Result<()>;
}

impl Sink for Vec<u8> {
    fn start_over(&mut self) -> io::Result<()> {
        self.clear();
        Ok(())
    }

    fn accept(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.extend_from_slice(bytes);
        Ok(())
    }
}

impl Sink for File {
    fn start_over(&mut self) -> io::Result<()> {
        self.set_len(0)?;
        self.rewind()
    }

    fn accept(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write_all(bytes)
    }
}

impl Store {
    /// Reads the whole file.
    pub(crate) fn read(&self, most_bytes: u64) -> Result<Vec<u8>, StorageError> {
        let here = self.clone();
        self.run(async move { here.whole(Vec::new(), most_bytes).await })
    }

    /// Downloads the whole file into a local file.
    pub(crate) fn download(&self, file: File, most_bytes: u64) -> Result<File, StorageError> {
        let here = self.clone();
        self.run(async move { here.whole(file, most_bytes).await })
    }

    /// Reads a range. If the range ends beyond the end of the file, the result is shorter. If
    /// `version` is given, reads only this version.
    pub(crate) fn part(
        &self,
        range: Range<u64>,
        version: Option<Version>,
    ) -> Result<ReadPart, StorageError> {
        let here = self.clone();
        self.run(async move { here.range(range, version).await })
    }

    async fn whole<S: Sink>(self, mut sink: S, most_bytes: u64) -> Result<S, Fail> {
        for attempt in 0.. {
            let found = self.store.get_opts(&self.key, GetOptions::default()).await?;
            let version = Version::new(&found.meta);
            self.check_size(version.bytes, most_bytes)?;
            sink.start_over()?;
            match Self::take_all(found, version.bytes, &mut sink).await {
                // The library resumes only at the same version, which it recognises by the tag.
                // Without a tag, read from the start again.
                Err(Fail::Body) if version.etag.is_none() && attempt < self.settings.retries => {
                    tokio::time::sleep(self.settings.first_pause).await;
                }
                done => return done.map(|()| sink),
            }
        }
        Err(Fail::Ended)
    }

    async fn take_all(found: GetResult, bytes: u64, sink: &mut impl Sink) -> Result<(), Fail> {
        let mut rest = bytes;
        let mut stream = found.into_stream();
        while let Some(chunk) = stream.next().await {
            let chunk = chunk.map_err(|_| Fail::Body)?;
            // A server may send more than it stated, which would exceed the limit that was checked.
            rest = rest.checked_sub(chunk.len() as u64).ok_or(Fail::Body)?;
            sink.accept(&chunk)?;
        }
        match rest {
            0 => Ok(()),
            _ => Err(Fail::Body),
        }
    }

    async fn range(self, range: Range<u64>, version: Option<Version>) -> Result<ReadPart, Fail> {
        let options = GetOptions {
            range: Some(GetRange::Bounded(range.clone())),
            if_match: version.as_ref().and_then(Version::strong_etag),
            ..GetOptions::default()
        };
        let found = match self.store.get_opts(&self.key, options).await {
            // An empty file has no first byte, so a server refuses every range of it.
            Err(_) if range.start == 0 && self.is_beyond_end() => return Ok(ReadPart::of_empty()),
            found => found?,
        };
        let is = Version::new(&found.meta);
        // Not every server obeys `If-Match`, and weak tags cannot be sent in it.
        if version.is_some_and(|version| version != is) {
            return Err(Fail::Own(StorageProblem::Changed.at_place(&self.location)));
        }
        let mut bytes = Vec::new();
        let len = found.range.end - found.range.start;
        Self::take_all(found, len, &mut bytes).await?;
        Ok(ReadPart { bytes, version: is })
    }

    /// Returns whether the last range began after the end of the file. This includes the first byte
    /// of an empty file.
    fn is_beyond_end(&self) -> bool {
        matches!(self.log.last(), Last::Status { status: 416, .. })
    }

    fn check_size(&self, bytes: u64, most_bytes: u64) -> Result<(), Fail> {
        if bytes <= most_bytes {
            Ok(())
        } else {
            Err(Fail::Own(StorageProblem::TooLarge { most_bytes }.at_place(&self.location)))
        }
    }
}

impl ReadPart {
    fn of_empty() -> Self {
        Self { bytes: Vec::new(), version: Version::unknown(0) }
    }
}
