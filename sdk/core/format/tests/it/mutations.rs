//! Changed bytes.

/// xorshift64* (Vigna 2016), with bytes that tell more than others.
pub struct Random(u64, &'static [u8]);

impl Random {
    pub fn new(telling: &'static [u8]) -> Self {
        Self(0x6874_6578, telling)
    }

    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let high = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32;
        (high as usize) % n.max(1)
    }

    fn byte(&mut self) -> u8 {
        match self.below(2) {
            0 => self.1[self.below(self.1.len())],
            _ => self.below(256) as u8,
        }
    }

    pub fn mutate(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        let at = self.below(bytes.len());
        match self.below(6) {
            0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            1 if at < bytes.len() => bytes[at] = self.byte(),
            2 => bytes.truncate(at),
            3 => bytes.insert(at, self.byte()),
            // A huge integer in place of a small one.
            4 => {
                let end = (at + 1).min(bytes.len());
                let length = self.below(10);
                let huge = std::iter::repeat_n(0xff, length).chain([1]);
                bytes.splice(at..end, huge);
            }
            _ => {
                let from = self.below(other.len());
                let to = (from + self.below(64)).min(other.len());
                let end = (at + self.below(64)).min(bytes.len());
                bytes.splice(at..end, other[from..to].iter().copied());
            }
        }
    }
}
