//! Validation returns a report for any bytes.

use crate::common;

use std::time::{Duration, Instant};

use common::cases::cases;
use common::parts::{manifest, parts};
use common::raw_zip::archive;
use common::{asset, five};
use htex_format::{Limits, validate};

const MUTATIONS: usize = 100_000;

/// xorshift64* (Vigna 2016).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let high = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32;
        (high as usize) % n.max(1)
    }

    fn byte(&mut self) -> u8 {
        let telling = *b"\0\xFF\x7F\x80{}[]\",:-.09eE\\/";
        if self.below(2) == 0 { telling[self.below(telling.len())] } else { self.below(256) as u8 }
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        let at = self.below(bytes.len());
        match self.below(5) {
            0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            1 if at < bytes.len() => bytes[at] = self.byte(),
            2 => bytes.truncate(at),
            3 => bytes.insert(at, self.byte()),
            _ => {
                let from = self.below(other.len());
                let to = (from + self.below(64)).min(other.len());
                let end = (at + self.below(64)).min(bytes.len());
                bytes.splice(at..end, other[from..to].iter().copied());
            }
        }
    }
}

#[test]
fn no_mutation_makes_validation_panic_or_hang() {
    let limits = Limits::default();
    let mut random = Random(0x6874_6578);
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
