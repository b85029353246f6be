//! What a player renders.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/blocks.rs"]
mod blocks;
#[path = "common/script.rs"]
mod script;

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

/// The largest difference of neighbours.
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
            let got: Vec<f32> = lengths
                .iter()
                .flat_map(|n| rendered(&mut parts, *n))
                .collect();
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
    assert_eq!(block.kind(), BlockKind::Noise { half: 8 });
    assert_eq!(block.speeds_mm_s().collect::<Vec<_>>(), [40.0, 80.0]);
    for (speed, level) in [
        (10.0, 1.0),
        (40.0, 1.0),
        (50.0, 1.25),
        (80.0, 2.0),
        (999.0, 2.0),
    ] {
        let mut player = Player::new(block, 1);
        player.set_motion(speed, 0.1);
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

#[test]
fn a_change_of_the_motion_makes_no_step() {
    let mut plan = tones();
    plan.conditions = vec![1.0, 0.005, 1.0, 0.01, 0.0, 1.0, 0.006, 1.0, 0.01, 0.0];
    let bytes = plan.bytes();
    let mut player = Player::new(Block::open(&bytes).unwrap(), 1);
    let steady = steepest(&rendered(&mut player, 1000));
    for (speed, force) in [
        (80.0, 0.4),
        (0.0, 0.0),
        (40.0, 0.4),
        (1.0, 0.0),
        (80.0, 1.0),
    ] {
        player.set_motion(speed, force);
        let step = steepest(&rendered(&mut player, 137));
        // The level moves by at most 1.42 in 20 samples.
        assert!(
            step < 1.3 * steady + 1.42 / 20.0,
            "{speed} mm/s: {step}, steady {steady}"
        );
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

/// The bits are those of every processor: `sdk/bake/tests/board.rs` compares blocks of models with a Cortex-M4F.
#[test]
fn the_bits_are_constant() {
    let hash =
        |bytes: &[u8]| script::hash(&mut Player::new(Block::open(bytes).unwrap(), script::SEED));
    let hashes = [noise(), tones()].map(|plan| format!("{:08x}", hash(&plan.bytes())));
    assert_eq!(hashes, ["a3f11f1e", "7b3bc533"]);
}
