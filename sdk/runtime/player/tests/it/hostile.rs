//! No block makes a player panic, or render a sample that is not finite.

use crate::common::blocks;
use crate::common::mutated;

use blocks::{Plan, noise, tones, with_checksum};
use htex_player::{Block, OpenError, Player};
use mutated::MOTIONS;
use proptest::prelude::*;

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
        // Neither flash memory behind a block nor its alignment matters.
        let more = [&[0xFF][..], &plan.bytes(), &[0xFF; 7]].concat();
        assert_eq!(play(&more[1..]), Ok(()));
    }
}

#[test]
fn every_truncation_and_every_changed_bit_is_found() {
    for bytes in mutated::damaged() {
        assert!(play(&bytes).is_err(), "{bytes:?}");
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
    assert_eq!(with(&|plan| plan.speeds = vec![80.0, 80.0]), Err(OpenError::Axes));
    assert_eq!(with(&|plan| plan.forces[0] = f32::NAN), Err(OpenError::Axes));
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
    for bytes in mutated::extreme() {
        assert_eq!(play(&bytes), Ok(()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn mutated_blocks_play_or_are_refused(bytes in mutated::changed()) {
        let _ = play(&bytes);
    }

    #[test]
    fn random_numbers_play_or_are_refused((bytes, mild) in mutated::random()) {
        let result = play(&bytes);
        prop_assert!(!mild || result.is_ok());
    }

    #[test]
    fn random_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(play(&bytes).is_err());
        prop_assert!(play(&with_checksum([&b"HTXB\x01\x00"[..], &bytes].concat())).is_err());
    }
}
