//! Coded fields. The encoder predicts each number (an 8-bit step) from the previous condition and
//! from the previous numbers. The encoder stores the errors of the predictions in a range code with
//! adaptive probabilities.
//!
//! In a grid of 405 conditions of the model Bands, a condition takes 9.7 bytes if it is coded, and
//! 20.1 bytes if it is packed. The measurements are in `docs/accuracy-and-time.md`.
//!
//! [`FieldCoder`] defines which binary decisions are coded and in which order, so the same code
//! writes and reads a field.

use crate::range_coder::{Chance, Coder, Decoder, Encoder};

/// Largest number of steps in a coded list.
pub(crate) const MOST_STEPS: usize = 0xFFFF;
/// Expected length of the first list. The list's actual length is compared with it.
const USUAL_LENGTH: i32 = 30;
/// Largest step.
const LAST: i32 = u8::MAX as i32;
/// Units of a predicted step: sixteenths.
const UNIT: i32 = 16;
/// Unrest before the first step of a list, in eighths of a step.
const FIRST_UNREST: i32 = 12;
/// Largest error, in steps, that counts for the unrest.
const MOST_UNREST: i32 = 40;
/// Unrests at which the next row of probabilities begins.
const UNRESTS: [i32; ROWS - 1] = [4, 8, 14, 22, 34];
const ROWS: usize = 6;
/// A size of at least this number is coded as its excess over this number.
const EXCESS: i32 = 15;
/// Largest number of bits after the leading one bit of an excess. No valid code contains a larger
/// excess.
const MOST_EXCESS_BITS: u32 = 17;

/// Probabilities in 256ths. The first is the probability that an error is 0. The next five are the
/// probabilities that its size is 1, 2, 3, 4 or 5, provided that it is not smaller. The last one
/// applies to every larger size.
type Row = [u8; 7];

/// The tables were trained on the fits of Bands to 100 strokes of ten materials, 12 other
/// recordings, ten imported textures and two simulated surfaces, and tested on as many others.
const DIFFERENT: Row = [250, 128, 128, 128, 128, 128, 128];
const FIRST: Row = [124, 21, 30, 46, 59, 189, 253];
const ALONE: [Row; ROWS] = [
    [99, 161, 180, 117, 110, 112, 101],
    [71, 136, 147, 130, 134, 144, 114],
    [56, 127, 142, 135, 129, 103, 106],
    [43, 100, 118, 116, 116, 88, 68],
    [28, 63, 94, 98, 82, 79, 57],
    [26, 45, 58, 62, 63, 52, 40],
];
const AFTER_A_LIST: [Row; ROWS] = [
    [137, 208, 201, 170, 168, 165, 213],
    [113, 198, 206, 183, 133, 123, 139],
    [90, 183, 190, 157, 159, 141, 117],
    [66, 155, 165, 159, 155, 129, 126],
    [44, 96, 125, 137, 137, 138, 133],
    [26, 50, 67, 83, 92, 104, 85],
];
/// Probabilities, in 256ths, that an error that is not 0 is positive.
const POSITIVE_DIFFERENT: u8 = 128;
const POSITIVE_ALONE: u8 = 160;
const POSITIVE_AFTER_A_LIST: u8 = 133;

/// The probabilities of the errors' sizes.
#[derive(Clone, Copy)]
struct Sizes([Chance; 7]);

impl Sizes {
    fn new(row: Row) -> Self {
        Self(row.map(Chance::new))
    }

    /// Returns the probability that a size that is at least `size` is not larger.
    fn at(&mut self, size: i32) -> &mut Chance {
        let last = self.0.len() - 1;
        &mut self.0[(size as usize).min(last)]
    }
}

/// The probabilities of one kind of prediction.
struct Kind<const N: usize> {
    rows: [Sizes; N],
    positive: Chance,
}

impl<const N: usize> Kind<N> {
    fn new(rows: [Row; N], positive: u8) -> Self {
        Self { rows: rows.map(Sizes::new), positive: Chance::new(positive) }
    }

