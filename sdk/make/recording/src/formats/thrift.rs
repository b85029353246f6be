//! Lengths of structures in Thrift's compact protocol
//! (<https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>), in which
//! Parquet writes its headers. This module checks the lengths before the crate `parquet` reads the
//! headers, because that crate trusts the number of elements that a list states.

/// Deepest allowed nesting of structures and lists.
const DEEPEST: usize = 32;

/// The type codes of true and false.
const TRUTH_VALUES: [u8; 2] = [1, 2];

/// Returns the length of the structure at the beginning of `bytes`.
///
/// # Errors
/// When the structure is not complete. An element of a list takes at least one byte.
pub(crate) fn struct_len(bytes: &[u8]) -> Result<usize, &'static str> {
    let mut walk = Walk { bytes, at: 0 };
    walk.fields(0)?;
    Ok(walk.at)
}

struct Walk<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Walk<'_> {
    fn fields(&mut self, depth: usize) -> Result<(), &'static str> {
        if depth > DEEPEST {
            return Err("its header is nested too deeply");
        }
        loop {
            let header = self.byte()?;
            let (delta, kind) = (header >> 4, header & 0x0f);
            if kind == 0 {
                return Ok(());
            }
            if delta == 0 {
                self.varint()?;
            }
            // A field of type true or false has no bytes after its header.
            if kind > 2 {
                self.value(kind, depth)?;
            }
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Result<(), &'static str> {
        match kind {
            1..=3 => self.skip(1),
            4..=6 => self.varint().map(drop),
            7 => self.skip(8),
            8 => {
                let length = self.varint()?;
                self.skip(length)
            }
            9 | 10 => {
                let header = self.byte()?;
                let count = match header >> 4 {
                    15 => self.varint()?,
                    count => u64::from(count),
                };
                self.elements(count, &[header & 0x0f], depth)
            }
            11 => match self.varint()? {
                0 => Ok(()),
                count => {
                    let kinds = self.byte()?;
                    self.elements(count, &[kinds >> 4, kinds & 0x0f], depth)
                }
            },
            12 => self.fields(depth + 1),
            13 => self.skip(16),
            _ => Err("its header has a value of an unknown type"),
        }
    }

    fn elements(&mut self, count: u64, kinds: &[u8], depth: usize) -> Result<(), &'static str> {
        if depth > DEEPEST {
            return Err("its header is nested too deeply");
        }
        // The library takes such elements for values without bytes, so it would read lists
        // differently from this code.
        if kinds.iter().any(|kind| TRUTH_VALUES.contains(kind)) {
            return Err("its header has a list of truth values, which none of Parquet's has");
        }
        // Without this check, a few bytes could keep the library busy for hours.
        if count > (self.bytes.len() - self.at) as u64 {
            return Err("its header claims a list longer than the file");
        }
        for _ in 0..count {
            for kind in kinds {
                self.value(*kind, depth + 1)?;
            }
        }
        Ok(())
    }

    fn varint(&mut self) -> Result<u64, &'static str> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err("its header has a number of more than 64 bits")
    }

    fn byte(&mut self) -> Result<u8, &'static str> {
        let byte = self.bytes.get(self.at).copied();
        self.at += 1;
        byte.ok_or("its header is cut off")
    }

    fn skip(&mut self, length: u64) -> Result<(), &'static str> {
        let left = (self.bytes.len() - self.at) as u64;
        if length > left {
            return Err("its header is cut off");
        }
        self.at += length as usize;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_those_of_whole_structures() {
        // Field 1, i32: 3; field 2, list of two bytes; the end.
        assert_eq!(struct_len(&[0x15, 0x06, 0x19, 0x23, 1, 2, 0, 9]), Ok(7));
        // The same list, of truth values.
        assert!(struct_len(&[0x15, 0x06, 0x19, 0x21, 1, 2, 0, 9]).is_err());
        // Seven bytes that claim a list of two thousand million elements.
        let long = [0x19, 0xf3, 0xff, 0xff, 0xff, 0xff, 0x07, 0];
        assert!(struct_len(&long).is_err());
        assert!(struct_len(&[0x15]).is_err() && struct_len(&[]).is_err());
        assert!(struct_len(&[0x1c; 100]).is_err());
    }
}
