//! Size and stated errors of blocks.

use crate::bake_common as common;

use common::asset;
use htex_play::bake::{BakeLimits, BakeResult, Grid, bake};
use htex_play::{Motion, Registry};
use htex_player::{Block, Player};

const KILOBYTE: usize = 1024;
const WITHIN_DB: f64 = 0.3;

/// Largest size of a block on the documented grid, bytes, and its largest errors at the conditions
/// and between them, dB.
fn limits(model: &str) -> (usize, [f64; 2]) {
    match model {
        // A filter of 641 coefficients does not resolve the spectrum of `bands` at a fourth of the
        // highest speed.
        "bands" => (16 * KILOBYTE, [0.45; 2]),
        // The resonances move over the grid, and a finer grid would have more than 64 conditions.
        "arma" => (21 * KILOBYTE, [0.1, 0.32]),
        _ => (16 * KILOBYTE, [0.1, WITHIN_DB]),
    }
}

fn documented(model: &str) -> BakeResult {
    let grid = Grid::new(vec![40.0, 100.0, 160.0], vec![0.2, 0.4, 0.6]).unwrap();
    bake(asset().representation(model).unwrap(), &grid, 8_000.0, WITHIN_DB).unwrap()
}

#[test]
fn a_grid_takes_what_is_documented() {
    for model in Registry::placeless_names() {
        let baked = documented(model);
        let BakeResult { at_conditions_db, between_db, taps, filters, grid, .. } = baked;
        let conditions = grid.motions().count();
        let bytes = baked.bytes.len();
        println!(
            "{model}: {bytes} bytes, {conditions} conditions, {filters} filters of {taps}, {at_conditions_db:.3} dB, {between_db:.3} dB between"
        );
        let (most_bytes, limits_db) = limits(model);
        assert!(bytes <= most_bytes, "{model}: {bytes} bytes");
        assert!(at_conditions_db <= limits_db[0], "{model}");
        assert!(between_db <= limits_db[1], "{model}");
    }
}

#[test]
fn a_limit_of_the_filter_is_kept_and_its_error_told() {
    let grid = Grid::new(vec![40.0, 160.0], vec![0.4]).unwrap();
    let asset = asset();
    let sbeta = asset.representation("sbeta").unwrap();
    let with = |limits: BakeLimits| bake(sbeta, &grid, 8_000.0, limits).unwrap();
    let free = with(BakeLimits::within_db(WITHIN_DB));
    assert!(free.taps > 257, "{}", free.taps);
    for (longest, most) in [(300, 257), (65, 65), (3, 65)] {
        let limited = with(BakeLimits::within_db(WITHIN_DB).with_longest(longest));
        assert!(limited.taps <= most, "{longest}: {}", limited.taps);
        assert!(limited.at_conditions_db > free.at_conditions_db, "{longest}");
    }
}

#[test]
fn a_block_states_quantity_and_law_and_follows_it() {
    let asset = asset();
    let baked = documented("sslope");
    let block = Block::open(&baked.bytes).unwrap();
    assert_eq!(block.quantity().name(), asset.quantity().name());
    assert_eq!(block.quantity().unit(), asset.quantity().unit());
    let sslope = asset.representation("sslope").unwrap();
    let law = sslope.conditions().unwrap().range().law;
    assert_eq!(block.law().level_force, law.level_force.exponent as f32);
    // Beyond the grid, levels have the same ratio as the host's.
    let host = |motion| sslope.level_rms(Some(motion)).unwrap();
    let player = |motion: Motion| {
        let mut player = Player::new(block, 3);
        player.set_motion(motion.speed_mm_s as f32, motion.force_n as f32);
        let mut samples = vec![0.0; 400_000];
        player.render(&mut samples);
        let power: f64 = samples.iter().map(|x| f64::from(*x).powi(2)).sum();
        let peak = samples.iter().fold(0.0f32, |most, x| most.max(x.abs()));
        ((power / samples.len() as f64).sqrt(), peak / block.full_scale())
    };
    let edge = Motion::new(160.0, 0.6);
    let (at_edge, peak) = player(edge);
    assert!((0.5..1.1).contains(&peak), "{peak} of the full scale");
    for beyond in [Motion::new(240.0, 0.6), Motion::new(160.0, 1.1), Motion::new(160.0, 19.0)] {
        let ratio = player(beyond).0 / at_edge;
        let expected = host(beyond) / host(edge);
        assert!((ratio / expected - 1.0).abs() < 0.04, "{beyond:?}: {ratio}, host {expected}");
    }
}