    /// Codes an error. A decoder is given `None`. Returns `None` if no valid code contains this
    /// error.
    fn error(&mut self, coder: &mut impl Coder, unrest: i32, given: Option<i32>) -> Option<i32> {
        let row = UNRESTS.iter().filter(|from| unrest >= **from).count();
        let sizes = &mut self.rows[row.min(N - 1)];
        let wanted = given.unwrap_or(0);
        let size_wanted = wanted.abs();
        if !coder.decide(sizes.at(0), size_wanted > 0) {
            return Some(0);
        }
        let negative = coder.decide(&mut self.positive, wanted < 0);
        let mut size = 1;
        while size < EXCESS && coder.decide(sizes.at(size), size_wanted > size) {
            size += 1;
        }
        if size == EXCESS {
            size += excess(coder, size_wanted - EXCESS)?;
        }
        Some(if negative { -size } else { size })
    }
}

/// Codes a number of at least 0 whose distribution is unknown. It adds 1 to the number, codes how
/// many bits follow the leading one bit of the sum, and then codes these bits. Returns `None` if
/// there are more than [`MOST_EXCESS_BITS`] bits.
fn excess(coder: &mut impl Coder, wanted: i32) -> Option<i32> {
    let wanted = wanted.max(0).unsigned_abs() + 1;
    let mut bits = 0;
    while coder.toss(wanted.ilog2() > bits) {
        bits += 1;
        if bits > MOST_EXCESS_BITS {
            return None;
        }
    }
    Some(bits_below_one(coder, bits, wanted) as i32 - 1)
}

/// Codes the bits after the leading one bit of a number, the most significant bit first. Returns
/// the number.
fn bits_below_one(coder: &mut impl Coder, bits: u32, wanted: u32) -> u32 {
    (0..bits)
        .rev()
        .fold(1, |number, bit| number << 1 | u32::from(coder.toss(wanted >> bit & 1 == 1)))
}

/// Why steps cannot be read.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum CodeError {
    /// No encoder writes these bytes.
    Invalid,
    /// The number of steps exceeds the number that may be read.
    TooMany,
}

/// Codes the values of one field, condition by condition.
pub(crate) struct FieldCoder {
    list: bool,
    different: Kind<1>,
    first: Sizes,
    alone: Kind<ROWS>,
    after_a_list: Kind<ROWS>,
    /// The step of a scalar, or the length of a list, at the previous condition.
    before: i32,
    /// The expected list, in sixteenths of a step. The actual list may differ from it by a
    /// constant.
    expected: Vec<i32>,
    /// Sizes of the errors of the previous list.
    errors: Vec<i32>,
}

impl FieldCoder {
    pub(crate) fn new(list: bool) -> Self {
        Self {
            list,
            different: Kind::new([DIFFERENT], POSITIVE_DIFFERENT),
            first: Sizes::new(FIRST),
            alone: Kind::new(ALONE, POSITIVE_ALONE),
            after_a_list: Kind::new(AFTER_A_LIST, POSITIVE_AFTER_A_LIST),
            before: if list { USUAL_LENGTH } else { 0 },
            expected: Vec::new(),
            errors: Vec::new(),
        }
    }

    /// Codes the steps at one condition: one step of a scalar, or all steps of a list. A decoder is
    /// given `None`. `left` is the number of values that may still be read; the function subtracts
    /// the number of steps.
    pub(crate) fn code(
        &mut self,
        coder: &mut impl Coder,
        given: Option<&[u8]>,
        left: &mut usize,
    ) -> Result<Vec<u8>, CodeError> {
        let (number, most) = match (self.list, given) {
            (true, given) => (given.map(|steps| steps.len() as i32), MOST_STEPS as i32),
            (false, given) => (given.and_then(|steps| steps.first()).map(|q| i32::from(*q)), LAST),
        };
        let difference = number.map(|number| number - self.before);
        let difference = self.different.error(coder, 0, difference).ok_or(CodeError::Invalid)?;
        self.before += difference;
        if !(0..=most).contains(&self.before) {
            return Err(CodeError::Invalid);
        }
        let count = if self.list { self.before as usize } else { 1 };
        *left = left.checked_sub(count).ok_or(CodeError::TooMany)?;
        if self.list { self.steps(coder, count, given) } else { Ok(vec![self.before as u8]) }
    }

