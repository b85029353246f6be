//! What a player renders.

use crate::common::blocks;

use blocks::{noise, tones};
use htex_player::{Block, BlockKind, Player};

fn rendered(player: &mut Player<'_>, count: usize) -> Vec<f32> {
    let mut samples = vec![0.0; count];
    player.render(&mut samples);
    samples
}

fn rms(samples: &[f32]) -> f64 {
    let power: f64 = samples.iter().map(|x| f64::from(*x).powi(2)).sum();
    (power / samples.len() as f64).sqrt()
}

/// The largest difference between neighbouring samples.
fn steepest(samples: &[f32]) -> f32 {
    let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.fold(0.0, f32::max)
}

#[test]
fn samples_do_not_depend_on_the_lengths_of_buffers() {
    for plan in [noise(), tones()] {
        let bytes = plan.bytes();
        let block = Block::open(&bytes).unwrap();
        let mut whole = Player::new(block, 3);
        let mut parts = Player::new(block, 3);
        for (motion, lengths) in [(50.0, [1, 2, 300]), (0.0, [77, 0, 200]), (75.0, [5, 5, 5])] {
            whole.set_motion(motion, 0.4);
            parts.set_motion(motion, 0.4);
            let expected = rendered(&mut whole, lengths.iter().sum());
            let got: Vec<f32> = lengths.iter().flat_map(|n| rendered(&mut parts, *n)).collect();
            assert_eq!(expected, got);
        }
    }
}

#[test]
fn levels_are_those_of_the_block_and_seeds_differ() {
    let mut plan = noise();
    (plan.up, plan.row) = (1, 0);
    plan.rows.clear();
    let bytes = plan.bytes();
    let block = Block::open(&bytes).unwrap();
    let (half, filters) = (8, 2);
    assert_eq!(block.kind(), BlockKind::Noise { half, filters });
    assert_eq!(block.speeds_mm_s().collect::<Vec<_>>(), [40.0, 80.0]);
    assert_eq!((block.quantity().unit(), block.full_scale()), ("N", 10.0));
    for (speed, force, level) in [
        (40.0, 0.4, 1.0),
        (50.0, 0.4, 1.25),
        (80.0, 0.4, 2.0),
        // Beyond the grid, by the law, starting from the nearest motion of the grid.
        (10.0, 0.4, 0.5),
        (50.0, 0.1, 1.25 * 0.25f64.powf(0.75)),
        (320.0, 0.8, 2.0 * 2.0 * 2f64.powf(0.75)),
        // Ratios of speeds are limited to 1/16 to 8, and the level is limited to the ceiling.
        (1.0, 0.4, 0.25),
        (1000.0, 0.4, 2.0 * 8f64.sqrt()),
        (80.0, 20.0, 8.0),
    ] {
        let mut player = Player::new(block, 1);
        assert!(player.set_motion(speed, force));
        let read = rms(&rendered(&mut player, 400_000));
        assert!((read / level - 1.0).abs() < 0.01, "{speed} mm/s: {read}");
    }
    let [a, b, again] = [1, 2, 1].map(|seed| rendered(&mut Player::new(block, seed), 50_000));
    assert_eq!(a, again);
    let product: f64 = a.iter().zip(&b).map(|(x, y)| f64::from(x * y)).sum();
    assert!((product / 50_000.0).abs() < 0.05, "{product}");
}

#[test]
fn sinusoids_have_their_frequencies_and_levels() {
    let bytes = tones().bytes();
    let mut player = Player::new(Block::open(&bytes).unwrap(), 1);
    let samples = rendered(&mut player, 1000);
    let scale = 1.0 / (0.5 + 0.125f64).sqrt();
    for (n, x) in samples.iter().enumerate() {
        let turn = std::f64::consts::TAU * 0.05 * n as f64;
        let exact = scale * (turn.cos() + 0.5 * (2.0 * turn).cos());
        assert!((f64::from(*x) - exact).abs() < 3e-4, "{n}: {x} and {exact}");
    }
}

/// Returns the frequency of the first sinusoid, cycles per sample.
fn frequency(motion: (f32, f32)) -> f64 {
    let mut plan = tones();
    plan.law[0] = 0.5;
    plan.numbers = vec![0.02, 1.0, 0.1, 0.0, 0.04, 1.0, 0.2, 0.0];
    let bytes = plan.bytes();
    let mut player = Player::new(Block::open(&bytes).unwrap(), 1);
    player.set_motion(motion.0, motion.1);
    let samples = rendered(&mut player, 10_000);
    let rises = samples.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0);
    rises.count() as f64 / 10_000.0
}

