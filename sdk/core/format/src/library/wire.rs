//! Encoding of numbers and texts in pages: little-endian numbers, LEB128 integers, and
//! prefix-compressed texts. The encoding of a text leaves out the prefix that the text has in
//! common with the previous text.

/// Longest text in a page, bytes: a name, a tag or the id of a model.
pub(crate) const TEXT_BYTES: usize = 255;
/// Largest size of a 64-bit integer in LEB128, bytes. Each byte holds seven bits.
const VARINT_BYTES: usize = 10;

/// The reason why a page's contents cannot be read: an offset in the unpacked page, and the problem
/// at that offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{problem} at byte {at} of the unpacked page")]
pub(crate) struct WireError {
    pub at: usize,
    pub problem: &'static str,
}

/// Reads values from an unpacked page.
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(crate) fn malformed(&self, problem: &'static str) -> WireError {
        WireError { at: self.at, problem }
    }

    pub(crate) fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    pub(crate) fn read_bytes(&mut self, count: usize) -> Result<&'a [u8], WireError> {
        let end = self.at.checked_add(count);
        let taken = end
            .and_then(|end| self.bytes.get(self.at..end))
            .ok_or(self.malformed("the page ends within a value"))?;
        self.at += count;
        Ok(taken)
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], WireError> {
        let mut array = [0; N];
        array.copy_from_slice(self.read_bytes(N)?);
        Ok(array)
    }

    pub(crate) fn byte(&mut self) -> Result<u8, WireError> {
        self.array().map(|[byte]| byte)
    }

    /// Reads a LEB128 integer. A code that is longer than necessary is an error.
    pub(crate) fn varint(&mut self) -> Result<u64, WireError> {
        let mut value = 0u64;
        for i in 0..VARINT_BYTES {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            // Nine bytes contain 63 bits, so the tenth byte may contain only one bit.
            if i == VARINT_BYTES - 1 && byte > 1 {
                return Err(self.malformed("an integer exceeds 64 bits"));
            }
            value |= bits << (7 * i);
            if byte & 0x80 == 0 {
                // A zero byte at the end adds nothing to the value, so the same integer has a
                // shorter code.
                let is_shortest = byte != 0 || i == 0;
                return if is_shortest {
                    Ok(value)
                } else {
                    Err(self.malformed("an integer has superfluous bytes"))
                };
            }
        }
        Err(self.malformed("an integer exceeds 64 bits"))
    }

    /// Reads the number of values that follow. Each takes at least `least` bytes, so the number is
    /// limited by the rest of the page.
    pub(crate) fn count(&mut self, least: usize) -> Result<usize, WireError> {
        let count = self.varint()?;
        let most = self.rest() / least.max(1);
        match usize::try_from(count) {
            Ok(count) if count <= most => Ok(count),
            _ => Err(self.malformed("the page is too short for a count")),
        }
    }

    /// Reads the length of a text.
    fn length(&mut self) -> Result<usize, WireError> {
        match usize::try_from(self.varint()?) {
            Ok(length) if length <= TEXT_BYTES => Ok(length),
            _ => Err(self.malformed("a text is longer than 255 bytes")),
        }
    }

    pub(crate) fn text(&mut self) -> Result<&'a str, WireError> {
        let length = self.length()?;
        let bytes = self.read_bytes(length)?;
        std::str::from_utf8(bytes).map_err(|_| self.malformed("a text is not UTF-8"))
    }

    /// Reads the next text into `text`, which must contain the previous text.
    pub(crate) fn following(&mut self, text: &mut Vec<u8>) -> Result<(), WireError> {
        let shared = self.length()?;
        if shared > text.len() {
            return Err(self.malformed("a text shares more than the text before it has"));
        }
        let rest = self.length()?;
        if shared + rest > TEXT_BYTES {
            return Err(self.malformed("a text is longer than 255 bytes"));
        }
        text.truncate(shared);
        text.extend_from_slice(self.read_bytes(rest)?);
        Ok(())
    }
}

/// Appends an integer in LEB128.
#[cfg(feature = "write")]
pub(crate) fn put_varint(page: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        page.push(value as u8 | 0x80);
        value >>= 7;
    }
    page.push(value as u8);
}

/// Appends a text of at most 255 bytes.
#[cfg(feature = "write")]
pub(crate) fn put_text(page: &mut Vec<u8>, text: &str) {
    put_varint(page, text.len() as u64);
    page.extend_from_slice(text.as_bytes());
}

/// Appends a text of at most 255 bytes, without the prefix that it shares with the text before.
#[cfg(feature = "write")]
pub(crate) fn put_following(page: &mut Vec<u8>, before: &[u8], text: &[u8]) {
    let shared = common_prefix(before, text);
    put_varint(page, shared as u64);
    put_varint(page, (text.len() - shared) as u64);
    page.extend_from_slice(&text[shared..]);
}

/// Returns the length of the prefix that two texts share, bytes.
#[cfg(feature = "write")]
pub(crate) fn common_prefix(a: &[u8], b: &[u8]) -> usize {
    a.iter().zip(b).take_while(|(a, b)| a == b).count()
}

/// Returns the size of an integer in LEB128, bytes.
#[cfg(feature = "write")]
pub(crate) fn varint_bytes(value: u64) -> usize {
    let bits = u64::BITS - (value | 1).leading_zeros();
    bits.div_ceil(7) as usize
}

#[cfg(all(test, feature = "write"))]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn integers_and_texts_are_read_as_written(
            value: u64, shift in 0u32..64, before: Vec<u8>, text in proptest::collection::vec(0u8..4, 0..255),
        ) {
            let value = value >> shift;
            let mut page = Vec::new();
            put_varint(&mut page, value);
            prop_assert_eq!(page.len(), varint_bytes(value));
            put_following(&mut page, &before, &text);
            let mut cursor = Cursor::new(&page);
            prop_assert_eq!(cursor.varint(), Ok(value));
            let mut read = before;
            prop_assert_eq!(cursor.following(&mut read), Ok(()));
            prop_assert_eq!(read, text);
            prop_assert_eq!(cursor.rest(), 0);
        }
    }

    /// Examples of LEB128 from DWARF 5, appendix C, and encodings that must be refused.
    #[test]
    fn integers_have_one_form() {
        let read = |bytes: &[u8]| Cursor::new(bytes).varint().map_err(|m| m.problem);
        assert_eq!(read(&[2]), Ok(2));
        assert_eq!(read(&[0x80, 1]), Ok(128));
        assert_eq!(read(&[0xb9, 0x64]), Ok(12857));
        assert_eq!(read(&[0x80, 0]), Err("an integer has superfluous bytes"));
        assert_eq!(read(&[0x80]), Err("the page ends within a value"));
        let most = [[0xff; 9].as_slice(), &[1]].concat();
        assert_eq!(read(&most), Ok(u64::MAX));
        let over = [[0xff; 9].as_slice(), &[2]].concat();
        assert_eq!(read(&over), Err("an integer exceeds 64 bits"));
    }
}
