//! Blocks that were changed, and motions that are impossible for a finger.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::blocks::{Plan, noise, tones, with_checksum};
use super::stream::{Case, Step};

pub const MOTIONS: [(f32, f32); 11] = [
    (60.0, 0.4),
    (f32::MAX, f32::MAX),
    (0.0, -1.0),
    (-f32::MAX, f32::MIN_POSITIVE),
    (40.0, 1e-30),
    (f32::NAN, 0.4),
    (f32::INFINITY, f32::NEG_INFINITY),
    (79.999, 0.4),
    (1000.0, 20.0),
    (0.5, 1e-45),
    (999.0, 1e-6),
];

/// Changed blocks with a matching checksum, so that they reach the checks after the checksum, and
/// the player.
pub fn changed() -> impl Strategy<Value = Vec<u8>> {
    let changes = prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6);
    (any::<bool>(), any::<bool>(), changes, 0usize..4).prop_map(
        |(is_tones, moves, changes, cut)| {
            let flags = if moves { 2 } else { 0 };
            let mut bytes = Plan { flags, ..plan(is_tones) }.bytes();
            bytes.truncate(bytes.len() - 4 - 4 * (cut / 3));
            for (index, byte) in changes {
                let at = index.index(bytes.len());
                bytes[at] = byte;
            }
            with_checksum(bytes)
        },
    )
}

/// Blocks with random numbers, and whether the numbers are small.
pub fn random() -> impl Strategy<Value = (Vec<u8>, bool)> {
    let words = prop::collection::vec(any::<u32>(), 20);
    (any::<bool>(), words, any::<bool>()).prop_map(|(is_tones, words, mild)| {
        let mut plan = plan(is_tones);
        let all = plan.levels.iter_mut().chain(&mut plan.numbers);
        for (x, word) in all.zip(&words) {
            let random = f32::from_bits(*word);
            *x = if mild { (*word as f32 / u32::MAX as f32) * 5e-8 } else { random };
        }
        for (x, word) in plan.integers.iter_mut().zip(words) {
            *x = word as i16;
        }
        (plan.bytes(), mild)
    })
}

fn plan(is_tones: bool) -> Plan {
    if is_tones { tones() } else { noise() }
}

/// Blocks with the largest permitted numbers.
pub fn extreme() -> Vec<Vec<u8>> {
    let mut loud = noise();
    loud.levels = vec![1e9; 2];
    loud.ceiling = 1e10;
    loud.law = [4.0, 4.0, 4.0];
    loud.forces = vec![1e-6];
    loud.rows = vec![64.0; 8];
    loud.numbers = vec![1.0 / 16_777_216.0; 2];
    loud.integers = vec![i16::MIN; 22];
    let mut faint = loud.clone();
    faint.law = [-4.0; 3];
    faint.numbers = vec![1e-45, 1e-38];
    let mut high = tones();
    (high.law, high.forces) = ([4.0; 3], vec![1e-6]);
    high.numbers = vec![0.5, 64.0, 0.5, 64.0, 1e-45, -64.0, 0.0, 1e-4];
    (loud.flags, loud.fluctuation) = (2, (1, [255, 255], 16.0));
    (high.flags, high.fluctuation) = (3, (u16::MAX, [255, 0], -16.0));
    [loud, faint, high].map(|plan| plan.bytes()).to_vec()
}

/// Bytes that are not a block: every truncation, every changed bit, and random bytes.
pub fn damaged() -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    for bytes in [noise(), tones()].map(|plan| plan.bytes()) {
        all.extend((0..bytes.len()).map(|length| bytes[..length].to_vec()));
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            all.push(changed);
        }
    }
    all
}

/// Returns `count` blocks for each kind of change, with the motions above. The blocks are the same
/// every time.
pub fn cases(count: usize) -> Vec<Case> {
    let mut runner = TestRunner::deterministic();
    let mut blocks = extreme();
    let random_bytes = prop::collection::vec(any::<u8>(), 0..200);
    for _ in 0..count {
        blocks.push(changed().new_tree(&mut runner).unwrap().current());
        blocks.push(random().new_tree(&mut runner).unwrap().current().0);
        let bytes = random_bytes.new_tree(&mut runner).unwrap().current();
        blocks.push(with_checksum([&b"HTXB\x01\x00"[..], &bytes].concat()));
        blocks.push(bytes);
    }
    blocks.into_iter().map(case).collect()
}

/// The steps for a block: each motion, then samples, then integers with a full scale that may be
/// invalid.
pub fn case(block: Vec<u8>) -> Case {
    let steps = MOTIONS.into_iter().flat_map(|(speed, force)| {
        let motion = Step::SetMotion(speed, force);
        [motion, Step::Render(97), Step::RenderI16(31, speed)]
    });
    Case { block, seed: 1, steps: steps.collect() }
}