#[test]
fn frequencies_of_sinusoids_follow_the_law_beyond_the_grid() {
    for (speed, expected) in
        [(40.0, 0.02), (10.0, 0.01), (320.0, 0.08), (160.0, 0.04 * 2f64.sqrt())]
    {
        let read = frequency((speed, 0.4));
        assert!((read - expected).abs() < 2e-4, "{speed} mm/s: {read}");
    }
    // No frequency is raised above 0.4.
    let mut plan = tones();
    (plan.law[0], plan.highest) = (4.0, 0.4);
    let bytes = plan.bytes();
    let mut player = Player::new(Block::open(&bytes).unwrap(), 1);
    player.set_motion(160.0, 0.4);
    let samples = rendered(&mut player, 10_000);
    // With 0.2 and 0.4 cycles per sample, the period is 5 samples.
    let differs = samples.windows(6).any(|part| (part[5] - part[0]).abs() > 1e-2);
    assert!(!differs);
}

#[test]
fn a_reading_that_is_none_of_a_finger_is_held_for_a_tenth_of_a_second() {
    for plan in [noise(), tones()] {
        let bytes = plan.bytes();
        let block = Block::open(&bytes).unwrap();
        for bad in [(1000.5, 0.4), (-2000.0, 0.4), (60.0, 20.5)] {
            let [mut player, mut steady] = [1, 1].map(|seed| Player::new(block, seed));
            player.set_motion(60.0, 0.4);
            steady.set_motion(60.0, 0.4);
            rendered(&mut player, 7);
            rendered(&mut steady, 7);
            // A hold of 800 samples, which further implausible readings do not prolong.
            let mut held = Vec::new();
            for _ in 0..8 {
                assert!(player.set_motion(bad.0, bad.1));
                held.extend(rendered(&mut player, 100));
            }
            assert_eq!(held, rendered(&mut steady, 800));
            rendered(&mut player, 60);
            assert_eq!(rms(&rendered(&mut player, 100)), 0.0);
            player.set_motion(bad.0, bad.1);
            assert_eq!(rms(&rendered(&mut player, 100)), 0.0);
            player.set_motion(60.0, 0.4);
            rendered(&mut player, 60);
            assert!(rms(&rendered(&mut player, 200)) > 0.5);
        }
    }
}

#[test]
fn a_motion_that_is_set_again_does_not_delay_its_change() {
    for plan in [noise(), tones()] {
        let bytes = plan.bytes();
        let block = Block::open(&bytes).unwrap();
        let [mut often, mut once] = [1, 1].map(|seed| Player::new(block, seed));
        for motion in [(70.0, 0.4), (0.0, 0.0), (45.0, 0.5)] {
            once.set_motion(motion.0, motion.1);
            let expected = rendered(&mut once, 200);
            let mut got = Vec::new();
            for _ in 0..20 {
                often.set_motion(motion.0, motion.1);
                got.extend(rendered(&mut often, 10));
            }
            assert_eq!(expected, got);
        }
    }
}

#[test]
fn a_change_of_the_motion_makes_no_step() {
    let mut plan = tones();
    plan.numbers = vec![0.005, 1.0, 0.01, 0.0, 0.006, 1.0, 0.01, 0.0];
    let bytes = plan.bytes();
    let mut player = Player::new(Block::open(&bytes).unwrap(), 1);
    let steady = steepest(&rendered(&mut player, 1000));
    for (speed, force) in [(80.0, 0.4), (0.0, 0.0), (40.0, 0.4), (1.0, 0.0), (80.0, 0.3)] {
        player.set_motion(speed, force);
        let step = steepest(&rendered(&mut player, 137));
        // The level moves by at most 1.42 in 20 samples.
        assert!(step < 1.3 * steady + 1.42 / 20.0, "{speed} mm/s: {step}, steady {steady}");
    }
}

#[test]
fn a_resting_finger_is_silent_after_the_glide() {
    for plan in [noise(), tones()] {
        let bytes = plan.bytes();
        let mut player = Player::new(Block::open(&bytes).unwrap(), 1);
        rendered(&mut player, 100);
        for (speed, force) in [(0.4, 1.0), (60.0, 0.0), (0.0, 0.0)] {
            player.set_motion(60.0, 0.4);
            assert!(rms(&rendered(&mut player, 200)) > 0.5);
            player.set_motion(speed, force);
            rendered(&mut player, 60);
            assert_eq!(rms(&rendered(&mut player, 100)), 0.0);
        }
    }
}

#[test]
fn integers_are_rounded_samples_within_their_range() {
    let bytes = noise().bytes();
    let block = Block::open(&bytes).unwrap();
    let samples = rendered(&mut Player::new(block, 9), 500);
    for full_scale in [10.0f32, 0.5] {
        let mut integers = [0i16; 500];
        Player::new(block, 9).render_i16(&mut integers, full_scale);
        for (x, i) in samples.iter().zip(integers) {
            let exact = f64::from(*x) * 32_767.0 / f64::from(full_scale);
            let error = exact.clamp(-32_768.0, 32_767.0) - f64::from(i);
            assert!(error.abs() <= 0.51, "{x} and {i}");
        }
    }
    let mut integers = [1i16; 20];
    Player::new(block, 9).render_i16(&mut integers, f32::NAN);
    assert_eq!(integers, [0; 20]);
}
