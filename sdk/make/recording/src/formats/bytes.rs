//! Reads numbers of either byte order from files. The functions do not trust the sizes that a file
//! states.

use std::io::{self, ErrorKind, Read};

/// Largest number of bytes that are read at once.
const AT_ONCE: usize = 64 << 10;

/// A byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberType {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// Returns the size of a value in bytes.
    pub(crate) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Returns the value stored in the first bytes of `bytes`; missing bytes count as 0.
    pub(crate) fn value(self, bytes: &[u8], endian: Endian) -> f64 {
        let mut little = [0; 8];
        for (to, from) in little.iter_mut().zip(bytes) {
            *to = *from;
        }
        let size = self.size();
        if endian == Endian::Big {
            little[..size].reverse();
        }
        let [a, b, c, d, ..] = little;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::I64 => i64::from_le_bytes(little) as f64,
            Self::U64 => u64::from_le_bytes(little) as f64,
            Self::F64 => f64::from_le_bytes(little),
        }
    }
}

/// A reader that keeps track of its position.
pub(crate) struct ByteReader<R> {
    pub(crate) source: R,
    pub(crate) endian: Endian,
    /// Number of bytes read so far.
    pub(crate) at: u64,
}

impl<R: Read> ByteReader<R> {
    pub(crate) fn new(source: R, endian: Endian) -> Self {
        Self { source, endian, at: 0 }
    }

    pub(crate) fn array<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes)?;
        self.at += N as u64;
        Ok(bytes)
    }

    pub(crate) fn u32(&mut self) -> io::Result<u32> {
        let bytes = self.array()?;
        Ok(match self.endian {
            Endian::Little => u32::from_le_bytes(bytes),
            Endian::Big => u32::from_be_bytes(bytes),
        })
    }

    pub(crate) fn u64(&mut self) -> io::Result<u64> {
        let bytes = self.array()?;
        Ok(match self.endian {
            Endian::Little => u64::from_le_bytes(bytes),
            Endian::Big => u64::from_be_bytes(bytes),
        })
    }

    /// Reads `length` bytes. Memory is allocated only as the bytes arrive.
    pub(crate) fn vec(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let read = self.source.by_ref().take(length).read_to_end(&mut bytes)?;
        self.at += read as u64;
        if read as u64 == length { Ok(bytes) } else { Err(ErrorKind::UnexpectedEof.into()) }
    }

    /// Skips bytes.
    pub(crate) fn skip(&mut self, length: u64) -> io::Result<()> {
        let skipped = io::copy(&mut self.source.by_ref().take(length), &mut io::sink())?;
        self.at += skipped;
        if skipped == length { Ok(()) } else { Err(ErrorKind::UnexpectedEof.into()) }
    }

    /// Reads `count` values and passes on each with its index.
    pub(crate) fn values(
        &mut self,
        kind: NumberType,
        count: u64,
        mut keep: impl FnMut(u64, f64),
    ) -> io::Result<()> {
        let size = kind.size();
        let most = count.saturating_mul(size as u64).min(AT_ONCE as u64);
        let mut buffer = vec![0; most as usize];
        let mut done = 0;
        while done < count {
            let here = (count - done).min((AT_ONCE / size) as u64) as usize;
            let bytes = &mut buffer[..here * size];
            self.source.read_exact(bytes)?;
            self.at += bytes.len() as u64;
            for (index, value) in (done..).zip(bytes.chunks_exact(size)) {
                keep(index, kind.value(value, self.endian));
            }
            done += here as u64;
        }
        Ok(())
    }
}
