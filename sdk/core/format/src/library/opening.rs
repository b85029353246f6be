//! Opens a library without doing input or output: [`Opening`] tells the caller which bytes of the
//! file it needs next.

use std::ops::Range;

use htex_base::finding::Findings;

use crate::library::error::LibraryError;
use crate::library::fault::Fault;
use crate::library::header::{HEADER_BYTES, Header, newer_note_of};
use crate::library::index::Index;
use crate::library::limits::Limits;
use crate::library::page;
use crate::library::root::{PLACE, Root};
use crate::library::rules as rule;

/// Size of the first read, bytes. Except in huge libraries, the first read contains the header and
/// the whole root page.
pub const FIRST_READ: u64 = 16 << 10;

/// A library that is being opened. The caller passes bytes of the file to an `Opening` until
/// [`Self::give`] returns an [`Index`].
///
/// ```
/// use htex_format::library::{Index, LibraryError, Limits, Opening, Progress};
///
/// fn open(file: &[u8]) -> Result<Index, LibraryError> {
///     let mut opening = Opening::new(Limits::default());
///     loop {
///         let wanted = opening.wanted();
///         let end = (wanted.end as usize).min(file.len());
///         let bytes = file.get(wanted.start as usize..end).unwrap_or_default();
///         match opening.give(bytes, file.len() as u64)? {
///             Progress::More(next) => opening = next,
///             Progress::Open(index) => return Ok(index),
///         }
///     }
/// }
/// assert!(open(b"not a library").is_err());
/// ```
#[derive(Debug)]
pub struct Opening {
    limits: Limits,
    /// The bytes from the start of the file that the caller has given so far.
    start: Vec<u8>,
    header: Option<Header>,
    index: Option<Index>,
}

/// Result of [`Opening::give`].
#[derive(Debug)]
pub enum Progress {
    /// More bytes of the file are needed. [`Opening::wanted`] returns their range.
    More(Opening),
    /// The library is open.
    Open(Index),
}

impl Opening {
    /// Starts opening a library.
    pub fn new(limits: Limits) -> Self {
        Self { limits, start: Vec::new(), header: None, index: None }
    }

    /// Returns which bytes of the file are needed next. The returned range may end after the end of
    /// the file.
    pub fn wanted(&self) -> Range<u64> {
        let have = self.start.len() as u64;
        match &self.header {
            None => 0..FIRST_READ,
            Some(header) => have..header.root.end,
        }
    }

    /// Receives the bytes of the range [`Self::wanted`], or fewer bytes if the file ends earlier.
    /// `file_bytes` is the length of the whole file.
    ///
    /// # Errors
    /// Returns [`LibraryError::Invalid`] if the header or the root page breaks a rule.
    pub fn give(mut self, bytes: &[u8], file_bytes: u64) -> Result<Progress, LibraryError> {
        self.take(bytes, file_bytes).map_err(|fault| {
            // A newer minor version is reported first, because it may be the cause of the fault.
            let mut findings = Findings::default();
            let note = newer_note_of(&self.start);
            note.into_iter().chain([fault]).for_each(|fault| fault.add_to(&mut findings));
            LibraryError::Invalid { findings: findings.into_list() }
        })?;
        Ok(match self.index.take() {
            Some(index) => Progress::Open(index),
            None => Progress::More(self),
        })
    }

    /// Takes bytes. Sets the index once the root page is complete.
    fn take(&mut self, bytes: &[u8], file_bytes: u64) -> Result<(), Fault> {
        let wanted = self.wanted();
        let most = usize::try_from(wanted.end - wanted.start).unwrap_or(usize::MAX);
        // A server that does not support ranges may send the whole file, so the bytes that are not
        // wanted are dropped.
        self.start.extend_from_slice(&bytes[..bytes.len().min(most)]);
        let header = match self.header.take() {
            Some(header) => header,
            None => self.read_header(file_bytes)?,
        };
        let is_complete = self.start.len() as u64 >= header.root.end;
        if !is_complete && self.start.len() as u64 == wanted.start {
            let message = format!("no bytes follow byte {}; get it again", wanted.start);
            return Err(Fault::new(rule::LIBRARY_TRUNCATED, "", message));
        }
        if is_complete {
            self.index = Some(self.read_root(header)?);
        } else {
            self.header = Some(header);
        }
        Ok(())
    }

    fn read_header(&self, file_bytes: u64) -> Result<Header, Fault> {
        let header = Header::read(&self.start, file_bytes, &self.limits)?;
        let packed = header.root.end - header.root.start;
        // The size is checked before the caller is asked for the root page, because the caller
        // allocates as many bytes as the header states.
        page::check_packed_size(packed, self.limits.root_bytes, PLACE)?;
        Ok(header)
    }

    fn read_root(&self, header: Header) -> Result<Index, Fault> {
        // The bytes up to the end of the root are in memory, so the end fits into `usize`.
        let packed = self.start.get(HEADER_BYTES..header.root.end as usize).unwrap_or_default();
        let root = page::unpack(packed, self.limits.root_bytes, PLACE)?;
        let root = Root::read(&root, &header, self.limits.leaf_bytes)?;
        Ok(Index::new(header, root, *blake3::hash(packed).as_bytes(), self.limits))
    }
}