    fn steps(
        &mut self,
        coder: &mut impl Coder,
        count: usize,
        given: Option<&[u8]>,
    ) -> Result<Vec<u8>, CodeError> {
        let is_expected = count == self.expected.len();
        let mut steps: Vec<u8> = Vec::with_capacity(count);
        let mut errors = Vec::with_capacity(count);
        // How far the list is above the expected list, in sixteenths of a step.
        let mut above = 0;
        let mut unrest = FIRST_UNREST;
        for i in 0..count {
            let wanted = given.and_then(|given| given.get(i)).map(|q| i32::from(*q));
            let (step, error) = match steps.last() {
                _ if is_expected => {
                    let sum = self.expected[i] + above + UNIT / 2;
                    let predicted = sum.div_euclid(UNIT).clamp(0, LAST);
                    let unrest = unrest + 4 * self.errors[i];
                    let error = wanted.map(|wanted| wanted - predicted);
                    let error = self.after_a_list.error(coder, unrest, error);
                    let error = error.ok_or(CodeError::Invalid)?;
                    (predicted + error, error.abs())
                }
                Some(&last) => {
                    let error = wanted.map(|wanted| wanted - i32::from(last));
                    let error = self.alone.error(coder, unrest, error);
                    let error = error.ok_or(CodeError::Invalid)?;
                    (i32::from(last) + error, error.abs())
                }
                None => (self.first_step(coder, wanted.unwrap_or(0)), 0),
            };
            steps.push(u8::try_from(step).map_err(|_| CodeError::Invalid)?);
            errors.push(error);
            if is_expected || i > 0 {
                unrest = (unrest + 8 * error.min(MOST_UNREST)) / 2;
            }
            if is_expected {
                above += (UNIT * step - self.expected[i] - above).div_euclid(4);
            }
        }
        if is_expected {
            for (expected, step) in self.expected.iter_mut().zip(&steps) {
                let moved = *expected + above;
                *expected = moved + (UNIT * i32::from(*step) - moved).div_euclid(2);
            }
        } else {
            self.expected = steps.iter().map(|step| UNIT * i32::from(*step)).collect();
        }
        self.errors = errors;
        Ok(steps)
    }

    /// Codes the first step of a list if there is no previous list: the number of bits of the step,
    /// and then the bits after its leading one bit.
    fn first_step(&mut self, coder: &mut impl Coder, wanted: i32) -> i32 {
        let wanted = wanted.unsigned_abs();
        let bits_wanted = u32::BITS - wanted.leading_zeros();
        let mut bits = 0;
        while bits < u8::BITS && coder.decide(self.first.at(bits as i32), bits_wanted > bits) {
            bits += 1;
        }
        if bits == 0 { 0 } else { bits_below_one(coder, bits - 1, wanted) as i32 }
    }
}

/// Codes the steps of all coded fields. `lists` says for each field whether it is a list.
/// `conditions` contains the steps of each field, for each condition.
pub(crate) fn encode(lists: &[bool], conditions: &[Vec<Vec<u8>>]) -> Vec<u8> {
    let mut encoder = Encoder::default();
    let mut coders: Vec<FieldCoder> = lists.iter().map(|list| FieldCoder::new(*list)).collect();
    for fields in conditions {
        for (coder, steps) in coders.iter_mut().zip(fields) {
            let mut left = usize::MAX;
            // With an encoder, `code` returns the steps that it was given.
            let _ = coder.code(&mut encoder, Some(steps), &mut left);
        }
    }
    encoder.finish()
}

