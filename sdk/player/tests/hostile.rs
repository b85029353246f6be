//! No block makes a player panic or render a sample that is not finite.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/blocks.rs"]
mod blocks;

use blocks::{Plan, noise, tones, with_checksum};
use htex_player::{Block, OpenError, Player};
use proptest::prelude::*;

const MOTIONS: [(f32, f32); 11] = [
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

/// Opens bytes, and plays them if they are a block.
fn play(bytes: &[u8]) -> Result<(), OpenError> {
    let mut player = Player::new(Block::open(bytes)?, 1);
    for (speed, force) in MOTIONS {
        let is_set = player.set_motion(speed, force);
        assert_eq!(is_set, speed.is_finite() && force.is_finite());
        let (mut samples, mut integers) = ([0.0; 97], [0; 31]);
        player.render(&mut samples);
        player.render_i16(&mut integers, speed);
        assert!(samples.iter().all(|x| x.is_finite()), "{samples:?}");
    }
    Ok(())
}

#[test]
fn sound_blocks_play() {
    for plan in [noise(), tones()] {
        assert_eq!(play(&plan.bytes()), Ok(()));
        // Flash memory behind a block does not matter, nor does its alignment.
        let more = [&[0xFF][..], &plan.bytes(), &[0xFF; 7]].concat();
        assert_eq!(play(&more[1..]), Ok(()));
    }
}

#[test]
fn every_truncation_and_every_changed_byte_is_found() {
    for plan in [noise(), tones()] {
        let bytes = plan.bytes();
        for length in 0..bytes.len() {
            assert!(play(&bytes[..length]).is_err(), "{length} bytes");
        }
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[at] ^= 1 << bit;
                assert!(play(&changed).is_err(), "bit {bit} of byte {at}");
            }
        }
    }
}

#[test]
fn each_error_has_its_reason() {
    let with = |change: &dyn Fn(&mut Plan)| {
        let mut plan = noise();
        change(&mut plan);
        play(&plan.bytes())
    };
    let header = Err(OpenError::Header);
    assert_eq!(with(&|plan| plan.kind = 3), header);
    assert_eq!(with(&|plan| plan.flags = 1), header);
    assert_eq!(with(&|plan| plan.rate_hz = f32::NAN), header);
    assert_eq!(with(&|plan| plan.up = 65), header);
    assert_eq!(with(&|plan| plan.row = 0), header);
    assert_eq!(with(&|plan| plan.size = 0), header);
    assert_eq!(with(&|plan| plan.size = 324), header);
    assert_eq!(with(&|plan| plan.filters = 0), header);
    assert_eq!(with(&|plan| plan.filters = 65), header);
    assert_eq!(with(&|plan| plan.quantity = 6), header);
    assert_eq!(with(&|plan| plan.law[1] = 4.5), header);
    assert_eq!(with(&|plan| plan.ceiling = f32::INFINITY), header);
    assert_eq!(with(&|plan| plan.full_scale = 0.0), header);
    assert_eq!(with(&|plan| plan.highest = 0.6), header);
    assert_eq!(with(&|plan| plan.glide = 0), header);
    assert_eq!(with(&|plan| plan.forces.clear()), header);
    assert_eq!(
        with(&|plan| plan.speeds = vec![80.0, 80.0]),
        Err(OpenError::Axes)
    );
    assert_eq!(
        with(&|plan| plan.forces[0] = f32::NAN),
        Err(OpenError::Axes)
    );
    let axes = Err(OpenError::Axes);
    assert_eq!(with(&|plan| plan.speeds[0] = 0.4), axes);
    assert_eq!(with(&|plan| plan.speeds[1] = 1001.0), axes);
    assert_eq!(with(&|plan| plan.forces[0] = 0.0), axes);
    assert_eq!(with(&|plan| plan.forces[0] = 20.5), axes);
    let values = Err(OpenError::Values);
    assert_eq!(with(&|plan| plan.levels[0] = -1.0), values);
    assert_eq!(with(&|plan| plan.numbers[1] = f32::INFINITY), values);
    assert_eq!(with(&|plan| plan.numbers[0] = 1e-7), values);
    assert_eq!(with(&|plan| plan.rows[0] = f32::NAN), values);
    let length = Err(OpenError::Length);
    assert_eq!(with(&|plan| plan.integers.truncate(19)), length);
    assert_eq!(with(&|plan| plan.levels.push(0.0)), length);
    let mut frequency = tones();
    frequency.numbers[0] = 0.6;
    assert_eq!(play(&frequency.bytes()), values);
    frequency.filters = 1;
    assert_eq!(play(&frequency.bytes()), header);
    let mut odd = noise();
    (odd.filters, odd.numbers) = (1, vec![1e-9]);
    odd.integers = vec![1; 11];
    assert_eq!(play(&odd.bytes()), Ok(()));
    let mut bytes = odd.content();
    *bytes.last_mut().unwrap() = 1;
    assert_eq!(play(&with_checksum(bytes)), values);
    let mut next = noise().bytes();
    next[4] = 2;
    assert_eq!(play(&next), Err(OpenError::Version));
    next[0] = b'h';
    assert_eq!(play(&next), Err(OpenError::NotABlock));
}

#[test]
fn extreme_numbers_stay_finite() {
    let mut loud = noise();
    loud.levels = vec![1e9; 2];
    loud.ceiling = 1e10;
    loud.law = [4.0, 4.0, 4.0];
    loud.forces = vec![1e-6];
    loud.rows = vec![64.0; 8];
    loud.numbers = vec![1.0 / 16_777_216.0; 2];
    loud.integers = vec![i16::MIN; 22];
    assert_eq!(play(&loud.bytes()), Ok(()));
    loud.law = [-4.0; 3];
    loud.numbers = vec![1e-45, 1e-38];
    assert_eq!(play(&loud.bytes()), Ok(()));
    let mut tones = tones();
    (tones.law, tones.forces) = ([4.0; 3], vec![1e-6]);
    tones.numbers = vec![0.5, 64.0, 0.5, 64.0, 1e-45, -64.0, 0.0, 1e-4];
    assert_eq!(play(&tones.bytes()), Ok(()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Changed bytes with a matching checksum reach the checks behind it, and the player.
    #[test]
    fn mutated_blocks_play_or_are_refused(
        is_tones in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in 0usize..4,
    ) {
        let mut bytes = if is_tones { tones().bytes() } else { noise().bytes() };
        bytes.truncate(bytes.len() - 4 - 4 * (cut / 3));
        for (index, byte) in changes {
            let at = index.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = play(&with_checksum(bytes));
    }

    #[test]
    fn random_numbers_play_or_are_refused(
        is_tones in any::<bool>(),
        words in prop::collection::vec(any::<u32>(), 20),
        mild in any::<bool>(),
    ) {
        let mut plan = if is_tones { tones() } else { noise() };
        let all = plan.levels.iter_mut().chain(&mut plan.numbers);
        for (x, word) in all.zip(&words) {
            let random = f32::from_bits(*word);
            *x = if mild { (*word as f32 / u32::MAX as f32) * 5e-8 } else { random };
        }
        for (x, word) in plan.integers.iter_mut().zip(words) {
            *x = word as i16;
        }
        let result = play(&plan.bytes());
        prop_assert!(!mild || result.is_ok());
    }

    #[test]
    fn random_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(play(&bytes).is_err());
        prop_assert!(play(&with_checksum([&b"HTXB\x01\x00"[..], &bytes].concat())).is_err());
    }
}
