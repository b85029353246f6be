//! Validation returns a report for any bytes.

use crate::common;
use crate::mutations::Random;

use std::time::{Duration, Instant};

use common::cases::cases;
use common::parts::{manifest, parts};
use common::raw_zip::archive;
use common::{asset, five};
use htex_format::{Limits, validate};

const MUTATIONS: usize = 100_000;

#[test]
fn no_mutation_makes_validation_panic_or_hang() {
    let limits = Limits::default();
    let mut random = Random::new(b"\0\xFF\x7F\x80{}[]\",:-.09eE\\/");
    let mut whole: Vec<Vec<u8>> = cases().into_iter().map(|case| case.bytes).collect();
    whole.push(asset(2, five(2)).to_bytes().unwrap());
    let (json, block) = (manifest().to_string().into_bytes(), vec![0, 0, 192, 63, 0, 0, 32, 64]);
    let (start, mut slowest, mut valid) = (Instant::now(), Duration::ZERO, 0);
    for i in 0..MUTATIONS {
        let (mut json, mut block) = (json.clone(), block.clone());
        let bytes = match i % 4 {
            0 | 1 => {
                let mut bytes = whole[random.below(whole.len())].clone();
                let other = whole[random.below(whole.len())].clone();
                (0..=random.below(4)).for_each(|_| random.mutate(&mut bytes, &other));
                bytes
            }
            2 => {
                let other = json.clone();
                (0..=random.below(4)).for_each(|_| random.mutate(&mut json, &other));
                archive(&parts(&json, &block))
            }
            _ => {
                (0..=random.below(2)).for_each(|_| random.mutate(&mut block, &json));
                archive(&parts(&json, &block))
            }
        };
        let before = Instant::now();
        valid += usize::from(validate(&bytes, &limits).valid);
        slowest = slowest.max(before.elapsed());
    }
    let took = start.elapsed();
    println!("{MUTATIONS} mutations in {took:.1?}, the slowest {slowest:.1?}, {valid} still valid");
    assert!(took < Duration::from_secs(30) && slowest < Duration::from_secs(1));
}