/// Reads the steps that [`encode`] wrote. `left` is the number of values that may still be read.
pub(crate) fn decode(
    lists: &[bool],
    conditions: usize,
    bytes: &[u8],
    left: &mut usize,
) -> Result<Vec<Vec<Vec<u8>>>, CodeError> {
    let mut decoder = Decoder::new(bytes);
    let mut coders: Vec<FieldCoder> = lists.iter().map(|list| FieldCoder::new(*list)).collect();
    let mut fields =
        || coders.iter_mut().map(|coder| coder.code(&mut decoder, None, left)).collect();
    let steps = (0..conditions).map(|_| fields()).collect::<Result<Vec<Vec<Vec<u8>>>, _>>()?;
    // Other bytes may give the same decisions, but only the bytes that `encode` writes are valid.
    if encode(lists, &steps) == bytes { Ok(steps) } else { Err(CodeError::Invalid) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decoded(lists: &[bool], conditions: usize, bytes: &[u8]) -> Option<Vec<Vec<Vec<u8>>>> {
        decode(lists, conditions, bytes, &mut 100_000).ok()
    }

    #[test]
    fn the_bytes_are_those_of_the_specification() {
        let conditions = [vec![vec![40, 39, 39, 40, 43]], vec![vec![41, 39, 40, 40, 43]]];
        let bytes = [0xFF, 0xFF, 0xFB, 0x76, 0x57, 0x42, 0xB5];
        assert_eq!(encode(&[true], &conditions), bytes);
        assert_eq!(decoded(&[true], 2, &bytes).unwrap(), conditions);
        assert!(
            include_str!("../../../../spec/htex-coded-1.md").contains("`FF FF FB 76 57 42 B5`")
        );
        // A code without steps has no bytes, and a difference between steps can have any size.
        assert_eq!(encode(&[], &[vec![], vec![]]), [0u8; 0]);
        let jumps =
            [vec![vec![0, 255, 0, 128, 1]], vec![vec![255, 0, 255, 127, 254]], vec![vec![]]];
        assert_eq!(decoded(&[true], 3, &encode(&[true], &jumps)).unwrap(), jumps);
    }

    #[test]
    fn a_limit_holds_for_a_few_bytes_that_stand_for_many_numbers() {
        let flat = vec![vec![vec![7; 1000]]; 100];
        let bytes = encode(&[true], &flat);
        assert!(bytes.len() < 500, "{}", bytes.len());
        assert_eq!(decode(&[true], 100, &bytes, &mut 100_000).unwrap(), flat);
        assert_eq!(decode(&[true], 100, &bytes, &mut 99_999), Err(CodeError::TooMany));
    }

    proptest! {
        #[test]
        fn steps_come_back_and_nothing_else_stands_for_them(
            lists in prop::collection::vec(any::<bool>(), 1..4),
            shapes in prop::collection::vec((0usize..50, any::<u8>(), 1u8..100), 1..12),
            noise in prop::collection::vec(any::<u8>(), 1..200),
            damage: usize, junk: u8, other in prop::collection::vec(any::<u8>(), 0..40),
        ) {
            let conditions: Vec<Vec<Vec<u8>>> = shapes.iter().map(|(count, first, spread)| {
                let steps = |i: usize| noise[i * 7 % noise.len()] % spread;
                lists.iter().map(|list| {
                    let count = if *list { *count } else { 1 };
                    (0..count).map(|i| first.saturating_add(steps(i))).collect()
                }).collect()
            }).collect();
            let mut bytes = encode(&lists, &conditions);
            prop_assert_eq!(decoded(&lists, conditions.len(), &bytes), Some(conditions.clone()));
            prop_assert_ne!(bytes.last(), Some(&0));
            prop_assert_eq!(decoded(&lists, conditions.len(), &[&bytes[..], &[0]].concat()), None);
            // If other bytes can be read, they are the code of other steps.
            for changed in [other, [&bytes[..], &[junk]].concat(), {
                let at = damage % (8 * bytes.len().max(1));
                if let Some(byte) = bytes.get_mut(at / 8) {
                    *byte ^= 1 << (at % 8);
                }
                bytes
            }] {
                if let Some(steps) = decoded(&lists, conditions.len(), &changed) {
                    prop_assert_eq!(encode(&lists, &steps), changed);
                }
            }
        }
    }
}
