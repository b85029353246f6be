//! Packed lists of 8-bit integers (steps): the first step, then the differences between neighbours
//! in a Rice code.
//!
//! A step takes two to five bits if it differs little from the previous step. Each list has exactly
//! one valid code, so that reading and writing a block again gives the same bytes. To make the code
//! unique, a writer uses the Rice parameter that takes the fewest bits, and a reader refuses a list
//! with any other parameter.

/// Bits of the Rice parameter `k`.
const PARAMETER_BITS: u32 = 3;
/// Bits of the first step.
const FIRST_BITS: u32 = 8;
/// Largest folded difference between two steps.
const MOST: u32 = 2 * u8::MAX as u32;

/// Returns the largest number of steps that this number of bytes can contain. A difference takes at
/// least one bit.
pub(crate) fn most_steps(bytes: usize) -> usize {
    bytes.saturating_mul(8)
}

/// Returns the size of the packed list in bytes.
pub(crate) fn packed_bytes(steps: &[u8]) -> usize {
    bits(steps, parameter(steps)).div_ceil(8)
}

/// Packs a list; an empty list takes no bytes.
pub(crate) fn pack(steps: &[u8]) -> Vec<u8> {
    let Some(&first) = steps.first() else {
        return Vec::new();
    };
    let k = parameter(steps);
    let mut out = Writer::default();
    out.put(k, PARAMETER_BITS);
    out.put(first.into(), FIRST_BITS);
    for z in differences(steps) {
        (0..z >> k).for_each(|_| out.put(1, 1));
        out.put(0, 1);
        out.put(z & ((1 << k) - 1), k);
    }
    out.bytes
}

/// Unpacks `count` steps from the start of `bytes` and returns them with the number of bytes read.
/// Returns `None` if the bytes end too early or differ from what [`pack`] writes.
pub(crate) fn unpack(bytes: &[u8], count: usize) -> Option<(Vec<u8>, usize)> {
    if count == 0 {
        return Some((Vec::new(), 0));
    }
    let mut reader = Reader { bytes, at: 0 };
    let k = reader.read(PARAMETER_BITS)?;
    let mut last = u8::try_from(reader.read(FIRST_BITS)?).ok()?;
    let mut steps = vec![last];
    for _ in 1..count {
        let mut quotient = 0;
        while reader.read(1)? == 1 {
            quotient += 1;
            // No valid difference is larger. The check also keeps the shift below from overflowing.
            if quotient > MOST {
                return None;
            }
        }
        let z = (quotient << k) | reader.read(k)?;
        last = u8::try_from(i32::from(last) + unfold(z)).ok()?;
        steps.push(last);
    }
    // Only the code that `pack` writes is valid: it uses the best parameter, and the unused bits of
    // the last byte are zero.
    let used = reader.at.div_ceil(8);
    (parameter(&steps) == k && reader.rest_is_zero()).then_some((steps, used))
}

/// Returns the Rice parameter that takes the fewest bits. If several parameters take equally few
/// bits, returns the smallest of them.
fn parameter(steps: &[u8]) -> u32 {
    let all = 0..1 << PARAMETER_BITS;
    // If keys are equal, `min_by_key` returns the first element. So the smallest parameter wins, as
    // the specification demands.
    all.min_by_key(|&k| bits(steps, k)).unwrap_or(0)
}

fn bits(steps: &[u8], k: u32) -> usize {
    let code = |z: u32| (z >> k) as usize + 1 + k as usize;
    match steps {
        [] => 0,
        _ => (PARAMETER_BITS + FIRST_BITS) as usize + differences(steps).map(code).sum::<usize>(),
    }
}

/// Returns the differences between neighbours, folded so that 0, -1, 1, -2, ... become 0, 1, 2, 3,
/// ...
fn differences(steps: &[u8]) -> impl Iterator<Item = u32> {
    steps.windows(2).map(|pair| {
        let difference = i32::from(pair[1]) - i32::from(pair[0]);
        ((difference << 1) ^ (difference >> 31)) as u32
    })
}

