//! An input that several readers from third-party libraries can share.

use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use crate::input::Random;

/// An input of known length that can be read at any place.
#[derive(Clone)]
pub(crate) struct SharedInput {
    input: Arc<Mutex<Random>>,
    length: u64,
}

impl SharedInput {
    pub(crate) fn new(input: Random) -> io::Result<Self> {
        Ok(Self { length: input.len()?, input: Arc::new(Mutex::new(input)) })
    }

    /// Returns the length in bytes.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// Reads bytes. No memory is allocated for bytes beyond the end.
    pub(crate) fn read(&self, at: u64, length: u64) -> io::Result<Vec<u8>> {
        let left = self.length.saturating_sub(at);
        if length > left {
            let problem = format!("{length} bytes are wanted at byte {at}, where {left} are left");
            return Err(io::Error::new(ErrorKind::UnexpectedEof, problem));
        }
        let mut input = self.input.lock().unwrap_or_else(PoisonError::into_inner);
        input.seek(SeekFrom::Start(at))?;
        let mut bytes = Vec::new();
        let read = (&mut *input).take(length).read_to_end(&mut bytes)?;
        if read as u64 == length { Ok(bytes) } else { Err(ErrorKind::UnexpectedEof.into()) }
    }
}
