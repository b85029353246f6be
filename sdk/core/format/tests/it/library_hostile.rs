//! Reading returns a report for any bytes, in bounded memory.
//!
//! This file has only one test, so that the peak memory of the process belongs to that test.

use crate::library_common as common;
use crate::mutations::Random;

use std::time::{Duration, Instant};

use common::cases::{cases, sharing};
use common::raw::Raw;
use common::{pack, texture};
use htex_format::library::{Library, Limits, validate_source};

const FILES: usize = 100_000;
const MOST_MIB: u64 = 256;

impl Random {
    /// A file with changed bytes anywhere.
    fn file(&mut self, whole: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = whole[self.below(whole.len())].clone();
        let other = &whole[self.below(whole.len())];
        (0..=self.below(4)).for_each(|_| self.mutate(&mut bytes, other));
        bytes
    }

    /// A file with a changed page of the index, and valid checksums and lengths.
    fn with_page(&mut self, raw: &Raw) -> Vec<u8> {
        let number = self.below(raw.leaves.len() + 1);
        let mut page = raw.page(number);
        let other = raw.page(self.below(raw.leaves.len() + 1));
        (0..=self.below(3)).for_each(|_| self.mutate(&mut page, &other));
        raw.clone().with(|raw| raw.replaced = vec![(number, page)]).bytes()
    }
}

#[test]
fn no_mutation_makes_reading_panic_hang_or_take_memory() {
    let limits = Limits::default();
    let mut random = Random::new(b"\0\x01\x7F\x80\xFF/.P");
    let mut whole: Vec<Vec<u8>> = cases().into_iter().map(|case| case.bytes).collect();
    whole.push(pack("Shared", &sharing()).1);
    let raw = Raw::of(&["a", "b/c"].map(texture), 1);
    let (start, mut slowest, mut valid) = (Instant::now(), Duration::ZERO, 0);
    for i in 0..FILES {
        let bytes = match i % 2 {
            0 => random.file(&whole),
            _ => random.with_page(&raw),
        };
        let before = Instant::now();
        let report = validate_source(bytes.as_slice(), &limits).unwrap();
        valid += usize::from(report.valid);
        if let Ok(library) = Library::open_source(bytes.as_slice()) {
            let _ = library.get("b/c");
        }
        slowest = slowest.max(before.elapsed());
    }
    let (took, peak) = (start.elapsed(), peak_mib());
    println!(
        "{FILES} files in {took:.1?}, the slowest {slowest:.1?}, {valid} still valid, peak {peak:?} MiB"
    );
    assert!(valid > 0 && slowest < Duration::from_secs(5));
    assert!(peak.is_none_or(|peak| peak < MOST_MIB), "{peak:?}");
}

/// Returns the peak memory (RSS) of this process; `None` if the system does not report it.
fn peak_mib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib >> 10)
}
