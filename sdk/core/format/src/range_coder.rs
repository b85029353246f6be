//! A binary range coder, which compresses a sequence of yes-or-no decisions. The more probable a
//! decision was, the fewer bits it takes.
//!
//! All arithmetic is in integers, so every machine writes the same bytes. The encoder writes the
//! fewest bytes from which the decisions can be read, and drops zeros at the end. Therefore, each
//! sequence of decisions has exactly one code.

/// Bits of a probability: 65,536 stands for certainty.
const BITS: u32 = 16;
/// Smallest probability of either answer.
const LEAST: u32 = 64;
/// Number that is added to the count of decisions. With it, the first decision after the start
/// changes a probability by one part in `STARTED + DELAY`.
const DELAY: u32 = 3;
/// Initial count of decisions: a probability from a table counts as if it had already adapted to
/// this many decisions.
const STARTED: u32 = 16;
/// Largest count of decisions. When the count has reached this number, a probability follows about
/// the last 80 decisions.
const MOST_SEEN: u32 = 80;
/// The range is widened by a byte as soon as it is below this.
const NARROW: u32 = 1 << 24;

/// The probability that a decision is no. It adapts to the decisions that were made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chance {
    no: u32,
    seen: u32,
}

impl Chance {
    /// Starts with a probability from a table, in 256ths.
    pub(crate) const fn new(no_in_256: u8) -> Self {
        Self { no: (no_in_256 as u32) << (BITS - 8), seen: STARTED }
    }

    fn adapt(&mut self, yes: bool) {
        let by = self.seen + DELAY;
        if yes {
            self.no -= self.no / by;
        } else {
            self.no += ((1 << BITS) - self.no) / by;
        }
        self.no = self.no.clamp(LEAST, (1 << BITS) - LEAST);
        self.seen = (self.seen + 1).min(MOST_SEEN);
    }
}

/// Either direction of the coder. If code describes a sequence of decisions with this trait, the
/// same code both writes and reads the sequence.
pub(crate) trait Coder {
    /// Codes a decision. `no` is the probability, out of 65,536, that the decision is no. An
    /// encoder writes `yes` and returns it; a decoder ignores `yes` and returns what it reads.
    fn code(&mut self, no: u32, yes: bool) -> bool;

    /// Codes a decision, and adapts its probability.
    fn decide(&mut self, chance: &mut Chance, yes: bool) -> bool {
        let yes = self.code(chance.no, yes);
        chance.adapt(yes);
        yes
    }

    /// Codes a decision whose two answers are equally probable.
    fn toss(&mut self, yes: bool) -> bool {
        self.code(1 << (BITS - 1), yes)
    }
}

/// Writes decisions.
pub(crate) struct Encoder {
    /// After the bytes in `out`, a range of numbers remains possible. This is the lower end of the
    /// range.
    low: u64,
    range: u32,
    out: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self { low: 0, range: u32::MAX, out: Vec::new() }
    }
}

impl Encoder {
    /// Returns the bytes, without zeros at the end.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        let end = self.low + u64::from(self.range);
        // Tries no further byte first, then one byte, and so on up to four. Each attempt takes the
        // first number of the range whose remaining bits are zero.
        for bytes in 0..=4u32 {
            let rest = (1u64 << (32 - 8 * bytes)) - 1;
            let number = (self.low + rest) & !rest;
            if number < end {
                self.low = number;
                self.carry();
                (0..bytes).for_each(|_| self.shift());
                break;
            }
        }
        while self.out.last() == Some(&0) {
            self.out.pop();
        }
        self.out
    }

    /// Adds the carry of the lower end to the bytes that were already written.
    fn carry(&mut self) {
        if self.low >> 32 == 0 {
            return;
        }
        self.low &= u64::from(u32::MAX);
        for byte in self.out.iter_mut().rev() {
            *byte = byte.wrapping_add(1);
            if *byte != 0 {
                break;
            }
        }
    }

    fn shift(&mut self) {
        self.out.push((self.low >> 24) as u8);
        self.low = self.low << 8 & u64::from(u32::MAX);
    }
}

impl Coder for Encoder {
    fn code(&mut self, no: u32, yes: bool) -> bool {
        let below = (self.range >> BITS) * no;
        if yes {
            self.low += u64::from(below);
            self.range -= below;
            self.carry();
        } else {
            self.range = below;
        }
        while self.range < NARROW {
            self.shift();
            self.range <<= 8;
        }
        yes
    }
}

/// Reads decisions. After the end of the bytes, it reads zeros.
pub(crate) struct Decoder<'a> {
    bytes: &'a [u8],
    /// Distance of the number that was read from the lower end of the range.
    number: u32,
    range: u32,
}

impl<'a> Decoder<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { bytes, number: 0, range: u32::MAX };
        (0..4).for_each(|_| decoder.shift());
        decoder
    }

    fn shift(&mut self) {
        let byte = self.bytes.split_off_first().copied().unwrap_or(0);
        self.number = self.number << 8 | u32::from(byte);
    }
}

impl Coder for Decoder<'_> {
    fn code(&mut self, no: u32, _: bool) -> bool {
        let below = (self.range >> BITS) * no;
        let yes = self.number >= below;
        if yes {
            self.number -= below;
            self.range -= below;
        } else {
            self.range = below;
        }
        while self.range < NARROW {
            self.shift();
            self.range <<= 8;
        }
        yes
    }
}
