//! No block makes a player panic or render a sample that is not finite.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/blocks.rs"]
mod blocks;

use blocks::{Plan, noise, tones, with_checksum};
use htex_player::{Block, OpenError, Player};
use proptest::prelude::*;

const MOTIONS: [(f32, f32); 8] = [
    (60.0, 0.4),
    (f32::MAX, f32::MAX),
    (0.0, -1.0),
    (-f32::MAX, f32::MIN_POSITIVE),
    (40.0, 1e-30),
    (f32::NAN, 0.4),
    (f32::INFINITY, f32::NEG_INFINITY),
    (79.999, 0.4),
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
    assert_eq!(
        with(&|plan| plan.conditions[0] = -1.0),
        Err(OpenError::Values)
    );
    assert_eq!(
        with(&|plan| plan.conditions[3] = f32::INFINITY),
        Err(OpenError::Values)
    );
    assert_eq!(
        with(&|plan| plan.rows[0] = f32::NAN),
        Err(OpenError::Values)
    );
    assert_eq!(
        with(&|plan| plan.conditions.truncate(19)),
        Err(OpenError::Length)
    );
    assert_eq!(
        with(&|plan| plan.conditions.push(0.0)),
        Err(OpenError::Length)
    );
    let mut frequency = tones();
    frequency.conditions[1] = 0.6;
    assert_eq!(play(&frequency.bytes()), Err(OpenError::Values));
    let mut next = noise().bytes();
    next[4] = 2;
    assert_eq!(play(&next), Err(OpenError::Version));
    next[0] = b'h';
    assert_eq!(play(&next), Err(OpenError::NotABlock));
}

#[test]
fn extreme_numbers_stay_finite() {
    let mut loud = noise();
    loud.conditions = [&[1e9][..], &[64.0; 9], &[1e9], &[-64.0; 9]].concat();
    loud.rows = vec![64.0; 8];
    assert_eq!(play(&loud.bytes()), Ok(()));
    loud.conditions = [&[1e9][..], &[1e-38; 9], &[1e9], &[0.0; 9]].concat();
    assert_eq!(play(&loud.bytes()), Ok(()));
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
        for (x, word) in plan.conditions.iter_mut().zip(words) {
            let random = f32::from_bits(word);
            *x = if mild { (word as f32 / u32::MAX as f32) * 0.5 } else { random };
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