fn unfold(z: u32) -> i32 {
    (z >> 1) as i32 ^ -((z & 1) as i32)
}

/// Writes bits, the most significant bit of each byte first.
#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    /// Used bits of the last byte.
    taken: u32,
}

impl Writer {
    fn put(&mut self, value: u32, bits: u32) {
        for bit in (0..bits).rev() {
            if self.taken.is_multiple_of(8) {
                self.bytes.push(0);
                self.taken = 0;
            }
            if let Some(last) = self.bytes.last_mut() {
                *last |= ((value >> bit & 1) as u8) << (7 - self.taken);
            }
            self.taken += 1;
        }
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    /// Number of bits already read.
    at: usize,
}

impl Reader<'_> {
    fn read(&mut self, bits: u32) -> Option<u32> {
        let mut value = 0;
        for _ in 0..bits {
            let byte = self.bytes.get(self.at / 8)?;
            value = value << 1 | u32::from(byte >> (7 - self.at % 8) & 1);
            self.at += 1;
        }
        Some(value)
    }

    /// Returns whether the remaining bits of the last byte are zero.
    fn rest_is_zero(&mut self) -> bool {
        let left = self.at.next_multiple_of(8) - self.at;
        self.read(left as u32) == Some(0)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_bits_are_those_of_the_specification() {
        // First come k = 1 and the step 40. The differences -1, 0, 1 and 3 follow as 1, 0, 2 and 6.
        // The bits are 001 00101000 01 00 100 11100, and one zero.
        let steps = [40, 39, 39, 40, 43];
        assert_eq!(pack(&steps), [0b0010_0101, 0b0000_1001, 0b0011_1000]);
        assert_eq!(unpack(&pack(&steps), 5).unwrap(), (steps.to_vec(), 3));
        // An empty list, and a list of one step.
        assert_eq!(pack(&[]), [0u8; 0]);
        assert_eq!(pack(&[255]), [0b0001_1111, 0b1110_0000]);
    }

    #[test]
    fn other_forms_and_steps_out_of_range_are_refused() {
        // A bit after the last step is set.
        assert_eq!(unpack(&[0b0001_1111, 0b1110_0001], 1), None);
        // The code uses k = 1, but k = 0 would take fewer bits.
        assert_eq!(unpack(&[0b0011_1111, 0b1110_0000], 1), None);
        // 255 and one more.
        assert_eq!(unpack(&[0b0001_1111, 0b1111_1000], 2), None);
        // Endless ones.
        assert_eq!(unpack(&[0xFF; 400], 2), None);
    }

    proptest! {
        #[test]
        fn a_list_comes_back_and_nothing_else_stands_for_it(
            first: u8, by in prop::collection::vec(-9i32..=9, 0..70), damage in 0usize..600, junk: u8,
        ) {
            let mut steps = vec![first];
            for by in by {
                let next = i32::from(*steps.last().unwrap()) + by * by * by;
                steps.push(next.clamp(0, 255) as u8);
            }
            let mut bytes = pack(&steps);
            prop_assert_eq!(bytes.len(), packed_bytes(&steps));
            prop_assert!(steps.len() <= most_steps(bytes.len()));
            bytes.push(junk);
            prop_assert_eq!(unpack(&bytes, steps.len()), Some((steps.clone(), bytes.len() - 1)));
            prop_assert_eq!(unpack(&bytes[..bytes.len() - 2], steps.len()), None);
            let at = damage % (8 * (bytes.len() - 1));
            bytes[at / 8] ^= 1 << (at % 8);
            if let Some((other, used)) = unpack(&bytes, steps.len()) {
                prop_assert_eq!(&pack(&other)[..], &bytes[..used]);
                prop_assert_ne!(other, steps);
            }
        }
    }
}
